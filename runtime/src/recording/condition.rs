//! What a manifest says of the temperature or the load that a recording was made at.

use serde::Deserialize;

use super::column::Column;

/// Columns of a condition. They are read by [`conditions`](super::conditions) alone: a row without a readable temperature is as right as the others.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// The file, where it is not the trajectory's.
    #[serde(default)]
    pub file: Option<String>,
    /// Any number; their mean counts.
    pub columns: Vec<Column>,
    /// Of a temperature `degC`, `K` or `degF`; of a load what a person calls it, the same for all recordings of a robot.
    #[serde(default)]
    pub unit: Option<String>,
}
