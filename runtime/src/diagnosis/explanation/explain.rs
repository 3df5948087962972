//! From a model with accepted terms to an outcome: numbers with their uncertainty, held-out errors, curves, sentences.

use crate::diagnosis::candidates::companions::LEVELS;
use crate::diagnosis::candidates::nuisances::friction_columns;
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::explanation::deviations::deviations;
use crate::diagnosis::explanation::finding::{named_on, of_contacts, of_term};
use crate::diagnosis::explanation::how::how;
use crate::diagnosis::explanation::standard_model::{StandardModelFit, estimated, in_sample};
use crate::diagnosis::explanation::{
    covariance, curves, delay, free_form, line, pushed, rate, standing, transient, words,
};
use crate::diagnosis::judging::between_motions::between_motions;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::skew::Skew;
use crate::diagnosis::outcome::{
    BetweenMotions, CannotTell, Diagnosis, Errors, Estimated, Finding, HeldOut, ParameterShift, Removed,
    Sampling, SearchOutcome, Small,
};
use crate::diagnosis::rate::WrongRate;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{SHIFTED, TOLD_APART};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::report::SearchReport;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::effects::{Abscissa, EffectKind, EffectTerm, Form, Place, SmoothingWindow};
use crate::model::{JointIndex, Robot};
use crate::parallel;

/// What is known when a search has ended, besides the search.
pub(in crate::diagnosis) struct Ended<'a> {
    pub standard: &'a StandardModelFit,
    /// Pushes from outside, and slow rows that leave nothing out.
    pub contacts: Option<(&'a Contacts, &'a Design)>,
    pub report: SearchReport,
    /// Skew of the torques that was taken out of the signals, s.
    pub delay: f64,
    /// Times that were wrong by a factor, and were corrected.
    pub rate: Option<&'a WrongRate>,
    pub sampling: Sampling,
}

/// Puts everything into words and numbers; the search stays as it is.
///
/// # Errors
/// [`DiagnosisError`] where a model that is compared has no fit.
pub(in crate::diagnosis) fn explain(
    search: &Search<'_>,
    ended: Ended<'_>,
    settings: &Settings,
) -> Result<Diagnosis, DiagnosisError> {
    let model = &search.model;
    let robot = model.context.model.robot();
    let standard = ended.standard;
    let skew = ended.delay + model.slow.fit.chi[model.slow.design.parameters];

    // 1. What was found, and what it gains on motion that was held out.
    let deviations = deviations(model)?;
    let effects =
        parallel::map(settings.threads, model.terms.len(), |k| of_term(model, k, deviations[k].clone()));
    let effects = effects.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut cannot_tell = cannot_tell(model, &effects);
    for tie in &search.ties {
        let [one, other] = [0, 1].map(|k| (tie.effects[k], tie.places[k]));
        let (pair, turned) = (apart(robot, [one, other]), apart(robot, [other, one]));
        if !cannot_tell.contains(&pair) && !cannot_tell.contains(&turned) {
            cannot_tell.push(pair);
        }
    }
    let (transients, effects) = transient::told_apart(model, effects);
    let (findings, held_out) = found(search, &ended, (effects, skew), settings)?;

    // 2. What it changes, and what it leaves.
    let after = estimated(&model.slow);
    let is_wave = |f: &Finding| f.term.effect.properties().abscissa == Abscissa::WaveAngle;
    let waves = |joint: usize| findings.iter().any(|f| is_wave(f) && f.joints.contains(&joint));
    let spectra = search.spectra.iter().filter(|s| waves(s.joint)).cloned().collect();
    let removed = |t: &Accepted| Removed {
        effect: t.effect.id_at(t.place).into(),
        joints: named_on(robot, t.effect, t.place),
    };
    let mut diagnosis = Diagnosis {
        robot: robot.name.to_string(),
        before: standard.in_sample.clone(),
        after: in_sample(&model.fast),
        held_out,
        mismatch: curves::mismatch(model, standard),
        verdict: Vec::new(),
        cannot_tell,
        small: Vec::new(),
        transients,
        unexplained: curves::unexplained(model),
        shifts: shifts(robot, &standard.estimated, &after),
        standard: ended.rate.map_or(&standard.estimated, |wrong| &wrong.declared).clone(),
        model: after,
        delay: skew,
        delay_sigma: Skew::known(skew, (&model.slow.design, &model.slow.fit), model.slow.design.parameters)
            .sigma,
        spectra,
        series: curves::series(model, &standard.fitted_fast),
        rows: model.slow.design.rows.len() + model.fast.design.rows.len(),
        tried: search.tried,
        sampling: ended.sampling,
        search: SearchOutcome {
            stop: ended.report.stop,
            removed: ended.report.removed.iter().map(removed).collect(),
        },
        not_judged: Vec::new(),
        refuted: Vec::new(),
        standing: Vec::new(),
        covariance: None,
        between_motions: Vec::new(),
        findings,
    };
    stand(model, &mut diagnosis, settings.threads);
    diagnosis.verdict = words::verdict(&diagnosis);
    diagnosis.verdict.extend(words::of_user(robot, &settings.laws, &search.untried, &diagnosis));
    if let Some(reference) = &model.context.reference {
        diagnosis.verdict.push(words::of_reference(reference, model.context.is_alone()));
    }
    Ok(diagnosis)
}

