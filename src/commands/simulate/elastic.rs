//! The option `--elastic JOINT:STIFFNESS[:DAMPING[:PLAY]]`.

use dynid_runtime::model::{JointIndex, JointNumber, Robot};
use dynid_runtime::simulation::ElasticJoint;

use crate::failure::Failure;
use crate::ranges;
use crate::words::joint_number;

/// Reads a number within its range.
type Parser = fn(&str) -> Result<f64, String>;

/// The elastic joint of a robot that a value of the option is for.
pub(super) fn elastic_joint(robot: &Robot, text: &str) -> Result<ElasticJoint, Failure> {
    let wrong = || Failure::Input(format!("--elastic {text}: expected JOINT:STIFFNESS[:DAMPING[:PLAY]]"));
    let mut fields = text.split(':');
    let number: usize = fields.next().and_then(|x| x.parse().ok()).ok_or_else(wrong)?;
    let JointIndex(joint) = robot.joint_index(JointNumber(number)).ok_or_else(|| {
        let known: Vec<String> = (0..robot.joints()).map(|j| joint_number(robot, j)).collect();
        Failure::Input(format!(
            "--elastic {text}: the joints of {} are {}, not {number}",
            robot.name,
            known.join(", ")
        ))
    })?;
    let mut elastic = ElasticJoint { joint, stiffness: 0.0, damping: 0.0, play: 0.0 };
    let numbers: Vec<&str> = fields.collect();
    if numbers.is_empty() || numbers.len() > 3 {
        return Err(wrong());
    }
    let parts: [(&str, Parser, &mut f64); 3] = [
        ("stiffness", ranges::stiffness, &mut elastic.stiffness),
        ("damping", ranges::damping, &mut elastic.damping),
        ("play", ranges::play, &mut elastic.play),
    ];
    for (number, (name, parser, value)) in numbers.into_iter().zip(parts) {
        *value = parser(number)
            .map_err(|why| Failure::Input(format!("--elastic {text}: {name} {number}: {why}")))?;
    }
    Ok(elastic)
}
