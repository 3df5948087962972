//! dynid.

pub mod models;
