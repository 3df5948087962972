//! What a person should know about an estimate, in words.

use crate::model::JointNumber;
use serde::{Deserialize, Serialize};

/// What a person should know about an estimate before believing it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
#[non_exhaustive]
pub enum Warning {
    /// The data do not determine a parameter; its value was set to zero.
    NotDetermined {
        /// Its name.
        parameter: String,
        /// The parameters that it cannot be told from; empty: it never acted.
        from: Vec<String>,
    },
    /// The scaled observation matrix is nearly singular.
    BadlyConditioned {
        /// Condition number.
        condition: f64,
        /// The parameters that make up the weakest direction, the strongest first.
        parameters: Vec<String>,
    },
    /// Iterated weights gave up on an equation; the weights of (20) from its own fit were used instead.
    WeightCollapsed {
        /// Its joint; `None` for the power model.
        joint: Option<JointNumber>,
        /// Its relative error with iterated weights.
        relative_error: f64,
    },
    /// The model explains less of an equation than no model at all.
    NotExplained {
        /// Its joint; `None` for the power model.
        joint: Option<JointNumber>,
        /// Its relative error.
        relative_error: f64,
    },
    /// Motions with fewer rows of an equation than it has parameters: their error is taken from the others.
    FewRows {
        /// Their joint; `None` for the power model.
        joint: Option<JointNumber>,
        /// How many motions.
        motions: usize,
        /// Of how many that have rows.
        of: usize,
    },
    /// Total least squares: there are no standard deviations.
    NoDeviations,
    /// Total least squares has no solution here; that of least squares is given.
    NoTotalSolution,
    /// More than half of what tells some parameters apart is noise of the encoders: that part of them may be
    /// anything between nothing and twice as much, which their standard deviations say.
    NoisyColumns,
    /// The iteration of the weights had not converged.
    NotConverged {
        /// Iterations made.
        iterations: usize,
    },
}

/// The equation of a joint, or that of the power model.
fn named(joint: Option<JointNumber>) -> String {
    joint.map_or_else(|| "power".to_owned(), |joint| format!("joint {joint}"))
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Warning::NotDetermined { parameter, from } if from.is_empty() => {
                write!(
                    f,
                    "{parameter} is not determined: nothing in the recording depends on it; set to zero"
                )
            }
            Warning::NotDetermined { parameter, from } => {
                write!(f, "{parameter} cannot be told from {} in this motion; set to zero", from.join(", "))
            }
            Warning::BadlyConditioned { condition, parameters } => write!(
                f,
                "badly conditioned ({condition:.0}): this motion hardly tells {} apart",
                parameters.join(", ")
            ),
            Warning::WeightCollapsed { joint, relative_error } => write!(
                f,
                "{}: iterated weights gave up on it (error {:.0} %); the weights of its own fit were used",
                named(*joint),
                100.0 * relative_error
            ),
            Warning::NotExplained { joint: Some(joint), relative_error } => write!(
                f,
                "joint {joint}: the model does not explain its torque (error {:.0} %)",
                100.0 * relative_error
            ),
            Warning::NotExplained { joint: None, relative_error } => write!(
                f,
                "the model does not explain the power of the joints (error {:.0} %)",
                100.0 * relative_error
            ),
            Warning::FewRows { joint, of: 1, .. } => write!(
                f,
                "{}: fewer equations than parameters, so that its own error says little (a longer motion or a wider \
                 --band gives more)",
                named(*joint)
            ),
            Warning::FewRows { joint, motions, of } => write!(
                f,
                "{}: {motions} of {of} motions have fewer equations than parameters, so that their own error says little; \
                 their weights rest on all motions together (longer motions or a wider --band give more)",
                named(*joint)
            ),
            Warning::NoDeviations => write!(
                f,
                "total least squares gives no standard deviations: its assumption, errors of the columns that are \
                 independent and of one relative size, does not hold for columns that come from one position signal"
            ),
            Warning::NoTotalSolution => {
                write!(f, "total least squares has no solution here: the values are those of least squares")
            }
            Warning::NoisyColumns => write!(
                f,
                "more than half of what tells some parameters apart is noise of the positions: inertias come out too small; \
                 lower --band, or move faster"
            ),
            Warning::NotConverged { iterations } => {
                write!(f, "the weights had not converged after {iterations} iterations")
            }
        }
    }
}
