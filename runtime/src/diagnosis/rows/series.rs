//! One column in one motion.

/// One column in one motion at the full rate: the joints that it acts on, with their torques.
pub(in crate::diagnosis) type Series = Vec<(usize, Vec<f64>)>;
