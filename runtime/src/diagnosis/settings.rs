//! What a diagnosis can be told, and what it tells while it works.

use super::rows::signals::CUTOFF;
use crate::estimation::choose_bandwidth;
use crate::recording::Trajectory;

/// Settings of a diagnosis. None of them knows a robot: speeds and travels count relative to the joint's own.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Half-width of the smoothing for effects that are as slow as the motion, s.
    pub slow_window: f64,
    /// Half-width of the smoothing for effects faster than the motion (ripple, elasticity, backlash), s.
    pub fast_window: f64,
    /// Rows where a joint is slower than this fraction of its top speed are left out: sign(v) is noise there.
    pub standstill: f64,
    /// Least share of a joint's unexplained held-out energy that an effect must explain to be named.
    pub least_share: f64,
    /// Least confidence: one minus the probability that any of all candidates comes as far by accident.
    pub least_confidence: f64,
    /// Most effects that are named.
    pub most_effects: usize,
    /// Threads.
    pub threads: usize,
}

/// Cut-off of the position filter, and settings whose windows let through no more than the recording's band.
pub(super) fn fitted_to(
    settings: &Settings,
    trajectories: &[Trajectory],
) -> Result<(f64, Settings), DiagnosisError> {
    let band = choose_bandwidth(trajectories)?;
    // A Hann window of half-width T lets half of the amplitude through at 1 / (2 T).
    let least = 0.5 / band.band.max(1e-6);
    let mut fitted = settings.clone();
    fitted.slow_window = fitted.slow_window.max(least);
    fitted.fast_window = fitted.fast_window.max(least);
    Ok((band.cutoff.min(CUTOFF), fitted))
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            slow_window: 0.045,
            fast_window: 0.020,
            standstill: 0.015,
            least_share: 0.12,
            least_confidence: 0.99,
            most_effects: 12,
            threads: 2,
        }
    }
}

/// Told how far a diagnosis is.
pub trait Progress: Sync {
    /// `done` in 0..=1 of the whole, and what is being done.
    fn at(&self, done: f64, what: &str);
}

/// Tells nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn at(&self, _: f64, _: &str) {}
}

/// Why the data cannot support a diagnosis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiagnosisError {
    /// A signal could not be prepared.
    #[error(transparent)]
    Signal(#[from] crate::signal::SignalError),
    /// The recursive model could not be built.
    #[error(transparent)]
    Model(#[from] crate::model::RecursiveModelError),
    /// No motion at all.
    #[error("the recording has no motion")]
    NoMotion,
    /// No joint moves for long enough, and no baseline tells what the robot is like.
    #[error(
        "no joint moves for long enough to conclude anything: joint {joint} moves most, in {rows} usable rows of the {needed} that a joint needs; let at least one joint move back and forth for ten seconds at two speeds, or give a baseline in which the robot moves"
    )]
    NothingMoves {
        /// Number j of the joint that moves most.
        joint: usize,
        /// Its rows.
        rows: usize,
        /// Rows that a joint needs.
        needed: usize,
    },
    /// Fewer rows than numbers.
    #[error(
        "the motion is too short: {rows} usable rows for {parameters} parameters of the standard model that it determines; record at least {times} times as long"
    )]
    TooShort {
        /// Rows of all joints.
        rows: usize,
        /// Parameters that they determine.
        parameters: usize,
        /// How much longer it should be.
        times: usize,
    },
    /// The standard model does not describe the recording at all.
    #[error(
        "the standard model explains only {explained:.0} % of the torque: is this the right robot, with the right units and joint order?"
    )]
    AnotherRobot {
        /// Per cent.
        explained: f64,
    },
}
