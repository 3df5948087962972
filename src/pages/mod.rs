//! Reports as pages and on a terminal.

pub mod diagnosis;
pub mod identification;
