//! One finding of a diagnosis on its page.

use dynid_runtime::diagnosis::{Curve, Diagnosis, Finding, OrderSpectrum, TorqueSeries};
use dynid_runtime::effects::{Abscissa, EffectKind};
use dynid_runtime::report::{Band, Page, Plot, Role, SeriesKind, change_of_error, significant};

use crate::words::{confidence_words, effect_words, joint_words, part_words};

/// A finding: what it is, where it was seen, what it changed.
pub(super) fn found(page: &mut Page, diagnosis: &Diagnosis, finding: &Finding) {
    let effect = EffectKind::from_id(&finding.effect);
    page.heading(&format!("{} on {}", EffectKind::title_of(&finding.effect), joint_words(&finding.joints)));
    page.paragraph(&finding.sentence);
    if let Some(formula) = finding.formula() {
        page.paragraph(&format!("Its law: {formula}."));
    }
    if let Some(curve) = &finding.curve {
        page.plot(&revealing(curve));
    }
    for curve in &finding.more_curves {
        page.plot(&revealing(curve));
    }
    for spectrum in diagnosis.spectra.iter().filter(|s| finding.joints.contains(&s.joint)) {
        if effect.is_some_and(|e| e.properties().abscissa == Abscissa::WaveAngle) {
            page.plot(&orders(spectrum, unit(finding)));
        }
    }
    // One motion shows it; the others are folded below it.
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
    numbers(page, finding);
    if let Some(effect) = effect {
        page.note(&format!("Literature: {}.", effect.words().source));
    }
}

/// The parameters of a finding, what they change, and what was considered instead.
fn numbers(page: &mut Page, finding: &Finding) {
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
        "On held-out motion its joints' error {}; {}.",
        change_of_error(finding.held_out_before, finding.held_out_after),
        confidence_words(finding.confidence)
    ));
    if let Some(on_test) = &finding.on_test {
        page.paragraph(&format!(
            "On the test recording {}: the slope of what the model without it leaves over what it predicts.",
            part_words(on_test)
        ));
    }
    if !finding.alternatives.is_empty() {
        page.subheading("Other explanations");
        let rows: Vec<Vec<String>> = finding
            .alternatives
            .iter()
            .map(|a| {
                vec![format!("{} on {}", effect_words(&a.effect), joint_words(&a.joints)), a.why_not.clone()]
            })
            .collect();
        page.table(&["effect", "<why not"], &rows);
    }
}

/// The residual over the variable that reveals the effect, with the law.
fn revealing(curve: &Curve) -> Plot {
    let points: Vec<(f64, f64)> = curve.x.iter().copied().zip(curve.residual.iter().copied()).collect();
    let (x, torque) = match curve.fine.is_empty() {
        true => (&curve.x, &curve.law),
        false => (&curve.fine.x, &curve.fine.torque),
    };
    let law: Vec<(f64, f64)> = x.iter().copied().zip(torque.iter().copied()).collect();
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
    finding.term.scale.map_or("N.m", |scale| scale.kind().torque_unit())
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
        Plot::TIME,
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
        Plot::TIME,
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
