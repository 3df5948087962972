//! The recording by forward simulation on the page of a diagnosis.

use dynid_runtime::diagnosis::Diagnosis;
use dynid_runtime::report::{Page, Plot, Role, SeriesKind, change_of_error, percent, significant};

use super::extras::Extras;
use crate::words::joint_number;
use dynid_runtime::simulation::replay::ClosedLoop;

/// Recorded and simulated torques.
pub(super) fn forward(
    page: &mut Page,
    diagnosis: &Diagnosis,
    extras: &Extras,
    run: &Result<ClosedLoop, String>,
) {
    page.heading("The same by forward simulation");
    let run = match run {
        Ok(run) => run,
        Err(reason) => {
            page.paragraph(&format!("Not done: {reason}."));
            return;
        }
    };
    page.paragraph(&format!(
        "The identified robot follows the recorded motion ({} s) in closed loop, once without and once with the \
         findings. The error of its torques against the recorded ones {}.",
        significant(run.duration, 3),
        change_of_error(run.before, run.after)
    ));
    if !run.left_out.is_empty() {
        page.paragraph(&format!("Not part of the simulation: {}.", run.left_out.join(", ")));
    }
    first_motion(page, diagnosis, extras, run);
    let rows: Vec<Vec<String>> = (0..run.per_joint_before.len())
        .map(|j| {
            vec![
                extras.joint(j),
                percent(run.per_joint_before[j]),
                percent(run.per_joint_after[j]),
                significant(1e3 * run.tracking_before[j], 2),
                significant(1e3 * run.tracking_after[j], 2),
            ]
        })
        .collect();
    let header = ["", "torque error, without", "with", "off the motion, mrad or mm, without", "with"];
    page.table(&header, &rows);
}

/// What is left of the torque of a joint with findings, in the first motion.
fn first_motion(page: &mut Page, diagnosis: &Diagnosis, extras: &Extras, run: &ClosedLoop) {
    let found = diagnosis.findings.iter().flat_map(|f| f.joints.iter().copied());
    let mut numbers = found.chain(diagnosis.mismatch.iter().map(|m| m.joint)).map(|j| j.to_string());
    let left = |recorded: &[f64], simulated: &[f64]| -> Vec<(f64, f64)> {
        let rest = recorded.iter().zip(simulated).map(|(y, m)| y - m);
        run.first.time.iter().copied().zip(rest).collect()
    };
    let first = &run.first;
    let place =
        |number: String| (0..extras.robot.joints()).find(|&j| joint_number(&extras.robot, j) == number);
    if let Some(j) = numbers.find_map(place).filter(|&j| j < first.recorded.len()) {
        page.plot(
            &Plot::new(
                format!("{}: recorded less simulated torque, first motion", extras.joint(j)),
                Plot::TIME,
                format!("residual, {}", extras.robot.joint_kinds()[j].torque_unit()),
            )
            .with(
                "without the findings",
                Role::Before,
                SeriesKind::Line,
                left(&first.recorded[j], &first.before[j]),
            )
            .with(
                "with them",
                Role::After,
                SeriesKind::Line,
                left(&first.recorded[j], &first.after[j]),
            ),
        );
    }
}
