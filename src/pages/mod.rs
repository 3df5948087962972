//! Reports as pages and on a terminal.

pub mod diagnosis;
pub mod identification;
mod parameters;
mod provenance;
mod residuals;
mod torques;
pub mod validation;

pub use parameters::Prior;
