//! Diagnosis: locate the mismatch between a model and a recording, name the physics that was left out, add it, and
//! show on motion that was held back that the fit got better.
//!
//! 1. Windows in which something outside pushed the robot are found and set aside.
//! 2. Rows at two paces: smoothed as slow as the motion (friction, load, springs, bodies), and faster (ripple,
//!    elasticity, backlash).
//! 3. Every effect of the catalogue, at every place and with a grid of shapes, is tried together with all standard
//!    parameters, and judged on motion that was held back; the best that holds becomes part of the model; then again.
//!    On a short recording, where one law hides another, two of a joint are tried together.
//! 4. What was accepted is reconsidered, pruned and explained.

#![allow(
    clippy::needless_range_loop,
    reason = "joints, segments and matrix entries are numbered as in the equations"
)]

mod candidates;
mod contact;
mod explanation;
mod judging;
mod outcome;
mod predict;
mod rows;
pub mod scoring;
mod search;
mod settings;

pub use outcome::{
    Alternative, CannotTell, Curve, Diagnosis, Errors, Estimated, Finding, HeldOut, Mismatch, OrderSpectrum,
    ParameterShift, ParameterValue, TorqueSeries, Unexplained,
};
pub use predict::term_torques;
pub use settings::{DiagnosisError, Progress, Settings, Silent};

use crate::effects::{EffectKind, EffectTerm, Place};
use crate::model::Model;
use crate::recording::Trajectory;
use contact::search as contact_search;
use explanation::explain;
use rows::context::{Context, scales, top_speeds};
use rows::design::{Design, Plan};
use rows::fit;
use rows::signals::{Signals, directions};
use search::state::Search;

/// Stretches that few motions are split into, all together.
const STRETCHES: usize = 8;
/// From this many motions on, whole motions are held back.
const ENOUGH_MOTIONS: usize = 3;
/// A recording shorter than this has no rows to spare, s: slow effects are smoothed no more than fast ones.
const SHORT: f64 = 12.0;
/// A delay is named from this many samples and seconds; a smaller one is part of sampling and silently taken out.
const NAMED_DELAY: (f64, f64) = (0.75, 1e-3);

