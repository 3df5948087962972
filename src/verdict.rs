//! Whether a recording can be one of its robot, in words.

use std::path::Path;

use dynid_runtime::estimation::Estimate;
use dynid_runtime::estimation::observe::Observation;
use dynid_runtime::model::{JointIndex, Robot};
use dynid_runtime::plausibility::{
    AngleUnit, ChannelFault, Instead, Judged, Signal, Verdict, faulty_channel, judge,
};
use dynid_runtime::report::{percent, significant};

use crate::failure::Failure;
use crate::models;
use crate::words::table_doubts;

/// What a person does who wants an answer all the same.
const ALL_THE_SAME: &str = "(--implausible goes on all the same)";

/// Checks that the recording can be one of its robot; warnings for the person, if there are any to give.
///
/// # Errors
/// [`Failure::Data`] where something else explains the recording far better, or where physics takes away what the
/// free fit explains of a joint.
pub fn check(
    path: &Path,
    judged: &Judged<'_>,
    torques: &Observation,
    estimated: &Estimate,
) -> Result<Vec<String>, Failure> {
    let robot = judged.model.robot();
    check_channels(path, judged, |_| true)?;
    let mut warnings = table_doubts(robot);
    let verdict = judge(judged, torques, estimated, models::all());
    if let Some(words) = better_words(robot, &verdict) {
        return Err(refused(path, robot, &words));
    }
    match verdict {
        Verdict::Impossible { joint, error } => {
            let words = format!(
                "no {} can have made this recording: without negative inertias or friction that drives, the best parameters \
             leave {} of the torque of joint {} unexplained. It is a recording of another robot, the sign, order, unit or \
             offset of a column is wrong, or a spring, a balancer or a cable that the table has not moves the joint: \
             `dynid diagnose` looks for these",
                robot.name,
                percent(error),
                robot.joint_number(joint)
            );
            Err(refused(path, robot, &words))
        }
        Verdict::OverPosition { joints } => {
            warnings.extend(joints.iter().map(|&(joint, [before, after])| {
                format!(
                    "the torque of joint {} depends on its position as that of no rigid robot does (a spring, a balancer, a \
                     cable): the best parameters that a robot can have leave {} of it unexplained, with such a torque {}. \
                     It is not in this model, and its parameters are off by what they make of it: `dynid diagnose` adds it",
                    robot.joint_number(joint),
                    percent(before),
                    percent(after)
                )
            }));
            Ok(warnings)
        }
        Verdict::Strained { possible, free } => {
            warnings.push(format!(
            "some parameters are none that a robot can have (a negative inertia, friction that drives): the best possible \
             ones leave {} of the torques unexplained, these {}. A filtered or delayed torque signal does that; so do a \
             wrong table, sign, order, unit or offset",
            percent(possible),
            percent(free)
        ));
            Ok(warnings)
        }
        _ => Ok(warnings),
    }
}

/// Checks that a recording has no mistake that explains it far better than its description. What the diagnosis looks for
/// itself, a position that is off, a base that is tilted or a wrong rate, is none.
///
/// # Errors
/// [`Failure::Data`] with the mistake.
pub fn check_mistakes(
    path: &Path,
    judged: &Judged<'_>,
    torques: &Observation,
    estimated: &Estimate,
) -> Result<(), Failure> {
    let robot = judged.model.robot();
    let of_time =
        |fault: &ChannelFault| matches!(fault, ChannelFault::Slow { .. } | ChannelFault::TooFast { .. });
    check_channels(path, judged, |fault| !of_time(fault))?;
    let verdict = judge(judged, torques, estimated, models::all());
    if let Verdict::Better { instead, .. } = &verdict
        && let Some((Instead::Offset { .. } | Instead::Zeros(_) | Instead::Tilt(_), _)) = instead.first()
    {
        return Ok(());
    }
    better_words(robot, &verdict).map_or(Ok(()), |words| Err(refused(path, robot, &words)))
}

fn check_channels(
    path: &Path,
    judged: &Judged<'_>,
    counts: impl Fn(&ChannelFault) -> bool,
) -> Result<(), Failure> {
    let robot = judged.model.robot();
    match faulty_channel(robot, judged.motions).filter(counts) {
        Some(fault) => {
            Err(Failure::Data(format!("{}: {}. {ALL_THE_SAME}", path.display(), fault_words(&fault, robot))))
        }
        None => Ok(()),
    }
}

fn refused(path: &Path, robot: &Robot, words: &str) -> Failure {
    let words = words.trim_end_matches('.');
    let doubts: String = table_doubts(robot)
        .iter()
        .map(|doubt| format!(". In the table of {}, {doubt}", robot.name))
        .collect();
    Failure::Data(format!("{}: {words}{doubts}. {ALL_THE_SAME}", path.display()))
}

/// What would explain the recording far better, where something would.
fn better_words(robot: &Robot, verdict: &Verdict) -> Option<String> {
    let Verdict::Better { own, worst: (joint, error), instead } = verdict else { return None };
    let (first, best) = instead.first()?;
    let names: Vec<String> = instead.iter().map(|(what, _)| words(what, robot)).collect();
    Some(format!(
        "this cannot be a recording of {} as it is described: the best parameters that such a robot can have leave {} of \
         the torques unexplained (joint {}: {}); {} leaves {}. {}",
        robot.name,
        percent(*own),
        robot.joint_number(*joint),
        percent(*error),
        names.join(" or "),
        percent(*best),
        advice(first),
    ))
}