/// Contacts, the effects of the terms, ripple by its lines, the delay, a wrong rate; and what all of them gain.
fn found(
    search: &Search<'_>,
    ended: &Ended<'_>,
    (effects, skew): (Vec<Finding>, f64),
    settings: &Settings,
) -> Result<(Vec<Finding>, HeldOut), DiagnosisError> {
    let model = &search.model;
    let robot = model.context.model.robot();
    let mut findings: Vec<Finding> = ended.contacts.map(|(c, _)| of_contacts(robot, c)).into_iter().collect();
    findings.extend(effects);
    let settings = search.settings_of_next(settings);
    findings.extend(line::findings(search, &settings));
    let expected = model.context.reference.as_ref().map_or(0.0, |r| r.delay());
    let late = delay::finding(model, skew - expected, &settings)?;
    let named_skew = late.is_some().then_some(skew - expected);
    findings.extend(late);
    rate::in_true_seconds(robot, &mut findings);
    // Pushes and a wrong rate are looked for on slow rows, and what was there before them was predicted on these.
    let slow = ended.contacts.is_some() || ended.rate.is_some();
    let (window, standard, band) = if slow {
        (SmoothingWindow::Slow, &ended.standard.held_slow, ended.sampling.slow_band)
    } else {
        (SmoothingWindow::Fast, &ended.standard.held, ended.sampling.band)
    };
    let regression = model.regression(window);
    let curves = regression.curves();
    let held = regression.held_out(false, &curves)?;
    findings.extend(ended.rate.map(|wrong| rate::finding(model, wrong, &held)));
    // Both are told of the same rows.
    let held = match ended.contacts {
        Some((contacts, all)) => pushed::aware(model, all, contacts, held),
        None => held,
    };
    let standard_on_same_rows = match ended.contacts {
        Some((_, all)) => Some(pushed::unaware(model, all)?),
        None if curves.is_empty() => None,
        None => Some(model.standard()?.regression(window).held_out(model.change, &curves)?),
    };
    let standard = standard_on_same_rows.as_ref().unwrap_or(standard);
    let before = before(model, ended, (standard, named_skew))?;
    // Without a finding the model is the standard one.
    let held = if findings.is_empty() { standard } else { &held };
    let after = held.errors();
    let held_out = HeldOut {
        how: how(model, ended.contacts.is_some(), &curves),
        band,
        before: before.relative_error.unwrap_or_default(),
        after: after.relative_error.unwrap_or_default(),
        per_joint_before: before.per_joint,
        per_joint_after: after.per_joint,
        by_motion: by_motion(model, &regression.design, [standard, held]),
    };
    Ok((findings, held_out))
}

/// What was there before, and how all that the model has varies together.
fn stand(model: &ExtendedModel<'_>, diagnosis: &mut Diagnosis, threads: usize) {
    let standing = standing::terms(model);
    diagnosis.standing = standing.iter().map(|(term, _)| standing::told(term)).collect();
    let column = |term: &EffectTerm| {
        let is = |t: &Accepted| t.effect == term.effect && t.place == term.place && t.shape == term.shape;
        let range = &model.slow.term_columns[model.terms.iter().position(is)?];
        (range.len() == term.amplitude.len() && term.transmission().is_none()).then_some(range.start)
    };
    let found = diagnosis.findings.iter().map(|f| &f.term);
    let found = found.map(|term| (term, column(term)));
    let all: Vec<_> = found.chain(standing.iter().map(|(term, first)| (term, *first))).collect();
    let upper = covariance::upper(model, &all, threads);
    diagnosis.covariance = upper;
    diagnosis.between_motions = between(model, threads);
}

/// How much each joint differs between motions: of the baseline, or of the recording; as a reference knew it where there
/// is one.
fn between(model: &ExtendedModel<'_>, threads: usize) -> Vec<Option<BetweenMotions>> {
    if let Some(reference) = &model.context.reference {
        return reference.between_motions().to_vec();
    }
    let (design, bench) = (&model.slow.design, model.bench(SmoothingWindow::Slow));
    let friction: Vec<Vec<Vec<f64>>> =
        (0..design.joints).map(|j| friction_columns(&model.context, design, j)).collect();
    let residual = model.slow.residual();
    between_motions(&bench.units, &bench.regressors(design), &friction, LEVELS, (&residual, threads))
}

