//! The law of one joint as a torque of a simulated robot.

use super::extra::{ExtraTorque, Instant};
use crate::effects::{At, AtRest, EffectTerm, JointLaw, Moved, Scale};
use crate::model::{ParameterKind, Robot};

/// The law of one joint as a torque of this joint, or of one that feels it.
pub(super) struct EffectTorque {
    law: &'static dyn JointLaw,
    /// The joint that it is a torque of.
    joint: usize,
    /// The joint whose state it is made from.
    of: usize,
    scale: Scale,
    shape: Vec<f64>,
    amplitude: Vec<f64>,
    /// Fv, Fc and offset of the joint in the standard model.
    friction: [f64; 3],
    memory: f64,
    last: Option<f64>,
}

/// Fv, Fc and offset of a joint in the standard model, from base parameters.
pub(super) fn friction(robot: &Robot, chi: &[f64], joint: usize) -> [f64; 3] {
    let joint_of = robot.joint_of_frame();
    [ParameterKind::Fv, ParameterKind::Fc, ParameterKind::Off].map(|kind| {
        let own = |k: usize| {
            let parameter = &robot.standard[robot.base[k].standard];
            parameter.kind == kind && joint_of[parameter.frame] == Some(joint)
        };
        (0..chi.len()).find(|&k| own(k)).map_or(0.0, |k| chi[k])
    })
}

/// No law of a joint has as many amplitudes.
const MOST_COLUMNS: usize = 16;

impl EffectTorque {
    /// From a term that has the law's scales; `None` where it has none. `joints`: the one that it is a torque of, and the
    /// one whose state it is made from; `chi` are the robot's base parameters.
    pub(super) fn new(
        robot: &Robot,
        chi: &[f64],
        law: &'static dyn JointLaw,
        [joint, of]: [usize; 2],
        term: &EffectTerm,
    ) -> Option<Self> {
        Some(Self {
            law,
            joint,
            of,
            scale: term.scale?.into(),
            shape: term.shape.clone(),
            amplitude: term.amplitude.clone(),
            friction: friction(robot, chi, of),
            memory: 0.0,
            last: None,
        })
    }

    fn at_rest(&self) -> AtRest {
        self.law.at_rest(&self.shape, &self.amplitude)
    }

    /// The torque if the joint moves in the direction `sign`.
    fn toward(&self, at: &Instant<'_>, sign: f64, memory: f64) -> f64 {
        let dq = at.dq[self.of];
        let load = at.load[self.of];
        let [fv, fc, off] = self.friction;
        let friction = fv * dq + fc * sign;
        let here = At {
            time: at.time,
            q: at.q[self.of],
            dq,
            ddq: at.ddq[self.of],
            sign,
            load,
            link: at.link[self.of],
            gravity: at.gravity[self.of],
            torque: load + friction + off + at.effects[self.of],
            friction,
        };
        let mut columns = [0.0; MOST_COLUMNS];
        let count = self.law.amplitudes(&self.shape).min(MOST_COLUMNS);
        self.law.law(&self.scale, &self.shape, &here, memory, &mut columns[..count]);
        columns[..count].iter().zip(&self.amplitude).map(|(c, a)| c * a).sum()
    }
}

impl ExtraTorque for EffectTorque {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        out[self.joint] += match self.at_rest() {
            AtRest::Smooth => self.toward(at, if at.dq[self.of] < 0.0 { -1.0 } else { 1.0 }, self.memory),
            AtRest::Dry => 0.0,
            AtRest::BuildsUp => self.toward(at, 0.0, self.memory),
        };
    }

    fn dry_friction(&self, at: &Instant<'_>, levels: &mut [[f64; 2]]) {
        let memory = match self.at_rest() {
            AtRest::Smooth => return,
            AtRest::Dry => self.memory,
            AtRest::BuildsUp => 0.0,
        };
        levels[self.joint][0] -= self.toward(at, -1.0, memory);
        levels[self.joint][1] += self.toward(at, 1.0, memory);
    }

    fn has_dry_friction(&self) -> bool {
        self.at_rest() != AtRest::Smooth
    }

    fn looks_at_effects(&self) -> bool {
        self.law.looks_at_torque()
    }

    fn needs_gravity(&self) -> bool {
        self.law.needs_gravity(&self.shape)
    }

    fn advance(&mut self, at: &Instant<'_>, step: f64) {
        let q = at.q[self.of];
        match self.last {
            Some(last) => {
                let moved = Moved { travel: q - last, step };
                self.memory = self.law.advance(&self.scale, &self.shape, self.memory, moved);
            }
            None => self.memory = self.law.memory_at_start(&self.scale, at.dq[self.of]),
        }
        self.last = Some(q);
    }
}
