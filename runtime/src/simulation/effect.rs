//! Effects that a diagnosis accepted, in a simulated robot.

use super::extra::{ExtraTorque, Instant};
use crate::effects::{At, AtRest, EffectKind, EffectTerm, Form, JointLaw, Place, Scale};
use crate::model::{Model, ParameterKind, Robot};

/// What accepted effects are to a simulation.
pub struct SimulatedEffects {
    /// Torques of the laws of joints.
    pub torques: Vec<Box<dyn ExtraTorque>>,
    /// Base parameters with the bodies that were found on links.
    pub chi: Vec<f64>,
    /// Effects that a rigid plant does not have: errors of the table, skews of the recording, compliance
    /// ([`super::ElasticJoint`] has it), contacts of one recording.
    pub left_out: Vec<EffectKind>,
}

impl SimulatedEffects {
    /// Brings accepted effects into a robot with base parameters `chi`.
    ///
    /// Bodies are added to chi; laws of a joint become torques; everything else is left out and named.
    pub fn new(model: &dyn Model, chi: &[f64], terms: &[EffectTerm]) -> Self {
        let robot = model.robot();
        let mut all = Self { torques: Vec::new(), chi: chi.to_vec(), left_out: Vec::new() };
        for term in terms {
            match (term.effect.form(), term.place, term.scale) {
                (Form::Joint(law), Place::Joint(joint), Some(scale)) if joint < robot.joints() => {
                    all.torques.push(Box::new(EffectTorque::new(robot, chi, law, joint, scale.into(), term)));
                }
                (Form::Body(_), Place::Link(frame), _) => all.add_body(robot, frame, &term.amplitude),
                _ => all.left_out.push(term.effect),
            }
        }
        all
    }

    fn add_body(&mut self, robot: &Robot, frame: usize, inertial: &[f64]) {
        let mut body = vec![0.0; robot.standard.len()];
        let of_frame = (0..body.len())
            .filter(|&k| robot.standard[k].frame == frame && robot.standard[k].kind <= ParameterKind::M);
        for (k, value) in of_frame.zip(inertial) {
            body[k] = *value;
        }
        for (chi, more) in self.chi.iter_mut().zip(robot.base_from_standard(&body)) {
            *chi += more;
        }
    }
}

/// The law of one joint as a torque.
struct EffectTorque {
    law: &'static dyn JointLaw,
    joint: usize,
    scale: Scale,
    shape: Vec<f64>,
    amplitude: Vec<f64>,
    /// Fv, Fc and offset of the joint in the standard model.
    friction: [f64; 3],
    memory: f64,
    last: Option<f64>,
}

/// Laws have one or two amplitudes, bodies ten.
const MOST_COLUMNS: usize = 16;

impl EffectTorque {
    fn new(
        robot: &Robot,
        chi: &[f64],
        law: &'static dyn JointLaw,
        joint: usize,
        scale: Scale,
        term: &EffectTerm,
    ) -> Self {
        let joint_of = robot.joint_of_frame();
        let of = |kind: ParameterKind| -> f64 {
            let own = |k: usize| {
                let parameter = &robot.standard[robot.base[k].standard];
                parameter.kind == kind && joint_of[parameter.frame] == Some(joint)
            };
            (0..chi.len()).find(|&k| own(k)).map_or(0.0, |k| chi[k])
        };
        Self {
            law,
            joint,
            scale,
            shape: term.shape.clone(),
            amplitude: term.amplitude.clone(),
            friction: [of(ParameterKind::Fv), of(ParameterKind::Fc), of(ParameterKind::Off)],
            memory: 0.0,
            last: None,
        }
    }

    fn at_rest(&self) -> AtRest {
        self.law.at_rest(&self.shape, &self.amplitude)
    }

