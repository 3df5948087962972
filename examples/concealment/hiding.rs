//! How each effect is hidden: where it can be, how large, and how it is put into a simulated robot or its recording.
//!
//! An effect of the catalogue that has no line here is not hidden, and a run says so.

use std::f64::consts::{PI, TAU};

use dynid_runtime::effects::{ContactForce, EffectKind, EffectTerm, Place, TermScale};
use dynid_runtime::model::{Model, ParameterKind, Robot};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::{ElasticJoint, World};

use crate::Failure;
use crate::motions::{RATE, RECORD_EVERY, SHARE};
use crate::places::{self, Places, inertias, lengths, of_joint};
use crate::secret::Secret;

/// A quantity of a hidden effect, for the person who reads what was hidden.
pub type Number = (&'static str, f64);

/// How an effect is hidden.
pub struct Hiding {
    /// Which.
    pub effect: EffectKind,
    /// What its magnitude counts. The torque is about proportional to it.
    pub counts: &'static str,
    /// Where a search for the right magnitude begins.
    pub start: f64,
    /// The most that a robot may have of it.
    pub most: f64,
    /// Whether it is hidden as a change since an earlier recording.
    pub is_change: bool,
    /// Joints on which it can show at all.
    pub places: fn(&dyn Model) -> Places,
    /// Puts it into a robot; gives what a person would call it by.
    pub put: Put,
    /// What a recording says wrongly about the motion because of it.
    pub distort: fn(&mut Trajectory, &Secret, f64),
}

/// Puts an effect of a magnitude into a robot whose nominal model is given.
type Put = fn(&mut World<'static>, &'static dyn Model, &Secret, f64) -> Result<Vec<Number>, Failure>;

/// The line of an effect.
pub fn of(effect: EffectKind) -> Option<&'static Hiding> {
    TABLE.iter().find(|hiding| hiding.effect == effect)
}

