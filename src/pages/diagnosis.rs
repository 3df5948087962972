//! The report of `diagnose`: the verdict first, then for every finding where it was seen and what it changed.

use dynid_runtime::diagnosis::{Curve, Diagnosis, Finding, OrderSpectrum, TorqueSeries};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::report::{Band, Page, Plot, Role, SeriesKind, falls_or_rises, percent, significant};
use dynid_runtime::simulation::replay::ClosedLoop;

/// A recording that was kept apart from the diagnosis, and the errors on it.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptApart {
    /// Which recording.
    pub name: String,
    /// Relative error of the standard model, overall and per joint.
    pub before: (f64, Vec<f64>),
    /// The same with the findings.
    pub after: (f64, Vec<f64>),
}

/// What a report has besides the diagnosis itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extras {
    /// Errors on a recording that took no part.
    pub kept_apart: Option<KeptApart>,
    /// The recording by forward simulation, or why it cannot be simulated; `None` where it was not asked for.
    pub forward: Option<Result<ClosedLoop, String>>,
}

/// The whole page.
pub fn page(title: &str, diagnosis: &Diagnosis, extras: &Extras, notes: &[String]) -> String {
    let mut page = Page::new(&format!("{}: {title}", diagnosis.robot));
    page.verdict(&diagnosis.verdict.join(" "));
    if !notes.is_empty() {
        page.list(notes);
    }
    errors(&mut page, diagnosis, extras.kept_apart.as_ref());
    for finding in &diagnosis.findings {
        found(&mut page, diagnosis, finding);
    }
    if let Some(run) = &extras.forward {
        forward(&mut page, diagnosis, run);
    }
    mismatch(&mut page, diagnosis);
    shifts(&mut page, diagnosis);
    cannot_tell(&mut page, diagnosis);
    unexplained(&mut page, diagnosis);
    page.heading("How this was done");
    page.paragraph(&format!(
        "{} equations; {} candidate effects at places with all of their shapes were tried. Every candidate was \
         fitted together with all standard parameters and judged on motion that was held back: {}.",
        diagnosis.rows, diagnosis.tried, diagnosis.held_out.how
    ));
    if diagnosis.delay != 0.0 {
        page.paragraph(&format!(
            "A skew of {} ms between torques and positions was taken out first.",
            significant(1e3 * diagnosis.delay, 3)
        ));
    }
    page.to_html()
}

fn errors(page: &mut Page, diagnosis: &Diagnosis, kept_apart: Option<&KeptApart>) {
    page.heading("Before and after");
    let held = &diagnosis.held_out;
    let header = ["relative error of the torques", "before", "after"];
    let joints: Vec<String> = (0..held.per_joint_before.len()).map(|j| format!("joint {}", j + 1)).collect();
    let mut rows = vec![
        vec![
            "fitted motion".to_owned(),
            percent(diagnosis.before.relative_error),
            percent(diagnosis.after.relative_error),
        ],
        vec![format!("held back: {}", held.how), percent(held.before), percent(held.after)],
    ];
    if let Some(test) = kept_apart {
        rows.push(vec![
            format!("kept apart, 25 Hz band: {}", test.name),
            percent(test.before.0),
            percent(test.after.0),
        ]);
    }
    page.table(&header, &rows);
    let at = |errors: &[f64], j: usize| errors.get(j).map_or_else(|| "-".to_owned(), |e| percent(*e));
    let per_joint = |columns: &[&[f64]]| -> Vec<Vec<String>> {
        let row = |(j, name): (usize, &String)| {
            std::iter::once(name.clone()).chain(columns.iter().map(|c| at(c, j))).collect()
        };
        joints.iter().enumerate().map(row).collect()
    };
    let mut header = vec!["", "held back, before", "after"];
    let mut columns: Vec<&[f64]> = vec![&held.per_joint_before, &held.per_joint_after];
    if let Some(test) = kept_apart {
        header.extend(["kept apart, before", "after"]);
        columns.extend([&*test.before.1, &*test.after.1]);
    }
    page.table(&header, &per_joint(&columns));
    page.details("Each joint on the fitted motion", |page| {
        let columns: [&[f64]; 2] = [&diagnosis.before.per_joint, &diagnosis.after.per_joint];
        page.table(&["", "before", "after"], &per_joint(&columns));
    });
    if !held.by_motion.is_empty() {
        page.details("Each motion that was held back", |page| {
            let rows: Vec<Vec<String>> = held
                .by_motion
                .iter()
                .map(|(name, before, after)| vec![name.clone(), percent(*before), percent(*after)])
                .collect();
            page.table(&["held back", "before", "after"], &rows);
        });
    }
}