    /// The torque if the joint moves in the direction `sign`.
    fn toward(&self, at: &Instant<'_>, sign: f64, memory: f64) -> f64 {
        let dq = at.dq[self.joint];
        let load = at.load[self.joint];
        let [fv, fc, off] = self.friction;
        let friction = fv * dq + fc * sign;
        let here = At {
            time: at.time,
            q: at.q[self.joint],
            dq,
            sign,
            load,
            torque: load + friction + off,
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
            AtRest::Smooth => self.toward(at, if at.dq[self.joint] < 0.0 { -1.0 } else { 1.0 }, self.memory),
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

    fn advance(&mut self, at: &Instant<'_>, _: f64) {
        let q = at.q[self.joint];
        if let Some(last) = self.last {
            self.memory = self.law.advance(&self.shape, self.memory, q - last);
        }
        self.last = Some(q);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::TermScale;
    use crate::simulation::testing::pendulum;

    fn term(effect: EffectKind, place: Place, shape: &[f64], amplitude: &[f64]) -> EffectTerm {
        let scale = TermScale::UNIT;
        EffectTerm {
            effect,
            place,
            joints: vec![1],
            shape: shape.to_vec(),
            amplitude: amplitude.to_vec(),
            sigma: vec![0.0; amplitude.len()],
            scale: Some(scale),
            wrenches: Vec::new(),
        }
    }

    #[test]
    fn stribeck_friction_raises_the_level_of_both_directions_and_fades_with_speed() {
        let (model, chi) = pendulum(0.0, 1.0, 1.0, 0.0);
        let terms = [term(EffectKind::Stribeck, Place::Joint(0), &[0.1], &[2.0])];
        let simulated = SimulatedEffects::new(&model, &chi, &terms);
        let level = |dq: f64| {
            let at = Instant { time: 0.0, q: &[0.3], dq: &[dq], load: &[0.0] };
            let mut levels = [[0.0; 2]];
            simulated.torques[0].dry_friction(&at, &mut levels);
            levels[0]
        };
        assert_eq!(level(0.0), [2.0, 2.0]);
        assert!((level(0.1)[1] - 2.0 * (-1.0_f64).exp()).abs() < 1e-15);
        assert!(simulated.torques[0].has_dry_friction());
    }

    #[test]
    fn friction_that_bends_upwards_or_takes_off_does_not_hold_a_joint_at_rest() {
        let (model, chi) = pendulum(0.0, 1.0, 1.0, 0.0);
        let torques = |power: f64, f: f64| {
            let terms = [term(EffectKind::NonlinearViscous, Place::Joint(0), &[power], &[f])];
            let simulated = SimulatedEffects::new(&model, &chi, &terms);
            let at = Instant { time: 0.0, q: &[0.3], dq: &[-0.5], load: &[0.0] };
            let (mut torque, mut levels) = ([0.0], [[0.0; 2]]);
            simulated.torques[0].torque(&at, &mut torque);
            simulated.torques[0].dry_friction(&at, &mut levels);
            (torque[0], levels[0])
        };
        assert_eq!(torques(2.0, 3.0), (-0.75, [0.0; 2]));
        assert_eq!(torques(2.0, -3.0), (0.75, [0.0; 2]));
        let (torque, levels) = torques(0.5, 3.0);
        assert_eq!(torque, 0.0);
        assert!((levels[0] - 3.0 * 0.5_f64.sqrt()).abs() < 1e-15 && levels[0] == levels[1]);
    }

    #[test]
    fn a_body_on_a_link_becomes_part_of_chi() {
        let (model, chi) = pendulum(0.0, 1.0, 0.0, 0.0);
        let mut inertial = [0.0; 10];
        inertial[5] = 0.25;
        let terms = [term(EffectKind::Payload, Place::Link(0), &[], &inertial)];
        let simulated = SimulatedEffects::new(&model, &chi, &terms);
        let robot = model.robot();
        let zz = robot.base.iter().position(|b| b.name.starts_with("ZZ1")).expect("ZZ1 is a base parameter");
        assert!((simulated.chi[zz] - chi[zz] - 0.25).abs() < 1e-15);
    }

    #[test]
    fn what_a_rigid_plant_does_not_have_is_named() {
        let (model, chi) = pendulum(0.0, 1.0, 0.0, 0.0);
        let terms = [term(EffectKind::TimeDelay, Place::Robot, &[], &[0.001])];
        assert_eq!(SimulatedEffects::new(&model, &chi, &terms).left_out, [EffectKind::TimeDelay]);
    }
}
