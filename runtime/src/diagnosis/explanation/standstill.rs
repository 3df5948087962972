//! What is said of a recording in which the robot holds still, and of joints that hold still in any.

use crate::diagnosis::contact::standing::AtRest;
use crate::diagnosis::explanation::finding::of_contacts;
use crate::diagnosis::explanation::words;
use crate::diagnosis::outcome::*;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::motion::Moving;
use crate::diagnosis::rules::LEAST_ROWS;
use crate::model::{JointIndex, Model, Robot};

/// The outcome for a recording in which no joint moves, beside a baseline in which they do, or a reference.
/// `None` where the robot does not stand for long enough either, or no joint's friction is known.
pub(in crate::diagnosis) fn explain(
    context: &Context<'_>,
    rest: &AtRest,
    chi_sigma: &[f64],
    sampling: Sampling,
) -> Option<Diagnosis> {
    let robot = context.model.robot();
    let before_it = if context.reference.is_some() { "reference" } else { "baseline" };
    let known: Vec<usize> = (0..rest.coulomb.len()).filter(|&j| rest.coulomb[j].is_some()).collect();
    if rest.time == 0.0 || known.is_empty() {
        return None;
    }
    let contacts = rest.contacts(context.signals.len());
    let findings: Vec<Finding> = contacts.iter().map(|c| of_contacts(robot, c)).collect();
    let before = Errors::of_squares(&rest.by_joint[0], &rest.by_joint[2]);
    let after = Errors::of_squares(&rest.by_joint[1], &rest.by_joint[2]);
    let estimated = Estimated { chi: context.chi.clone(), sigma: chi_sigma.to_vec() };
    let all: f64 = rest.by_joint[0].iter().sum();
    let mismatch = known
        .iter()
        .map(|&j| Mismatch {
            joint: joint_number(robot, j),
            share: if all > 0.0 { rest.by_joint[0][j] / all } else { 0.0 },
            where_: "while the robot holds still".into(),
        })
        .collect();
    let mut diagnosis = Diagnosis {
        robot: robot.name.to_string(),
        before: before.clone(),
        after: after.clone(),
        held_out: HeldOut {
            how: format!(
                "gravity and static friction, as the {before_it} has them, while the robot holds still"
            ),
            band: sampling.band,
            before: before.relative_error.unwrap_or_default(),
            after: after.relative_error.unwrap_or_default(),
            per_joint_before: before.per_joint,
            per_joint_after: after.per_joint,
            by_motion: Vec::new(),
        },
        mismatch,
        small: Vec::new(),
        transients: Vec::new(),
        cannot_tell: loads(robot, rest),
        unexplained: Unexplained { per_joint: vec![0.0; robot.joints()], ..Unexplained::default() },
        verdict: Vec::new(),
        shifts: Vec::new(),
        standard: estimated.clone(),
        model: estimated,
        delay: 0.0,
        delay_sigma: 0.0,
        spectra: Vec::new(),
        series: Vec::new(),
        rows: 0,
        tried: 0,
        sampling,
        search: SearchOutcome { stop: StopReason::NoneAccepted, removed: Vec::new() },
        not_judged: Vec::new(),
        refuted: Vec::new(),
        standing: Vec::new(),
        covariance: None,
        between_motions: Vec::new(),
        findings,
    };
    diagnosis.verdict = verdict(robot, rest, &diagnosis);
    Some(diagnosis)
}

/// A torque that is off for as long as the robot stands may come from any of these.
fn loads(robot: &Robot, rest: &AtRest) -> Vec<CannotTell> {
    let mut joints: Vec<usize> = rest.loads.iter().map(|(_, l)| joint_number(robot, l.joint)).collect();
    joints.sort_unstable();
    joints.dedup();
    if joints.is_empty() {
        return Vec::new();
    }
    vec![CannotTell {
        between: ["payload", "added_mass", "spring", "base_tilt", "contact"].map(String::from).to_vec(),
        joints,
        on: Vec::new(),
        experiment: "move each joint slowly back and forth through several poses, so that friction and gravity can be told apart"
            .into(),
        variables: Vec::new(),
    }]
}

fn verdict(robot: &Robot, rest: &AtRest, diagnosis: &Diagnosis) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(contact) = diagnosis.findings.first() {
        lines.push(contact.sentence.clone());
    }
    if let Some((_, most)) = rest.loads.iter().max_by(|a, b| a.1.torque.abs().total_cmp(&b.1.torque.abs())) {
        lines.push(format!(
            "Joint {} holds {:.3} more than gravity and static friction explain for as long as the robot stands: its load is another one, but which cannot be told at rest.",
            joint_number(robot, most.joint),
            most.torque
        ));
    }
    if lines.is_empty() {
        lines.push(
            "The robot holds still, and its torques stay within gravity and static friction: nothing can be found in them."
                .into(),
        );
    }
    lines.push(format!(
        "It stands for {:.1} s: only contacts are looked for, and none that stays within static friction ({}) can be seen.",
        rest.time,
        rest.coulomb
            .iter()
            .enumerate()
            .filter_map(|(j, c)| Some(format!("joint {}: {:.3}", joint_number(robot, j), (*c)?)))
            .collect::<Vec<_>>()
            .join(", ")
    ));
    lines
}

/// Number j of a joint.
fn joint_number(robot: &Robot, joint: usize) -> usize {
    robot.joint_number(JointIndex(joint)).0
}

/// Names the joints on which no law was looked for.
pub(in crate::diagnosis) fn name_not_judged(diagnosis: &mut Diagnosis, model: &dyn Model, moving: &Moving) {
    diagnosis.not_judged = moving
        .not_judged()
        .into_iter()
        .map(|j| NotJudged {
            joint: joint_number(model.robot(), j),
            rows: moving.rows[j],
            why: format!("it has to move: {} usable rows, {LEAST_ROWS} are needed", moving.rows[j]),
        })
        .collect();
    // Where nothing moves, the verdict is about that already.
    if diagnosis.not_judged.len() < model.robot().joints() {
        diagnosis.verdict.extend(words::not_judged(&diagnosis.not_judged));
    }
}
