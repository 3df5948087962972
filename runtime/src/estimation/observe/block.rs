//! The size of the blocks in which columns are computed at the full rate.

/// Samples that are evaluated at a time, a whole number of lines.
pub(super) const BLOCK: usize = 64;
