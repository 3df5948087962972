//! The HTML reports.

pub mod diagnosis;
pub mod identification;
