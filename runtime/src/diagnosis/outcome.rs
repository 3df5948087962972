//! What a diagnosis found, as data: the JSON of the contract and what a report draws.

use crate::effects::{ContactForce, EffectTerm, Parameter};
use serde::{Deserialize, Serialize};

/// Relative errors |Y - W chi| / |Y|.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Errors {
    /// All joints together.
    pub relative_error: f64,
    /// Joint by joint.
    pub per_joint: Vec<f64>,
}

impl Errors {
    /// From the squares of residual and torque, per joint.
    pub(crate) fn of_squares(left: &[f64], whole: &[f64]) -> Self {
        let ratio = |a: f64, b: f64| if b > 0.0 { (a / b).sqrt() } else { 0.0 };
        Self {
            relative_error: ratio(left.iter().sum(), whole.iter().sum()),
            per_joint: left.iter().zip(whole).map(|(a, b)| ratio(*a, *b)).collect(),
        }
    }
}

/// Relative errors on motion that was held out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct HeldOut {
    /// How motion was held out.
    pub how: String,
    /// Standard model.
    pub before: f64,
    /// With the findings.
    pub after: f64,
    /// Standard model, joint by joint.
    pub per_joint_before: Vec<f64>,
    /// With the findings, joint by joint.
    pub per_joint_after: Vec<f64>,
    /// The same for each motion or stretch that was held out: its name, before, after.
    pub by_motion: Vec<(String, f64, f64)>,
}

/// Where the standard model fails.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mismatch {
    /// Number j of the joint.
    pub joint: usize,
    /// Share of all unexplained torque beyond the noise floor, in units of each joint's noise.
    pub share: f64,
    /// In words.
    #[serde(rename = "where")]
    pub where_: String,
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

/// The residual against the variable that reveals an effect, with the fitted law over it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    /// Variable, with its unit.
    pub variable: String,
    /// Torque unit.
    pub unit: String,
    /// Middle of each bin.
    pub x: Vec<f64>,
    /// Mean of the residual that the effect has to explain.
    pub residual: Vec<f64>,
    /// Standard error of that mean.
    pub error: Vec<f64>,
    /// Mean of the fitted law.
    pub law: Vec<f64>,
}

/// Amplitude over order of a joint's residual: periods per radian (or metre) times 2 pi.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct OrderSpectrum {
    /// Number j of the joint.
    pub joint: usize,
    /// Order: angle of the wave per angle of the joint.
    pub order: Vec<f64>,
    /// Order per motor turn is order divided by this.
    pub gear: f64,
    /// Amplitude, N.m or N.
    pub amplitude: Vec<f64>,
}

/// Torques of one joint in one motion.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TorqueSeries {
    /// Motion.
    pub motion: String,
    /// Number j of the joint.
    pub joint: usize,
    /// s.
    pub time: Vec<f64>,
    /// Measured.
    pub measured: Vec<f64>,
    /// Standard model, refitted without the findings.
    pub before: Vec<f64>,
    /// With the findings.
    pub after: Vec<f64>,
}

/// A base parameter before and after the findings became part of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterShift {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Standard model alone.
    pub before: f64,
    /// Its standard deviation.
    pub sigma_before: f64,
    /// With the findings.
    pub after: f64,
    /// Its standard deviation.
    pub sigma_after: f64,
}

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
    /// Its term in the model.
    pub term: EffectTerm,
    /// Where it is a contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactForce>,
}

