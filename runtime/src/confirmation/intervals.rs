//! Rows of a test recording that a curve says nothing of: at values of its variables that the recording which it was fitted to
//! has not passed.

use crate::effects::{Axis, EffectTerm, Variable};
use crate::prediction::JointRows;
use crate::signal::Motion;

/// A curve's variables and intervals, and the motions of a test recording; no variable for a law that says something of every
/// motion.
pub(super) struct Intervals<'a> {
    axes: Vec<Axis>,
    motions: &'a [Motion],
}

impl<'a> Intervals<'a> {
    /// Of a term of a robot of so many joints.
    pub(super) fn new(term: &EffectTerm, joints: usize, motions: &'a [Motion]) -> Self {
        Self { axes: term.intervals(joints), motions }
    }

    /// Whether row `t` of a joint lies beyond one of them.
    pub(super) fn leave_out(&self, rows: &JointRows, t: usize) -> bool {
        let Some(motion) = self.motions.get(rows.trajectory) else { return false };
        let sample = ((rows.time[t] - motion.start) * motion.rate).round().max(0.0) as usize;
        self.axes.iter().any(|axis| {
            value(motion, axis.variable, sample).is_some_and(|x| (x - axis.centre).abs() > axis.half)
        })
    }
}

/// A variable at a sample; `None` where the motion alone does not say it.
fn value(motion: &Motion, variable: Variable, sample: usize) -> Option<f64> {
    let series = match variable {
        Variable::Position(j) => motion.q.get(j),
        Variable::Speed(j) => motion.dq.get(j),
        Variable::Acceleration(j) => motion.ddq.get(j),
        Variable::Load(_)
        | Variable::Torque(_)
        | Variable::Time
        | Variable::TimeSinceReversal(_)
        | Variable::TravelSinceReversal(_) => None,
    };
    series?.get(sample).copied()
}
