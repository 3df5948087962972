//! How much an estimate can be believed: variances of groups, noise that lasts, covariances.

mod autoregression;
mod between;
mod covariance;
mod noise;
mod series;

pub(super) use covariance::{Solved, covariance, variances};
