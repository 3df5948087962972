//! The HTML reports.

pub mod identification;
