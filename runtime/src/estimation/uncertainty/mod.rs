//! How much an estimate can be believed: variances of groups, noise that lasts, covariances.

mod autoregression;
mod between;
mod covariance;
mod freedom;
mod noise;
mod series;
mod variance_function;

pub(super) use covariance::{Solved, covariance, variances};
