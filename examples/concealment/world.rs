//! A robot as it is simulated, with what it hides.

use std::f64::consts::{PI, TAU};

use dynid_runtime::effects::{EffectKind, EffectTerm, Place, TermScale};
use dynid_runtime::model::{JointIndex, Link, Model, ParameterKind, RecursiveModel, Robot};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::{ElasticJoint, ExtraTorque, Plant, SimulatedEffects, SimulationError};

use crate::Failure;
use crate::motions::SHARE;
use crate::secret::{Secret, inertias, lengths, of_joint};
use crate::torques::{CoupledRotor, Dahl, Push};

/// A quantity of a hidden effect, for the person who reads what was hidden.
pub type Number = (&'static str, f64);

/// A robot with or without something hidden.
pub struct World {
    nominal: &'static dyn Model,
    /// The robot with another table or another gravity.
    table: Option<RecursiveModel>,
    standard: Vec<f64>,
    elastic: Vec<ElasticJoint>,
    laws: Vec<EffectTerm>,
    dahl: Vec<(usize, f64, f64)>,
    coupled: Vec<([usize; 2], f64, f64)>,
    /// Force in frame 0, N, frame it acts on, from, to, s.
    pushes: Vec<([f64; 3], usize, [f64; 2])>,
}

impl World {
    /// The robot as its YAML has it.
    pub fn plain(model: &'static dyn Model) -> Result<Self, Failure> {
        let nominal = model.robot().nominal.as_ref().ok_or("the robot has no nominal values")?;
        Ok(Self {
            nominal: model,
            table: None,
            standard: nominal.standard.to_vec(),
            elastic: Vec::new(),
            laws: Vec::new(),
            dahl: Vec::new(),
            coupled: Vec::new(),
            pushes: Vec::new(),
        })
    }

    /// The model that moves.
    pub fn model(&self) -> &dyn Model {
        self.table.as_ref().map_or(self.nominal, |table| table as &dyn Model)
    }

    /// The parameters of the robot without what is hidden in it, for its controller.
    pub fn known(&self) -> Vec<f64> {
        self.model().robot().base_from_standard(&self.standard)
    }

    /// Hides an effect; returns what a person would call it by.
    pub fn hide(&mut self, secret: &Secret, magnitude: f64) -> Result<Vec<Number>, Failure> {
        use EffectKind as E;
        let robot = self.nominal.robot();
        let j = secret.joint.unwrap_or(0);
        Ok(match secret.effect {
            E::Payload | E::AddedMass => self.body(secret, magnitude),
            E::JointElasticity | E::Backlash => {
                let elastic = elastic(self.nominal, secret, magnitude)?;
                self.elastic.push(elastic);
                vec![("k", elastic.stiffness), ("d", elastic.damping), ("gap", elastic.play)]
            }
            E::CoupledTransmission => {
                let ratio = [-0.5, 0.25, 0.5, 1.0][(4.0 * secret.chance[0]) as usize % 4];
                self.coupled.push(([j - 1, j], ratio, magnitude));
                vec![("with_joint", j as f64), ("ratio", ratio)]
            }
            E::BaseTilt | E::GeometryError => self.another_table(secret, magnitude)?,
            E::Contact => self.push(secret, magnitude),
            E::FrictionLevelChange => {
                for kind in [ParameterKind::Fv, ParameterKind::Fc] {
                    if let Some(k) = of_joint(robot, kind, j) {
                        self.standard[k] *= 1.0 + magnitude;
                    }
                }
                vec![("factor", 1.0 + magnitude)]
            }
            E::PreslidingHysteresis => {
                let (level, distance) =
                    (magnitude * friction(robot, j), secret.between(0, 0.01, 0.03) * range(robot, j));
                self.dahl.push((j, level, distance));
                vec![("level", level), ("distance", distance)]
            }
            // What the drive or the clock report is altered afterwards.
            E::TorqueSaturation => vec![("size", magnitude), ("at_torque", secret.most_torque)],
            E::TorqueConstantError | E::TimeDelay | E::WrongSampleRate | E::PositionOffset => {
                vec![("size", magnitude)]
            }
            _ => self.law(secret, j, magnitude),
        })
    }

    /// A joint's law, in units of the joint's friction, speed and travel.
    fn law(&mut self, secret: &Secret, j: usize, magnitude: f64) -> Vec<Number> {
        use EffectKind as E;
        let robot = self.nominal.robot();
        let (friction, speed, range) = (friction(robot, j), speed(robot, j), range(robot, j));
        let gear = robot.drive.gear.get(j * (robot.joints() + 1)).map_or(1.0, |g| g.abs());
        let phase = TAU * secret.chance[3];
        let level = magnitude * friction;
        let wave = || vec![level * phase.cos(), level * phase.sin()];
        let (shape, amplitude, numbers): (Vec<f64>, Vec<f64>, Vec<Number>) = match secret.effect {
            E::Stribeck => {
                let vs = secret.between(0, 0.03, 0.12) * speed;
                (vec![vs], vec![level], vec![("fs", level), ("vs", vs)])
            }
            E::NonlinearViscous => {
                let p = if secret.chance[0] < 0.7 {
                    secret.between(1, 0.35, 0.7)
                } else {
                    secret.between(1, 1.6, 2.4)
                };
                (vec![p], vec![level], vec![("f", level), ("p", p)])
            }
            E::LoadDependentFriction => (Vec::new(), vec![magnitude], vec![("mu", magnitude)]),
            E::PositionDependentFriction => {
                let order = secret.between(0, 2.0, 6.0) * PI / range;
                (vec![order], wave(), vec![("amplitude", level), ("wave_number", order)])
            }
            E::AsymmetricFriction => {
                (Vec::new(), vec![level / speed], vec![("half_difference", level / speed)])
            }
            E::FrictionDrift => {
                let tau = secret.between(0, 2.0, 9.0);
                (vec![1.0, tau], vec![level], vec![("coulomb", level), ("tau", tau)])
            }
            E::TorqueRipple => {
                let order = [1.0, 2.0, 4.0][(3.0 * secret.chance[0]) as usize % 3];
                (vec![order * gear], wave(), vec![("amplitude", level), ("order_per_motor_turn", order)])
            }
            // A spring of a joint: linear about a rest position, which is an offset.
            _ => {
                let k = 2.0 * level / range;
                (Vec::new(), vec![k], vec![("k", k)])
            }
        };
        let scale = TermScale { speed, range, torque: 1.0, duration: 10.0, gear, prismatic: false };
        let number = self.nominal.robot().joint_number(JointIndex(j));
        self.laws.push(EffectTerm {
            effect: secret.effect,
            place: Place::Joint(j),
            joints: vec![number.0],
            shape,
            sigma: vec![0.0; amplitude.len()],
            amplitude,
            scale: Some(scale),
            wrenches: Vec::new(),
        });
        numbers
    }

    /// A cube of 6 cm somewhere beside the origin of the joint's frame.
    fn body(&mut self, secret: &Secret, magnitude: f64) -> Vec<Number> {
        let robot = self.nominal.robot();
        let nominal = &self.standard;
        let moving: f64 = (robot.standard.iter().zip(nominal))
            .filter(|(p, _)| p.kind == ParameterKind::M)
            .map(|(_, value)| value)
            .sum();
        let mass = magnitude * moving;
        let [x, y, z] = [0, 1, 2].map(|k| secret.between(k, -0.08, 0.08));
        let own = 0.06 * 0.06 / 6.0;
        let inertial = [
            own + y * y + z * z,
            -x * y,
            -x * z,
            own + x * x + z * z,
            -y * z,
            own + x * x + y * y,
            x,
            y,
            z,
            1.0,
        ];
        let joint_of = robot.joint_of_frame();
        let own_body = (0..robot.standard.len()).filter(|&k| {
            joint_of[robot.standard[k].frame] == secret.joint && robot.standard[k].kind <= ParameterKind::M
        });
        for (k, per_kg) in own_body.zip(inertial) {
            self.standard[k] += mass * per_kg;
        }
        vec![("mass", mass), ("x", x), ("y", y), ("z", z)]
    }

    fn another_table(&mut self, secret: &Secret, magnitude: f64) -> Result<Vec<Number>, Failure> {
        let mut changed = self.model().robot().clone();
        let numbers = if secret.effect == EffectKind::BaseTilt {
            let g = -changed.gravity[2];
            let about = TAU * secret.chance[0];
            let level = g * magnitude.sin();
            changed.gravity = [level * about.cos(), level * about.sin(), -g * magnitude.cos()];
            vec![("tilt", magnitude), ("direction", about)]
        } else {
            let known = lengths(self.nominal.robot());
            let own: Vec<_> = known.iter().filter(|l| Some(l.joint) == secret.joint).collect();
            let length =
                own.get((secret.chance[0] * own.len() as f64) as usize).ok_or("no length on this joint")?;
            let frame = &mut changed.frames.to_mut()[length.frame];
            let value = if length.is_d { &mut frame.d } else { &mut frame.r };
            let error = -*value * magnitude;
            *value += *value * magnitude;
            vec![(if length.is_d { "error_d" } else { "error_r" }, error)]
        };
        // Every standard parameter by itself: the regrouping of the nominal table does not hold for another one.
        let every = Robot::with_standard_as_base(
            &changed.name,
            changed.gravity,
            changed.frames.to_vec(),
            changed.drive.clone(),
            changed.limits.clone(),
        );
        changed.base = every.base;
        changed.standard = every.standard;
        self.table = Some(RecursiveModel::new(changed)?);
        Ok(numbers)
    }

    fn push(&mut self, secret: &Secret, magnitude: f64) -> Vec<Number> {
        let robot = self.nominal.robot();
        let n = robot.joints();
        let mean = (0..n).map(|j| friction(robot, j)).sum::<f64>() / n.max(1) as f64;
        let force = magnitude * mean / 0.3;
        let around = TAU * secret.chance[0];
        let up = secret.between(1, -0.9, 0.9);
        let flat = (1.0 - up * up).sqrt();
        let window = secret.window();
        let last = robot.joint_of_frame().iter().rposition(Option::is_some).unwrap_or(0);
        self.pushes.push((
            [force * flat * around.cos(), force * flat * around.sin(), force * up],
            last,
            window,
        ));
        vec![("force", force), ("from", window[0]), ("to", window[1])]
    }

    /// The robot for one motion; only the first of a recording is touched by something outside.
    pub fn plant(&self, motion: usize) -> Result<Plant<'_>, SimulationError> {
        let model = self.model();
        let robot = model.robot();
        let chi = self.known();
        let mut torques: Vec<Box<dyn ExtraTorque + '_>> = Vec::new();
        for torque in SimulatedEffects::new(model, &chi, &self.laws).torques {
            torques.push(torque);
        }
        for &(joint, level, distance) in &self.dahl {
            torques.push(Box::new(Dahl { joint, level, distance, state: 0.0, last: None }));
        }
        for &(joints, ratio, share) in &self.coupled {
            let own = |kind| of_joint(robot, kind, joints[1]).map_or(0.0, |k| share * self.standard[k]);
            let (viscous, coulomb) = (own(ParameterKind::Fv), own(ParameterKind::Fc));
            torques.push(Box::new(CoupledRotor { joints, ratio, viscous, coulomb }));
        }
        for &(force, frame, window) in self.pushes.iter().filter(|_| motion == 0) {
            let links = robot.frames.iter().map(Link::constant).collect();
            torques.push(Box::new(Push { robot, links, frame, force, window }));
        }
        if self.elastic.is_empty() {
            return Plant::with_torques(model, &chi, torques);
        }
        Plant::with_effects(model, &self.standard, &self.elastic, torques)
    }
}

