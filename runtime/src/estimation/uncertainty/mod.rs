//! How much an estimate can be believed: variances of groups, noise that lasts, covariances.

mod autoregression;
mod between;
mod covariance;
mod freedom;
mod innovations;
mod noise;
mod series;
mod solved;
mod variance_function;

pub(super) use covariance::{covariance, variances};
pub(super) use solved::Solved;
