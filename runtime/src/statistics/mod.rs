//! Statistics that identification and diagnosis share.

// For curves, which are those of the evaluator and of the diagnosis.
#[cfg(feature = "diagnosis")]
pub(crate) mod bins;
pub(crate) mod median;
pub(crate) mod moderation;
pub(crate) mod student;
