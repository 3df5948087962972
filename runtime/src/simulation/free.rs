//! A law over any variables as a torque of a simulated robot.

use super::effect::friction;
use super::extra::{ExtraTorque, Instant};
use crate::effects::{EffectTerm, FreeLaw, Seen, SinceReversal, Variable};
use crate::model::Robot;

/// The law as a torque.
pub(super) struct FreeTorque {
    law: FreeLaw,
    joint: usize,
    amplitude: Vec<f64>,
    /// Fv, Fc and offset of every joint in the standard model.
    friction: Vec<[f64; 3]>,
    /// Positions, speeds and accelerations at the last step.
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    since: Vec<SinceReversal>,
}

impl FreeTorque {
    /// From a term; `None` where its shape means no law. `chi` are the robot's base parameters.
    pub(super) fn new(robot: &Robot, chi: &[f64], joint: usize, term: &EffectTerm) -> Option<Self> {
        let n = robot.joints();
        let law = FreeLaw::from_shape(&term.shape, n)?;
        (law.amplitudes() == term.amplitude.len()).then(|| Self {
            law,
            joint,
            amplitude: term.amplitude.clone(),
            friction: (0..n).map(|j| friction(robot, chi, j)).collect(),
            q: Vec::new(),
            dq: vec![0.0; n],
            ddq: vec![0.0; n],
            since: vec![SinceReversal::default(); n],
        })
    }

    fn value(&self, variable: Variable, at: &Instant<'_>) -> f64 {
        match variable {
            Variable::Position(j) => at.q[j],
            Variable::Speed(j) => at.dq[j],
            Variable::Acceleration(j) => self.ddq[j],
            Variable::Load(j) => at.load[j],
            Variable::Torque(j) => {
                let [fv, fc, off] = self.friction[j];
                let sign = if at.dq[j] == 0.0 { 0.0 } else { at.dq[j].signum() };
                at.load[j] + fv * at.dq[j] + fc * sign + off + at.effects[j]
            }
            Variable::Time => at.time,
            Variable::TimeSinceReversal(j) => self.since[j].time,
            Variable::TravelSinceReversal(j) => self.since[j].travel,
        }
    }

    /// The torque if the joint itself moves in the direction `sign`.
    fn toward(&self, at: &Instant<'_>, sign: f64) -> f64 {
        let seen = |axis: &crate::effects::Axis| {
            let own = (axis.variable == Variable::Speed(self.joint)).then_some(sign);
            axis.seen(self.value(axis.variable, at), own)
        };
        let seen: Vec<Seen> = self.law.axes.iter().map(seen).collect();
        let mut columns = Vec::with_capacity(self.amplitude.len());
        self.law.columns(&seen, &mut columns);
        columns.iter().zip(&self.amplitude).map(|(c, a)| c * a).sum()
    }
}

impl ExtraTorque for FreeTorque {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        out[self.joint] += self.toward(at, 0.0);
    }

    fn dry_friction(&self, at: &Instant<'_>, levels: &mut [[f64; 2]]) {
        let smooth = self.toward(at, 0.0);
        levels[self.joint][0] -= self.toward(at, -1.0) - smooth;
        levels[self.joint][1] += self.toward(at, 1.0) - smooth;
    }

    fn looks_at_effects(&self) -> bool {
        self.law.looks_at_torque()
    }

    fn has_dry_friction(&self) -> bool {
        self.law.axes.iter().any(|a| a.variable == Variable::Speed(self.joint))
    }

    fn advance(&mut self, at: &Instant<'_>, step: f64) {
        if step > 0.0 && !self.q.is_empty() {
            for j in 0..at.q.len() {
                self.ddq[j] = (at.dq[j] - self.dq[j]) / step;
                self.since[j].advance(at.dq[j], at.q[j] - self.q[j], step);
            }
        }
        self.q.clear();
        self.q.extend_from_slice(at.q);
        self.dq.copy_from_slice(at.dq);
    }
}