/// `joints 2 and 3`, `the whole robot`.
pub(crate) fn joint_words(joints: &[usize]) -> String {
    match joints {
        [] => "the whole robot".to_owned(),
        [one] => format!("joint {one}"),
        [first @ .., last] => {
            let first: Vec<String> = first.iter().map(ToString::to_string).collect();
            format!("joints {} and {last}", first.join(", "))
        }
    }
}

/// The confidence in words.
pub(crate) fn confidence_words(confidence: f64) -> String {
    format!("confidence {}", significant(confidence, 4))
}

fn found(page: &mut Page, diagnosis: &Diagnosis, finding: &Finding) {
    let words = EffectKind::from_id(&finding.effect).map(EffectKind::words);
    let title = words.map_or(finding.effect.as_str(), |w| w.title);
    page.heading(&format!("{title} on {}", joint_words(&finding.joints)));
    page.paragraph(&finding.sentence);
    if let Some(curve) = &finding.curve {
        page.plot(&revealing(curve));
    }
    for spectrum in diagnosis.spectra.iter().filter(|s| finding.joints.contains(&s.joint)) {
        if finding.effect == EffectKind::TorqueRipple.id() {
            page.plot(&orders(spectrum, unit(finding)));
        }
    }
    // One motion shows it; the others are there for who wants to look.
    let mut shown = diagnosis.series.iter().filter(|s| finding.joints.contains(&s.joint));
    if let Some(first) = shown.next() {
        page.plot(&torques(first, finding)).plot(&residuals(first, finding));
    }
    let others: Vec<&TorqueSeries> = shown.collect();
    if !others.is_empty() {
        page.details("The other motions and joints", |page| {
            for series in others {
                page.plot(&torques(series, finding)).plot(&residuals(series, finding));
            }
        });
    }
    let parameters: Vec<Vec<String>> = finding
        .parameters
        .iter()
        .map(|(name, p)| {
            let sigma = if p.sigma > 0.0 { significant(p.sigma, 2) } else { "-".to_owned() };
            vec![name.clone(), significant(p.value, 4), sigma, p.unit.clone()]
        })
        .collect();
    page.table(&["parameter", "value", "sigma", "unit"], &parameters);
    page.paragraph(&format!(
        "On held-back motion its joints' error {} from {} to {}; {}.",
        falls_or_rises(finding.held_out_before, finding.held_out_after),
        percent(finding.held_out_before),
        percent(finding.held_out_after),
        confidence_words(finding.confidence)
    ));
    if !finding.alternatives.is_empty() {
        page.subheading("Other explanations");
        let rows: Vec<Vec<String>> = finding
            .alternatives
            .iter()
            .map(|a| vec![format!("{} on {}", a.effect, joint_words(&a.joints)), a.why_not.clone()])
            .collect();
        page.table(&["effect", "<why not"], &rows);
    }
    if let Some(words) = words {
        page.note(&format!("Literature: {}.", words.source));
    }
}

/// The residual over the variable that reveals the effect, with the law.
fn revealing(curve: &Curve) -> Plot {
    let points: Vec<(f64, f64)> = curve.x.iter().copied().zip(curve.residual.iter().copied()).collect();
    let law: Vec<(f64, f64)> = curve.x.iter().copied().zip(curve.law.iter().copied()).collect();
    let bound = |sign: f64| -> Vec<(f64, f64)> {
        let with_error = curve.residual.iter().zip(&curve.error).map(|(r, e)| r + sign * 2.0 * e);
        curve.x.iter().copied().zip(with_error).collect()
    };
    let mut plot = Plot::new(
        format!("What the standard model leaves, over {}", curve.variable),
        curve.variable.clone(),
        format!("residual, {}", curve.unit),
    )
    .with("fitted law", Role::Law, SeriesKind::Line, law);
    if curve.error.iter().any(|e| *e > 0.0) {
        plot = plot.with("two standard errors", Role::Aside, SeriesKind::Line, bound(1.0)).with(
            "",
            Role::Aside,
            SeriesKind::Line,
            bound(-1.0),
        );
    }
    plot.with("mean residual", Role::Before, SeriesKind::Points, points)
}

fn orders(spectrum: &OrderSpectrum, unit: &str) -> Plot {
    let points = spectrum.order.iter().copied().zip(spectrum.amplitude.iter().copied()).collect();
    Plot::new(
        format!(
            "Order spectrum of joint {}: waves per turn of the joint (a motor turn is {} of its turns)",
            spectrum.joint,
            significant(1.0 / spectrum.gear, 3)
        ),
        "order, waves per joint turn",
        format!("amplitude, {unit}"),
    )
    .with("residual", Role::Before, SeriesKind::Line, points)
}

