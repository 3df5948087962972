//! The effects that are hidden, a line each.

use std::f64::consts::PI;

use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::World;

use crate::failure::Failure;
use crate::hiding::{Hiding, Put};
use crate::motions::{RATE, RECORD_EVERY};
use crate::outside;
use crate::places::{self, Places};
use crate::put::{Joint, Number, body, coupled, length, push, spring, tilt};
use crate::secret::Secret;

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

/// How each of them is hidden.
pub const TABLE: [Hiding; 28] = [
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
            Ok(vec![("f", level), ("v0", joint.speed), ("p", p)])
        },
    ),
    law(EffectKind::LoadDependentFriction, "mu", 0.05, 0.3, |world, model, s, m| {
        world.put(&Joint::of(model, s).term(s, Vec::new(), vec![m]));
        Ok(vec![("mu", m)])
    }),
    // One of the losses is small beside the other: equal ones are friction that grows with the load.
    law(EffectKind::DriveEfficiency, "the larger loss, of the load", 0.2, 0.6, |world, model, s, m| {
        let less = m * s.between(1, 0.0, 0.4);
        let [driving, driven] = if s.chance[0] < 0.5 { [m, less] } else { [less, m] };
        world.put(&Joint::of(model, s).term(s, vec![1.0], vec![driving, driven]));
        Ok(vec![("efficiency_driving", 1.0 / (1.0 + driving)), ("efficiency_driven", 1.0 - driven)])
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
    // A curve that no line and no wave follows.
    law(
        EffectKind::PositionDependentTorque,
        "quadratic and cubic part, of the dry friction",
        0.3,
        3.0,
        |world, model, s, m| {
            let joint = Joint::of(model, s);
            let part = m * joint.friction;
            world.put(&joint.term(s, vec![0.0, 0.5 * joint.range], vec![0.0, part, part, 0.0, 0.0]));
            Ok(vec![("part", part)])
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
            // is the same in every motion: what it gives at a torque does not depend on how far the motion goes. The
            // droop bends from the start, or begins at a knee.
            |motion, s, size| {
                let knee = s.between(1, 0.4, 0.7);
                for x in &mut motion.torque[s.joint.unwrap_or(0)] {
                    let part = *x / s.most_torque.max(1e-9);
                    let droop = if s.chance[0] < 0.5 {
                        part.powi(2)
                    } else {
                        (part.abs() - knee).max(0.0) / (1.0 - knee)
                    };
                    *x += size * droop * *x;
                }
            },
        )
    },
    // On one joint, or on all.
    recorded(
        EffectKind::TorqueConstantDrift,
        "change of the torque constant in 10 s",
        [0.05, 0.5],
        places::every,
        |motion, s, size| {
            let tau = s.between(1, 3.0, 60.0);
            let gone = |t: f64| -(-t / tau).exp_m1();
            let factor = |t: f64| 1.0 + size * gone(t) / gone(10.0);
            let warm = |j: usize| s.chance[0] < 0.5 || s.joint == Some(j);
            for (_, torque) in motion.torque.iter_mut().enumerate().filter(|(j, _)| warm(*j)) {
                torque.iter_mut().zip(&motion.time).for_each(|(x, t)| *x *= factor(*t));
            }
        },
    ),
    Hiding {
        put: |_, _, s, m| Ok(vec![("k", m), ("heard_joint", (outside::other(s) + 1) as f64)]),
        ..recorded(
            EffectKind::TorqueCrosstalk,
            "part of the neighbour's torque",
            [0.03, 0.3],
            places::every,
            |motion, s, size| {
                let heard = motion.torque[outside::other(s)].clone();
                let own = &mut motion.torque[s.joint.unwrap_or(0)];
                own.iter_mut().zip(heard).for_each(|(x, heard)| *x += size * heard);
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
    // Physics outside of the catalogue: a cable over two joints and the like.
    recorded(
        EffectKind::FreeForm,
        "torque, of the largest of the joint",
        [0.05, 0.5],
        places::every,
        outside::distort,
    ),
];
