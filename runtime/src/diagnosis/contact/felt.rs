//! What every joint feels of a push, and the force that explains it.

use crate::diagnosis::contact::force::{JointRow, UnitForces, as_torques};
use crate::diagnosis::contact::noise::Noise;
use crate::diagnosis::contact::squares::{Squares, mean_beside};
use crate::diagnosis::contact::windows::told;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{
    FELT, FORCE_EXPLAINS, FORCE_LEAVES, LINKS_ALIKE, SCAN_EDGE, UNDETERMINED_FORCE,
};
use crate::effects::{ContactForce, JointTorque};

/// Rows of all joints at all times, and what a model leaves of their torques.
pub(in crate::diagnosis) struct Around<'a> {
    pub context: &'a Context<'a>,
    pub design: &'a Design,
    pub residual: &'a [f64],
    /// Standard deviation of the residual of each joint.
    pub sigma: &'a [f64],
}

impl Around<'_> {
    /// From one row to the next of a motion, s.
    pub fn step(&self, motion: usize) -> f64 {
        self.design.spacing(motion) as f64 / self.context.signals[motion].rate
    }

    /// The row that a time is nearest to, counted from the beginning of its motion.
    pub fn place(&self, motion: usize, time: f64) -> usize {
        let s = &self.context.signals[motion];
        ((time - s.start) * s.rate / self.design.spacing(motion) as f64).round().max(0.0) as usize
    }
}

/// What each joint feels within places of a motion.
pub(in crate::diagnosis) struct Felt {
    motion: usize,
    places: [usize; 2],
    /// Rows of each joint that has any: joint, rows, mean torque with its standard deviation.
    joints: Vec<(usize, Vec<usize>, JointRow)>,
}

impl Felt {
    /// Mean torques from the first place to the last, as half waves beside the model have them, or, where a joint reverses there,
    /// the residual itself; joints that stand still all the time say nothing.
    pub fn of(around: &Around<'_>, noise: &Noise, motion: usize, places: [usize; 2]) -> Self {
        Self::with(around, noise, (motion, places), |joint| noise.pushed(joint, motion, places))
    }

    /// Mean torques as the residual itself has them, of a model that was fitted without these rows.
    pub fn of_residual(around: &Around<'_>, noise: &Noise, motion: usize, places: [usize; 2]) -> Self {
        Self::with(around, noise, (motion, places), |_| None)
    }

    /// Mean torques with their standard deviations as `pushed` tells them of a joint, else those of the residual.
    fn with(
        around: &Around<'_>,
        noise: &Noise,
        (motion, places): (usize, [usize; 2]),
        pushed: impl Fn(usize) -> Option<[f64; 2]>,
    ) -> Self {
        let design = around.design;
        let of_joint = |joint: usize| {
            let spacing = design.spacing(motion);
            let rows = design.of_signal(joint, motion).into_iter().flat_map(|(range, _)| range);
            let inside = |r: &usize| (places[0]..=places[1]).contains(&(design.rows[*r].centre / spacing));
            let rows: Vec<usize> = rows.filter(inside).collect();
            let sigma = noise.sigma(joint, rows.len()).filter(|_| !rows.is_empty())?;
            let left = rows.iter().map(|&r| around.residual[r]).sum::<f64>() / rows.len() as f64;
            let [mean, sigma] = pushed(joint).unwrap_or([left, sigma]);
            let sigma = sigma.hypot(around.context.signals[motion].rounding[joint]);
            let y = rows.iter().map(|&r| design.torque(r)).sum::<f64>() / rows.len() as f64;
            Some((joint, rows, JointRow { joint, residual: mean, y, sigma: sigma.max(1e-12) }))
        };
        Self { motion, places, joints: (0..design.joints).filter_map(of_joint).collect() }
    }

    fn means(&self) -> Vec<JointRow> {
        self.joints.iter().map(|(_, _, row)| *row).collect()
    }

    /// Probability that one of all windows of the recording comes as far by accident on all joints together.
    pub fn doubt(&self, noise: &Noise) -> f64 {
        noise.doubt(self.joints.iter().map(|(joint, _, row)| (*joint, row.residual / row.sigma)))
    }

    /// Probability that a joint comes as far by accident in these places alone.
    pub fn doubt_of(&self, joint: usize) -> f64 {
        let of_joint = self.joints.iter().find(|(j, ..)| *j == joint);
        let square = of_joint.map_or(0.0, |(_, _, row)| (row.residual / row.sigma).powi(2));
        Evidence::fisher(square, 1, f64::INFINITY).p_value
    }

    /// Torques of unit forces at the origin of a frame, in the middle.
    fn unit(&self, around: &Around<'_>, frame: usize) -> UnitForces {
        let s = &around.context.signals[self.motion];
        let middle = (self.places[0] + self.places[1]) / 2 * around.design.spacing(self.motion);
        UnitForces::at(around.context, frame, s, middle.min(s.len().saturating_sub(1)))
    }

