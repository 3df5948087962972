//! Topics of a log.

use serde::Serialize;

/// What a log published under one name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// Type of its messages.
    pub kind: String,
    /// How they are encoded; `cdr` in ROS 2.
    pub encoding: String,
    /// How many there are.
    pub count: u64,
}