/// What is wrong with a channel, and what to look at.
fn fault_words(fault: &ChannelFault, robot: &Robot) -> String {
    let number = |joint: JointIndex| robot.joint_number(joint);
    let same = |what: &str, [a, b]: [JointIndex; 2]| {
        let (a, b) = (number(a), number(b));
        format!(
            "joints {a} and {b} have the same {what} in every row: one column is given twice. Look at `columns`"
        )
    };
    match fault {
        ChannelFault::ConstantTorque { joint, value } => format!(
            "the torque of joint {} is {} in every row while the joint moves: the channel is not connected, or `columns` \
             names another one",
            number(*joint),
            significant(*value, 4)
        ),
        ChannelFault::SameTorque { joints } => same("torque", *joints),
        ChannelFault::SamePosition { joints } => same("position", *joints),
        ChannelFault::Slow { step } => format!(
            "its rows are {} s apart, which no motion of a robot is seen at. Are the times in ms? Look at `time: unit`",
            significant(*step, 3)
        ),
        ChannelFault::TooFast { joint, speed, limit } => format!(
            "joint {} is faster than {} for half of the time, and its limit is {} (rad/s or m/s): the unit of the angles or \
             of the times is another one",
            number(*joint),
            significant(*speed, 3),
            significant(*limit, 3)
        ),
        ChannelFault::TooStrong { joint, torque, limit } => format!(
            "the torque of joint {} is above {} for half of the time, and its limit is {} (N.m or N): its unit, its gain or \
             the side of the gear is another one",
            number(*joint),
            significant(*torque, 3),
            significant(*limit, 3)
        ),
        _ => "a channel cannot be right".to_owned(),
    }
}

fn advice(instead: &Instead) -> &'static str {
    match instead {
        Instead::Robot(_) => {
            "Name that robot; if the robot is right, look for a wrong sign, order of columns, unit or offset"
        }
        Instead::Sign { .. } => "Change it with a negative `gain`, or in the robot's `drive: gear`",
        Instead::Scale { .. } => {
            "All torques of a recording are read in one `unit`: bring the column to it with its `gain`"
        }
        Instead::Gravity(_) | Instead::Tilt(_) => {
            "Check `gravity` in the robot's table, and how its base was mounted"
        }
        Instead::TableAngles => "Write them in rad, as 90*pi/180",
        Instead::Exchange { .. } => "Check the order of `columns`",
        Instead::Unit(_) => "Check `unit`",
        Instead::Offset { .. } | Instead::Zeros(_) => "Check `offset`, and theta in the robot's table",
        _ => "Check the recording's YAML",
    }
}

fn words(instead: &Instead, robot: &Robot) -> String {
    let name = |of: Signal| match of {
        Signal::Position => "position",
        Signal::Torque => "torque",
        Signal::Both => "position and torque",
    };
    let number = |joint: JointIndex| robot.joint_number(joint);
    match instead {
        Instead::Robot(robot) => robot.clone(),
        Instead::Sign { of, joint } => {
            format!("the opposite sign of the {} of joint {}", name(*of), number(*joint))
        }
        Instead::Exchange { of, joints: [a, b] } => {
            format!("exchanging {} of joints {} and {}", name(*of), number(*a), number(*b))
        }
        Instead::Scale { joint, factor } if *factor > 1.0 => {
            format!("the torque of joint {} times 1000 (kN.m read as N.m, or N.m as mN.m)", number(*joint))
        }
        Instead::Scale { joint, .. } => {
            format!(
                "a thousandth of the torque of joint {} (mN.m read as N.m, or N.m as kN.m)",
                number(*joint)
            )
        }
        Instead::Gravity(g) => {
            let axis = (0..3).max_by(|&a, &b| g[a].abs().total_cmp(&g[b].abs())).unwrap_or(2);
            let sign = if g[axis] < 0.0 { "-" } else { "+" };
            format!("gravity along {sign}{} of frame 0", ["x", "y", "z"][axis])
        }
        Instead::Tilt(g) => {
            let [x, y, z] = g.map(|g| significant(g, 3));
            let along: f64 = g.iter().zip(&robot.gravity).map(|(a, b)| a * b).sum();
            let squares: f64 = robot.gravity.iter().map(|g| g * g).sum();
            let tilt = (along / squares).clamp(-1.0, 1.0).acos().to_degrees();
            format!("gravity [{x}, {y}, {z}] m/s2, of a base that is tilted by {tilt:.0} degrees,")
        }
        Instead::TableAngles => "reading the table's angles beyond a turn in degrees".to_owned(),
        Instead::Unit(AngleUnit::Degrees) => "reading angles in degrees".to_owned(),
        Instead::Unit(AngleUnit::Radians) => "reading angles in radians".to_owned(),
        Instead::Zeros(zeros) => {
            let each =
                |(joint, by): &(JointIndex, f64)| format!("joint {} {:+.1}", number(*joint), by.to_degrees());
            let joints: Vec<String> = zeros.iter().map(each).collect();
            let see = if joints.len() == 1 { "its encoder sees it" } else { "their encoders see them" };
            format!("{} degrees beyond where {see}", joints.join(" and "))
        }
        Instead::Offset { joint, degrees } => {
            format!("an offset of {degrees} degrees on the position of joint {}", number(*joint))
        }
        _ => "something else".to_owned(),
    }
}
