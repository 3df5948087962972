//! What is observed and how its rows are sampled. Equation numbers are those of Gautier and Briot.

use std::ops::Range;

use super::standstill::Standstill;
use crate::signal::Motion;

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
    /// Variance of the noise in each joint's accelerations within the rows, (rad/s²)² or (m/s²)²
    /// ([`crate::estimation::EncoderNoise`]): what it adds to WT W is worked out for [`Observation::noise_of_columns`].
    /// Empty: none.
    ///
    /// [`Observation::noise_of_columns`]: super::Observation::noise_of_columns
    pub acceleration_noise: Vec<f64>,
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
            acceleration_noise: Vec::new(),
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
