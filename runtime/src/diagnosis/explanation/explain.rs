//! From accepted terms to findings: numbers with their uncertainty, held-out errors, curves, sentences.

use crate::diagnosis::candidates::candidate::pace;
use crate::diagnosis::candidates::trial::delay_columns;
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::explanation::curves;
use crate::diagnosis::explanation::quantities::{parameters, uncertainty};
use crate::diagnosis::explanation::words;
use crate::diagnosis::judging::folds::single_motion;
use crate::diagnosis::judging::held_back::{HeldBack, hold_back};
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::outcome::*;
use crate::diagnosis::predict::errors;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::{Design, LONGEST_BLOCK};
use crate::diagnosis::rows::fit::fit_weighted;
use crate::diagnosis::search::state::{Accepted, Search, Side};
use crate::diagnosis::settings::Settings;
use crate::diagnosis::{DiagnosisError, NAMED_DELAY, joint_number, unit_term};
use crate::effects::{EffectKind, EffectTerm, Form, Place};
use crate::model::Model;
use std::collections::BTreeSet;

/// Laws are told apart where the better one is so by accident with less than this probability.
const MOST_DOUBT: f64 = 0.05;

/// Skew of the torques behind the positions in a design, s.
pub(in crate::diagnosis) fn delay_of(context: &Context<'_>, mut design: Design) -> f64 {
    for column in delay_columns(context, &design) {
        design.push(column);
    }
    design.refresh();
    let mut sigma = vec![1.0; design.joints];
    let fit = fit_weighted(&design, &mut sigma, |_| true);
    fit.chi[design.columns.len() - 1]
}

/// The standard model before anything was added.
pub(in crate::diagnosis) struct Bare {
    pub in_sample: Errors,
    pub held: HeldBack,
    pub estimated: Estimated,
    pub residual_slow: Vec<f64>,
    held_slow: HeldBack,
    /// Fitted torque of the fast rows.
    fitted_fast: Vec<f64>,
    /// With the windows of contacts, slow rows.
    held_with_windows: Errors,
}

impl Bare {
    pub fn new(search: &Search<'_, '_>, aligned: &Design) -> Self {
        let (slow, fast) = (&search.slow, &search.fast);
        let mut sigma = slow.sigma.clone();
        let _ = fit_weighted(aligned, &mut sigma, |_| true);
        let residual = fast.fit.residual(&fast.design);
        Self {
            in_sample: in_sample(fast),
            held: hold_back(&fast.design, &fast.sigma, search.change),
            estimated: estimated(slow),
            residual_slow: slow.fit.residual(&slow.design),
            held_slow: hold_back(&slow.design, &slow.sigma, search.change),
            fitted_fast: fast.design.y.iter().zip(&residual).map(|(y, r)| y - r).collect(),
            held_with_windows: hold_back(aligned, &sigma, search.change).errors(),
        }
    }
}

fn in_sample(side: &Side) -> Errors {
    let d = &side.design;
    let p = d.columns.len();
    let (mut left, mut whole) = (vec![0.0; d.joints], vec![0.0; d.joints]);
    for j in 0..d.joints {
        for g in (0..d.segments.len()).filter(|&g| d.segments[g].fresh) {
            left[j] += side.fit.squares(d, j, g);
            whole[j] += d.gram[j][g][p * (p + 1) + p];
        }
    }
    errors(&left, &whole)
}

fn estimated(side: &Side) -> Estimated {
    let p = side.design.parameters;
    let variances = side.fit.variances();
    Estimated {
        chi: side.fit.chi.iter().take(p).copied().collect(),
        sigma: variances.iter().take(p).map(|v| v.max(0.0).sqrt()).collect(),
    }
}

