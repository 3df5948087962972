//! A diagnosis that another recording has a say in: what makes motion worse that it was not fitted to is not reported.
//!
//! Evidence inside one recording cannot exclude that a law imitates something that this motion has and other motion has
//! not. Where there is a test recording, each finding is therefore held against it: the torques of its joints must not
//! be predicted worse with it than by the model without it, everything else fitted anew. What fails is taken out,
//! and the diagnosis is made again without it. The test recording then no longer is one for what was
//! chosen by it: of a finding that stays, only that it did not fail is known from it.

use crate::diagnosis::{Diagnosis, DiagnosisError, Finding, Progress, Refuted, Settings, diagnose};
use crate::effects::{EffectKind, EffectTerm};
use crate::model::{JointNumber, Model};
use crate::prediction::{Evaluation, PredictionError, Predictor, Prepared, evaluate};
use crate::recording::Trajectory;

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

/// Diagnoses a recording as [`diagnose`] does, and takes out what makes the test recording worse: see
/// [`Diagnosis::refuted`].
///
/// # Errors
/// [`ConfirmationError`] where [`diagnose`] fails, or the test recording cannot be predicted.
pub fn diagnose_and_confirm(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    test: &Prepared,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, ConfirmationError> {
    let mut settings = settings.clone();
    let mut refuted: Vec<Refuted> = Vec::new();
    loop {
        let mut diagnosis = diagnose(model, trajectories, baseline, &settings, progress)?;
        let failing = failing(model, &diagnosis, test)?;
        if failing.is_empty() {
            diagnosis.verdict.extend(words(&refuted));
            diagnosis.refuted = refuted;
            return Ok(diagnosis);
        }
        for (k, reason) in failing {
            let term = &diagnosis.findings[k].term;
            settings.excluded.push((term.effect, term.place));
            refuted.push(reason);
        }
    }
}

/// What was taken out and why, for a person; nothing where nothing was.
fn words(refuted: &[Refuted]) -> Option<String> {
    let one = |r: &Refuted| {
        let title = EffectKind::from_id(&r.effect).map_or("", |kind| kind.words().title).to_lowercase();
        let joints: Vec<String> = r.joints.iter().map(ToString::to_string).collect();
        let place =
            if joints.is_empty() { String::new() } else { format!(" on joint {}", joints.join(" and ")) };
        format!("{title}{place} ({:.2} % to {:.2} %)", 100.0 * r.test_before, 100.0 * r.test_after)
    };
    let list: Vec<String> = refuted.iter().map(one).collect();
    (!list.is_empty()).then(|| {
        format!(
            "Not reported, because the test recording is predicted worse with it (error of its joints): {}.",
            list.join("; ")
        )
    })
}

/// The findings that make the test recording worse, and by how much.
fn failing(
    model: &dyn Model,
    diagnosis: &Diagnosis,
    test: &Prepared,
) -> Result<Vec<(usize, Refuted)>, PredictionError> {
    let all = diagnosis.terms();
    let with = Predictor { chi: &diagnosis.model.chi, effects: &all, delay: diagnosis.delay };
    let mut failing = Vec::new();
    for (k, finding) in diagnosis.findings.iter().enumerate() {
        let Some((chi, effects)) = without(diagnosis, k) else { continue };
        let without = Predictor { chi: &chi, effects: &effects, delay: diagnosis.delay };
        let evaluation = evaluate(model, &[without, with], &test.motions, &test.settings, &[])?;
        if !shows(model, finding, [without, with], test, &evaluation)? {
            continue;
        }
        let [before, after] = [0, 1].map(|which| evaluation.predictions[which].errors.per_joint.clone());
        // Each joint in units of its own error, so that a joint with small torques counts as much as any.
        let known = after.iter().zip(&before).filter_map(|(a, b)| Some(((*a)?, b.filter(|b| *b > 0.0)?)));
        let rise = known.map(|(a, b)| (a / b).powi(2) - 1.0);
        if rise.sum::<f64>() > 0.0 {
            let [test_before, test_after] = [0, 1].map(|which| error_on(model, finding, &evaluation, which));
            let (effect, joints) = (finding.effect.clone(), finding.joints.clone());
            failing.push((k, Refuted { effect, joints, test_before, test_after }));
        }
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
    evaluation: &Evaluation,
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
            let change = rows.predicted[0][t] - rows.predicted[1][t];
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

/// Parameters and effects without a finding; `None` for what is no law of the robot (pushes) or belongs to the model
/// with and without findings (the skew of the channels).
fn without(diagnosis: &Diagnosis, k: usize) -> Option<(Vec<f64>, Vec<EffectTerm>)> {
    let finding = &diagnosis.findings[k];
    match (finding.term.effect, &finding.without) {
        (EffectKind::Contact | EffectKind::TimeDelay, _) => None,
        (_, Some(without)) => {
            // What is no term of the fit, such as lines of a ripple, stays as it is.
            let lines = diagnosis.findings.iter().filter(|f| f.without.is_none()).map(|f| f.term.clone());
            Some((without.chi.clone(), without.effects.iter().cloned().chain(lines).collect()))
        }
        (_, None) => {
            let mut effects = diagnosis.terms();
            effects.remove(k);
            Some((diagnosis.model.chi.clone(), effects))
        }
    }
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
