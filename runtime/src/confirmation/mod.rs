//! A diagnosis that another recording has a say in: what makes motion worse that it was not fitted to is not reported.
//!
//! Evidence inside one recording cannot exclude that a law imitates something that this motion has and other motion has
//! not. Where there is a test recording, each finding is therefore held against it: the part of it that is there
//! ([`OnTest`]) must be more than one half, or its joints are predicted worse with it; it must be told from nothing where
//! the motion could have shown it; it must not certainly make the other joints worse; and a factor must be the same. That is
//! asked with the parameters that were found beside it: those of a model without it imitate it on several joints. Joints of which
//! the model predicts no more than zero torques would are not asked. What fails
//! is taken out, and the search goes on without it; where all of it may be there and the motion does not tell, it stays a rival
//! of what is looked for then. The test recording then no longer is one for what was chosen by it: of a
//! finding that stays, only that it did not fail is known from it.

mod intervals;
mod late;
mod slope;

use crate::diagnosis::{
    Diagnosis, DiagnosisError, Finding, Objection, OnTest, Progress, Refuted, Settings, diagnose_despite,
};
use crate::effects::{EffectKind, EffectTerm, SmoothingWindow};
use crate::model::{JointNumber, Model};
use crate::prediction::{Evaluation, PredictionError, Predictor, Prepared, evaluate};
use crate::recording::Trajectory;
use intervals::Intervals;
use slope::{Judgement, Slope};

/// Why there is no confirmed diagnosis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConfirmationError {
    /// The recording supports no diagnosis.
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
    /// The test recording cannot be predicted.
    #[error(transparent)]
    Test(#[from] PredictionError),
}

