//! Recorded beside simulated torques.

use crate::signal::{Butterworth, Motion, SignalError};
use serde::Serialize;

/// Transient of the loop that is left out at the start of a recording, s.
const START_TRANSIENT: f64 = 0.2;

/// Recorded and simulated torques.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Which recording was followed.
    pub recording: String,
    /// Length of its motions, s.
    pub duration: f64,
    /// Relative error of the torques with the standard model simulated.
    pub before: f64,
    /// The same with the findings.
    pub after: f64,
    /// Joint by joint.
    pub per_joint_before: Vec<Option<f64>>,
    /// Joint by joint, with the findings.
    pub per_joint_after: Vec<Option<f64>>,
    /// Largest distance of each joint from the recorded motion, standard model, rad or m.
    pub tracking_before: Vec<f64>,
    /// The same with the findings.
    pub tracking_after: Vec<f64>,
    /// Findings that a simulation along a recorded motion does not have.
    pub left_out: Vec<String>,
    /// The first motion: time, and for each joint what was recorded and simulated.
    #[serde(skip)]
    pub first: Compared,
}

/// Torques of one motion, `[joint][row]`, in the band of the comparison.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Compared {
    /// s.
    pub time: Vec<f64>,
    /// Recorded.
    pub recorded: Vec<Vec<f64>>,
    /// Simulated without the findings.
    pub before: Vec<Vec<f64>>,
    /// Simulated with them.
    pub after: Vec<Vec<f64>>,
}

/// Sums over the motions of a recording; the first of two is without the findings, the second with them.
pub(super) struct Comparison {
    squares: [Vec<f64>; 2],
    whole: Vec<f64>,
    tracking: [Vec<f64>; 2],
    first: Option<Compared>,
    duration: f64,
}

impl Comparison {
    pub(super) fn new(joints: usize) -> Self {
        let none = vec![0.0; joints];
        Self {
            squares: [none.clone(), none.clone()],
            whole: none.clone(),
            tracking: [none.clone(), none],
            first: None,
            duration: 0.0,
        }
    }

    /// Takes over how far each joint was from a motion at most.
    pub(super) fn track(&mut self, variant: usize, errors: &[f64]) {
        self.tracking[variant].iter_mut().zip(errors).for_each(|(most, e)| *most = most.max(*e));
    }

    /// Adds a motion: torques `[j][t]` as they were recorded and simulated, on rows where joints are faster than
    /// `slowest`.
    pub(super) fn add(
        &mut self,
        motion: &Motion,
        slowest: &[f64],
        recorded: &[Vec<f64>],
        simulated: &[Vec<Vec<f64>>],
    ) {
        let rows = compared_rows(motion);
        self.duration += rows.len() as f64 / motion.rate;
        for j in 0..self.whole.len() {
            for t in rows.clone().filter(|&t| motion.dq[j][t].abs() > slowest[j]) {
                self.whole[j] += recorded[j][t].powi(2);
                for (squares, torque) in self.squares.iter_mut().zip(simulated) {
                    squares[j] += (recorded[j][t] - torque[j][t]).powi(2);
                }
            }
        }
        self.first.get_or_insert_with(|| {
            let cut = |signals: &[Vec<f64>]| signals.iter().map(|x| x[rows.clone()].to_vec()).collect();
            Compared {
                time: rows.clone().map(|t| motion.start + t as f64 / motion.rate).collect(),
                recorded: cut(recorded),
                before: cut(&simulated[0]),
                after: cut(&simulated[1]),
            }
        });
    }

    /// Relative errors over everything that was added.
    pub(super) fn finish(self) -> ClosedLoop {
        let ratio = |a: f64, b: f64| if b > 0.0 { (a / b).sqrt() } else { 0.0 };
        let overall = |left: &[f64]| ratio(left.iter().sum(), self.whole.iter().sum());
        let per_joint = |left: &[f64]| {
            left.iter().zip(&self.whole).map(|(a, b)| (*b > 0.0).then(|| (a / b).sqrt())).collect()
        };
        let [before, after] = &self.squares;
        let [tracking_before, tracking_after] = self.tracking;
        ClosedLoop {
            duration: self.duration,
            before: overall(before),
            after: overall(after),
            per_joint_before: per_joint(before),
            per_joint_after: per_joint(after),
            tracking_before,
            tracking_after,
            first: self.first.unwrap_or_default(),
            ..ClosedLoop::default()
        }
    }
}

/// Rows beyond the edge effects of the filters and the start of the loop.
fn compared_rows(motion: &Motion) -> std::ops::Range<usize> {
    let samples = motion.q.first().map_or(0, Vec::len);
    let first = motion.edge_samples.max((START_TRANSIENT * motion.rate) as usize);
    first..samples.saturating_sub(motion.edge_samples).max(first)
}

/// The recorded torques with the skew to the positions taken out.
pub(super) fn shifted(motion: &Motion, delay: f64) -> Vec<Vec<f64>> {
    let later = delay * motion.rate;
    let shift = |x: &Vec<f64>| -> Vec<f64> {
        let last = x.len().saturating_sub(1);
        (0..x.len())
            .map(|k| {
                let at = (k as f64 + later).clamp(0.0, last as f64);
                let low = at as usize;
                x[low] + (at - low as f64) * (x[(low + 1).min(last)] - x[low])
            })
            .collect()
    };
    if delay == 0.0 { motion.torque.clone() } else { motion.torque.iter().map(shift).collect() }
}

/// Torques in a band.
pub(super) fn smooth(torques: &[Vec<f64>], rate: f64, band: f64) -> Result<Vec<Vec<f64>>, SignalError> {
    let filter = Butterworth::low_pass(4, band, rate)?;
    torques.iter().map(|x| filter.zero_phase(x)).collect()
}
