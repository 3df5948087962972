//! All of dynid that runs on recordings; knows no robot by name.
#![deny(missing_docs)]

#[cfg(feature = "diagnosis")]
pub mod confirmation;
#[cfg(feature = "diagnosis")]
pub mod diagnosis;
pub mod effects;
pub mod estimation;
pub mod law_file;
pub mod model;
#[cfg(feature = "diagnosis")]
pub mod model_file;
#[cfg(feature = "paper")]
pub mod paper;
pub mod plausibility;
#[cfg(feature = "diagnosis")]
pub mod prediction;
pub mod recording;
pub mod regular_file;
pub mod report;
pub mod signal;
#[cfg(feature = "simulation")]
pub mod simulation;

mod far_off;
mod parallel;
mod statistics;
#[cfg(test)]
mod testing;
