//! The report of `identify`: the parameters, and the torques measured and predicted.

use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{Bodies, Identified, NamedParameter};
use dynid_runtime::report::{Page, percent, significant};

use super::parameters::{Prior, parameters, relations};
use super::provenance::provenance;
use super::residuals::residuals;
use super::torques::torques;
use crate::body_report;
use crate::compared::Compared;
use crate::provenance::Provenance;
use crate::recorded::{Recorded, left_out_words};
use crate::words::joint_number;

/// What a page of an identification is made of.
#[derive(Debug, Clone, Copy)]
pub struct Told<'a> {
    /// What was identified.
    pub identified: &'a Identified,
    /// The rows that are drawn.
    pub compared: Compared<'a>,
    /// Whether they are those of the whole recording; of a longer one they are those of its first pieces.
    pub whole: bool,
    /// What was known of the parameters beforehand.
    pub prior: Option<&'a Prior>,
    /// Where all of it comes from.
    pub from: &'a Provenance,
}

/// The whole page.
pub fn page(recorded: &Recorded, told: Told<'_>) -> String {
    let (robot, identified) = (told.compared.robot, told.identified);
    let mut page = Page::new(&recorded.heading());
    page.verdict(&verdict(robot, identified));
    page.list(left_out_words(&recorded.rows));
    page.list(doubts(identified));
    page.list(&identified.warnings);
    page.heading("Base parameters");
    parameters(&mut page, robot, &identified.base_parameters, told.prior);
    page.note(
        "sigma is for errors that last, as the residuals show it, and holds what noise of the encoders may have taken away: \
         value ± 1.96 sigma contains the truth in 95 of 100 recordings. The white one is for errors that are independent from \
         row to row.",
    );
    page.details("What is regrouped into each base parameter", |page| relations(page, robot));
    more_of_parameters(&mut page, identified);
    if let Some(bodies) = &identified.bodies {
        self::bodies(&mut page, bodies);
    }
    page.heading("Torques, measured and predicted");
    torques(&mut page, told.compared);
    if !told.whole {
        page.note(
            "The recording is long: only its beginning is drawn. The parameters are those of all of it.",
        );
    }
    page.note(&format!(
        "Both are seen through the same filter of {} Hz bandwidth. Gaps are rows that were left out.",
        significant(identified.band, 3)
    ));
    page.heading("What the model leaves");
    residuals(&mut page, told.compared);
    page.details("Rows used and left out", |page| {
        page.table(
            &["trajectory", "joint", "used", "standstill", "fixed", "window", "ends"],
            &rows(identified),
        );
    });
    provenance(&mut page, told.from);
    page.to_html()
}

/// How the parameters were made those of bodies.
fn bodies(page: &mut Page, bodies: &Bodies) {
    page.subheading("Bodies");
    let errors = bodies.relative_errors.map_or_else(String::new, |[free, least]| {
        format!(
            " The torques' error was {} as identified; it is {} with the bodies nearest to the data, whatever the prior.",
            percent(free),
            percent(least)
        )
    });
    let weight = bodies.prior_weight.zip(bodies.from_data).map_or_else(String::new, |(weight, from_data)| {
        format!(
            " The prior has weight {}, the largest with about the least expected error of the torques (Mallows' Cp), which \
             leaves {} of these to the data.",
            significant(weight, 3),
            significant(from_data, 3)
        )
    });
    page.paragraph(&format!(
        "The values are those of the bodies nearest to the prior: their squared distance from the identified ones, in units of \
         the uncertainty of {} base parameters, is {}; the least that bodies can have is {}.{weight}{errors}",
        bodies.determined,
        significant(bodies.distance, 3),
        significant(bodies.least, 3)
    ));
    if !bodies.ellipsoids.is_empty() {
        page.table(&body_report::ELLIPSOIDS, &body_report::ellipsoid_rows(bodies));
        page.note(
            "Each body is kept within an ellipsoid around its geometry. Margin 1: a point at its centre; 0.4: it is evenly \
             filled; 0: all mass at its surface.",
        );
    }
    if !bodies.impossible.is_empty() {
        page.table(&body_report::IMPOSSIBLE, &body_report::impossible_rows(bodies));
        page.note("What cannot be as it was identified, and how near all others could be if it alone need not be a body.");
    }
}

/// Beside another method's values, and which are essential.
fn more_of_parameters(page: &mut Page, identified: &Identified) {
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
            if essential.cancelled.is_empty() { "none".to_owned() } else { essential.cancelled.join(", ") }
        ));
    }
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
