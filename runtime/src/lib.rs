//! All of dynid that runs on recordings; knows no robot by name.
#![deny(missing_docs)]

pub mod diagnosis;
pub mod effects;
pub mod estimation;
pub mod model;
pub mod model_file;
pub mod paper;
pub mod plausibility;
pub mod prediction;
pub mod recording;
pub mod report;
pub mod signal;
pub mod simulation;

mod parallel;
