//! What was found, and what was not chosen, cannot be told or was too small.

use super::drawn::Curve;
use crate::effects::{ContactForce, EffectTerm, Parameter};
use serde::{Deserialize, Serialize};

/// An effect that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Finding {
    /// Effect.
    pub effect: String,
    /// Numbers j of the joints; empty for the whole robot.
    pub joints: Vec<usize>,
    /// One minus the probability that held-out motion improves so much by chance, all tries counted.
    pub confidence: f64,
    /// Mean held-out gain of a block of motion in standard errors; 0 where it was not measured by blocks.
    #[serde(default)]
    pub significance: f64,
    /// Its quantities by name.
    pub parameters: std::collections::BTreeMap<String, ParameterValue>,
    /// Held-out relative error of its joints without it (everything else in the model).
    pub held_out_before: f64,
    /// With it.
    pub held_out_after: f64,
    /// Share of the held-out squares of its joints that it explains.
    pub share: f64,
    /// Other explanations.
    pub alternatives: Vec<Alternative>,
    /// For a person.
    pub sentence: String,
    /// What the report draws.
    pub curve: Option<Curve>,
    /// Curves over further variables, where it depends on several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub more_curves: Vec<Curve>,
    /// What it depends on, where that is not what its effect says: `q3`, `dq2`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<String>,
    /// A short formula that fits its curve within the band. Others may do as well.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposal: Option<String>,
    /// Its term in the model.
    pub term: EffectTerm,
    /// Where it is a contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactForce>,
    /// How much of it a test recording shows; `None` where there is none, or where its rows do not show such a law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on_test: Option<OnTest>,
    /// The model without it, everything else fitted anew; `None` where it is no term of the fit.
    #[serde(skip)]
    pub without: Option<WithoutIt>,
}

/// How much of a law is there on motion that it was not fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnTest {
    /// Slope of what the model without the law leaves over what the law predicts: 1 where all of it is there, 0 where
    /// nothing of it is.
    pub part: f64,
    /// Its standard deviation; `None` where too little motion shows the law to tell.
    pub sigma: Option<f64>,
    /// Stretches of motion that the standard deviation is made from.
    pub units: usize,
}

/// A model without one of its effects.
#[derive(Debug, Clone, PartialEq)]
pub struct WithoutIt {
    /// Base parameters.
    pub chi: Vec<f64>,
    /// The other effects.
    pub effects: Vec<EffectTerm>,
}

impl Finding {
    /// A term of a model, with everything else still unknown: no confidence, no errors, no words.
    pub fn of(term: EffectTerm) -> Self {
        Self {
            effect: term.id().into(),
            joints: term.joints.clone(),
            confidence: 0.0,
            significance: 0.0,
            parameters: std::collections::BTreeMap::new(),
            held_out_before: 0.0,
            held_out_after: 0.0,
            share: 0.0,
            alternatives: Vec::new(),
            sentence: String::new(),
            curve: None,
            more_curves: Vec::new(),
            variables: Vec::new(),
            proposal: None,
            term,
            contacts: Vec::new(),
            on_test: None,
            without: None,
        }
    }
}

/// A value in the JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// Value, SI.
    pub value: f64,
    /// Standard deviation; 0 where not known.
    pub sigma: f64,
    /// Unit.
    pub unit: String,
}

impl From<&Parameter> for ParameterValue {
    fn from(p: &Parameter) -> Self {
        Self { value: p.value, sigma: p.sigma, unit: p.unit.clone() }
    }
}

/// A rejected explanation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Effect.
    pub effect: String,
    /// Numbers j of its joints.
    pub joints: Vec<usize>,
    /// Why it was not chosen.
    pub why_not: String,
    /// Share of the held-out squares that it would have explained.
    pub share: f64,
}

/// Effects that this motion cannot tell apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CannotTell {
    /// Effects.
    pub between: Vec<String>,
    /// Numbers j of the joints of all.
    pub joints: Vec<usize>,
    /// Those of each where they differ, none for the whole robot; empty where each is on all of `joints`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub on: Vec<Vec<usize>>,
    /// The motion that would tell.
    pub experiment: String,
    /// Variables of each, where the effects are laws over variables that go together in this motion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<Vec<String>>,
}

impl CannotTell {
    /// What cannot be told apart: effects, each with the variables that it is over where it has any.
    pub fn sides(&self) -> Vec<String> {
        let over = |k: usize| match self.variables.get(k).map(Vec::as_slice) {
            None | Some([]) => String::new(),
            Some(variables) => format!(" over {}", variables.join(" and ")),
        };
        self.between.iter().enumerate().map(|(k, effect)| format!("{effect}{}", over(k))).collect()
    }
}

/// A law that is there, and no larger than what the robot's torques repeat to: no finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Small {
    /// Effect.
    pub effect: String,
    /// Numbers j of the joints; empty for the whole robot.
    pub joints: Vec<usize>,
    /// Root mean square of its torque that nothing else explains, on the joint where it stands out most.
    pub torque: f64,
    /// How large it had to be to be named.
    pub least: f64,
    /// Unit of both.
    pub unit: String,
}

/// A law that a reference has already, with the amplitudes that reference and recording have together: no finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// Effect.
    pub effect: String,
    /// Numbers j of the joints; empty for the whole robot.
    pub joints: Vec<usize>,
    /// Its term in the model.
    pub term: EffectTerm,
}

/// A law of time that is certain to be there and cannot be told from an event: part of the model, and no finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Transient {
    /// Effect.
    pub effect: String,
    /// Numbers j of the joints; empty for the whole robot.
    pub joints: Vec<usize>,
    /// So many seconds after the beginning of the motion nearly nothing is left of it.
    pub faded_after: f64,
    /// Its term in the model.
    pub term: EffectTerm,
}

/// An effect that was accepted first and did not hold beside the others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Removed {
    /// Effect.
    pub effect: String,
    /// Numbers j of its joints; empty for the whole robot.
    pub joints: Vec<usize>,
}

/// A law that the recording shows and a test recording does not: it is not in the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refuted {
    /// Effect.
    pub effect: String,
    /// Numbers j of its joints; empty for the whole robot.
    pub joints: Vec<usize>,
    /// Relative error of the test recording's torques on its joints without it.
    pub test_before: f64,
    /// With it.
    pub test_after: f64,
    /// How much of it is there.
    pub on_test: OnTest,
    /// Whether it is there on its joints, and the other joints are predicted worse with it.
    #[serde(default)]
    pub harms_others: bool,
}

/// A joint on which nothing could be looked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NotJudged {
    /// Number j of the joint.
    pub joint: usize,
    /// Rows in which it moves.
    pub rows: usize,
    /// What would be needed, in words.
    pub why: String,
}
