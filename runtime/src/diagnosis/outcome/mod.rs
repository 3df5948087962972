//! What a diagnosis found, as data: the JSON of the contract and what a report draws.

mod between_motions;
mod drawn;
mod errors;
mod finding;

pub use between_motions::BetweenMotions;
pub use drawn::{Curve, FineLaw, OrderSpectrum, TorqueSeries};
pub use errors::{Errors, HeldOut, Mismatch, Unexplained};
pub use finding::{
    Alternative, CannotTell, Finding, NotJudged, OnTest, ParameterValue, Refuted, Removed, Small, Standing,
    Transient, WithoutIt,
};

use crate::effects::EffectTerm;
use serde::{Deserialize, Serialize};

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
    /// Laws of a reference: missing in the standard model, and no news.
    #[serde(default)]
    pub standing: Vec<Standing>,
    /// What was there at the beginning of the motion and cannot be told from an event. The parameters were found beside it;
    /// it is no part of what is saved.
    #[serde(default)]
    pub transients: Vec<Transient>,
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
    /// Its standard deviation, s.
    pub delay_sigma: f64,
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
    /// Laws that a test recording does not show, in the order in which they were taken out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refuted: Vec<Refuted>,
    /// Upper triangle, row by row, of the covariance of the base parameters and of the amplitudes of [`Self::terms`], in
    /// their order; a row of zeros is of what is not determined. Not part of the JSON.
    #[serde(skip)]
    pub covariance: Option<Vec<f64>>,
    /// How much each joint's torques differ from one motion to the next, where the recording has several; empty where
    /// nobody knows. Not part of the JSON.
    #[serde(skip)]
    pub between_motions: Vec<Option<BetweenMotions>>,
}

impl Diagnosis {
    /// What the model takes to other motion beside its parameters: the terms of the findings, and those that a reference has
    /// already. Transients stay with the motion that they were in.
    pub fn terms(&self) -> Vec<EffectTerm> {
        let found = self.findings.iter().map(|f| &f.term);
        found.chain(self.standing.iter().map(|s| &s.term)).cloned().collect()
    }
}