/// Diagnoses a recording as [`diagnose`](crate::diagnosis::diagnose) does, and takes out what the test recording does
/// not show: see [`Diagnosis::refuted`].
///
/// # Errors
/// [`ConfirmationError`] where [`diagnose`](crate::diagnosis::diagnose) fails, or the test recording cannot be predicted.
pub fn diagnose_and_confirm(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    test: &Prepared,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, ConfirmationError> {
    let mut refuted: Vec<Refuted> = Vec::new();
    let mut failed = None;
    let mut objections = |diagnosis: &mut Diagnosis| {
        let failing = held_against_test(model, diagnosis, test).unwrap_or_else(|error| {
            failed = Some(error);
            Vec::new()
        });
        let object = |(k, reason, still_possible): (usize, Refuted, bool)| {
            refuted.push(reason);
            Objection::to(&diagnosis.findings[k], still_possible)
        };
        failing.into_iter().map(object).collect()
    };
    let recordings = [trajectories, baseline];
    let mut diagnosis = diagnose_despite(model, recordings, &mut objections, settings, progress)?;
    if let Some(error) = failed {
        return Err(error.into());
    }
    // What was refuted beside other laws, and holds beside those that took their place, is found.
    let is_found =
        |r: &Refuted| diagnosis.findings.iter().any(|f| (&f.effect, &f.joints) == (&r.effect, &r.joints));
    refuted.retain(|r| !is_found(r));
    diagnosis.verdict.extend(words(&refuted));
    diagnosis.refuted = refuted;
    Ok(diagnosis)
}

/// What was taken out and why, for a person; nothing where nothing was.
fn words(refuted: &[Refuted]) -> Option<String> {
    let one = |r: &Refuted| {
        let title = EffectKind::name_of(&r.effect);
        let joints: Vec<String> = r.joints.iter().map(ToString::to_string).collect();
        let place =
            if joints.is_empty() { String::new() } else { format!(" on joint {}", joints.join(" and ")) };
        let part = match r.on_test.sigma {
            Some(sigma) => format!("{:.2} ± {sigma:.2}", r.on_test.part),
            None => format!("{:.2}", r.on_test.part),
        };
        let errors = format!("{:.2} % to {:.2} %", 100.0 * r.test_before, 100.0 * r.test_after);
        let others = if r.harms_others { "; of the others it rises by more" } else { "" };
        format!("{title}{place} ({part} of it; error of its joints {errors}{others})")
    };
    let list: Vec<String> = refuted.iter().map(one).collect();
    (!list.is_empty())
        .then(|| format!("Not reported, because the test recording does not show it: {}.", list.join("; ")))
}

/// Finds out how much of each finding the test recording shows, and returns those that it does not show, and whether they may be
/// there all the same.
fn held_against_test(
    model: &dyn Model,
    diagnosis: &mut Diagnosis,
    test: &Prepared,
) -> Result<Vec<(usize, Refuted, bool)>, PredictionError> {
    let without: Vec<(usize, Vec<f64>, Vec<EffectTerm>)> = (0..diagnosis.findings.len())
        .filter_map(|k| without(diagnosis, k).map(|(chi, effects)| (k, chi, effects)))
        .collect();
    if without.is_empty() {
        return Ok(Vec::new());
    }
    let (all, delay) = (diagnosis.terms(), diagnosis.delay);
    let whole = Predictor { chi: &diagnosis.model.chi, effects: &all, delay };
    let mut predictors = vec![whole];
    predictors.extend(without.iter().map(|(_, chi, effects)| Predictor { chi, effects, delay }));
    // A factor by itself, with the parameters that were found beside it.
    let factors: Vec<(usize, Vec<EffectTerm>)> = (0..diagnosis.findings.len())
        .filter(|&k| diagnosis.findings[k].term.effect.properties().is_factor)
        .map(|k| (k, terms_but(diagnosis, k)))
        .collect();
    let first_factor = predictors.len();
    predictors.extend(factors.iter().map(|(_, effects)| Predictor { effects, ..whole }));
    let mut evaluation = evaluate(model, &predictors, &test.motions, &test.settings, &[])?;
    late::leave_out_rest(&mut evaluation.rows, delay);
    let mut failing = Vec::new();
    let mut parts = Vec::new();
    for (which, (k, ..)) in without.iter().enumerate().map(|(i, w)| (i + 1, w)) {
        let finding = &diagnosis.findings[*k];
        let joints = joints_of(model, finding);
        let intervals = Intervals::new(&finding.term, model.robot().joints(), &test.motions);
        let slope_of = |which, joints| Slope::of(&evaluation, [which, 0], joints, &intervals);
        let slope_on = |joints| slope_of(which, joints);
        let Some(slope) = slope_on(Some(&joints)) else { continue };
        // Zero torques would be as good: the test asks for parameters that the recording does not determine.
        if error_on(model, finding, &evaluation, which) >= 1.0 {
            continue;
        }
        let models = [predictors[which], predictors[0]];
        if finding.term.effect.properties().window == SmoothingWindow::Fast
            && !shows(model, finding, models, test, (&evaluation, [which, 0]))?
        {
            continue;
        }
        let on_test = OnTest { part: slope.value, sigma: slope.sigma, units: slope.units };
        parts.push((*k, on_test));
        // By the parameters that joints share it may show, or do harm, on others.
        let on_all = slope_on(None);
        let own = slope.judgement();
        let harms_others = own == Judgement::Stands && on_all.as_ref().is_some_and(Slope::certainly_harms);
        let factor = factors.iter().position(|(factor, _)| factor == k);
        let is_another = factor.is_some_and(|i| {
            let numbers = finding.term.sigma.iter().zip(&finding.term.amplitude);
            let known = numbers.map(|(sigma, a)| sigma / a.abs()).fold(0.0, f64::max);
            slope_of(first_factor + i, Some(&joints)).is_some_and(|slope| slope.certainly_differs(known))
        });
        let fails = match own {
            Judgement::Stands => harms_others || is_another,
            Judgement::Harms => true,
            Judgement::NotSeen => on_all.is_none_or(|s| s.judgement() != Judgement::Stands),
        };
        if fails {
            let [test_before, test_after] = [which, 0].map(|m| error_on(model, finding, &evaluation, m));
            let (effect, joints) = (finding.effect.clone(), finding.joints.clone());
            let still_possible = own != Judgement::Stands && slope.may_be_whole();
            let reason = Refuted { effect, joints, test_before, test_after, on_test, harms_others };
            failing.push((*k, reason, still_possible));
        }
    }
    for (k, on_test) in parts {
        diagnosis.findings[k].on_test = Some(on_test);
    }
    Ok(failing)
}

/// Least part of what a law does at the full rate that rows must keep to say something about it. Judgement: where most
/// of it is smoothed away, what is left of it depends on the smoothing.
const KEPT_BY_ROWS: f64 = 0.5;

/// Whether the rows of a comparison show what a finding does: a wave that is faster than they are, they do not.
fn shows(
    model: &dyn Model,
    finding: &Finding,
    models: [Predictor<'_>; 2],
    test: &Prepared,
    (evaluation, which): (&Evaluation, [usize; 2]),
) -> Result<bool, PredictionError> {
    let joints = joints_of(model, finding);
    let mean = |(sum, count): (f64, usize)| sum / count.max(1) as f64;
    let (mut at_full_rate, mut on_rows) = ((0.0, 0), (0.0, 0));
    for motion in &test.motions {
        let [without, with] = [models[0].torques(model, motion)?, models[1].torques(model, motion)?];
        for &j in &joints {
            for (a, b) in without[j].iter().zip(&with[j]) {
                at_full_rate = (at_full_rate.0 + (a - b).powi(2), at_full_rate.1 + 1);
            }
        }
    }
    for rows in evaluation.rows.iter().filter(|r| joints.contains(&r.joint)) {
        for t in (0..rows.used.len()).filter(|&t| rows.used[t]) {
            let change = rows.predicted[which[0]][t] - rows.predicted[which[1]][t];
            on_rows = (on_rows.0 + change * change, on_rows.1 + 1);
        }
    }
    Ok(mean(on_rows).sqrt() >= KEPT_BY_ROWS * mean(at_full_rate).sqrt())
}

/// Joints of a finding, counted from 0; all of them for the whole robot.
fn joints_of(model: &dyn Model, finding: &Finding) -> Vec<usize> {
    let robot = model.robot();
    if finding.joints.is_empty() {
        return (0..robot.joints()).collect();
    }
    finding.joints.iter().filter_map(|&j| Some(robot.joint_index(JointNumber(j))?.0)).collect()
}

/// Parameters and effects without a finding; `None` for what is no law of the robot (pushes) or is wrong with
/// the recording alone.
fn without(diagnosis: &Diagnosis, k: usize) -> Option<(Vec<f64>, Vec<EffectTerm>)> {
    let finding = &diagnosis.findings[k];
    match (finding.term.effect, &finding.without) {
        (EffectKind::Contact, _) => None,
        (_, Some(without)) => {
            // What is no term of the fit, such as lines of a ripple, stays as it is.
            let lines = diagnosis.findings.iter().filter(|f| f.without.is_none()).map(|f| f.term.clone());
            let standing = diagnosis.standing.iter().map(|s| s.term.clone());
            Some((
                without.chi.clone(),
                without.effects.iter().cloned().chain(lines).chain(standing).collect(),
            ))
        }
        (_, None) if finding.term.distortion().is_some() => None,
        (_, None) => Some((diagnosis.model.chi.clone(), terms_but(diagnosis, k))),
    }
}

/// The terms of a model but for that of a finding.
fn terms_but(diagnosis: &Diagnosis, k: usize) -> Vec<EffectTerm> {
    let mut terms = diagnosis.terms();
    terms.remove(k);
    terms
}

/// Relative error of a model of an evaluation on the joints of a finding, of all joints for the whole robot.
fn error_on(model: &dyn Model, finding: &Finding, evaluation: &Evaluation, which: usize) -> f64 {
    let joints = joints_of(model, finding);
    let (mut left, mut whole) = (0.0, 0.0);
    for rows in evaluation.rows.iter().filter(|r| joints.contains(&r.joint)) {
        for (t, y) in rows.measured.iter().enumerate().filter(|(t, _)| rows.used[*t]) {
            left += (y - rows.predicted[which][t]).powi(2);
            whole += y * y;
        }
    }
    if whole > 0.0 { f64::sqrt(left / whole) } else { 0.0 }
}