    /// Standard deviations of a mean force on the link of frame number `link`; `None` where a direction is not determined.
    pub fn force_sigma(&self, around: &Around<'_>, link: usize) -> Option<[f64; 3]> {
        let (force, covariance) = self.unit(around, link.checked_sub(1)?).with_covariance(&self.means())?;
        // The shape of a push is another than half a wave.
        let sigma = [0, 1, 2].map(|k| covariance[(k, k)].max(0.0).sqrt().hypot(SCAN_EDGE * force[k]));
        let known = sigma.iter().all(|s| s.is_finite() && *s < UNDETERMINED_FORCE * force.norm());
        known.then_some(sigma)
    }

    /// Squares of a joint's rows.
    pub fn squares(&self, around: &Around<'_>, joint: usize) -> Squares {
        let mut all = Squares::default();
        for (joint, rows, _) in self.joints.iter().filter(|(j, _, _)| *j == joint) {
            let weight = 1.0 / (around.sigma[*joint] * around.sigma[*joint]);
            let residual: Vec<f64> = rows.iter().map(|&r| around.residual[r]).collect();
            for (i, &r) in rows.iter().enumerate() {
                all += Squares {
                    before: weight * residual[i].powi(2),
                    after: weight * (residual[i] - mean_beside(&residual, i)).powi(2),
                    torque: weight * around.design.torque(r).powi(2),
                };
            }
        }
        all
    }
}

/// A push as a force on a link where at least two joints feel it and one force explains them all; else as the torques of
/// the joints that feel it, among them the one it was `found` on. `None` where no joint has rows there.
pub(in crate::diagnosis) fn wrench(
    around: &Around<'_>,
    felt: &Felt,
    (found, edges, doubt): (usize, [f64; 2], f64),
) -> Option<ContactForce> {
    let s = &around.context.signals[felt.motion];
    let spacing = around.design.spacing(felt.motion);
    let means = felt.means();
    let feels = |row: &JointRow| row.joint == found || row.residual.abs() > FELT * row.sigma;
    let torques: Vec<JointTorque> = (felt.joints.iter().filter(|(_, _, row)| feels(row)))
        .map(|(joint, rows, row)| JointTorque {
            joint: *joint,
            mean: row.residual,
            largest: largest_mean(rows, around.residual, row.residual),
            sigma: row.sigma.hypot(SCAN_EDGE * row.residual),
        })
        .collect();
    let many = torques.len();
    let mut push = as_torques(
        around.context.model.robot(),
        &s.name,
        felt.places.map(|place| s.time(place * spacing)),
        edges,
        torques,
    );
    push.confidence = Some(told(doubt));
    if many >= 2 {
        put_force(around, felt, &means, &mut push);
    }
    (many > 0).then_some(push)
}

/// The outermost link on which a force explains what all joints feel as well as on any other, where it does.
fn put_force(around: &Around<'_>, felt: &Felt, means: &[JointRow], push: &mut ContactForce) {
    let joint_of_frame = around.context.model.robot().joint_of_frame();
    let whole: f64 = means.iter().map(|row| (row.residual / row.sigma).powi(2)).sum();
    let links: Vec<(usize, f64)> = (0..joint_of_frame.len())
        .rev()
        .filter(|&frame| joint_of_frame[frame].is_some())
        .map(|frame| {
            let unit = felt.unit(around, frame);
            (frame, unit.left(means, &unit.force(means)))
        })
        .collect();
    let least = links.iter().map(|l| l.1).fold(f64::INFINITY, f64::min);
    let mut alike = links.iter().filter(|l| l.1 <= least + LINKS_ALIKE).map(|l| l.0);
    let explained = 1.0 - least / whole >= FORCE_EXPLAINS && least <= FORCE_LEAVES * means.len() as f64;
    let Some(frame) = alike.next().filter(|_| explained) else { return };
    let force = felt.unit(around, frame).force(means);
    // The largest torques against the means tell how much more the push was at its height.
    let ratios = push.joint_torques.iter().map(|t| t.largest / t.mean);
    let ratio = ratios.filter(|r| r.is_finite()).fold(1.0, f64::max);
    push.link = frame + 1;
    push.or_links = alike.map(|frame| frame + 1).collect();
    push.mean_force = [force[0], force[1], force[2]];
    push.force = push.mean_force.map(|f| f * ratio);
    push.force_sigma = felt.force_sigma(around, frame + 1);
}

/// The largest mean of five rows of a push, at least its whole mean. What a fit has taken over of it is missing in all rows.
fn largest_mean(rows: &[usize], residual: &[f64], mean: f64) -> f64 {
    let of = |rows: &[usize]| rows.iter().map(|&r| residual[r]).sum::<f64>() / rows.len() as f64;
    let missing = mean - of(rows);
    let means = rows.chunks(5).map(|rows| of(rows) + missing);
    means.fold(mean, |a, b| if b.abs() > a.abs() { b } else { a })
}
