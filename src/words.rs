//! Joints and confidences in words.

use dynid_runtime::diagnosis::{CannotTell, Diagnosis, OnTest, Small, Standing, Transient};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::{Frame, JointIndex, Robot};
use dynid_runtime::report::significant;

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

/// What an effect is called, in the middle of a sentence.
pub fn effect_words(id: &str) -> String {
    EffectKind::name_of(id).to_owned()
}

/// Effects that cannot be told apart, each on its joints where these differ: `stribeck on joint 1`.
pub fn apart_words(cannot_tell: &CannotTell, between: &str) -> String {
    let sides = cannot_tell.sides().into_iter().zip(&cannot_tell.between);
    let mut sides: Vec<String> =
        sides.map(|(side, id)| side.replacen(id.as_str(), &effect_words(id), 1)).collect();
    if cannot_tell.on.is_empty() {
        return format!("{} on {}", sides.join(between), joint_words(&cannot_tell.joints));
    }
    for (side, joints) in sides.iter_mut().zip(&cannot_tell.on) {
        side.push_str(&format!(" on {}", joint_words(joints)));
    }
    sides.join(between)
}

/// An effect that is there and too small to be named.
pub fn small_words(small: &Small) -> String {
    format!(
        "{} on {} ({} {} of the torque; from {} {} on it would be named)",
        effect_words(&small.effect),
        joint_words(&small.joints),
        significant(small.torque, 2),
        small.unit,
        significant(small.least, 2),
        small.unit
    )
}

/// What was there at the beginning of the motion only, and is part of the model without being named.
pub fn transient_words(transient: &Transient) -> String {
    format!(
        "{} on {}, which has faded after {} s (part of the model, so that parameters and laws are those of the motion after it)",
        effect_words(&transient.effect),
        joint_words(&transient.joints),
        significant(transient.faded_after, 2)
    )
}

/// The laws that a reference has already, in one line.
pub fn standing_words(diagnosis: &Diagnosis) -> String {
    let one = |s: &Standing| format!("{} on {}", effect_words(&s.effect), joint_words(&s.joints));
    diagnosis.standing.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// The confidence in words.
pub fn confidence_words(confidence: f64) -> String {
    format!("confidence {}", significant(confidence, 2))
}

/// Angles of the table that are hardly meant in rad.
pub fn table_doubts(robot: &Robot) -> Vec<String> {
    let turns = |angle: f64| angle.abs() > std::f64::consts::TAU;
    let of_frame = |(k, frame): (usize, &Frame)| {
        let angles = [("alpha", frame.alpha), ("gamma", frame.gamma), ("theta", frame.theta)];
        let wrong: Vec<String> = angles
            .into_iter()
            .filter(|(_, angle)| turns(*angle))
            .map(|(name, angle)| {
                format!(
                    "frame {}: {name} is {} rad, more than a turn. Are degrees meant? Write {}*pi/180",
                    k + 1,
                    significant(angle, 4),
                    significant(angle, 4)
                )
            })
            .collect();
        wrong
    };
    robot.frames.iter().enumerate().flat_map(of_frame).collect()
}

/// How much of a law a test recording shows, as the end of `on the test recording ..`.
pub fn part_words(on_test: &OnTest) -> String {
    match on_test.sigma {
        Some(sigma) => format!("{:.2} ± {sigma:.2} of it is there", on_test.part),
        None => format!("{:.2} of it is there", on_test.part),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apart(between: [&str; 2], on: &[&[usize]]) -> CannotTell {
        CannotTell {
            between: between.map(String::from).to_vec(),
            joints: vec![5, 6],
            on: on.iter().map(|joints| joints.to_vec()).collect(),
            experiment: String::new(),
            variables: Vec::new(),
        }
    }

    #[test]
    fn laws_of_different_joints_are_told_with_their_own() {
        let same = apart(["stribeck", "backlash"], &[]);
        assert_eq!(apart_words(&same, " and "), "Stribeck friction and backlash on joints 5 and 6");
        let differ = apart(["torque_constant_drift"; 2], &[&[5], &[]]);
        assert_eq!(
            apart_words(&differ, " or "),
            "torque constant drift on joint 5 or torque constant drift on the whole robot"
        );
    }
}
