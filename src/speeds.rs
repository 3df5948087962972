//! Columns of speeds that contradict the positions, in words.

use dynid_runtime::model::Robot;
use dynid_runtime::report::significant;
use dynid_runtime::signal::SpeedFault;

use crate::failure::Failure;
use crate::words::joint_number;

/// Factors that have a name: of what is written to what is meant. A factor within a fiftieth of one is that.
const KNOWN: [(f64, &str); 6] = [
    (180.0 / std::f64::consts::PI, "degrees where radians are declared"),
    (std::f64::consts::PI / 180.0, "radians where degrees are declared"),
    (30.0 / std::f64::consts::PI, "revolutions a minute where rad/s are declared"),
    (std::f64::consts::PI / 30.0, "rad/s where revolutions a minute are declared"),
    (1000.0, "millimetres or milliseconds"),
    (1e-3, "millimetres or milliseconds"),
];

/// A sentence for each of them: which joint, what its column is, and what to do.
pub fn speed_words(faults: &[SpeedFault], robot: &Robot) -> Vec<String> {
    let (n, first) = (robot.joints(), faults.first());
    // One factor on all joints may also be that of the times.
    let all = faults.len() == n
        && n > 1
        && first.is_some_and(|f| {
            let alike = |g: &SpeedFault| g.of == g.joint && (g.factor / f.factor - 1.0).abs() < 0.02;
            f.factor > 0.0 && faults.iter().all(alike)
        });
    let also = if all { ", or the unit or rate of time: where positions are right" } else { "" };
    faults.iter().map(|fault| one(fault, robot, also)).collect()
}

/// A refusal, and what is wrong with the speeds: the one may be the cause of the other.
pub fn and_of_speeds(failure: Failure, speeds: &[String]) -> Failure {
    match failure {
        Failure::Data(words) if !speeds.is_empty() => {
            Failure::Data(format!("{}. Besides, {}", words.trim_end_matches('.'), speeds.join("; ")))
        }
        other => other,
    }
}

fn one(fault: &SpeedFault, robot: &Robot, also: &str) -> String {
    let joint = joint_number(robot, fault.joint);
    let late = if fault.late == 0.0 {
        String::new()
    } else {
        let side = if fault.late > 0.0 { "late" } else { "early" };
        format!(", {} s {side}", significant(fault.late.abs(), 2))
    };
    let factor = significant(fault.factor, 3);
    let (what, mend) = if fault.of != fault.joint {
        let of = joint_number(robot, fault.of);
        (format!("it is that of joint {of}, times {factor}{late}"), "the order of the columns")
    } else if (fault.factor - 1.0).abs() <= 0.05 {
        (format!("it is the derivative of the position{late}"), "the times of the columns")
    } else if (fault.factor + 1.0).abs() <= 0.05 {
        (format!("it has the other sign{late}"), "the sign of one of the two")
    } else {
        let known = KNOWN.iter().find(|(k, _)| (fault.factor.abs() / k - 1.0).abs() < 0.02);
        let named = known.map_or_else(String::new, |(_, name)| format!(" ({name})"));
        (
            format!("it is {factor} times the derivative of the position{named}{late}"),
            "the unit of one of the two",
        )
    };
    format!(
        "the speed of joint {joint} contradicts its position: {what}. The positions are used and the speeds are not; \
         correct {mend} in the recording{also}"
    )
}
