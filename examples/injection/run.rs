//! One window with one law.

use std::fmt;
use std::time::Instant;

use dynid_runtime::confirmation::diagnose_and_confirm;
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::{Distortion, EffectKind, EffectTerm};
use dynid_runtime::model::Model;
use dynid_runtime::prediction::{Comparison, Predictor};
use dynid_runtime::recording::Trajectory;

use crate::draw::{draw, is_of_the_robot};
use crate::failure::Failure;
use crate::fit::{Fitted, fit};
use crate::options::Options;
use crate::random::Random;
use crate::residual::beside;

/// What windows are cut from.
pub struct Recordings<'a> {
    pub model: &'a dyn Model,
    pub motions: &'a [Trajectory],
    pub baseline: &'a [Trajectory],
}

/// One window and what is added to it.
pub struct Case {
    effect: Option<EffectKind>,
    size: f64,
    seed: u64,
}

impl Case {
    /// Every effect in every size with every seed.
    pub fn all(options: &Options) -> Result<Vec<Self>, Failure> {
        let mut cases = Vec::new();
        for seed in options.first_seed..options.first_seed + options.seeds {
            for id in &options.effects {
                let effect = EffectKind::from_id(id);
                if effect.is_none() && id != "none" {
                    return Err(format!("--effects {id}: the catalogue has no such effect").into());
                }
                let sizes = if effect.is_some() { &options.sizes[..] } else { &[0.0] };
                cases.extend(sizes.iter().map(|&size| Self { effect, size, seed }));
            }
        }
        Ok(cases)
    }

    pub fn effect_id(&self) -> String {
        self.effect.map_or("none", EffectKind::id).to_owned()
    }

    pub fn size_in_words(&self) -> String {
        self.effect.map_or_else(String::new, |_| format!("{}", self.size))
    }

    pub fn name(&self) -> String {
        format!("{} {} seed {}", self.effect_id(), self.size_in_words(), self.seed)
    }
}

/// What became of it.
pub struct Outcome {
    /// Joint numbers of the law; empty where it is of the whole robot.
    joints: Vec<usize>,
    /// What is seen of the law beside what was left anyway.
    visible: f64,
    pub named: bool,
    pub cannot_tell: bool,
    pub detected: bool,
    /// What was named besides, and is not named without the law.
    pub others: Vec<String>,
    /// What is named without the law.
    background: Vec<String>,
    seconds: f64,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match (self.named, self.cannot_tell, self.detected) {
            (true, ..) => "named",
            (_, true, _) => "not told apart",
            (_, _, true) => "called otherwise",
            _ => "missed",
        };
        write!(f, "{word} on joint {:?} at {:.2}, ", self.joints, self.visible)?;
        write!(f, "besides {:?}, without it {:?}, {:.1} s", self.others, self.background, self.seconds)
    }
}

/// Cuts the window, adds the law, diagnoses with and without it.
pub fn run(recordings: &Recordings<'_>, case: &Case, options: &Options) -> Result<Outcome, Failure> {
    let model = recordings.model;
    let mut random = Random::of(&[&case.effect_id(), &case.size_in_words()], case.seed);
    let (window, test) = cut(recordings.motions, options, &mut random)?;
    let plain = [window];
    let before = found(recordings, &plain, &test)?;
    let background: Vec<String> = before.findings.iter().map(|f| name(&f.effect, &f.joints)).collect();
    let Some(effect) = case.effect else {
        let outcome = Outcome {
            joints: Vec::new(),
            visible: 0.0,
            named: false,
            cannot_tell: false,
            detected: false,
            others: background.clone(),
            background,
            seconds: 0.0,
        };
        return Ok(outcome);
    };
    let known = match recordings.baseline {
        [] => None,
        baseline => Some(fit(model, baseline, None)?.chi),
    };
    let fitted = fit(model, &plain, known.as_deref())?;
    let mut term = draw(effect, model, &fitted.motions, &fitted.chi, &mut random).ok_or("no place for it")?;
    let visible = resize(model, &plain, &fitted, &mut term, (case.size, known.as_deref()))?;
    let with = [added(model, &plain[0], &fitted, &term)?];
    // The law stays in the motion that findings are tested on.
    let test: Vec<Trajectory> = match test.first() {
        Some(t) => vec![added(model, t, &fit(model, &test, Some(&fitted.chi))?, &term)?],
        None => Vec::new(),
    };
    let start = Instant::now();
    let after = found(recordings, &with, &test)?;
    let here = |joints: &[usize]| {
        is_of_the_robot(term.place) && term.joints.is_empty()
            || joints.is_empty()
            || term.joints.iter().any(|j| joints.contains(j))
    };
    let is_it = |effect: &str, joints: &[usize]| effect == term.effect.id() && here(joints);
    let findings = &after.findings;
    let others = findings.iter().filter(|f| !is_it(&f.effect, &f.joints));
    Ok(Outcome {
        joints: term.joints.clone(),
        visible,
        named: findings.iter().any(|f| is_it(&f.effect, &f.joints)),
        cannot_tell: after
            .cannot_tell
            .iter()
            .any(|c| here(&c.joints) && c.between.iter().any(|e| e == term.effect.id())),
        detected: findings.iter().any(|f| here(&f.joints)),
        others: others.map(|f| name(&f.effect, &f.joints)).filter(|n| !background.contains(n)).collect(),
        background,
        seconds: start.elapsed().as_secs_f64(),
    })
}

