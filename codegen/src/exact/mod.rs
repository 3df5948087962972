//! Exact arithmetic for decisions that floating point could only guess: what is zero, what is singular, what depends
//! on what.

mod angle;
mod form;
mod number;
mod rational;
mod span;

pub use angle::{Angles, Rotation};
pub use form::Form;
pub use number::Number;
pub use rational::{decimal, determinant, inverse};
pub use span::Span;
