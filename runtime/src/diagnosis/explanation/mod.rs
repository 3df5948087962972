//! Explanation: from accepted effects to numbers, curves and sentences.

mod binned;
pub(in crate::diagnosis) mod covariance;
pub(in crate::diagnosis) mod curves;
pub(in crate::diagnosis) mod delay;
mod deviations;
pub(in crate::diagnosis) mod explain;
pub(in crate::diagnosis) mod finding;
mod fine_law;
pub(in crate::diagnosis) mod free_form;
mod how;
pub(in crate::diagnosis) mod line;
mod proposal;
pub(in crate::diagnosis) mod pushed;
pub(in crate::diagnosis) mod quantities;
pub(in crate::diagnosis) mod rate;
pub(in crate::diagnosis) mod standard_model;
pub(in crate::diagnosis) mod standing;
pub(in crate::diagnosis) mod standstill;
pub(in crate::diagnosis) mod transient;
pub(in crate::diagnosis) mod words;
