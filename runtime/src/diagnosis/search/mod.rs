//! Search: which candidates become part of the model, one after the other.

pub(in crate::diagnosis) mod bench;
pub(in crate::diagnosis) mod body;
mod certainty;
pub(in crate::diagnosis) mod extended_model;
pub(in crate::diagnosis) mod free_form;
pub(in crate::diagnosis) mod friction_change;
pub(in crate::diagnosis) mod gate;
mod generalise;
pub(in crate::diagnosis) mod line;
mod one_curve;
pub(in crate::diagnosis) mod pair;
mod precedence;
pub(in crate::diagnosis) mod prominence;
pub(in crate::diagnosis) mod reconsider;
pub(in crate::diagnosis) mod refine;
pub(in crate::diagnosis) mod report;
pub(in crate::diagnosis) mod round;
pub(in crate::diagnosis) mod run;
pub(in crate::diagnosis) mod select;
mod sharpen;
pub(in crate::diagnosis) mod small_law;
pub(in crate::diagnosis) mod standing;
pub(in crate::diagnosis) mod state;
pub(in crate::diagnosis) mod tangents;
pub(in crate::diagnosis) mod term;
pub(in crate::diagnosis) mod transient;
pub(in crate::diagnosis) mod tuning;