/// The robot as its YAML has it.
pub fn plain(model: &'static dyn Model) -> Result<World<'static>, Failure> {
    let nominal = model.robot().nominal.as_ref().ok_or("the robot has no nominal values")?;
    Ok(World::from_standard(model, &nominal.standard))
}

/// Hides an effect in a robot; returns what a person would call it by.
pub fn hide(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let hiding =
        of(secret.effect).ok_or_else(|| format!("nobody knows how to hide {}", secret.effect.id()))?;
    (hiding.put)(world, model, secret, magnitude)
}

/// A line whose effect is a law of a joint.
const fn law(effect: EffectKind, counts: &'static str, start: f64, most: f64, put: Put) -> Hiding {
    Hiding { effect, counts, start, most, is_change: false, places: places::every, put, distort: undistorted }
}

/// A line whose effect is in the recording, not in the robot.
const fn recorded(
    effect: EffectKind,
    counts: &'static str,
    [start, most]: [f64; 2],
    places: fn(&dyn Model) -> Places,
    distort: fn(&mut Trajectory, &Secret, f64),
) -> Hiding {
    Hiding { effect, counts, start, most, is_change: false, places, put: nowhere, distort }
}

const fn undistorted(_: &mut Trajectory, _: &Secret, _: f64) {}

fn nowhere(
    _: &mut World<'static>,
    _: &'static dyn Model,
    _: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    Ok(vec![("size", magnitude)])
}

const TABLE: [Hiding; 23] = [
    law(EffectKind::Stribeck, "extra level at rest, of the dry friction", 0.3, 2.0, |world, model, s, m| {
        let joint = Joint::of(model, s);
        let (level, vs) = (m * joint.friction, s.between(0, 0.03, 0.12) * joint.speed);
        world.put(&joint.term(s, vec![vs], vec![level]));
        Ok(vec![("fs", level), ("vs", vs)])
    }),
    law(
        EffectKind::NonlinearViscous,
        "torque at top speed, of the dry friction",
        0.5,
        4.0,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let level = m * joint.friction;
            let p = if s.chance[0] < 0.7 { s.between(1, 0.35, 0.7) } else { s.between(1, 1.6, 2.4) };
            world.put(&joint.term(s, vec![p], vec![level]));
            Ok(vec![("f", level), ("p", p)])
        },
    ),
    law(EffectKind::LoadDependentFriction, "mu", 0.05, 0.3, |world, model, s, m| {
        world.put(&Joint::of(model, s).term(s, Vec::new(), vec![m]));
        Ok(vec![("mu", m)])
    }),
    law(
        EffectKind::PositionDependentFriction,
        "amplitude, of the dry friction",
        0.2,
        0.9,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let order = s.between(0, 2.0, 6.0) * PI / joint.range;
            world.put(&joint.term(s, vec![order], joint.wave(s, m)));
            Ok(vec![("amplitude", m * joint.friction), ("wave_number", order)])
        },
    ),
    law(
        EffectKind::AsymmetricFriction,
        "half difference at top speed, of the dry friction",
        0.3,
        2.0,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let half = m * joint.friction / joint.speed;
            world.put(&joint.term(s, Vec::new(), vec![half]));
            Ok(vec![("half_difference", half)])
        },
    ),
    law(
        EffectKind::PreslidingHysteresis,
        "part of the dry friction that builds up late",
        0.5,
        1.0,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let (level, distance) = (m * joint.friction, s.between(0, 0.01, 0.03) * joint.range);
            world.put(&joint.term(s, vec![distance], vec![level]));
            Ok(vec![("level", level), ("distance", distance)])
        },
    ),
    law(
        EffectKind::FrictionDrift,
        "fading Coulomb level, of the dry friction",
        0.3,
        2.0,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let (level, tau) = (m * joint.friction, s.between(0, 2.0, 9.0));
            world.put(&joint.term(s, vec![1.0, tau], vec![level]));
            Ok(vec![("coulomb", level), ("tau", tau)])
        },
    ),
    Hiding {
        is_change: true,
        ..law(
            EffectKind::FrictionLevelChange,
            "change of viscous and Coulomb friction",
            0.1,
            1.0,
            |world, _, s, m| {
                world.scale_friction(s.joint.unwrap_or(0), 1.0 + m);
                Ok(vec![("factor", 1.0 + m)])
            },
        )
    },
    law(EffectKind::TorqueRipple, "amplitude, of the dry friction", 0.1, 1.0, |world, model, s, m| {
        let joint = Joint::of(model, s);
        let order = [1.0, 2.0, 4.0][(3.0 * s.chance[0]) as usize % 3];
        world.put(&joint.term(s, vec![order * joint.gear], joint.wave(s, m)));
        Ok(vec![("amplitude", m * joint.friction), ("order_per_motor_turn", order)])
    }),
    // Linear about a rest position, which is an offset.
    law(
        EffectKind::Spring,
        "torque at half of the travel, of the dry friction",
        0.4,
        5.0,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let k = 2.0 * (m * joint.friction) / joint.range;
            world.put(&joint.term(s, Vec::new(), vec![k]));
            Ok(vec![("k", k)])
        },
    ),
    Hiding {
        is_change: true,
        places: places::flange,
        ..law(EffectKind::Payload, "mass, of the robot's moving mass", 0.01, 0.3, body)
    },
    Hiding {
        is_change: true,
        places: places::inner_links,
        ..law(EffectKind::AddedMass, "mass, of the robot's moving mass", 0.02, 0.3, body)
    },
    Hiding {
        is_change: true,
        places: places::whole_robot,
        ..law(EffectKind::BaseTilt, "tilt, rad", 0.02, 0.2, tilt)
    },
    Hiding {
        places: places::neighbours,
        ..law(EffectKind::CoupledTransmission, "Coulomb and viscous level, of the joint's", 0.2, 1.5, coupled)
    },
    Hiding {
        is_change: true,
        ..recorded(
            EffectKind::TorqueConstantError,
            "error of the torque constant",
            [0.04, 0.4],
            places::every,
            |motion, s, size| motion.torque[s.joint.unwrap_or(0)].iter_mut().for_each(|x| *x *= 1.0 + size),
        )
    },
    Hiding {
        put: |_, _, s, m| Ok(vec![("size", m), ("at_torque", s.most_torque)]),
        ..recorded(
            EffectKind::TorqueSaturation,
            "droop at the largest torque",
            [0.06, 0.4],
            places::every,
            // The drive reports current times its constant: more than the torque where the constant droops. The motor
            // is the same in every motion: what it gives at a torque does not depend on how far the motion goes.
            |motion, s, size| {
                for x in &mut motion.torque[s.joint.unwrap_or(0)] {
                    *x += size * s.most_torque * (*x / s.most_torque.max(1e-9)).powi(3);
                }
            },
        )
    },
    Hiding {
        places: places::swinging,
        ..law(
            EffectKind::JointElasticity,
            "compliance, in units of a link at 10 Hz",
            1.0,
            11.0,
            |w, model, s, m| spring(w, model, s, 10.0 / m.sqrt(), 0.0),
        )
    },
    // With play the spring behind it is stiff.
    Hiding {
        places: places::swinging,
        ..law(EffectKind::Backlash, "play, rad", 0.001, 0.02, |w, model, s, m| {
            spring(w, model, s, s.between(0, 30.0, 60.0), m)
        })
    },
    recorded(
        EffectKind::TimeDelay,
        "delay of the torque, s",
        [0.004, 0.03],
        places::whole_robot,
        // A delayed recording holds every control sample, and some of them become rows.
        |motion, _, size| {
            let late = (size * RATE).round() as usize;
            let kept: Vec<usize> = (late..motion.time.len()).step_by(RECORD_EVERY).collect();
            let pick = |signal: &[f64], shift: usize| kept.iter().map(|k| signal[k - shift]).collect();
            motion.torque = motion.torque.iter().map(|signal| pick(signal, late)).collect();
            motion.position = motion.position.iter().map(|signal| pick(signal, 0)).collect();
            motion.time = pick(&motion.time, 0);
        },
    ),
    recorded(
        EffectKind::WrongSampleRate,
        "error of the declared period",
        [0.02, 0.2],
        places::whole_robot,
        |motion, _, size| motion.time.iter_mut().for_each(|t| *t *= 1.0 + size),
    ),
    recorded(
        EffectKind::PositionOffset,
        "offset, rad",
        [0.03, 0.3],
        places::between_others,
        |motion, s, size| motion.position[s.joint.unwrap_or(0)].iter_mut().for_each(|q| *q += size),
    ),
    Hiding {
        places: places::with_lengths,
        ..law(EffectKind::GeometryError, "error of the length, of the length", 0.05, 0.4, length)
    },
    Hiding {
        places: places::whole_robot,
        ..law(
            EffectKind::Contact,
            "joint torque by the force at 0.3 m, of the dry friction; 0.5 s",
            1.0,
            8.0,
            push,
        )
    },
];

