//! Exact arithmetic for decisions that floating point could only guess: what is zero, what is singular, what depends
//! on what.

mod angle;
mod form;
mod rational;
mod span;
mod surd;

pub use angle::{Angles, Rotation};
pub use form::Form;
pub use rational::{decimal, determinant, inverse};
pub use span::Span;
pub use surd::Surd;