fn friction(robot: &Robot, joint: usize) -> f64 {
    let nominal = robot.nominal.as_ref();
    of_joint(robot, ParameterKind::Fc, joint).zip(nominal).map_or(1.0, |(k, nominal)| nominal.standard[k])
}

fn speed(robot: &Robot, joint: usize) -> f64 {
    SHARE * robot.limits.velocity.get(joint).map_or(1.0, |v| v[1])
}

fn range(robot: &Robot, joint: usize) -> f64 {
    SHARE * robot.limits.position.get(joint).map_or(1.0, |q| q[1] - q[0])
}

/// A spring between motor and link: the motor and its encoder on one side, the link on the other. With play the
/// spring behind it is stiff.
fn elastic(model: &dyn Model, secret: &Secret, magnitude: f64) -> Result<ElasticJoint, Failure> {
    let joint = secret.joint.ok_or("a spring needs a joint")?;
    let [_, link] = inertias(model, joint);
    let (frequency, play) = match secret.effect {
        EffectKind::Backlash => (secret.between(0, 30.0, 60.0), magnitude),
        _ => (10.0 / magnitude.sqrt(), 0.0),
    };
    let stiffness = link * (TAU * frequency).powi(2);
    let damping = 2.0 * secret.between(1, 0.02, 0.08) * (stiffness * link).sqrt();
    Ok(ElasticJoint { joint, stiffness, damping, play })
}

