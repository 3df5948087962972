//! From a modified Denavit-Hartenberg table to closed-form Rust.
#![deny(missing_docs)]

pub mod base;
mod emit;
pub mod exact;
mod generate;
pub mod mechanics;
pub mod robot;
pub mod symbolic;

pub use generate::{Collection, GenerateError, generate, generate_with, operation_counts, read_all};

#[cfg(test)]
mod testing;