/// Puts everything into words and numbers.
pub(in crate::diagnosis) fn explain(
    model: &dyn Model,
    mut search: Search<'_, '_>,
    bare: &Bare,
    contacts: Option<&Contacts>,
    delay: f64,
    settings: &Settings,
) -> Result<Diagnosis, DiagnosisError> {
    let robot = model.robot();
    let terms = search.terms.clone();
    let held_all = hold_back(&search.fast.design, &search.fast.sigma, false);
    let mut findings = Vec::new();
    let mut cannot_tell = Vec::new();
    for k in 0..terms.len() {
        let finding = finding(model, &mut search, &terms, k);
        for rival in &terms[k].rivals {
            if rival.doubt > MOST_DOUBT {
                cannot_tell.push(CannotTell {
                    between: vec![finding.effect.clone(), rival.effect.id().into()],
                    joints: finding.joints.clone(),
                    experiment: terms[k].effect.words().experiment.into(),
                });
            }
        }
        findings.push(finding);
    }
    if let Some(contacts) = contacts {
        findings.insert(0, contact_finding(contacts));
    }
    let skew = delay + search.slow.fit.chi[search.slow.design.parameters];
    let rate = search.context.signals.iter().map(|s| s.rate).fold(f64::INFINITY, f64::min);
    if (skew * rate).abs() >= NAMED_DELAY.0 && skew.abs() >= NAMED_DELAY.1 {
        findings.extend(delay_finding(&mut search, skew, settings));
    }

    let (before_error, after_held) = (bare.held.errors(), held_all.errors());
    let mut held_out = HeldOut {
        how: how(&search),
        before: before_error.relative_error,
        after: after_held.relative_error,
        per_joint_before: before_error.per_joint,
        per_joint_after: after_held.per_joint,
        by_motion: by_motion(&search, &bare.held, &held_all),
    };
    if contacts.is_some() {
        held_out.before = bare.held_with_windows.relative_error;
        held_out.per_joint_before.clone_from(&bare.held_with_windows.per_joint);
    }
    let after = estimated(&search.slow);
    let mut diagnosis = Diagnosis {
        robot: robot.name.to_string(),
        before: bare.in_sample.clone(),
        after: in_sample(&search.fast),
        held_out,
        mismatch: curves::mismatch(&search, bare, &bare.held_slow.left),
        verdict: Vec::new(),
        cannot_tell,
        unexplained: curves::unexplained(&search),
        shifts: shifts(model, &bare.estimated, &after),
        standard: bare.estimated.clone(),
        model: after,
        delay: skew,
        spectra: search
            .spectra
            .iter()
            .filter(|s| findings.iter().any(|f| f.effect == "torque_ripple" && f.joints.contains(&s.joint)))
            .cloned()
            .collect(),
        series: curves::series(&search, &bare.fitted_fast, &terms),
        rows: search.slow.design.rows.len() + search.fast.design.rows.len(),
        tried: search.tried,
        not_judged: Vec::new(),
        findings,
    };
    diagnosis.verdict = words::verdict(&diagnosis);
    Ok(diagnosis)
}

fn how(search: &Search<'_, '_>) -> String {
    let design = &search.slow.design;
    let mut fresh = design.segments.iter().filter(|s| s.fresh).map(|s| s.signal);
    let first = fresh.next();
    if search.change && fresh.all(|s| Some(s) == first) {
        "every stretch of the new motion predicted from the baseline and its other stretches".into()
    } else if search.change {
        "every new motion predicted from the baseline and the other new motions".into()
    } else if single_motion(&search.slow.design) {
        "forward in time".into()
    } else {
        "every motion predicted from the others".into()
    }
}

fn by_motion(search: &Search<'_, '_>, before: &HeldBack, after: &HeldBack) -> Vec<(String, f64, f64)> {
    let name = |g: usize| search.context.signals[search.fast.design.segments[g].signal].name.clone();
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
    list.into_iter().map(|(n, s)| (n, (s[0] / s[1]).sqrt(), (s[2] / s[3]).sqrt())).collect()
}