impl Finding {
    /// A term of a model, with everything else still unknown: no confidence, no errors, no words.
    pub fn of(term: EffectTerm) -> Self {
        Self {
            effect: term.effect.id().into(),
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
            term,
            contacts: Vec::new(),
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

/// Effects that this motion cannot tell apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CannotTell {
    /// Effects.
    pub between: Vec<String>,
    /// Numbers j of the joints.
    pub joints: Vec<usize>,
    /// The motion that would tell.
    pub experiment: String,
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

/// What nothing explains.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Unexplained {
    /// Share of the remaining held-out squares that is not noise, over all joints.
    pub share: f64,
    /// The same joint by joint.
    pub per_joint: Vec<f64>,
    /// Remaining residual of each joint over its speed.
    pub curves: Vec<Curve>,
}

/// A standard parameter set: base parameters with their standard deviations.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Estimated {
    /// chi.
    pub chi: Vec<f64>,
    /// Standard deviations.
    pub sigma: Vec<f64>,
}

/// Which part of the signals was looked at: band, windows, rows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Sampling {
    /// Highest frequency of the fast rows, Hz: half of the amplitude passes there. Errors are those of the fast rows.
    pub band: f64,
    /// The same of the slow rows, on which effects that are as slow as the motion are looked for.
    pub slow_band: f64,
    /// Cut-off of the filter of positions and torques, Hz (at most a fifth of the sampling rate of each motion).
    pub cutoff: f64,
    /// Half-width of the smoothing of the fast rows, s; rows are as far apart.
    pub fast_window: f64,
    /// Half-width of the smoothing of the slow rows, s.
    pub slow_window: f64,
    /// Speeds below which the joints count as standing still, rad/s or m/s; rows near a standstill are left out.
    pub standstill_speeds: Vec<f64>,
    /// Fast rows, all joints.
    pub fast_rows: usize,
    /// Slow rows, all joints.
    pub slow_rows: usize,
}

/// Why no more effects were added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StopReason {
    /// No candidate was left that holds.
    NoneAccepted,
    /// As many effects as the settings allow: there may be more.
    EffectLimit(usize),
    /// The effects were given.
    Given,
}

/// An effect that was accepted first and did not hold beside the others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Removed {
    /// Effect.
    pub effect: String,
    /// Numbers j of its joints; empty for the whole robot.
    pub joints: Vec<usize>,
}

/// How the search for effects ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SearchOutcome {
    /// Why it stopped.
    pub stop: StopReason,
    /// What was taken out of the model again.
    pub removed: Vec<Removed>,
}

/// The outcome of a diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Diagnosis {
    /// Robot.
    pub robot: String,
    /// Standard model, in sample.
    pub before: Errors,
    /// With the findings, in sample.
    pub after: Errors,
    /// On motion that was held out.
    pub held_out: HeldOut,
    /// Joint by joint, largest share first.
    pub mismatch: Vec<Mismatch>,
    /// What was found.
    pub findings: Vec<Finding>,
    /// What this motion cannot tell.
    pub cannot_tell: Vec<CannotTell>,
    /// What is there and too small to be named.
    #[serde(default)]
    pub small: Vec<Small>,
    /// What nothing explains.
    pub unexplained: Unexplained,
    /// The verdict in plain sentences.
    pub verdict: Vec<String>,
    /// Parameters that the findings moved by more than three standard deviations.
    pub shifts: Vec<ParameterShift>,
    /// Parameters of the standard model alone.
    pub standard: Estimated,
    /// Parameters with the findings in the model: what is saved, together with the terms of the findings.
    pub model: Estimated,
    /// Skew between torque and position that was taken out, s.
    pub delay: f64,
    /// Order spectra of the residuals of joints with ripple.
    pub spectra: Vec<OrderSpectrum>,
    /// Torques before and after on the joints of the findings.
    pub series: Vec<TorqueSeries>,
    /// Rows used.
    pub rows: usize,
    /// Things tried: effects at places, with all of their shapes.
    pub tried: usize,
    /// Band, windows and rows that all of this rests on.
    pub sampling: Sampling,
    /// How the search ended.
    pub search: SearchOutcome,
    /// Joints about which the recording says nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_judged: Vec<NotJudged>,
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

impl Diagnosis {
    /// The accepted terms.
    pub fn terms(&self) -> Vec<EffectTerm> {
        self.findings.iter().map(|f| f.term.clone()).collect()
    }
}
