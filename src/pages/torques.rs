//! Torques over time, measured and as one model predicts them.

use dynid_runtime::prediction::JointRows;
use dynid_runtime::report::{Page, Plot, Role, SeriesKind, capital};

use crate::compared::Compared;
use crate::words::joint_number;

/// A picture for each motion and joint: measured, predicted by the last model, and their difference.
pub(super) fn torques(page: &mut Page, compared: Compared<'_>) {
    for rows in &compared.evaluation.rows {
        page.plot(&plot(compared, rows));
    }
}

fn plot(compared: Compared<'_>, rows: &JointRows) -> Plot {
    let predicted = rows.predicted.last().map_or(&[][..], Vec::as_slice);
    let curve = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        let shown = |k: usize| if rows.used[k] { value(k) } else { f64::NAN };
        rows.time.iter().enumerate().take(predicted.len()).map(|(k, &t)| (t, shown(k))).collect()
    };
    let mut title = capital(&compared.joint(rows.joint));
    if compared.evaluation.trajectories.len() > 1 {
        title.push_str(&format!(", {}", compared.evaluation.trajectories[rows.trajectory]));
    }
    Plot::new(title, Plot::TIME, format!("torque, {}", compared.kind(rows.joint).torque_unit()))
        .with("measured", Role::Measured, SeriesKind::Line, curve(&|k| rows.measured[k]))
        .with("predicted", Role::After, SeriesKind::Line, curve(&|k| predicted[k]))
        .with("difference", Role::Law, SeriesKind::Line, curve(&|k| rows.measured[k] - predicted[k]))
}

/// The relative error of the last model joint by joint.
pub(super) fn per_joint(compared: Compared<'_>) -> Vec<Vec<String>> {
    let errors = compared.evaluation.predictions.last().map_or(&[][..], |p| &p.errors.per_joint[..]);
    let row = |(joint, error): (usize, &Option<f64>)| {
        vec![joint_number(compared.robot, joint), dynid_runtime::report::percent(*error)]
    };
    errors.iter().enumerate().map(row).collect()
}
