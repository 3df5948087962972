//! The one evaluator: torques of a model, with its effects and its delay, on the motions of a recording, and what
//! they leave of the measured ones.
//!
//! Every relative error that dynid gives of a model on a recording is [`evaluate`]'s: ||Y - prediction|| / ||Y|| over
//! the rows that an observation of the recording uses, both brought to the rows by the same low-pass filter. Models
//! that are compared are evaluated together: they have the same rows and the same band by construction.
//!
//! A figure means nothing without its band: friction that is missing shows below 5 Hz, ripple and elasticity above
//! 20 Hz, and from some frequency on there is only noise. [`Comparison`] says which band is taken.

mod comparison;
mod errors;
mod evaluate;
mod noise;
mod predictor;
mod states;
mod trend;

pub use crate::diagnosis::Errors;
pub use comparison::{Comparison, Prepared};
pub use errors::{above_noise, observed_errors};
pub use evaluate::{Evaluation, JointRows, Prediction, evaluate};
pub use predictor::{PredictionError, Predictor};
pub use states::{StateRows, row_states};
pub use trend::binned_means;

#[cfg(test)]
mod tests;
