//! The report of `diagnose`: the verdict first, then for every finding where it was seen and what it changed.

use dynid_runtime::diagnosis::Diagnosis;
use dynid_runtime::prediction::{Evaluation, Prediction};
use dynid_runtime::report::{Page, Plot, Role, SeriesKind, capital, percent, significant};

use super::extras::Extras;
use super::finding::found;
use super::forward::forward;
use crate::errors::noise_words;
use crate::pages::parameters::{parameters, relations};
use crate::pages::provenance::provenance;
use crate::pages::residuals::residuals;
use crate::recorded::titled;
use crate::words::{apart_words, small_words, standing_words, transient_words};

/// The whole page.
pub fn page(title: &str, diagnosis: &Diagnosis, extras: &Extras, notes: &[String]) -> String {
    let mut page = Page::new(&titled(&diagnosis.robot, title));
    page.verdict(&diagnosis.verdict.join(" "));
    page.list(notes);
    errors(&mut page, diagnosis, extras);
    for finding in &diagnosis.findings {
        found(&mut page, diagnosis, finding);
    }
    if let Some(run) = &extras.forward {
        forward(&mut page, diagnosis, extras, run);
    }
    mismatch(&mut page, diagnosis);
    shifts(&mut page, diagnosis);
    cannot_tell(&mut page, diagnosis);
    standing(&mut page, diagnosis);
    transients(&mut page, diagnosis);
    small(&mut page, diagnosis);
    unexplained(&mut page, diagnosis, extras);
    page.heading("Parameters with the findings in the model");
    let known = extras
        .prior
        .as_ref()
        .map_or_else(String::new, |p| format!(", beside those of the {}", prior_words(p.name)));
    page.details(&format!("All {} base parameters{known}", extras.robot.base.len()), |page| {
        parameters(page, &extras.robot, &extras.parameters(diagnosis), extras.prior.as_ref());
        relations(page, &extras.robot);
    });
    page.heading("How this was done");
    page.paragraph(&format!(
        "{} equations; {} candidate effects at places with all of their shapes were tried. Every candidate was \
         fitted together with all standard parameters and judged on held-out motion: {}.",
        diagnosis.rows, diagnosis.tried, diagnosis.held_out.how
    ));
    if diagnosis.delay != 0.0 {
        page.paragraph(&format!(
            "A skew of {} ms between torques and positions was taken out first.",
            significant(1e3 * diagnosis.delay, 3)
        ));
    }
    provenance(&mut page, &extras.from);
    page.to_html()
}

/// What a prior is, in a sentence.
fn prior_words(name: &str) -> &str {
    if name == "nominal" { "robot's table" } else { name }
}

/// Which rows, their band, and the errors before and after on them.
pub(crate) fn error_rows(diagnosis: &Diagnosis, extras: &Extras) -> Vec<Vec<String>> {
    let evaluated = |what: String, evaluation: &Evaluation| -> Vec<String> {
        let errors = evaluation.predictions.iter().map(|p| percent(p.errors.relative_error));
        [what, band(evaluation)].into_iter().chain(errors).collect()
    };
    let mut rows = Vec::new();
    match extras.evaluation() {
        Some(evaluation) => rows.push(evaluated("fitted motion".to_owned(), evaluation)),
        None => rows.push(vec![
            "fitted motion".to_owned(),
            own_rows(diagnosis.sampling.band),
            percent(diagnosis.before.relative_error),
            percent(diagnosis.after.relative_error),
        ]),
    }
    rows.push(vec![
        format!("held out ({})", diagnosis.held_out.how),
        own_rows(diagnosis.held_out.band),
        percent(diagnosis.held_out.before),
        percent(diagnosis.held_out.after),
    ]);
    if let Some(test) = &extras.tested {
        rows.push(evaluated(format!("test recording ({})", test.name), &test.evaluation));
    }
    if let Some(Ok(run)) = &extras.forward {
        let usual = "up to 25 Hz".to_owned();
        rows.push(vec!["by forward simulation".to_owned(), usual, percent(run.before), percent(run.after)]);
    }
    rows
}

/// The band of what only the diagnosis' own rows say: they are smoothed, not decimated.
fn own_rows(band: f64) -> String {
    format!("{} Hz, its own rows", significant(band, 3))
}

fn band(evaluation: &Evaluation) -> String {
    format!("{} Hz", significant(evaluation.band, 3))
}

