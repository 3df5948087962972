//! What a report of a diagnosis shows besides the diagnosis itself.

use dynid_runtime::diagnosis::Diagnosis;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::NamedParameter;
use dynid_runtime::prediction::{Evaluation, StateRows};
use dynid_runtime::simulation::replay::ClosedLoop;

use crate::compared::Compared;
use crate::estimated::named;
use crate::pages::Prior;
use crate::provenance::Provenance;
use crate::words::joint_number;

/// A recording that took no part in the diagnosis, and both models on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tested {
    /// Which recording.
    pub name: String,
    /// The standard model, then the model with the findings.
    pub evaluation: Evaluation,
}

/// Both models on the recording itself, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The standard model, then the model with the findings.
    pub evaluation: Evaluation,
    /// The states at its rows.
    pub states: Vec<StateRows>,
}

/// What a report has besides the diagnosis itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Extras {
    /// The robot.
    pub robot: Robot,
    /// The standard model and the model with the findings on the recording itself; `None` where it is too short.
    pub fitted: Option<Fitted>,
    /// The same on a recording that took no part.
    pub tested: Option<Tested>,
    /// The recording by forward simulation, or why it cannot be simulated; `None` where it was not asked for.
    pub forward: Option<Result<ClosedLoop, String>>,
    /// What was known of the base parameters beforehand.
    pub prior: Option<Prior>,
    /// Where all of it comes from.
    pub from: Provenance,
}

impl Extras {
    /// Of a robot of which nothing else is known than its table.
    pub fn of(robot: &Robot) -> Self {
        Self {
            robot: robot.clone(),
            fitted: None,
            tested: None,
            forward: None,
            prior: Prior::nominal(robot),
            from: Provenance::default(),
        }
    }

    /// Both models on the recording itself.
    pub fn evaluation(&self) -> Option<&Evaluation> {
        self.fitted.as_ref().map(|fitted| &fitted.evaluation)
    }

    /// The rows of the recording itself with both models, which are called before and after, or in a file `before` and
    /// `predicted`.
    pub fn compared(&self) -> Option<Compared<'_>> {
        let Fitted { evaluation, states } = self.fitted.as_ref()?;
        Some(Compared { robot: &self.robot, evaluation, states, models: &["before", "predicted"] })
    }

    /// The parameters with the findings in the model.
    pub(super) fn parameters(&self, diagnosis: &Diagnosis) -> Vec<NamedParameter> {
        named(&self.robot, &diagnosis.model)
    }

    /// `joint 3`, by the table, for a joint counted from 0.
    pub(super) fn joint(&self, j: usize) -> String {
        format!("joint {}", joint_number(&self.robot, j))
    }
}
