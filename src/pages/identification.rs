//! The report of `identify`: the parameters, and the torques measured and predicted.

use dynid_runtime::estimation::observe::{Equations, ObserveError, ObserveSettings, Rows, observe};
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{Identified, NamedParameter};
use dynid_runtime::report::{Page, Plot, Role, SeriesKind, percent, significant};

use crate::recorded::{Recorded, left_out_words};
use crate::words::joint_number;

/// The whole page. Where the recording is too long for its motions to be the whole of it, the torques are those of
/// the first pieces.
///
/// # Errors
/// What the observation refuses.
pub fn page(recorded: &Recorded, whole: bool, identified: &Identified) -> Result<String, ObserveError> {
    let model = recorded.dynamics.model();
    let robot = model.robot();
    let settings = ObserveSettings { keep_rows: true, ..recorded.settings.clone() };
    let observation = observe(model, &recorded.motions, Equations::Torque, None, &settings, None)?;
    let chi = identified.chi(robot).unwrap_or_else(|_| vec![0.0; robot.base.len()]);

    let mut page = Page::new(&format!("{}: {}", robot.name, recorded.title));
    page.verdict(&verdict(robot, identified));
    page.list(left_out_words(&recorded.rows));
    page.list(doubts(identified));
    page.list(&identified.warnings);
    page.heading("Torques, measured and predicted");
    for rows in observation.rows.iter().flatten() {
        let name = &observation.trajectories[rows.trajectory];
        page.plot(&torque_plot(robot, rows, &chi, name, observation.trajectories.len() > 1));
    }
    if !whole {
        page.note(
            "The recording is long: only its beginning is drawn. The parameters are those of all of it.",
        );
    }
    page.note(&format!(
        "Both are seen through the same filter of {} Hz bandwidth. Gaps are rows that were left out.",
        significant(identified.band, 3)
    ));
    page.heading("Base parameters");
    page.table(&["parameter", "value", "sigma", "sigma %", "sigma, white", "<unit"], &parameters(identified));
    page.note(
        "sigma is for errors that last, as the residuals show it, and holds what noise of the encoders may have taken away: \
         value ± 1.96 sigma contains the truth in 95 of 100 recordings. The white one is for errors that are independent from \
         row to row.",
    );
    if let Some(simulated) = &identified.simulated {
        page.subheading(&format!("Beside {}", simulated.compared_with));
        page.table(
            &["parameter", &identified.method, &simulated.compared_with, "difference / sigma"],
            &beside(identified, &simulated.values),
        );
        let worst = simulated.apart.iter().fold(0.0_f64, |m, &a| m.max(a));
        page.note(&format!(
            "The planned motions were simulated; simulated and measured positions are {} apart at most.",
            percent(worst)
        ));
    }
    if let Some(essential) = &identified.essential_parameters {
        page.subheading("Essential parameters");
        page.paragraph(&format!(
            "{} parameters are enough for an error of {}. Cancelled: {}.",
            essential.parameters.len(),
            percent(essential.relative_error),
            essential.cancelled.join(", ")
        ));
    }
    page.details("What is regrouped into each base parameter", |page| {
        page.table(&["parameter", "<relation"], &relations(robot));
    });
    page.details("Rows used and left out", |page| {
        page.table(
            &["trajectory", "joint", "used", "standstill", "fixed", "window", "ends"],
            &rows(identified),
        );
    });
    Ok(page.to_html())
}

fn verdict(robot: &Robot, identified: &Identified) -> String {
    let known = identified.per_joint.iter().enumerate().filter_map(|(joint, error)| Some((joint, (*error)?)));
    let worst = known.max_by(|a, b| a.1.total_cmp(&b.1)).map_or_else(String::new, |(joint, error)| {
        format!(" The worst joint is {} with {}.", joint_number(robot, joint), percent(error))
    });
    format!(
        "{} parameters identified with {}: the torques are reproduced with a relative error of {}.{worst}",
        identified.base_parameters.len(),
        identified.method,
        percent(identified.relative_error)
    )
}

fn torque_plot(robot: &Robot, rows: &Rows, chi: &[f64], trajectory: &str, several: bool) -> Plot {
    let predicted = rows.predict(chi);
    let curve = |values: &[f64]| -> Vec<(f64, f64)> {
        rows.time
            .iter()
            .zip(values)
            .zip(&rows.used)
            .map(|((&t, &v), &used)| (t, if used { v } else { f64::NAN }))
            .collect()
    };
    let mut title = format!("Joint {}", joint_number(robot, rows.equation));
    if several {
        title.push_str(&format!(", {trajectory}"));
    }
    Plot::new(title, "time, s", "torque, N.m or N")
        .with("measured", Role::Measured, SeriesKind::Line, curve(&rows.y))
        .with("predicted", Role::After, SeriesKind::Line, curve(&predicted))
        .with("difference", Role::Law, SeriesKind::Line, curve(&rows.residual(chi)))
}

fn parameters(identified: &Identified) -> Vec<Vec<String>> {
    identified.base_parameters.iter().map(crate::commands::parameter_cells).collect()
}

/// The values beside those that the simulation began with.
fn beside(identified: &Identified, values: &[f64]) -> Vec<Vec<String>> {
    let all = identified.base_parameters.iter().zip(values);
    all.map(|(p, &other)| {
        let sigmas = p.sigma.filter(|s| *s > 0.0).map(|s| significant((p.value - other) / s, 2));
        let mark = if p.doubt.is_some() { " !" } else { "" };
        vec![
            p.name.clone(),
            format!("{}{mark}", significant(p.value, 4)),
            significant(other, 4),
            sigmas.unwrap_or_else(|| "-".to_owned()),
        ]
    })
    .collect()
}

/// What is marked with `!`, in words.
fn doubts(identified: &Identified) -> Vec<String> {
    let told = |p: &NamedParameter| p.doubt.as_ref().map(|doubt| format!("! {} is {doubt}", p.name));
    identified.base_parameters.iter().filter_map(told).collect()
}

fn relations(robot: &Robot) -> Vec<Vec<String>> {
    robot.base.iter().map(|p| vec![p.name.to_string(), p.relation.to_string()]).collect()
}

fn rows(identified: &Identified) -> Vec<Vec<String>> {
    identified
        .equations
        .iter()
        .map(|e| {
            let mut row = vec![e.trajectory.clone()];
            row.extend(
                [e.joint, e.used, e.standstill, e.fixed, e.windows, e.edges].iter().map(ToString::to_string),
            );
            row
        })
        .collect()
}