/// Diagnoses a recording; `baseline` are motions of the same robot before it changed, empty where there are none.
///
/// With a baseline only what changed is looked for. Errors where the data cannot support an answer.
pub fn diagnose(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnosisError> {
    examine(model, trajectories, baseline, None, settings, progress)
}

/// Fits known effects, on a joint (0-based) where one is given, instead of looking for any: their shapes and
/// amplitudes come from the recording. What [`diagnose`] would ideally find.
pub fn fit_known(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    known: &[(EffectKind, Option<usize>)],
    settings: &Settings,
) -> Result<Diagnosis, DiagnosisError> {
    examine(model, trajectories, baseline, Some(known), settings, &Silent)
}

fn examine(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    known: Option<&[(EffectKind, Option<usize>)]>,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnosisError> {
    if trajectories.is_empty() {
        return Err(DiagnosisError::NoMotion);
    }
    progress.at(0.0, "signals");
    let n = model.robot().joints();
    let forms = directions(model.robot());
    let change = !baseline.is_empty();
    let mut delay = 0.0;
    let (cutoff, settings) = settings::fitted_to(settings, trajectories)?;
    let settings = &settings;
    let mut signals = prepare_all(baseline, trajectories, delay, cutoff)?;
    let given = settings::given_speeds(settings, n)?;
    let slowest = match &given {
        Some(speeds) => speeds.clone(),
        None => top_speeds(&signals, n).iter().map(|v| settings.standstill * v).collect(),
    };
    let duration: f64 = signals.iter().map(|s| s.len() as f64 / s.rate).sum();
    let short = duration < SHORT;
    let slow_window = if short { settings.fast_window } else { settings.slow_window };
    let motions = trajectories.len();
    let chunks = if motions < ENOUGH_MOTIONS { STRETCHES / motions } else { 1 };
    let nothing = vec![Vec::new(); signals.len()];
    // The narrower window needs less margin to a standstill.
    let fast_limits: Vec<f64> =
        if given.is_some() { slowest.clone() } else { slowest.iter().map(|v| v / 1.5).collect() };
    let plan = |half: f64| Plan {
        half,
        slowest: if half < settings.slow_window { &fast_limits } else { &slowest },
        directions: &forms,
        chunks,
        excluded: &nothing,
    };
    let open = Design::new(model, &signals, &plan(settings.slow_window));
    check(model, &open)?;
    let mut sigma = vec![1.0; n];
    let first = fit::fit_weighted(&open, &mut sigma, |_| true);
    let chi: Vec<f64> = first.chi.iter().take(open.parameters).copied().collect();
    check_fit(model, &open, &first, &sigma)?;

    // A skew of more than a sample is taken out of the signals themselves.
    for _ in 0..2 {
        let found = {
            let context = Context::new(model, &signals, scales(model, &signals, &chi), chi.clone())?;
            let design = Design::new(model, &signals, &plan(settings.slow_window));
            explain::delay_of(&context, design)
        };
        let rate = signals.iter().map(|s| s.rate).fold(f64::INFINITY, f64::min);
        if found.abs() * rate < 0.75 {
            break;
        }
        delay += found;
        signals = prepare_all(baseline, trajectories, delay, cutoff)?;
    }
    progress.at(0.05, "contacts");
    let mut context = Context::new(model, &signals, scales(model, &signals, &chi), chi.clone())?;
    let aligned = Design::new(model, &signals, &plan(settings.slow_window));
    let mut contacts = contact_search::find(&context, &aligned, &signals);
    let diagnosis = loop {
        let excluded = contacts.as_ref().map_or(&nothing, |c| &c.windows);
        let slow = Design::new(model, &signals, &Plan { excluded, ..plan(slow_window) });
        let fast = if short {
            slow.clone()
        } else {
            Design::new(model, &signals, &Plan { excluded, ..plan(settings.fast_window) })
        };
        if contacts.is_some() {
            let fit = fit::fit_weighted(&slow, &mut sigma, |_| true);
            let chi: Vec<f64> = fit.chi.iter().take(slow.parameters).copied().collect();
            context.update(chi);
        }
        progress.at(0.1, "candidates");
        let mut search = Search::new(&mut context, slow, fast, slowest.clone(), change, settings, progress)?;
        let bare = explain::Bare::new(&search, &aligned);
        match known {
            Some(known) => search.force(known),
            None => search.run(settings, progress),
        }
        if let Some(found) = &contacts
            && !contact_search::remain(
                found,
                &aligned,
                &search.residual_on(&aligned),
                &search.slow.sigma,
                &signals,
            )
        {
            // What looked like pushes from outside is explained by what is now in the model.
            contacts = None;
            context.update(chi.clone());
            continue;
        }
        progress.at(0.92, "explanations");
        break explain::explain(model, search, &bare, contacts.as_ref(), delay, settings)?;
    };
    progress.at(1.0, "done");
    Ok(diagnosis)
}

/// Speeds below which a joint counts as standing still in a recording, rad/s or m/s.
pub fn slowest_speeds(
    model: &dyn Model,
    trajectories: &[Trajectory],
    settings: &Settings,
) -> Result<Vec<f64>, DiagnosisError> {
    let (cutoff, settings) = settings::fitted_to(settings, trajectories)?;
    if let Some(speeds) = settings::given_speeds(&settings, model.robot().joints())? {
        return Ok(speeds);
    }
    let signals = prepare_all(&[], trajectories, 0.0, cutoff)?;
    Ok(top_speeds(&signals, model.robot().joints()).iter().map(|v| settings.standstill * v).collect())
}

/// Baseline first, then the recording that is diagnosed.
fn prepare_all(
    baseline: &[Trajectory],
    trajectories: &[Trajectory],
    delay: f64,
    cutoff: f64,
) -> Result<Vec<Signals>, DiagnosisError> {
    let old = baseline.iter().map(|t| Signals::new(t, false, delay, cutoff));
    old.chain(trajectories.iter().map(|t| Signals::new(t, true, delay, cutoff))).collect()
}

/// Refuses motions that leave a joint without rows.
fn check(model: &dyn Model, design: &Design) -> Result<(), DiagnosisError> {
    let robot = model.robot();
    for j in 0..design.joints {
        let rows = design.count(j, |g| design.segments[g].fresh);
        let needed = 40;
        if rows < needed {
            return Err(DiagnosisError::TooLittleMotion { joint: joint_number(robot, j), rows, needed });
        }
    }
    Ok(())
}

/// Refuses motions that do not determine the standard model, and recordings that it has nothing to do with.
fn check_fit(
    model: &dyn Model,
    design: &Design,
    fit: &fit::Fit,
    sigma: &[f64],
) -> Result<(), DiagnosisError> {
    let free: Vec<usize> = fit.undetermined(1e-4);
    let parameters = design.parameters;
    if free.len() * 4 > parameters {
        let names: Vec<String> = free
            .iter()
            .filter(|&&k| k < parameters)
            .map(|&k| model.robot().base[k].name.to_string())
            .collect();
        return Err(DiagnosisError::NotExciting { free: free.len(), parameters, names: names.join(", ") });
    }
    let mut left = 0.0;
    let mut all = 0.0;
    for (j, s) in sigma.iter().enumerate() {
        let rows = design.of_joint(j);
        left += s * s * rows.len() as f64;
        all += design.y[rows].iter().map(|y| y * y).sum::<f64>();
    }
    let explained = 100.0 * (1.0 - left / all.max(1e-300));
    if explained < 40.0 {
        return Err(DiagnosisError::AnotherRobot { explained });
    }
    Ok(())
}

/// Number j of the frame of a joint.
pub(crate) fn joint_number(robot: &crate::model::Robot, joint: usize) -> usize {
    1 + robot.joint_of_frame().iter().position(|f| *f == Some(joint)).unwrap_or(joint)
}

/// A term with unit amplitudes: what an effect at a place with a shape is.
fn unit_term(effect: EffectKind, place: Place, shape: Vec<f64>) -> EffectTerm {
    EffectTerm {
        effect,
        place,
        joints: Vec::new(),
        shape,
        amplitude: Vec::new(),
        sigma: Vec::new(),
        scale: None,
        wrenches: Vec::new(),
    }
}
