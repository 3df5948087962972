//! A case is simulated and diagnosed, and what was found is compared with what was hidden.

use std::sync::Arc;
use std::time::Instant;

use dynid::models;
use dynid_runtime::diagnosis::{Diagnosis, Finding, Reference, Settings, Silent, diagnose};
use dynid_runtime::effects::EffectKind;
use serde::{Deserialize, Serialize};

use crate::case::{Before, Case};
use crate::failure::Failure;
use crate::hide::{Hidden, recordings};
use crate::pushes::{Told, told};

/// How a case ended.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Score {
    /// What was hidden, and whether it was found: something on its joint, itself on its joint, or among what cannot
    /// be told apart there.
    pub hidden: Vec<(Hidden, Outcome)>,
    /// Findings that are none of the hidden effects on its joint.
    pub others: Vec<(String, Vec<usize>)>,
    /// Effects found anywhere, each once.
    pub found: Vec<String>,
    /// Of each finding its confidence, and whether it is one of the hidden effects on its joint.
    pub told: Vec<(f64, bool)>,
    /// Of the quantities of hidden effects that were named: effect, quantity, and how far the value is from the truth in
    /// its standard deviations.
    pub numbers: Vec<(String, String, f64)>,
    /// Why there is no diagnosis.
    pub refused: Option<String>,
    /// Time of the diagnosis, s.
    pub seconds: f64,
    /// Time of simulation and diagnosis, s.
    pub whole: f64,
}

impl Score {
    pub fn not_simulated() -> Self {
        Self { refused: Some("it could not be simulated".to_owned()), ..Self::default() }
    }

    /// Whether everything hidden was named, and nothing else.
    pub fn solved(&self) -> bool {
        self.refused.is_none() && self.others.is_empty() && self.hidden.iter().all(|(_, o)| o.named)
    }
}

/// What became of a hidden effect.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Something was found on the joint.
    pub detected: bool,
    /// The effect itself was found on its joint.
    pub named: bool,
    /// The effect is among those that the diagnosis says it cannot tell apart there.
    pub cannot_tell: bool,
    /// The effect is among those that the diagnosis says are there and too small to be named.
    pub small: bool,
    /// A contact that was found at its time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub push: Option<Told>,
}

/// Simulates, diagnoses, and only then compares.
pub fn score(case: &Case) -> Result<Score, Failure> {
    let model = models::find(&case.robot).ok_or("no such robot")?;
    let whole = Instant::now();
    let recordings = recordings(model, case, false)?;
    let mut settings = Settings::default();
    settings.threads = 1;
    let start = Instant::now();
    if case.reference.is_some() {
        let before = diagnose(model, &recordings.baseline, &[], &settings, &Silent)?;
        settings.reference = Reference::of(&before).map(Arc::new);
    }
    let alone = case.reference == Some(Before::Model);
    let baseline = if alone { &[] } else { recordings.baseline.as_slice() };
    let found = diagnose(model, &recordings.motions, baseline, &settings, &Silent);
    let mut score = Score { seconds: start.elapsed().as_secs_f64(), ..Score::default() };
    match found {
        Ok(found) => compare(&found, recordings.hidden, &mut score),
        Err(refusal) => {
            score.hidden = recordings.hidden.into_iter().map(|h| (h, Outcome::default())).collect();
            score.refused = Some(refusal.to_string());
        }
    }
    score.whole = whole.elapsed().as_secs_f64();
    Ok(score)
}

fn compare(found: &Diagnosis, hidden: Vec<Hidden>, score: &mut Score) {
    let here = |hidden: &Hidden, joints: &[usize]| {
        joints.is_empty() || hidden.joint.is_none_or(|joint| joints.contains(&joint))
    };
    let here_is = |h: &Hidden, f: &Finding| {
        let over = h.outside.as_ref().is_none_or(|what| what.is_over(&f.variables));
        f.effect == h.effect.id() && here(h, &f.joints) && over
    };
    let besides = |h: &Hidden, f: &Finding| {
        let also = h.outside.iter().flat_map(|what| &what.also);
        also.into_iter().any(|(effect, joint)| *effect == f.effect && f.joints == [*joint])
    };
    for finding in &found.findings {
        if !score.found.contains(&finding.effect) {
            score.found.push(finding.effect.clone());
        }
        let truth = hidden.iter().find(|h| here_is(h, finding) || besides(h, finding));
        score.told.push((finding.confidence, truth.is_some()));
        match truth {
            Some(truth) => score.numbers.extend(deviations(finding, truth)),
            None => {
                let over = finding.variables.join(" and ");
                let effect = finding.effect.clone();
                let what = if over.is_empty() { effect } else { format!("{effect}({over})") };
                score.others.push((what, finding.joints.clone()));
            }
        }
    }
    score.hidden = hidden
        .into_iter()
        .map(|h| {
            let id = h.effect.id();
            let push = told(found, &h);
            // Something outside is not found where it is found at another time.
            let at_its_time = h.effect != EffectKind::Contact || push.is_some();
            let outcome = Outcome {
                push,
                detected: found.findings.iter().any(|f| here(&h, &f.joints)),
                named: at_its_time && found.findings.iter().any(|f| here_is(&h, f)),
                cannot_tell: found
                    .cannot_tell
                    .iter()
                    .any(|c| here(&h, &c.joints) && c.between.iter().any(|effect| effect == id)),
                small: found.small.iter().any(|s| here(&h, &s.joints) && s.effect == id),
            };
            (h, outcome)
        })
        .collect();
}

/// How far the quantities that were drawn and that have a standard deviation are from the truth, in those.
fn deviations(finding: &Finding, truth: &Hidden) -> Vec<(String, String, f64)> {
    let own = |(name, value): &(&'static str, f64)| {
        let told = finding.parameters.get(*name).filter(|p| p.sigma > 0.0 && p.sigma.is_finite())?;
        let value = value * as_told(finding, truth, name);
        Some((finding.effect.clone(), (*name).to_owned(), (told.value - value) / told.sigma))
    };
    truth.numbers.iter().filter_map(own).collect()
}

/// What a hidden number is multiplied by to mean what the finding's means: a friction f at a speed v0 that grows with
/// the power p of the speed is told at the finding's own v0.
fn as_told(finding: &Finding, truth: &Hidden, name: &str) -> f64 {
    let drawn =
        |wanted: &str| truth.numbers.iter().find(|(name, _)| *name == wanted).map(|(_, value)| *value);
    match (name, drawn("v0"), drawn("p"), finding.parameters.get("v0")) {
        ("f", Some(speed), Some(power), Some(told)) => (told.value / speed).powf(power),
        _ => 1.0,
    }
}
