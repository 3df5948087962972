//! Judging: what a candidate gains on motion that it was not fitted to, and how sure it is that this is no accident.

pub(in crate::diagnosis) mod ar;
pub(in crate::diagnosis) mod autocorrelation;
pub(in crate::diagnosis) mod between_motions;
pub(in crate::diagnosis) mod calibration;
mod changes;
mod compared;
pub(in crate::diagnosis) mod evidence;
pub(in crate::diagnosis) mod folds;
pub(in crate::diagnosis) mod held_out;
pub(in crate::diagnosis) mod hull;
pub(in crate::diagnosis) mod judge;
#[cfg(test)]
mod judge_tests;
mod lag_products;
pub(in crate::diagnosis) mod partial_regression;
pub(in crate::diagnosis) mod passage;
pub(in crate::diagnosis) mod prediction;
pub(in crate::diagnosis) mod projection;
pub(in crate::diagnosis) mod regression;
pub(in crate::diagnosis) mod regressors;
pub(in crate::diagnosis) mod significance;
pub(in crate::diagnosis) mod skew;
mod taken;
#[cfg(test)]
pub(in crate::diagnosis) mod testing;
#[cfg(test)]
mod tests;
pub(in crate::diagnosis) mod uneven_noise;
pub(in crate::diagnosis) mod units;
mod wald;
pub(in crate::diagnosis) mod white_products;
mod whitening;