/// Rivals that explain nearly as much as the effects that were accepted; `effects` are those of the terms, in order.
fn cannot_tell(model: &ExtendedModel<'_>, effects: &[Finding]) -> Vec<CannotTell> {
    let mut list = Vec::new();
    let robot = model.context.model.robot();
    for (term, finding) in model.terms.iter().zip(effects) {
        for rival in term.rivals.iter().filter(|r| r.difference_p_value > TOLD_APART) {
            let of_rival = (rival.effect, rival.place);
            let mut pair = apart(robot, [(term.effect, term.place), of_rival]);
            pair.between[0].clone_from(&finding.effect);
            if !rival.shape.is_empty() {
                pair.variables = vec![finding.variables.clone(), free_form::variables(robot, &rival.shape)];
            }
            list.push(pair);
        }
    }
    list
}

/// Two laws that cannot be told apart.
fn apart(robot: &Robot, laws: [(EffectKind, Place); 2]) -> CannotTell {
    let on = laws.map(|(effect, place)| named_on(robot, effect, place));
    let mut joints = on.concat();
    joints.sort_unstable();
    joints.dedup();
    CannotTell {
        between: laws.map(|(effect, place)| effect.id_at(place).to_string()).to_vec(),
        joints,
        on: if on[0] == on[1] { Vec::new() } else { on.to_vec() },
        experiment: experiment(robot, laws[0], laws[1]),
        variables: Vec::new(),
    }
}

/// What would tell two laws apart: an experiment in words, and where both are laws of one joint the command that makes its
/// motion.
fn experiment(robot: &Robot, law: (EffectKind, Place), rival: (EffectKind, Place)) -> String {
    // How much friction differs from day to day tells no law from it.
    let telling = if law.0 == EffectKind::FrictionLevelChange { rival.0 } else { law.0 };
    let words = telling.words().experiment;
    let of_joint = |(effect, place): (EffectKind, Place)| match effect.form() {
        Form::Joint(_) => place.joint(),
        _ => None,
    };
    match (of_joint(law), of_joint(rival)) {
        (Some(a), Some(b)) if a == b && law.0 != rival.0 => {
            let joint = robot.joint_number(JointIndex(a)).0;
            let ids = [law.0.id(), rival.0.id()].join(",");
            format!(
                "{words} (`dynid excite {} --tell {ids} --joint {joint} --out DIR` makes such a motion)",
                robot.name
            )
        }
        _ => words.into(),
    }
}

/// What is there and below what is named.
pub(in crate::diagnosis) fn small(search: &Search<'_>, settings: &Settings) -> Vec<Small> {
    let context = &search.model.context;
    let unit = |own: &[usize]| own.first().map_or("N.m", |&j| context.scales[j].kind.torque_unit());
    let laws = search.small(settings).into_iter();
    laws.map(|law| Small {
        effect: law.effect.id_at(law.place).into(),
        joints: named_on(context.model.robot(), law.effect, law.place),
        torque: law.size.law,
        least: law.size.needed,
        unit: unit(&law.own).into(),
    })
    .collect()
}

/// Errors on held-out motion of the standard model on the recording as it is. What was found is not taken out of it: a
/// wrong rate, and a skew that is named.
fn before(
    model: &ExtendedModel<'_>,
    ended: &Ended<'_>,
    (standard, named_skew): (&HeldOutSquares, Option<f64>),
) -> Result<Errors, DiagnosisError> {
    if let Some(wrong) = ended.rate {
        return Ok(wrong.errors.clone());
    }
    match named_skew.filter(|_| ended.contacts.is_none()) {
        Some(skew) => Ok(delay::unaware(model, skew)?.errors()),
        None => Ok(standard.errors()),
    }
}

fn by_motion(
    model: &ExtendedModel<'_>,
    design: &Design,
    [before, after]: [&HeldOutSquares; 2],
) -> Vec<(String, f64, f64)> {
    let name = |g: usize| model.context.signals[design.segments[g].signal].name.clone();
    let mut list: Vec<(String, [f64; 4])> = Vec::new();
    for ((g, l0, w0), (_, l1, w1)) in before.by_segment.iter().zip(&after.by_segment) {
        let name = name(*g);
        match list.iter_mut().find(|(n, _)| *n == name) {
            Some((_, s)) => {
                for (s, x) in s.iter_mut().zip([l0, w0, l1, w1]) {
                    *s += x;
                }
            }
            None => list.push((name, [*l0, *w0, *l1, *w1])),
        }
    }
    // Of a motion of which the others tell nothing there is no error.
    list.retain(|(_, s)| s[1] > 0.0 && s[3] > 0.0);
    list.into_iter().map(|(n, s)| (n, (s[0] / s[1]).sqrt(), (s[2] / s[3]).sqrt())).collect()
}

fn shifts(robot: &Robot, before: &Estimated, after: &Estimated) -> Vec<ParameterShift> {
    robot
        .base
        .iter()
        .enumerate()
        .filter(|&(k, _)| {
            let spread = before.sigma[k].hypot(after.sigma[k]);
            (before.chi[k] - after.chi[k]).abs() > SHIFTED * spread
        })
        .map(|(k, b)| ParameterShift {
            name: b.name.to_string(),
            unit: b.unit.to_string(),
            before: before.chi[k],
            sigma_before: before.sigma[k],
            after: after.chi[k],
            sigma_after: after.sigma[k],
        })
        .collect()
}