fn name(effect: &str, joints: &[usize]) -> String {
    format!("{effect}@{}", joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(","))
}

fn found(
    recordings: &Recordings<'_>,
    motions: &[Trajectory],
    test: &[Trajectory],
) -> Result<Diagnosis, Failure> {
    let mut settings = Settings::default();
    settings.threads = 1;
    let (model, baseline) = (recordings.model, recordings.baseline);
    if test.is_empty() {
        return Ok(diagnose(model, motions, baseline, &settings, &Silent)?);
    }
    let test = Comparison::default().prepare(test)?;
    Ok(diagnose_and_confirm(model, motions, baseline, &test, &settings, &Silent)?)
}

/// A random window of one of the motions, and the part that is kept for the test.
fn cut(
    motions: &[Trajectory],
    options: &Options,
    random: &mut Random,
) -> Result<(Trajectory, Vec<Trajectory>), Failure> {
    let bounds = |m: &Trajectory| Some([*m.time.first()?, *m.time.last()?]);
    let room = |m: &Trajectory| {
        bounds(m).map_or(0.0, |[from, to]| (1.0 - options.test) * (to - from) - options.seconds)
    };
    let long: Vec<&Trajectory> = motions.iter().filter(|m| room(m) >= 0.0).collect();
    let motion = *long.get(random.below(long.len())).ok_or("no motion is as long as --seconds")?;
    let [first, last] = bounds(motion).ok_or("a motion without rows")?;
    let from = first + random.share() * room(motion);
    let window = motion.within([from, from + options.seconds]).ok_or("a window without rows")?;
    let kept = last - options.test * (last - first);
    let test =
        if options.test > 0.0 { motion.within([kept, last]).into_iter().collect() } else { Vec::new() };
    Ok((window, test))
}

/// Brings a law to the size that is wanted; returns what is then seen of it.
fn resize(
    model: &dyn Model,
    plain: &[Trajectory],
    fitted: &Fitted,
    term: &mut EffectTerm,
    (wanted, known): (f64, Option<&[f64]>),
) -> Result<f64, Failure> {
    let mut seen = 0.0;
    // The first torque may be far from the joint's: from there it is about proportional.
    let torque = added(model, &plain[0], fitted, term)?;
    let most = torque
        .torque
        .iter()
        .zip(&plain[0].torque)
        .zip(&fitted.residual)
        .map(|((with, without), residual)| {
            let squares: f64 = with.iter().zip(without).map(|(a, b)| (a - b).powi(2)).sum();
            (squares / with.len().max(1) as f64).sqrt() / residual.max(1e-12)
        })
        .fold(0.0, f64::max);
    let mut factor = 2.0 * wanted / most.max(1e-12);
    for _ in 0..5 {
        term.amplitude.iter_mut().for_each(|a| *a *= factor);
        let with = fit(model, &[added(model, &plain[0], fitted, term)?], known)?;
        let left = with.residual.iter().zip(&fitted.residual);
        seen = left.map(|(r, r0)| beside(*r, *r0, *r0)).fold(0.0, f64::max);
        factor = (wanted / seen.max(0.1 * wanted)).min(10.0);
        if (factor - 1.0).abs() < 0.1 {
            break;
        }
    }
    Ok(seen)
}

/// A recorded motion with the torque of a law in it.
fn added(
    model: &dyn Model,
    plain: &Trajectory,
    fitted: &Fitted,
    term: &EffectTerm,
) -> Result<Trajectory, Failure> {
    let motion = fitted.motions.first().ok_or("the motion is too short for the filters")?;
    let effects = std::slice::from_ref(term);
    let without = Predictor { chi: &fitted.chi, effects: &[], delay: 0.0 }.torques(model, motion)?;
    let is_skew = term.distortion() == Some(Distortion::Skew);
    let delay = if is_skew { term.amplitude.iter().sum() } else { 0.0 };
    let with = Predictor { chi: &fitted.chi, effects, delay }.torques(model, motion)?;
    let mut out = plain.clone();
    for (j, torque) in out.torque.iter_mut().enumerate() {
        for (t, value) in plain.time.iter().zip(torque) {
            let at = ((t - motion.start) * motion.rate).clamp(0.0, (with[j].len() - 1) as f64);
            let (low, part) = (at.floor() as usize, at.fract());
            let high = (low + 1).min(with[j].len() - 1);
            let law = |k: usize| with[j][k] - without[j][k];
            *value += (1.0 - part) * law(low) + part * law(high);
        }
    }
    Ok(out)
}
