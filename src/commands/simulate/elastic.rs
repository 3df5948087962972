//! The option `--elastic JOINT:STIFFNESS[:DAMPING[:PLAY]]`.

use dynid_runtime::model::{JointIndex, JointNumber, Robot};
use dynid_runtime::simulation::ElasticJoint;

use crate::failure::Failure;
use crate::words::joint_number;

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
    let numbers: Vec<f64> = fields.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    match numbers[..] {
        [stiffness] => Ok(ElasticJoint { joint, stiffness, damping: 0.0, play: 0.0 }),
        [stiffness, damping] => Ok(ElasticJoint { joint, stiffness, damping, play: 0.0 }),
        [stiffness, damping, play] => Ok(ElasticJoint { joint, stiffness, damping, play }),
        _ => Err(wrong()),
    }
}