fn shifts(model: &dyn Model, before: &Estimated, after: &Estimated) -> Vec<ParameterShift> {
    model
        .robot()
        .base
        .iter()
        .enumerate()
        .filter(|&(k, _)| {
            let spread = before.sigma[k].hypot(after.sigma[k]);
            (before.chi[k] - after.chi[k]).abs() > 3.0 * spread
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

/// Numbers j of the joints that an effect at a place is named on.
fn named_on(model: &dyn Model, effect: EffectKind, place: Place) -> Vec<usize> {
    let robot = model.robot();
    match (place, effect.form()) {
        (Place::Joint(j), _) => vec![joint_number(robot, j)],
        (Place::Pair(a, b), _) => vec![joint_number(robot, a), joint_number(robot, b)],
        (Place::Variant(v), Form::Sensitivity(law)) if !law.together() => law
            .variants(robot)
            .get(v)
            .and_then(|x| x.joint)
            .map(|j| joint_number(robot, j))
            .into_iter()
            .collect(),
        (Place::Link(frame), _) if effect == EffectKind::AddedMass => vec![frame + 1],
        _ => Vec::new(),
    }
}

fn finding(model: &dyn Model, search: &mut Search<'_, '_>, terms: &[Accepted], k: usize) -> Finding {
    let robot = model.robot();
    let accepted = &terms[k];
    let which = pace(accepted.effect);
    let joints = named_on(model, accepted.effect, accepted.place);
    let side = search.side(which);
    let range = side.term_columns[k].clone();
    let mut amplitude: Vec<f64> = range.clone().map(|c| side.fit.chi[c]).collect();
    let with = hold_back(&side.design, &side.sigma, false);
    let curve = curves::of_term(search, accepted, k);
    let (mut sigma, shape_sigma) = uncertainty(search, terms, k, &amplitude);
    let parameters = parameters(search, accepted, &mut amplitude, &mut sigma, &shape_sigma, model);
    let scale = match accepted.place {
        Place::Joint(j) => Some(search.context.scales[j].into()),
        _ => None,
    };
    // Without this term, everything else refitted.
    search.terms.remove(k);
    search.refit();
    let side = search.side(which);
    let without = hold_back(&side.design, &side.sigma, false);
    search.terms.insert(k, accepted.clone());
    search.refit();
    let (before, after) = (without.error_on(&accepted.own), with.error_on(&accepted.own));
    let share = 1.0 - (after / before).powi(2);
    let alternatives = accepted
        .rivals
        .iter()
        .map(|r| Alternative {
            effect: r.effect.id().into(),
            joints: named_on(model, r.effect, r.place),
            why_not: format!(
                "explains {:.0} % of what held-back motion leaves open, against {:.0} %",
                100.0 * r.share.clamp(0.0, 1.0),
                100.0 * accepted.share.clamp(0.0, 1.0)
            ),
            share: r.share,
        })
        .collect();
    let term = EffectTerm {
        joints: joints.clone(),
        amplitude,
        sigma,
        scale,
        ..unit_term(accepted.effect, accepted.place, accepted.shape.clone())
    };
    let mut finding = Finding {
        effect: accepted.effect.id().into(),
        joints,
        confidence: accepted.confidence,
        significance: accepted.significance,
        parameters: parameters.iter().map(|p| (p.name.clone(), p.into())).collect(),
        held_out_before: before,
        held_out_after: after,
        share,
        alternatives,
        sentence: String::new(),
        curve,
        term,
        contacts: Vec::new(),
    };
    finding.sentence = words::sentence(robot, accepted.effect, &finding);
    finding
}

pub(in crate::diagnosis) fn contact_finding(contacts: &Contacts) -> Finding {
    let largest = contacts.wrenches.iter().max_by(|a, b| norm(a.force).total_cmp(&norm(b.force)));
    let mut parameters = std::collections::BTreeMap::new();
    let value = |value: f64, unit: &str| ParameterValue { value, sigma: 0.0, unit: unit.into() };
    parameters.insert("windows".into(), value(contacts.wrenches.len() as f64, "1"));
    if let Some(w) = largest.filter(|w| norm(w.force) > 0.0) {
        parameters.insert("largest_force".into(), value(norm(w.force), "N"));
        parameters.insert("link".into(), value(w.link as f64, "1"));
    }
    let joints = contacts.wrenches.iter().flat_map(|w| &w.joint_torques);
    if let Some(most) = joints.max_by(|a, b| a.largest.abs().total_cmp(&b.largest.abs())) {
        let torque = ParameterValue { value: most.largest, sigma: most.sigma, unit: "N.m".into() };
        parameters.insert("largest_joint_torque".into(), torque);
        parameters.insert("joint".into(), value(most.joint as f64, "1"));
    }
    let (before, after) =
        ((contacts.before / contacts.torque).sqrt(), (contacts.after / contacts.torque).sqrt());
    let mut finding = Finding {
        effect: EffectKind::Contact.id().into(),
        joints: Vec::new(),
        confidence: (1.0 - contacts.doubt).clamp(0.0, 0.9999),
        significance: 0.0,
        parameters,
        held_out_before: before,
        held_out_after: after,
        share: 1.0 - contacts.after / contacts.before,
        alternatives: Vec::new(),
        sentence: String::new(),
        curve: None,
        term: EffectTerm {
            wrenches: contacts.wrenches.clone(),
            ..unit_term(EffectKind::Contact, Place::Robot, Vec::new())
        },
        contacts: contacts.wrenches.clone(),
    };
    finding.sentence = words::contact(&finding);
    finding
}

fn norm(f: [f64; 3]) -> f64 {
    f.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The delay as a finding, where it explains enough.
fn delay_finding(search: &mut Search<'_, '_>, skew: f64, settings: &Settings) -> Option<Finding> {
    let side = &search.slow;
    let p = side.design.parameters;
    let with = hold_back(&side.design, &side.sigma, false);
    // The torque's own rate of change, as much of it as the skew moved.
    let column = side.design.columns[p].clone();
    let mut without = side.design.clone();
    without.columns.remove(p);
    let taken = skew - side.fit.chi[p];
    without.y = side.design.y.iter().zip(&column).map(|(y, c)| y + taken * c).collect();
    without.refresh();
    let unaware = hold_back(&without, &side.sigma, false);
    let all: Vec<usize> = (0..side.design.joints).collect();
    let weigh = |h: &HeldBack| -> f64 { h.left.iter().zip(&side.sigma).map(|(l, s)| l / (s * s)).sum() };
    let share = 1.0 - weigh(&with) / weigh(&unaware);
    if share < settings.least_share {
        return None;
    }
    let variance = side.fit.variances()[p].max(0.0);
    let per_block = side.design.rows_within(LONGEST_BLOCK);
    let blocks: BTreeSet<_> = side.design.rows.iter().map(|&r| side.design.block(r, per_block)).collect();
    let evidence =
        Evidence::student(skew.abs() / variance.sqrt().max(1e-300), blocks.len().saturating_sub(1) as f64);
    let mut finding = Finding {
        effect: EffectKind::TimeDelay.id().into(),
        joints: Vec::new(),
        confidence: evidence.confidence(1),
        significance: evidence.significance,
        parameters: [(
            "delay".to_string(),
            ParameterValue { value: skew, sigma: variance.sqrt(), unit: "s".into() },
        )]
        .into_iter()
        .collect(),
        held_out_before: unaware.error_on(&all),
        held_out_after: with.error_on(&all),
        share,
        alternatives: Vec::new(),
        sentence: String::new(),
        curve: None,
        term: EffectTerm {
            amplitude: vec![skew],
            sigma: vec![variance.sqrt()],
            ..unit_term(EffectKind::TimeDelay, Place::Variant(0), Vec::new())
        },
        contacts: Vec::new(),
    };
    finding.sentence = words::sentence(search.context.model.robot(), EffectKind::TimeDelay, &finding);
    Some(finding)
}
