//! Candidates: every effect of the catalogue at every place, with a grid of shapes, as columns on the rows.

pub(in crate::diagnosis) mod candidate;
pub(in crate::diagnosis) mod companions;
pub(in crate::diagnosis) mod free_form;
pub(in crate::diagnosis) mod gains;
mod glance;
pub(in crate::diagnosis) mod nuisances;
pub(in crate::diagnosis) mod order_line;
pub(in crate::diagnosis) mod position_noise;
pub(in crate::diagnosis) mod ringing;
pub(in crate::diagnosis) mod spectrum;
pub(in crate::diagnosis) mod trial;
mod wave;
