//! What could be meant instead of what a recording says of itself: another robot, another gravity, a sign, an order, a
//! unit, an offset.

use std::f64::consts::PI;

use super::judged::{Judged, free_estimate};
use super::table::{self, Table};
use crate::estimation::observe::{Equations, observe};
use crate::estimation::{PhysicalFit, physical_fit};
use crate::model::{Drive, JointIndex, JointKind, Model, Robot};
use crate::recording::regear;
use crate::signal::Motion;

/// A joint's error from which something is looked for that was mistaken about it.
pub(super) const POOR: f64 = 0.25;
/// Between N.m and mN.m, N and kN.
const THOUSAND: f64 = 1000.0;

/// What could be meant instead.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Instead {
    /// Another robot, by its name.
    Robot(String),
    /// The opposite sign of a joint's signal.
    Sign {
        /// Which signal.
        of: Signal,
        /// Which joint.
        joint: JointIndex,
    },
    /// Two columns in the other order.
    Exchange {
        /// Which signal.
        of: Signal,
        /// Which joints.
        joints: [JointIndex; 2],
    },
    /// Another unit of the torque of one joint.
    Scale {
        /// Which joint.
        joint: JointIndex,
        /// What its torque is multiplied with.
        factor: f64,
    },
    /// Gravity along another axis of frame 0, or the other way, m/s2.
    Gravity([f64; 3]),
    /// Gravity in another direction than the table says, because the base is tilted, m/s2 in frame 0.
    Tilt([f64; 3]),
    /// Angles of the table that are beyond a turn in degrees.
    TableAngles,
    /// Angles in another unit.
    Unit(AngleUnit),
    /// Another zero of a joint's position.
    Offset {
        /// Which joint.
        joint: JointIndex,
        /// Degrees that are added.
        degrees: i32,
    },
    /// Other zeros of some joints: how far each is beyond where its encoder sees it, rad.
    Zeros(Vec<(JointIndex, f64)>),
}

/// A signal of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Positions.
    Position,
    /// Torques.
    Torque,
    /// Positions and torques.
    Both,
}

/// A unit of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// rad.
    Radians,
    /// degrees.
    Degrees,
}

/// Gravity along the other axes of frame 0 and the other way.
pub(super) fn other_gravities(robot: &Robot) -> impl Iterator<Item = Instead> {
    table::other_gravities(robot).map(Instead::Gravity)
}

/// What may have been mistaken about the table, and about signs and units of single joints. The joint that was mistaken
/// need not be the one that is explained worst: what it is coupled to is as wrong.
pub(super) fn single_mistakes(robot: &Robot) -> Vec<Instead> {
    let mut all: Vec<Instead> = other_gravities(robot).collect();
    if table::beyond_a_turn(robot) {
        all.push(Instead::TableAngles);
    }
    for joint in (0..robot.joints()).map(JointIndex) {
        all.extend([Signal::Position, Signal::Torque, Signal::Both].map(|of| Instead::Sign { of, joint }));
        all.extend([THOUSAND, 1.0 / THOUSAND].map(|factor| Instead::Scale { joint, factor }));
    }
    all
}

/// What else may have been mistaken about the joints that are explained poorly.
pub(super) fn mistakes(robot: &Robot, own: &PhysicalFit) -> Vec<Instead> {
    let kinds = robot.joint_kinds();
    let n = kinds.len();
    let poor: Vec<bool> = own.per_equation.iter().map(|e| e.is_some_and(|e| e > POOR)).collect();
    let mut all = Vec::new();
    for joint in (0..n).filter(|&j| poor[j] && kinds[j] == JointKind::Revolute) {
        let joint = JointIndex(joint);
        all.extend([90, -90, 180].map(|degrees| Instead::Offset { joint, degrees }));
    }
    for a in 0..n {
        for b in a + 1..n {
            if (poor[a] || poor[b]) && kinds[a] == kinds[b] {
                let joints = [JointIndex(a), JointIndex(b)];
                all.extend(
                    [Signal::Both, Signal::Torque, Signal::Position]
                        .map(|of| Instead::Exchange { of, joints }),
                );
            }
        }
    }
    all.extend([AngleUnit::Degrees, AngleUnit::Radians].map(Instead::Unit));
    all
}

