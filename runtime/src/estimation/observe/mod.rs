//! Observation: from motions to orthogonal factors of [W Y], one for each trajectory, block of time and equation.

mod merge;
mod row_plan;
mod rows;
mod select;
mod source;
mod stream;
#[cfg(test)]
mod tests;
mod work;

use std::ops::Range;

pub(crate) use row_plan::{RowPlan, row_plans};
pub use rows::Rows;
pub use select::{LeftOut, Standstill};

use super::Factor;
use crate::model::{Model, ParameterKind};
use crate::signal::{Decimator, KeptRows, Motion, SignalError};

/// What is observed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equations {
    /// The inverse dynamic model (4): one equation per joint.
    Torque,
    /// The power model (11): one equation.
    Power {
        /// dh evaluated in closed form from (q, dq, ddq); otherwise h(q, dq) is differentiated, as in the paper.
        closed_form: bool,
    },
}

/// How rows are sampled and which are used.
///
/// The band decides more than anything else what error a model has, and for which rows: a comparison needs the same
/// band and the same rows. [`crate::estimation::choose_bandwidth`] gives the band and the cut-off of the position
/// filter by one rule for all recordings. With it, weighted, on public recordings: Staubli TX-40 at 5 kHz, 50 Hz
/// band: 5.9 % in sample (6.8 % with every row); fitted on 0 to 4.5 s, 8.6 % on every row of 4.5 to 7.4 s, and in a
/// 25 Hz band 6.9 % on the moving ones. UR10e at 95 Hz, 5 Hz band, other motions: 3.9 %. Panda, jittery 1 kHz, 8 Hz band,
/// last two fifths: 1.2 %. (`cargo test --test real_recordings -- --nocapture`)
#[derive(Debug, Clone, PartialEq)]
pub struct ObserveSettings {
    /// Band of the rows, Hz: cut-off (-6 dB) of the parallel decimation. Torque ripple, flexibilities and noise
    /// above it are left out, the same in Y and in W. Limited to what the recording's rate can hold.
    pub band: f64,
    /// Rows a second, Hz; `None`: twice the band. The recording's rate is divided by a whole number.
    pub rate: Option<f64>,
    /// What is done with rows where the joint hardly moves.
    pub standstill: Standstill,
    /// Time windows, s, in the recording's time; a row is used if its whole filter support lies in one of them.
    /// Empty: everything.
    pub windows: Vec<[f64; 2]>,
    /// Whether the decimated rows themselves are returned.
    pub keep_rows: bool,
    /// Threads; 0: as many as the machine has. The result is the same, to the last digit, for every number.
    pub threads: usize,
}

impl Default for ObserveSettings {
    fn default() -> Self {
        ObserveSettings {
            band: 50.0,
            rate: None,
            standstill: Standstill::default(),
            windows: Vec::new(),
            keep_rows: false,
            threads: 0,
        }
    }
}

/// Columns beyond the base parameters: candidate effects, evaluated at the full rate and decimated with the rest.
pub trait ExtraColumns: Sync {
    /// A name for each extra unknown.
    fn names(&self) -> &[String];

    /// The extra unknowns that occur in the equation of a joint, ascending.
    fn columns(&self, joint: usize) -> &[usize];

    /// Writes the columns of a joint, in the order of `columns(joint)`: sample `range.start + t` of its c-th
    /// column to `out[c * stride + t]`. `trajectory` is the index of the motion.
    fn fill(
        &self,
        trajectory: usize,
        motion: &Motion,
        range: Range<usize>,
        joint: usize,
        stride: usize,
        out: &mut [f64],
    );
}

