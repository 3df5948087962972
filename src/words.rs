//! Robots' joints in words.

use dynid_runtime::model::{JointIndex, Robot};

/// The number that a joint (counted from 0) has in the table.
pub fn joint_number(robot: &Robot, joint: usize) -> String {
    robot.joint_number(JointIndex(joint)).to_string()
}

/// `joints 2 and 3`, `the whole robot`; the joints by their numbers.
pub fn joint_words(joints: &[usize]) -> String {
    match joints {
        [] => "the whole robot".to_owned(),
        [one] => format!("joint {one}"),
        [first @ .., last] => {
            let first: Vec<String> = first.iter().map(ToString::to_string).collect();
            format!("joints {} and {last}", first.join(", "))
        }
    }
}