/// Units in which the law of a joint is drawn.
struct Joint {
    joint: usize,
    friction: f64,
    speed: f64,
    range: f64,
    gear: f64,
}

impl Joint {
    fn of(model: &dyn Model, secret: &Secret) -> Self {
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
    fn wave(&self, secret: &Secret, magnitude: f64) -> Vec<f64> {
        let phase = TAU * secret.chance[3];
        let level = magnitude * self.friction;
        vec![level * phase.cos(), level * phase.sin()]
    }

    fn term(&self, secret: &Secret, shape: Vec<f64>, amplitude: Vec<f64>) -> EffectTerm {
        let (speed, range, gear) = (self.speed, self.range, self.gear);
        EffectTerm {
            scale: Some(TermScale { speed, range, torque: 1.0, duration: 10.0, gear, prismatic: false }),
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
fn body(
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

fn tilt(
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

fn length(
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
        error = -*value * magnitude;
        *value += *value * magnitude;
    })?;
    Ok(vec![(if length.is_d { "error_d" } else { "error_r" }, error)])
}

fn coupled(
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
fn spring(
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

/// Only the first motion of a recording is touched by something outside.
fn push(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let robot = model.robot();
    let n = robot.joints();
    let mean = (0..n).map(|j| friction(robot, j)).sum::<f64>() / n.max(1) as f64;
    let size = magnitude * mean / 0.3;
    let around = TAU * secret.chance[0];
    let up = secret.between(1, -0.9, 0.9);
    let flat = (1.0 - up * up).sqrt();
    let window = secret.window();
    let last = robot.joint_of_frame().iter().rposition(Option::is_some).unwrap_or(0);
    let force = [size * flat * around.cos(), size * flat * around.sin(), size * up];
    let motion = crate::motions::name(0);
    world.put_push(ContactForce { motion, window, link: last + 1, force, mean_force: force });
    Ok(vec![("force", size), ("from", window[0]), ("to", window[1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_catalogue_can_be_hidden() {
        for effect in EffectKind::ALL {
            assert!(of(effect).is_some(), "{} has no line in the table", effect.id());
        }
    }

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
            let hiding = of(secret.effect).expect("it is in the table");
            (hiding.distort)(&mut motion, &secret, 0.2);
            motion.torque[0].clone()
        };
        let (gentle, hard) = (report([1.0, -2.0]), report([1.0, -4.0]));
        assert_eq!(gentle[0], hard[0]);
        assert!((hard[1] + 4.0 * 1.2).abs() < 1e-12);
        assert!((gentle[1] + 2.0 * 1.05).abs() < 1e-12);
    }
}
