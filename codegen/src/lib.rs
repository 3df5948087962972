//! From a modified Denavit-Hartenberg table to closed-form Rust.
#![deny(missing_docs)]

pub mod base;
mod emit;
pub mod exact;
mod generate;
pub mod mechanics;
pub mod robot;
pub mod symbolic;

pub use generate::{GenerateError, Module, generate, generate_all, generate_with, operation_counts};

#[cfg(test)]
mod testing;
