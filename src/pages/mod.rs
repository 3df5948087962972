//! Reports as pages and on a terminal.

pub mod diagnosis;
mod diagnosis_finding;
mod diagnosis_forward;
pub mod diagnosis_summary;
pub mod identification;