/// Torque that a drive reports whose motor gives `torque`, where its constant droops by `size` at `most_torque`.
fn reported(torque: f64, size: f64, most_torque: f64) -> f64 {
    torque + size * most_torque * (torque / most_torque.max(1e-9)).powi(3)
}

/// What a recording says wrongly about the motion. `rate`: its control rate; a delayed recording holds every control
/// sample, and `every` of them becomes a row.
pub fn distort(motion: &mut Trajectory, secret: &Secret, size: f64, rate: f64, every: usize) {
    let j = secret.joint.unwrap_or(0);
    match secret.effect {
        EffectKind::TorqueConstantError => motion.torque[j].iter_mut().for_each(|x| *x *= 1.0 + size),
        // The drive reports current times its constant: more than the torque where the constant droops. The motor is
        // the same in every motion: what it gives at a torque does not depend on how far the motion goes.
        EffectKind::TorqueSaturation => {
            for x in &mut motion.torque[j] {
                *x = reported(*x, size, secret.most_torque);
            }
        }
        EffectKind::PositionOffset => motion.position[j].iter_mut().for_each(|q| *q += size),
        EffectKind::WrongSampleRate => motion.time.iter_mut().for_each(|t| *t *= 1.0 + size),
        EffectKind::TimeDelay => {
            let late = (size * rate).round() as usize;
            let kept: Vec<usize> = (late..motion.time.len()).step_by(every).collect();
            let pick = |signal: &[f64], shift: usize| kept.iter().map(|k| signal[k - shift]).collect();
            motion.torque = motion.torque.iter().map(|signal| pick(signal, late)).collect();
            motion.position = motion.position.iter().map(|signal| pick(signal, 0)).collect();
            motion.time = pick(&motion.time, 0);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_droops_alike_in_every_motion() {
        let secret = Secret {
            effect: EffectKind::TorqueSaturation,
            joint: Some(0),
            chance: [0.0; 4],
            most_torque: 4.0,
        };
        let report = |torque: [f64; 2]| {
            let mut motion = Trajectory {
                name: String::new(),
                time: vec![0.0, 1.0],
                position: vec![vec![0.0; 2]],
                velocity: None,
                torque: vec![torque.to_vec()],
                fixed: Vec::new(),
            };
            distort(&mut motion, &secret, 0.2, 2000.0, 4);
            motion.torque[0].clone()
        };
        let (gentle, hard) = (report([1.0, -2.0]), report([1.0, -4.0]));
        assert_eq!(gentle[0], hard[0]);
        assert!((hard[1] + 4.0 * 1.2).abs() < 1e-12);
        assert!((gentle[1] + 2.0 * 1.05).abs() < 1e-12);
    }
}
