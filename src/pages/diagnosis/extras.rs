//! What a report of a diagnosis shows besides the diagnosis itself.

use dynid_runtime::prediction::Evaluation;
use dynid_runtime::simulation::replay::ClosedLoop;

/// A recording that took no part in the diagnosis, and both models on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tested {
    /// Which recording.
    pub name: String,
    /// The standard model, then the model with the findings.
    pub evaluation: Evaluation,
}

/// What a report has besides the diagnosis itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extras {
    /// The standard model and the model with the findings on the recording itself; `None` where it is too short.
    pub fitted: Option<Evaluation>,
    /// The same on a recording that took no part.
    pub tested: Option<Tested>,
    /// The recording by forward simulation, or why it cannot be simulated; `None` where it was not asked for.
    pub forward: Option<Result<ClosedLoop, String>>,
    /// The number of each joint in the robot's table.
    pub joints: Vec<String>,
}

impl Extras {
    /// `joint 3`, by the table, for a joint counted from 0.
    pub(super) fn joint(&self, j: usize) -> String {
        format!("joint {}", self.joints.get(j).map_or_else(|| (j + 1).to_string(), String::clone))
    }
}
