//! Whether a recording can be one of the robot that it names: what physics says, and what would explain it better.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::fmt;
use std::path::Path;

use dynid_runtime::estimation::observe::{Equations, Observation, observe};
use dynid_runtime::estimation::{Estimate, EstimateSettings, PhysicalFit, estimate, physical_fit};
use dynid_runtime::model::{Drive, JointKind, Model, Robot};
use dynid_runtime::recording::{Side, regear};
use dynid_runtime::report::percent;
use dynid_runtime::signal::Motion;

use crate::failure::Failure;
use crate::models;
use crate::recorded::Recorded;

/// Strain from which the parameters are said not to be those of a real robot.
const STRAINED: f64 = 1.1;
/// A joint's error from which other robots are tried.
const POOR: f64 = 0.25;
/// A joint's error, and a strain, from which signs, orders, units and offsets are tried.
const BAD: f64 = 0.5;
const OVERSTRAINED: f64 = 2.0;
/// Something else is believed where it lowers the joints' errors by this factor, on their geometric mean.
const FAR_BETTER: f64 = 1.25;
/// Robots count as equally good where they lower the errors within this share of the best.
const AS_GOOD: f64 = 0.95;
/// A joint's error where half of its squared torque is explained.
const HALF: f64 = FRAC_1_SQRT_2;

