//! Puts drawn effects into simulated robots.

use std::f64::consts::TAU;

use dynid_runtime::effects::{ContactForce, EffectKind, EffectTerm, JointTorque, Place, TermScale};
use dynid_runtime::model::{JointIndex, Model, ParameterKind, Robot};
use dynid_runtime::simulation::{ElasticJoint, World};

use crate::failure::Failure;
use crate::motions::SHARE;
use crate::places::{inertias, lengths, of_joint};
use crate::secret::Secret;

/// A quantity of a hidden effect, for the person who reads what was hidden.
pub type Number = (&'static str, f64);

/// Units in which the law of a joint is drawn.
pub struct Joint {
    /// 0-based.
    pub joint: usize,
    /// Dry friction, N.m or N.
    pub friction: f64,
    /// Top speed of the motions.
    pub speed: f64,
    /// Travel of the motions.
    pub range: f64,
    /// Motor turns per joint turn.
    pub gear: f64,
}

impl Joint {
    /// Of the joint of a secret.
    pub fn of(model: &dyn Model, secret: &Secret) -> Self {
        let (robot, joint) = (model.robot(), secret.joint.unwrap_or(0));
        Self {
            joint,
            friction: friction(robot, joint),
            speed: SHARE * robot.limits.velocity.get(joint).map_or(1.0, |v| v[1]),
            range: SHARE * robot.limits.position.get(joint).map_or(1.0, |q| q[1] - q[0]),
            gear: robot.drive.gear.get(joint * (robot.joints() + 1)).map_or(1.0, |g| g.abs()),
        }
    }

    /// Amplitudes of cosine and sine of a wave, `magnitude` times the dry friction high.
    pub fn wave(&self, secret: &Secret, magnitude: f64) -> Vec<f64> {
        let phase = TAU * secret.chance[3];
        let level = magnitude * self.friction;
        vec![level * phase.cos(), level * phase.sin()]
    }

    /// The law of an effect on the joint.
    pub fn term(&self, secret: &Secret, shape: Vec<f64>, amplitude: Vec<f64>) -> EffectTerm {
        let (speed, range, gear) = (self.speed, self.range, self.gear);
        EffectTerm {
            scale: Some(TermScale {
                speed,
                range,
                centre: 0.0,
                torque: 1.0,
                start: 0.0,
                duration: 10.0,
                gear,
                fast: 0.0,
                prismatic: false,
            }),
            ..term(secret.effect, Place::Joint(self.joint), shape, amplitude)
        }
    }
}

fn term(effect: EffectKind, place: Place, shape: Vec<f64>, amplitude: Vec<f64>) -> EffectTerm {
    let sigma = vec![0.0; amplitude.len()];
    EffectTerm {
        effect,
        place,
        joints: Vec::new(),
        shape,
        amplitude,
        sigma,
        scale: None,
        wrenches: Vec::new(),
    }
}

fn friction(robot: &Robot, joint: usize) -> f64 {
    let nominal = robot.nominal.as_ref();
    of_joint(robot, ParameterKind::Fc, joint).zip(nominal).map_or(1.0, |(k, nominal)| nominal.standard[k])
}

/// A cube of 6 cm somewhere beside the origin of the joint's frame.
pub fn body(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let robot = model.robot();
    let nominal = robot.nominal.as_ref().ok_or("the robot has no nominal values")?;
    let moving: f64 = (robot.standard.iter().zip(&*nominal.standard))
        .filter(|(p, _)| p.kind == ParameterKind::M)
        .map(|(_, value)| value)
        .sum();
    let mass = magnitude * moving;
    let [x, y, z] = [0, 1, 2].map(|k| secret.between(k, -0.08, 0.08));
    let own = 0.06 * 0.06 / 6.0;
    let (xx, yy, zz) = (own + y * y + z * z, own + x * x + z * z, own + x * x + y * y);
    let inertial = [xx, -x * y, -x * z, yy, -y * z, zz, x, y, z, 1.0].map(|per_kg| mass * per_kg);
    let frame = robot.joint_of_frame().iter().position(|j| j.is_some() && *j == secret.joint);
    let place = Place::Link(frame.ok_or("a body needs a link")?);
    world.put(&term(secret.effect, place, Vec::new(), inertial.to_vec()));
    Ok(vec![("mass", mass), ("x", x), ("y", y), ("z", z)])
}

/// Gravity from another direction, the same size.
pub fn tilt(
    world: &mut World<'static>,
    _: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let about = TAU * secret.chance[0];
    world.change_table(|robot| {
        let g = -robot.gravity[2];
        let level = g * magnitude.sin();
        robot.gravity = [level * about.cos(), level * about.sin(), -g * magnitude.cos()];
    })?;
    Ok(vec![("tilt", magnitude), ("direction", about)])
}

/// A length of the table that is not the real one.
pub fn length(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let known = lengths(model.robot());
    let own: Vec<_> = known.iter().filter(|l| Some(l.joint) == secret.joint).collect();
    let length = own.get((secret.chance[0] * own.len() as f64) as usize).ok_or("no length on this joint")?;
    let mut error = 0.0;
    world.change_table(|robot| {
        let frame = &mut robot.frames.to_mut()[length.frame];
        let value = if length.is_d { &mut frame.d } else { &mut frame.r };
        error = *value * magnitude;
        *value += error;
    })?;
    Ok(vec![(if length.is_d { "error_d" } else { "error_r" }, error)])
}

/// A rotor that the joint before turns, too.
pub fn coupled(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let robot = model.robot();
    let j = secret.joint.filter(|j| *j > 0).ok_or("a coupling needs a joint before it")?;
    let nominal = robot.nominal.as_ref().ok_or("the robot has no nominal values")?;
    let ratio = [-0.5, 0.25, 0.5, 1.0][(4.0 * secret.chance[0]) as usize % 4];
    let own = |kind| of_joint(robot, kind, j).map_or(0.0, |k| magnitude * nominal.standard[k]);
    let amplitude = vec![own(ParameterKind::Fv), own(ParameterKind::Fc), 0.0];
    world.put(&term(secret.effect, Place::Pair(j - 1, j), vec![ratio], amplitude));
    Ok(vec![("with_joint", j as f64), ("ratio", ratio)])
}

/// A spring between motor and link: the motor and its encoder on one side, the link on the other.
pub fn spring(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    frequency: f64,
    play: f64,
) -> Result<Vec<Number>, Failure> {
    let joint = secret.joint.ok_or("a spring needs a joint")?;
    let [_, link] = inertias(model, joint);
    let stiffness = link * (TAU * frequency).powi(2);
    let damping = 2.0 * secret.between(1, 0.02, 0.08) * (stiffness * link).sqrt();
    world.put_spring(ElasticJoint { joint, stiffness, damping, play });
    Ok(vec![("k", stiffness), ("d", damping), ("gap", play)])
}

/// Only the first motion of a recording is touched by something outside: its last link by a force, or one joint by a
/// torque.
pub fn push(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let robot = model.robot();
    let n = robot.joints();
    let mean = (0..n).map(|j| friction(robot, j)).sum::<f64>() / n.max(1) as f64;
    let window = secret.window;
    let last = robot.joint_of_frame().iter().rposition(Option::is_some).unwrap_or(0);
    let motion = crate::motions::name(0);
    let mut contact = ContactForce { motion, window, link: last + 1, ..ContactForce::default() };
    let when = [("from", window[0]), ("to", window[1])];
    if let Some(joint) = secret.joint {
        let joint = robot.joint_number(JointIndex(joint)).0;
        let torque = magnitude * mean;
        contact.joint_torques = vec![JointTorque { joint, mean: 0.5 * torque, largest: torque, sigma: 0.0 }];
        world.put_push(contact);
        return Ok([&when[..], &[("pushed_joint", joint as f64), ("torque", torque)]].concat());
    }
    let size = magnitude * mean / 0.3;
    let around = TAU * secret.chance[0];
    let up = secret.between(1, -0.9, 0.9);
    let flat = (1.0 - up * up).sqrt();
    let force = [size * flat * around.cos(), size * flat * around.sin(), size * up];
    contact.force = force;
    contact.mean_force = force.map(|f| 0.5 * f);
    world.put_push(contact);
    let force = [("force", size), ("x", force[0]), ("y", force[1]), ("z", force[2])];
    Ok([&when[..], &force, &[("link", (last + 1) as f64)]].concat())
}
