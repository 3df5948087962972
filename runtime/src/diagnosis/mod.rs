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
mod search;
mod settings;

pub use outcome::{
    Alternative, CannotTell, Curve, Diagnosis, Errors, Estimated, Finding, HeldOut, Mismatch, NotJudged,
    OrderSpectrum, ParameterShift, ParameterValue, TorqueSeries, Unexplained,
};
pub use predict::{predict_errors, term_torques};
pub use settings::{DiagnosisError, Progress, Settings, Silent};

use crate::effects::{EffectKind, EffectTerm, Place};
use crate::model::Model;
use crate::recording::Trajectory;
use contact::search::{self as contact_search, Contacts};
use contact::{moving, standing};
use explanation::{explain, standstill};
use rows::context::{Context, scales, top_speeds};
use rows::design::{Design, Plan};
use rows::fit;
use rows::motion::{LEAST_ROWS, Moving, left_over};
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
    let slowest: Vec<f64> = top_speeds(&signals, n).iter().map(|v| settings.standstill * v).collect();
    let duration: f64 = signals.iter().map(|s| s.len() as f64 / s.rate).sum();
    let short = duration < SHORT;
    let slow_window = if short { settings.fast_window } else { settings.slow_window };
    let motions = trajectories.len();
    let chunks = if motions < ENOUGH_MOTIONS { STRETCHES / motions } else { 1 };
    let nothing = vec![Vec::new(); signals.len()];
    let all = Plan {
        half: settings.slow_window,
        slowest: &slowest,
        directions: &forms,
        chunks,
        excluded: &nothing,
    };
    let motion = Moving::of(&Design::new(model, &signals, &all));
    // What a joint without motion seems to do is noise.
    let slowest: Vec<f64> = slowest
        .iter()
        .zip(&motion.fitted)
        .map(|(v, fitted)| if *fitted { *v } else { f64::INFINITY })
        .collect();
    // The narrower window needs less margin to a standstill.
    let fast_limits: Vec<f64> = slowest.iter().map(|v| v / 1.5).collect();
    let plan = |half: f64| Plan {
        half,
        slowest: if half < settings.slow_window { &fast_limits } else { &slowest },
        directions: &forms,
        chunks,
        excluded: &nothing,
    };
    let mut open = Design::new(model, &signals, &plan(settings.slow_window));
    let mut sigma = vec![1.0; n];
    let mut first = fit::fit_weighted(&open, &mut sigma, |_| true);
    let left_over = check(model, &open, &first, &motion, &sigma)?;
    if !left_over.is_empty() {
        open.leave_out(&left_over);
        first = fit::fit_weighted(&open, &mut sigma, |_| true);
    }
    let design = |signals: &[Signals], plan: &Plan<'_>| {
        let mut design = Design::new(model, signals, plan);
        if !left_over.is_empty() {
            design.leave_out(&left_over);
        }
        design
    };
    check_fit(&open, &sigma)?;
    let chi: Vec<f64> = first.chi.iter().take(open.parameters).copied().collect();
    if !motion.judged.contains(&true) {
        let context = Context::new(model, &signals, scales(model, &signals, &chi), chi)?;
        let rest = standing::at_rest(&context, &motion.fitted, &slowest);
        let mut diagnosis = standstill::explain(&context, &rest, &motion, &first)?;
        standstill::name_not_judged(&mut diagnosis, model, &motion);
        return Ok(diagnosis);
    }

    // A skew of more than a sample is taken out of the signals themselves.
    for _ in 0..2 {
        let found = {
            let context = Context::new(model, &signals, scales(model, &signals, &chi), chi.clone())?;
            let rows = design(&signals, &plan(settings.slow_window));
            explain::delay_of(&context, rows)
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
    let aligned = design(&signals, &plan(settings.slow_window));
    let mut contacts = contact_search::find(&context, &aligned, &signals);
    // Pushes on single joints, looked for in what is left when the search is done.
    let mut pushed: Option<Contacts> = None;
    let mut scanned = false;
    let mut diagnosis = loop {
        let both = Contacts::joined(contacts.clone(), pushed.clone());
        let excluded = both.as_ref().map_or(&nothing, |c| &c.windows);
        let slow = design(&signals, &Plan { excluded, ..plan(slow_window) });
        let fast = if short {
            slow.clone()
        } else {
            design(&signals, &Plan { excluded, ..plan(settings.fast_window) })
        };
        if both.is_some() {
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
        if !scanned || pushed.is_some() {
            let excluded = contacts.as_ref().map_or(&nothing, |c| &c.windows);
            let all = design(&signals, &Plan { excluded, ..plan(settings.fast_window) });
            let found =
                moving::in_motion(search.context, &all, &search.residual_on(&all), &search.fast.sigma);
            if scanned {
                pushed = pushed.and_then(|p| moving::still_there(p, found.as_ref()));
            } else if found.is_some() {
                // What was found with the pushes among the rows is looked for again without them.
                (pushed, scanned) = (found, true);
                context.update(chi.clone());
                continue;
            }
        }
        progress.at(0.92, "explanations");
        let rest = standing::at_rest(search.context, &motion.fitted, &slowest);
        let contacts = Contacts::joined(Contacts::joined(contacts, pushed), rest.contacts(signals.len()));
        break explain::explain(model, search, &bare, contacts.as_ref(), delay, settings)?;
    };
    standstill::name_not_judged(&mut diagnosis, model, &motion);
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

/// Refuses motions that tell nothing. Returns the base parameters that are left out because the motion does not
/// determine them, where they are so many, or joints stand still, that small ones would be made up from noise.
fn check(
    model: &dyn Model,
    design: &Design,
    fit: &fit::Fit,
    moving: &Moving,
    sigma: &[f64],
) -> Result<Vec<usize>, DiagnosisError> {
    if !moving.fitted.contains(&true) {
        let most = moving.rows.iter().enumerate().max_by_key(|(_, rows)| **rows);
        let (joint, rows) = most.map_or((0, 0), |(j, r)| (joint_number(model.robot(), j), *r));
        return Err(DiagnosisError::NothingMoves { joint, rows, needed: LEAST_ROWS });
    }
    let free = fit.undetermined(1e-4).into_iter().filter(|&k| k < design.parameters).count();
    let few = 4 * free <= design.parameters && !moving.fitted.contains(&false);
    let left_over = if few { Vec::new() } else { left_over(design, sigma) };
    let (rows, parameters) =
        (design.rows.len(), design.parameters - if few { free } else { left_over.len() });
    if rows < 2 * parameters {
        let times = (2 * parameters).div_ceil(rows.max(1));
        return Err(DiagnosisError::TooShort { rows, parameters, times });
    }
    Ok(left_over)
}

/// Refuses recordings that the standard model has nothing to do with.
fn check_fit(design: &Design, sigma: &[f64]) -> Result<(), DiagnosisError> {
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