fn errors(page: &mut Page, diagnosis: &Diagnosis, extras: &Extras) {
    page.heading("Before and after");
    let held = &diagnosis.held_out;
    page.table(
        &["relative error of the torques", "<band", "before", "after"],
        &error_rows(diagnosis, extras),
    );
    if let Some(words) = extras.tested.as_ref().and_then(|t| noise_words(&t.evaluation)) {
        page.note(&format!("Test recording: {words}."));
    }
    let at = |errors: &[Option<f64>], j: usize| errors.get(j).map_or_else(|| "-".to_owned(), |e| percent(*e));
    let per_joint = |columns: &[&[Option<f64>]]| -> Vec<Vec<String>> {
        let row = |j: usize| std::iter::once(extras.joint(j)).chain(columns.iter().map(move |c| at(c, j)));
        (0..held.per_joint_before.len()).map(|j| row(j).collect()).collect()
    };
    let own: [&[Option<f64>]; 2] = [&held.per_joint_before, &held.per_joint_after];
    let header = format!("held out, {}, before", own_rows(held.band));
    page.table(&["", &header, "after"], &per_joint(&own));
    let columns = |predictions: &[Prediction]| -> Vec<Vec<Option<f64>>> {
        predictions.iter().map(|p| p.errors.per_joint.clone()).collect()
    };
    let evaluated = |page: &mut Page, what: &str, evaluation: &Evaluation| {
        let columns = columns(&evaluation.predictions);
        let columns: Vec<&[Option<f64>]> = columns.iter().map(Vec::as_slice).collect();
        page.table(&["", &format!("{what}, {}, before", band(evaluation)), "after"], &per_joint(&columns));
    };
    if let Some(test) = &extras.tested {
        evaluated(page, "test recording", &test.evaluation);
    }
    if let Some(evaluation) = extras.evaluation() {
        page.details("Each joint on the fitted motion", |page| evaluated(page, "fitted motion", evaluation));
    }
    if !held.by_motion.is_empty() {
        page.details("Each motion that was held out", |page| {
            let rows: Vec<Vec<String>> = held
                .by_motion
                .iter()
                .map(|(name, before, after)| vec![name.clone(), percent(*before), percent(*after)])
                .collect();
            page.table(&["held out", "before", "after"], &rows);
        });
    }
}

fn mismatch(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.mismatch.is_empty() {
        return;
    }
    page.heading("Where the standard model fails");
    let rows: Vec<Vec<String>> = diagnosis
        .mismatch
        .iter()
        .map(|m| vec![format!("joint {}", m.joint), percent(m.share), m.where_.clone()])
        .collect();
    page.table(&["joint", "share of what is unexplained", "<where it lives"], &rows);
}

fn shifts(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.shifts.is_empty() {
        return;
    }
    page.heading("Parameters that the missing physics had biased");
    let rows: Vec<Vec<String>> = diagnosis
        .shifts
        .iter()
        .map(|s| {
            vec![
                s.name.clone(),
                significant(s.before, 4),
                significant(s.sigma_before, 2),
                significant(s.after, 4),
                significant(s.sigma_after, 2),
                s.unit.clone(),
            ]
        })
        .collect();
    page.table(&["parameter", "before", "sigma", "after", "sigma", "unit"], &rows);
}

fn cannot_tell(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.cannot_tell.is_empty() {
        return;
    }
    page.heading("What this motion cannot tell");
    page.list(
        diagnosis
            .cannot_tell
            .iter()
            .map(|c| format!("{}. To tell: {}.", apart_words(c, " or "), c.experiment)),
    );
}

fn standing(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.standing.is_empty() {
        return;
    }
    page.heading("Also missing in both");
    page.paragraph(&format!("{}.", capital(&standing_words(diagnosis))));
}

fn transients(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.transients.is_empty() {
        return;
    }
    page.heading("Also there, and not told from an event");
    page.list(diagnosis.transients.iter().map(|t| format!("{}.", capital(&transient_words(t)))));
}

fn small(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.small.is_empty() {
        return;
    }
    page.heading("Also there, and too small to be named");
    page.list(diagnosis.small.iter().map(|s| format!("{}.", capital(&small_words(s)))));
}

fn unexplained(page: &mut Page, diagnosis: &Diagnosis, extras: &Extras) {
    page.heading("What nothing explains");
    page.paragraph(&format!(
        "{} of the squared error that remains on held-out motion is more than noise.",
        percent(diagnosis.unexplained.share)
    ));
    if let Some(compared) = extras.compared() {
        residuals(page, compared);
        return;
    }
    page.details("What remains, joint by joint", |page| {
        for (j, curve) in diagnosis.unexplained.curves.iter().enumerate() {
            let points = curve.x.iter().copied().zip(curve.residual.iter().copied()).collect();
            page.plot(
                &Plot::new(extras.joint(j), curve.variable.clone(), format!("residual, {}", curve.unit))
                    .with("mean residual", Role::Before, SeriesKind::Points, points),
            );
        }
    });
}
