//! The two ways of counting joints, as two types.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Place of a joint among the joints, from 0: the index into q, dq, ddq and the torques.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct JointIndex(pub usize);

/// Number j of a joint in the table, from 1: what a person reads and writes, as in `q4` or `Fv4`.
///
/// Fixed frames have numbers too, so that it is not always one more than the [`JointIndex`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct JointNumber(pub usize);

impl fmt::Display for JointNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
