//! Statistics that identification and diagnosis share.

// For curves, which are those of the evaluator and of the diagnosis.
#[cfg(feature = "diagnosis")]
pub(crate) mod bins;
// For scans over values, which the diagnosis alone makes.
#[cfg(feature = "diagnosis")]
pub(crate) mod golden;
// For lines of a spectrum, which the diagnosis alone looks for.
#[cfg(feature = "diagnosis")]
pub(crate) mod greatest_of;
pub(crate) mod median;
pub(crate) mod moderation;
pub(crate) mod student;