/// Unit of the torques of a finding's joints.
fn unit(finding: &Finding) -> &'static str {
    if finding.term.scale.is_some_and(|scale| scale.prismatic) { "N" } else { "N.m" }
}

/// A curve that is interrupted where rows were left out.
fn with_gaps(time: &[f64], values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let mut points = Vec::with_capacity(time.len());
    for (k, (&t, value)) in time.iter().zip(values).enumerate() {
        if k > 0 && t - time[k - 1] > 3.5 * usual {
            points.push((t, f64::NAN));
        }
        points.push((t, value));
    }
    points
}

fn torques(series: &TorqueSeries, finding: &Finding) -> Plot {
    let curve = |values: &[f64]| with_gaps(&series.time, values.iter().copied());
    let mut plot = Plot::new(
        format!("Torque of joint {}, {}", series.joint, series.motion),
        "time, s",
        format!("torque, {}", unit(finding)),
    )
    .with("measured", Role::Measured, SeriesKind::Line, curve(&series.measured))
    .with("model before", Role::Before, SeriesKind::Line, curve(&series.before))
    .with("model after", Role::After, SeriesKind::Line, curve(&series.after));
    plot.bands = windows(series, finding);
    plot
}

fn residuals(series: &TorqueSeries, finding: &Finding) -> Plot {
    let left = |model: &[f64]| with_gaps(&series.time, series.measured.iter().zip(model).map(|(y, m)| y - m));
    let mut plot = Plot::new(
        format!("What the model leaves of it, {}", series.motion),
        "time, s",
        format!("residual, {}", unit(finding)),
    )
    .with("before", Role::Before, SeriesKind::Line, left(&series.before))
    .with("after", Role::After, SeriesKind::Line, left(&series.after));
    plot.height = 200.0;
    plot.bands = windows(series, finding);
    plot
}

/// The windows of a contact in this motion.
fn windows(series: &TorqueSeries, finding: &Finding) -> Vec<Band> {
    finding
        .contacts
        .iter()
        .filter(|w| w.motion == series.motion)
        .map(|w| Band { from: w.window[0], to: w.window[1] })
        .collect()
}

/// Recorded and simulated torques.
fn forward(page: &mut Page, diagnosis: &Diagnosis, run: &Result<ClosedLoop, String>) {
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
         findings. The error of its torques against the recorded ones {} from {} to {}.",
        significant(run.duration, 3),
        falls_or_rises(run.before, run.after),
        percent(run.before),
        percent(run.after)
    ));
    if !run.left_out.is_empty() {
        page.paragraph(&format!("Not part of the simulation: {}.", run.left_out.join(", ")));
    }
    let found = diagnosis.findings.iter().flat_map(|f| f.joints.iter().copied());
    let mut joints = found.chain(diagnosis.mismatch.iter().map(|m| m.joint));
    let left = |recorded: &[f64], simulated: &[f64]| -> Vec<(f64, f64)> {
        let rest = recorded.iter().zip(simulated).map(|(y, m)| y - m);
        run.first.time.iter().copied().zip(rest).collect()
    };
    let first = &run.first;
    if let Some(j) = joints.find_map(|j| j.checked_sub(1).filter(|&j| j < first.recorded.len())) {
        page.plot(
            &Plot::new(
                format!("Joint {}: recorded less simulated torque, first motion", j + 1),
                "time, s",
                "N.m or N",
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
    let rows: Vec<Vec<String>> = (0..run.per_joint_before.len())
        .map(|j| {
            vec![
                format!("joint {}", j + 1),
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
    page.list(diagnosis.cannot_tell.iter().map(|c| {
        format!("{} on {}. To tell: {}.", c.between.join(" or "), joint_words(&c.joints), c.experiment)
    }));
}

fn unexplained(page: &mut Page, diagnosis: &Diagnosis) {
    page.heading("What nothing explains");
    page.paragraph(&format!(
        "{} of the squared error that remains on held-back motion is more than noise.",
        percent(diagnosis.unexplained.share)
    ));
    page.details("What remains, joint by joint", |page| {
        for (j, curve) in diagnosis.unexplained.curves.iter().enumerate() {
            let points = curve.x.iter().copied().zip(curve.residual.iter().copied()).collect();
            page.plot(
                &Plot::new(
                    format!("Joint {}", j + 1),
                    curve.variable.clone(),
                    format!("residual, {}", curve.unit),
                )
                .with("mean residual", Role::Before, SeriesKind::Points, points),
            );
        }
    });
}
