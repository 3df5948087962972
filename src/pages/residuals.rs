//! What models leave of the torques of each joint, over the variable that the reader chooses.

use dynid_runtime::prediction::{JointRows, StateRows, binned_means};
use dynid_runtime::report::{Page, Plot, Role, SeriesKind, capital};

use crate::compared::Compared;

/// Means over so many bins are drawn through the residuals.
const BINS: usize = 40;

/// Something that a residual may depend on: its name and unit, and its value at a row.
type Variable = (String, fn(&JointRows, &StateRows, usize) -> f64);

/// A picture for each joint, all motions in one. `models` of the comparison are one, or before and after.
pub(super) fn residuals(page: &mut Page, compared: Compared<'_>) {
    for joint in 0..compared.robot.joints() {
        page.plot(&plot(compared, joint));
    }
    page.note(
        "Every row that counts, all motions in one picture, and its mean over bins of equally many. The load is the torque \
         of inertia and gravity by the model.",
    );
}

fn variables(compared: Compared<'_>, joint: usize) -> [Variable; 5] {
    let kind = compared.kind(joint);
    [
        (format!("speed, {}", kind.speed_unit()), |_, state, k| state.speed[k]),
        (format!("position, {}", kind.position_unit()), |_, state, k| state.position[k]),
        (format!("acceleration, {}", kind.acceleration_unit()), |_, state, k| state.acceleration[k]),
        (format!("load, {}", kind.torque_unit()), |_, state, k| state.load[k]),
        (Plot::TIME.to_owned(), |rows, _, k| rows.time[k]),
    ]
}

fn plot(compared: Compared<'_>, joint: usize) -> Plot {
    let residual = |model: usize, (_, value): &Variable| -> Vec<(f64, f64)> {
        let of_motion = |(rows, state): (&JointRows, &StateRows)| -> Vec<(f64, f64)> {
            let used = (0..rows.time.len()).filter(|&k| rows.used[k]);
            used.map(|k| (value(rows, state, k), rows.measured[k] - rows.predicted[model][k])).collect()
        };
        compared.of_joint(joint).flat_map(of_motion).collect()
    };
    let models = compared.models.len();
    let over = |variable: &Variable| -> Vec<Vec<(f64, f64)>> {
        let clouds: Vec<Vec<(f64, f64)>> = (0..models).map(|model| residual(model, variable)).collect();
        let means: Vec<Vec<(f64, f64)>> = clouds.iter().map(|cloud| binned_means(cloud, BINS)).collect();
        clouds.into_iter().chain(means).collect()
    };
    let [first, others @ ..] = &variables(compared, joint);
    let title = capital(&compared.joint(joint));
    let mut plot = Plot::new(title, &first.0, format!("residual, {}", compared.kind(joint).torque_unit()));
    for (k, points) in over(first).into_iter().enumerate() {
        let model = k % models;
        let (label, role, mean) = match models {
            1 => ("residual", Role::After, Role::Law),
            _ => [("before", Role::Before, Role::Before), ("after", Role::After, Role::After)][model.min(1)],
        };
        plot = match k < models {
            true => plot.with(label, role, SeriesKind::Points, points),
            false => plot.with(format!("mean {label}"), mean, SeriesKind::Line, points),
        };
    }
    others.iter().fold(plot, |plot, variable| plot.over(&variable.0, over(variable)))
}
