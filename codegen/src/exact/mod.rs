//! Exact arithmetic for decisions that floating point could only guess: what is zero, what is singular.

mod rational;

pub use rational::{decimal, determinant, inverse};