/// What could be meant instead of what the recording's YAML says.
#[derive(Debug, Clone, PartialEq)]
enum Instead {
    Robot(&'static str),
    Sign { of: Signal, joint: usize },
    Exchange { of: Signal, joints: [usize; 2] },
    Unit { factor: f64, words: &'static str },
    Offset { joint: usize, by: f64, degrees: i32 },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Signal {
    Position,
    Torque,
    Both,
}

/// Checks that the recording can be one of its robot. `torques` are its torque equations, `estimated` their free
/// weighted estimate.
///
/// The free fit is compared with the best one that a real robot can have ([`physical_fit`]). Where physics costs
/// something or a joint is explained poorly, the other known robots of the same joints are tried; where it costs much
/// or a joint is explained badly, so are signs, orders of columns, units and offsets. Returns a warning for the person,
/// if there is one to give.
///
/// # Errors
/// [`Failure::Data`] where something else explains the recording far better, or where physics takes away what the
/// free fit explains of a joint.
pub fn check(
    path: &Path,
    recorded: &Recorded,
    torques: &Observation,
    estimated: &Estimate,
) -> Result<Option<String>, Failure> {
    let robot = recorded.dynamics.model().robot();
    let Some(own) = physical_fit(robot, torques, estimated) else { return Ok(None) };
    let Some(worst_joint) = largest(own.per_equation.len(), |j| own.per_equation[j]) else { return Ok(None) };
    let worst = own.per_equation[worst_joint];
    let mut candidates = Vec::new();
    if own.strain > STRAINED || worst > POOR {
        candidates.extend(other_robots(robot));
    }
    if own.strain > OVERSTRAINED || worst > BAD {
        candidates.extend(mistakes(robot, &own));
    }
    let refused = |words: String| {
        Err(Failure::Data(format!("{}: {words}. (--implausible identifies all the same)", path.display())))
    };
    let instead = better(recorded, candidates, &own);
    if let Some((first, fit)) = instead.first() {
        let names: Vec<String> = instead.iter().map(|(what, _)| what.to_string()).collect();
        return refused(format!(
            "this cannot be a recording of {} as it is described: the best parameters that such a robot can have leave {} \
             of the torques unexplained (joint {}: {}); {} leaves {}. {}",
            robot.name,
            percent(own.relative_error),
            worst_joint + 1,
            percent(own.per_equation[worst_joint]),
            names.join(" or "),
            percent(fit.relative_error),
            first.advice(),
        ));
    }
    if let Some(joint) = impossible(&own, estimated) {
        return refused(format!(
            "no {} can have made this recording: without negative inertias or friction that drives, the best parameters \
             leave {} of the torque of joint {} unexplained. It is a recording of another robot, or the sign, order, unit \
             or offset of a column is wrong",
            robot.name,
            percent(own.per_equation[joint]),
            joint + 1
        ));
    }
    Ok((own.strain > STRAINED).then(|| strained(&own, estimated)))
}

/// The joint of which physics takes most away, where that is more than a quarter of its squared torque and leaves less
/// than half of it explained.
fn impossible(own: &PhysicalFit, free: &Estimate) -> Option<usize> {
    let taken = |j: usize| own.per_equation[j].powi(2) - free.per_equation[j].powi(2);
    let joint = largest(own.per_equation.len(), taken)?;
    (own.per_equation[joint] > HALF && taken(joint) > 0.25).then_some(joint)
}

/// The joint with the largest value.
fn largest(joints: usize, value: impl Fn(usize) -> f64) -> Option<usize> {
    (0..joints).max_by(|&a, &b| value(a).total_cmp(&value(b)))
}

fn strained(own: &PhysicalFit, free: &Estimate) -> String {
    format!(
        "some parameters are none that a robot can have (a negative inertia, friction that drives): the best possible \
         ones leave {} of the torques unexplained, these {}. A filtered or delayed torque signal does that; so do a \
         wrong table, sign, order, unit or offset",
        percent(own.relative_error),
        percent(free.relative_error)
    )
}

fn kinds(robot: &Robot) -> Vec<JointKind> {
    robot.frames.iter().map(|f| f.kind).filter(|k| *k != JointKind::Fixed).collect()
}

fn other_robots(robot: &Robot) -> Vec<Instead> {
    let alike = |other: &&&'static dyn Model| {
        other.robot().name != robot.name && kinds(other.robot()) == kinds(robot)
    };
    models::all().iter().filter(alike).map(|m| Instead::Robot(m.robot().name.as_ref())).collect()
}

/// What may have been mistaken about the joints that are explained poorly.
fn mistakes(robot: &Robot, own: &PhysicalFit) -> Vec<Instead> {
    let kinds = kinds(robot);
    let n = kinds.len();
    let poor: Vec<bool> = own.per_equation.iter().map(|&e| e > POOR).collect();
    let mut all = Vec::new();
    for joint in (0..n).filter(|&j| poor[j]) {
        all.extend([Signal::Position, Signal::Torque].map(|of| Instead::Sign { of, joint }));
        if kinds[joint] == JointKind::Revolute {
            all.extend([(0.5, 90), (-0.5, -90), (1.0, 180)].map(|(turns, degrees)| Instead::Offset {
                joint,
                by: turns * PI,
                degrees,
            }));
        }
    }
    for a in 0..n {
        for b in a + 1..n {
            if (poor[a] || poor[b]) && kinds[a] == kinds[b] {
                let joints = [a, b];
                all.extend(
                    [Signal::Both, Signal::Torque, Signal::Position]
                        .map(|of| Instead::Exchange { of, joints }),
                );
            }
        }
    }
    all.push(Instead::Unit { factor: PI / 180.0, words: "angles in degrees" });
    all.push(Instead::Unit { factor: 180.0 / PI, words: "angles in radians" });
    all
}

/// What explains the recording far better than what was declared: the best, and other robots that are as good.
fn better(recorded: &Recorded, candidates: Vec<Instead>, own: &PhysicalFit) -> Vec<(Instead, PhysicalFit)> {
    let mut all: Vec<(f64, Instead, PhysicalFit)> = candidates
        .into_iter()
        .filter_map(|candidate| {
            let fit = candidate.fit(recorded)?;
            let better = ratio(&own.per_equation, &fit.per_equation);
            (better >= FAR_BETTER).then_some((better, candidate, fit))
        })
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = all.first().map_or(0.0, |first| first.0);
    let robot = |instead: &Instead| matches!(instead, Instead::Robot(_));
    let first_is_robot = all.first().is_some_and(|(_, instead, _)| robot(instead));
    all.into_iter()
        .enumerate()
        .filter(|(place, (better, instead, _))| {
            *place == 0 || first_is_robot && robot(instead) && *better > AS_GOOD * best
        })
        .map(|(_, (_, instead, fit))| (instead, fit))
        .collect()
}

/// Geometric mean of the joints' errors over those of another fit.
fn ratio(own: &[f64], other: &[f64]) -> f64 {
    let pairs: Vec<f64> =
        own.iter().zip(other).filter(|(a, b)| **a > 0.0 && **b > 0.0).map(|(a, b)| (a / b).ln()).collect();
    (pairs.iter().sum::<f64>() / pairs.len().max(1) as f64).exp()
}

impl Instead {
    /// How well it explains the recording. `None` where it cannot be told.
    fn fit(&self, recorded: &Recorded) -> Option<PhysicalFit> {
        let own = recorded.dynamics.model();
        let model = match self {
            Instead::Robot(name) => models::find(name)?,
            _ => own,
        };
        let (gear, other) = (&own.robot().drive, &model.robot().drive);
        let kinds = kinds(own.robot());
        let motor = recorded.side == Side::Motor;
        let changed = |motion: &Motion| match self {
            Instead::Robot(_) if motor => regear(motion, gear, other),
            // Columns of motors were mixed up before the gear brought them to the joints.
            Instead::Sign { .. } | Instead::Exchange { .. } if motor => {
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
        let motions = recorded.motions.iter().map(changed).collect::<Option<Vec<Motion>>>()?;
        let observation = observe(model, &motions, Equations::Torque, None, &recorded.settings, None).ok()?;
        let settings = EstimateSettings { r_sigma: None, block_sigmas: false, ..EstimateSettings::default() };
        physical_fit(model.robot(), &observation, &estimate(&observation, &settings))
    }

    fn change(&self, motion: &mut Motion, kinds: &[JointKind]) {
        let Motion { q, dq, ddq, torque, .. } = motion;
        let positions = [q, dq, ddq];
        match *self {
            Instead::Robot(_) => {}
            Instead::Sign { of: Signal::Torque, joint } => scale(&mut torque[joint], -1.0),
            Instead::Sign { joint, .. } => positions.into_iter().for_each(|p| scale(&mut p[joint], -1.0)),
            Instead::Exchange { of, joints: [a, b] } => {
                if of != Signal::Torque {
                    positions.into_iter().for_each(|p| p.swap(a, b));
                }
                if of != Signal::Position {
                    torque.swap(a, b);
                }
            }
            Instead::Unit { factor, .. } => {
                for positions in positions {
                    let revolute =
                        positions.iter_mut().zip(kinds).filter(|(_, k)| **k == JointKind::Revolute);
                    revolute.for_each(|(p, _)| scale(p, factor));
                }
            }
            Instead::Offset { joint, by, .. } => {
                let [q, ..] = positions;
                q[joint].iter_mut().for_each(|x| *x += by);
            }
        }
    }

    fn advice(&self) -> &'static str {
        match self {
            Instead::Robot(_) => {
                "Name that robot; if the robot is right, look for a wrong sign, order of columns, unit or offset"
            }
            Instead::Sign { .. } => "Change it with a negative `gain`, or in the robot's `drive: gear`",
            Instead::Exchange { .. } => "Check the order of `columns`",
            Instead::Unit { .. } => "Check `unit`",
            Instead::Offset { .. } => "Check `offset`, and theta in the robot's table",
        }
    }
}

impl fmt::Display for Instead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |of: Signal| match of {
            Signal::Position => "position",
            Signal::Torque => "torque",
            Signal::Both => "position and torque",
        };
        match self {
            Instead::Robot(robot) => f.write_str(robot),
            Instead::Sign { of, joint } => {
                write!(f, "the opposite sign of the {} of joint {}", name(*of), joint + 1)
            }
            Instead::Exchange { of, joints: [a, b] } => {
                write!(f, "exchanging {} of joints {} and {}", name(*of), a + 1, b + 1)
            }
            Instead::Unit { words, .. } => write!(f, "reading {words}"),
            Instead::Offset { joint, degrees, .. } => {
                write!(f, "an offset of {degrees} degrees on the position of joint {}", joint + 1)
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