impl Instead {
    /// Whether it is about signs, or units, or gravity, ...: what is as good as another of its family cannot be told from
    /// it.
    pub(super) fn same_family(&self, other: &Instead) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }

    /// How well it explains the recording. `None` where it cannot be told, or where the errors of the joints are not
    /// `promising` even with parameters that no robot can have.
    pub(super) fn fit(
        &self,
        judged: &Judged<'_>,
        others: &[&dyn Model],
        promising: impl Fn(&[Option<f64>]) -> bool,
    ) -> Option<PhysicalFit> {
        let own = judged.model;
        let altered;
        let model = match self {
            Instead::Robot(name) => *others.iter().find(|m| m.robot().name == name.as_str())?,
            Instead::Gravity(gravity) | Instead::Tilt(gravity) => {
                altered = table::altered(own.robot(), Table::Gravity(*gravity))?;
                &altered as &dyn Model
            }
            Instead::TableAngles => {
                altered = table::altered(own.robot(), Table::Degrees)?;
                &altered
            }
            _ => own,
        };
        let (gear, other) = (&own.robot().drive, &model.robot().drive);
        let kinds = own.robot().joint_kinds();
        let changed = |motion: &Motion| match self {
            Instead::Robot(_) if judged.motor_side => regear(motion, gear, other),
            // Columns of motors were mixed up before the gear brought them to the joints.
            Instead::Sign { .. } | Instead::Exchange { .. } | Instead::Scale { .. } if judged.motor_side => {
                let mut motors = regear(motion, gear, &direct(kinds.len()))?;
                self.change(&mut motors, &kinds);
                regear(&motors, &direct(kinds.len()), gear)
            }
            _ => {
                let mut motion = motion.clone();
                self.change(&mut motion, &kinds);
                Some(motion)
            }
        };
        let motions = judged.motions.iter().map(changed).collect::<Option<Vec<Motion>>>()?;
        let observation = observe(model, &motions, Equations::Torque, None, judged.settings, None).ok()?;
        let free = free_estimate(&observation);
        if !promising(&free.per_equation) {
            return None;
        }
        physical_fit(model.robot(), &observation, &free)
    }

    fn change(&self, motion: &mut Motion, kinds: &[JointKind]) {
        let Motion { q, dq, ddq, torque, .. } = motion;
        let positions = [q, dq, ddq];
        match *self {
            Instead::Robot(_) | Instead::Gravity(_) | Instead::Tilt(_) | Instead::TableAngles => {}
            Instead::Zeros(ref zeros) => {
                let [q, ..] = positions;
                for &(JointIndex(joint), by) in zeros {
                    q[joint].iter_mut().for_each(|x| *x += by);
                }
            }
            Instead::Scale { joint: JointIndex(joint), factor } => scale(&mut torque[joint], factor),
            Instead::Sign { of, joint: JointIndex(joint) } => {
                if of != Signal::Torque {
                    positions.into_iter().for_each(|p| scale(&mut p[joint], -1.0));
                }
                if of != Signal::Position {
                    scale(&mut torque[joint], -1.0);
                }
            }
            Instead::Exchange { of, joints: [JointIndex(a), JointIndex(b)] } => {
                if of != Signal::Torque {
                    positions.into_iter().for_each(|p| p.swap(a, b));
                }
                if of != Signal::Position {
                    torque.swap(a, b);
                }
            }
            Instead::Unit(unit) => {
                let factor = match unit {
                    AngleUnit::Degrees => PI / 180.0,
                    AngleUnit::Radians => 180.0 / PI,
                };
                for positions in positions {
                    let revolute =
                        positions.iter_mut().zip(kinds).filter(|(_, k)| **k == JointKind::Revolute);
                    revolute.for_each(|(p, _)| scale(p, factor));
                }
            }
            Instead::Offset { joint: JointIndex(joint), degrees } => {
                let by = f64::from(degrees) / 180.0 * PI;
                let [q, ..] = positions;
                q[joint].iter_mut().for_each(|x| *x += by);
            }
        }
    }
}

/// Motors that sit on their joints.
fn direct(joints: usize) -> Drive {
    let gear = (0..joints * joints).map(|k| if k % (joints + 1) == 0 { 1.0 } else { 0.0 });
    Drive { gear: gear.collect(), coupled_friction: Vec::new().into() }
}

fn scale(values: &mut [f64], factor: f64) {
    values.iter_mut().for_each(|x| *x *= factor);
}
