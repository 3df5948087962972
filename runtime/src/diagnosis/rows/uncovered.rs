//! How large the torques are that an error of the robot's numbers uncovers.
//!
//! Gravity along an axis hides the first moment of the arm about it; a base that is tilted shows it, as a torque over the
//! angle of that joint alone. A motion that hardly turns the joint does not tell its size, and would ask for a torque that
//! no arm has in every other motion. An arm's first moment is about its moment of inertia over half of its reach.

use crate::diagnosis::rows::context::Context;
use crate::effects::{EffectKind, Place, numbers_at};

/// The last columns of an error of the robot's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Uncovered {
    /// Derivatives that come before them.
    pub from: usize,
    /// Standard deviation of their amplitudes, N.m.
    pub deviation: f64,
}

impl Context<'_> {
    /// What an error of this size uncovers; `None` for a law that uncovers nothing.
    pub fn uncovered(&self, (effect, place): (EffectKind, Place), error: &[f64]) -> Option<Uncovered> {
        let (law, robot) = (effect.form().sensitivity()?, self.model.robot());
        let from = numbers_at(law, robot, place.variant()?).len();
        let turned = law.uncovered(robot, &vec![Vec::new(); robot.joints()]).into_iter().map(|(j, _)| j);
        let inertia = turned.map(|j| self.inertias(j)[1]).fold(0.0, f64::max);
        let reach: f64 = robot.frames.iter().map(|f| f.b.abs() + f.d.abs() + f.r.abs()).sum();
        let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let deviation = size(error.get(..from)?) * size(&robot.gravity) * inertia / (0.5 * reach);
        (deviation > 0.0 && deviation.is_finite()).then_some(Uncovered { from, deviation })
    }
}
