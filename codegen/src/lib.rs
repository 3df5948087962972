//! From a modified Denavit-Hartenberg table to closed-form Rust.
#![deny(missing_docs)]

pub mod base;
pub mod exact;
pub mod robot;