/// Called with the samples that are done and the samples that there are, from any thread.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Misuse of the observation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ObserveError {
    /// Too many joints.
    #[error("{found} joints: at most 32 are supported")]
    TooManyJoints {
        /// Joints of the robot.
        found: usize,
    },
    /// A motion of another robot.
    #[error("{motion} has {found} joints: the robot has {expected}")]
    Joints {
        /// Name of the motion.
        motion: String,
        /// Joints of the motion.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// Channels of different length.
    #[error("{motion}: its channels do not have the same number of samples")]
    Samples {
        /// Name of the motion.
        motion: String,
    },
    /// A fixed joint that is none.
    #[error("{motion}: joint {joint} is said to be fixed, but there is no such joint")]
    FixedJoint {
        /// Name of the motion.
        motion: String,
        /// 1-based joint.
        joint: usize,
    },
    /// Band or rate that mean nothing.
    #[error("{what} must be a positive number of Hz, not {value}")]
    Frequency {
        /// `band` or `rate`.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The standstill policy names another number of joints.
    #[error("{found} standstill speeds: the robot has {expected} joints")]
    StandstillSpeeds {
        /// Speeds given.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// Observations that do not go together.
    #[error("the observations have different unknowns or equations")]
    OtherUnknowns,
    /// No row is left in any motion.
    #[error("no row can be used: {reason}")]
    NoRows {
        /// Why.
        reason: String,
    },
    /// The decimation filter cannot be made.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

/// The rows of one equation in one trajectory, or in one block of its time.
#[derive(Debug, Clone, PartialEq)]
pub struct EquationFactor {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint, or 0 for the power model.
    pub equation: usize,
    /// Unknown of each column of the factor, ascending.
    pub columns: Vec<usize>,
    /// R of [W Y].
    pub factor: Factor,
}

/// The equations of one stretch of one trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeBlock {
    /// Index of the motion.
    pub trajectory: usize,
    /// First and last row centre, s.
    pub time: [f64; 2],
    /// One per equation.
    pub equations: Vec<EquationFactor>,
}

/// Motions as equations in the unknowns: nothing is kept but orthogonal factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// What is observed.
    pub equations: Equations,
    /// Names of the base parameters, then of the extra unknowns.
    pub unknowns: Vec<String>,
    /// How many of the unknowns are base parameters.
    pub base: usize,
    /// Which unknowns have columns without measuring errors: constants, and the sign of the speed.
    pub exact: Vec<bool>,
    /// Name of each motion.
    pub trajectories: Vec<String>,
    /// Rows a second, for each motion, Hz.
    pub rates: Vec<f64>,
    /// Band of the rows, for each motion, Hz.
    pub bands: Vec<f64>,
    /// For each motion and equation, all its rows.
    pub groups: Vec<EquationFactor>,
    /// The same rows by blocks of time: for what residuals have in common over time, and for resampling.
    pub blocks: Vec<TimeBlock>,
    /// For each motion and equation, in the order of `groups`: what was used and what was not.
    pub left_out: Vec<LeftOut>,
    /// Samples of the motions that were read, all joints counted once.
    pub samples: usize,
    /// The decimated rows, in the order of `groups`, where they were asked for.
    pub rows: Option<Vec<Rows>>,
}

impl Observation {
    /// Takes in the motions of another observation of the same unknowns, behind its own: a recording that is too
    /// long for the memory is read, observed and dropped piece by piece.
    ///
    /// # Errors
    /// Another model, other equations, or other extra unknowns.
    pub fn append(&mut self, mut other: Observation) -> Result<(), ObserveError> {
        if other.equations != self.equations || other.unknowns != self.unknowns {
            return Err(ObserveError::OtherUnknowns);
        }
        let before = self.trajectories.len();
        let blocks = other.blocks.iter_mut().flat_map(|b| {
            b.trajectory += before;
            &mut b.equations
        });
        for equation in blocks.chain(&mut other.groups) {
            equation.trajectory += before;
        }
        other.left_out.iter_mut().for_each(|l| l.trajectory += before);
        other.rows.iter_mut().flatten().for_each(|r| r.trajectory += before);
        self.trajectories.extend(other.trajectories);
        self.rates.extend(other.rates);
        self.bands.extend(other.bands);
        self.groups.extend(other.groups);
        self.blocks.extend(other.blocks);
        self.left_out.extend(other.left_out);
        self.samples += other.samples;
        self.rows = match (self.rows.take(), other.rows) {
            (Some(mut own), Some(theirs)) => {
                own.extend(theirs);
                Some(own)
            }
            _ => None,
        };
        Ok(())
    }
}

/// A motion with its decimation.
struct Prepared<'a> {
    source: Box<dyn source::Source + 'a>,
    motion: &'a Motion,
    decimator: Decimator,
    grid: KeptRows,
    equations: Vec<source::EquationColumns>,
    selection: Vec<select::Selection>,
}

/// Observes motions: evaluates the model at the full rate in blocks, decimates Y and every column of W with one
/// linear-phase filter, leaves out the rows that say nothing, and reduces the rest to orthogonal factors.
///
/// Neither W nor any of its columns is ever held at the full rate.
pub fn observe(
    model: &dyn Model,
    motions: &[Motion],
    equations: Equations,
    extra: Option<&dyn ExtraColumns>,
    settings: &ObserveSettings,
    progress: Option<Progress<'_>>,
) -> Result<Observation, ObserveError> {
    for (what, value) in [("band", settings.band), ("rate", settings.rate.unwrap_or(1.0))] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(ObserveError::Frequency { what, value });
        }
    }
    let detected = crate::signal::Standstill::of(motions);
    let mut prepared = Vec::with_capacity(motions.len());
    for (trajectory, motion) in motions.iter().enumerate() {
        let source = source::source(equations, model, trajectory, motion, extra)?;
        let decimator = row_plan::decimator(motion.rate, settings)?;
        let samples = motion.q.first().map_or(0, Vec::len);
        let valid = motion.spoiled..samples.saturating_sub(motion.spoiled).max(motion.spoiled);
        let grid = decimator.kept_rows(valid);
        let selection = select::select(trajectory, motion, equations, &decimator, grid, &detected, settings)?;
        let columns = source.equations();
        prepared.push(Prepared { source, motion, decimator, grid, equations: columns, selection });
    }
    if prepared.iter().all(|p| p.selection.iter().all(|s| s.left_out.used == 0)) {
        return Err(ObserveError::NoRows { reason: select::why_nothing(&prepared, settings) });
    }
    let (blocks, rows) = work::run(&prepared, settings, progress);
    let groups = work::merge(&prepared, &blocks, settings.threads);
    let robot = model.robot();
    let mut unknowns: Vec<String> = robot.base.iter().map(|p| p.name.to_string()).collect();
    if let (Some(extra), Equations::Torque) = (extra, equations) {
        unknowns.extend(extra.names().iter().cloned());
    }
    let exact = |kind| {
        matches!(kind, ParameterKind::Off | ParameterKind::Fc | ParameterKind::Fcm)
            && equations == Equations::Torque
    };
    let mut exact: Vec<bool> = robot.base.iter().map(|p| exact(robot.standard[p.standard].kind)).collect();
    exact.resize(unknowns.len(), false);
    Ok(Observation {
        equations,
        exact,
        base: robot.base.len(),
        unknowns,
        trajectories: motions.iter().map(|m| m.name.clone()).collect(),
        rates: prepared.iter().map(|p| p.motion.rate / p.decimator.factor() as f64).collect(),
        bands: prepared.iter().map(|p| row_plan::band_of(&p.decimator, p.motion.rate)).collect(),
        groups,
        blocks,
        left_out: prepared.iter().flat_map(|p| p.selection.iter().map(|s| s.left_out.clone())).collect(),
        samples: motions.iter().map(|m| m.q.first().map_or(0, Vec::len)).sum(),
        rows,
    })
}
