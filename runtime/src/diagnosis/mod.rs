//! Diagnosis: locate the mismatch between a model and a recording, name the physics that was left out, add it, and
//! show on motion that was held out that the fit got better.
//!
//! 1. The band is chosen, the motions are filtered, recordings that cannot be diagnosed are refused, and a skew between
//!    torques and positions is taken out.
//! 2. Windows in which something outside pushed the robot are found and set aside.
//! 3. Every effect of the catalogue, at every place and with a grid of shapes, is tried together with all standard
//!    parameters, and judged on motion that was held out; the best that holds becomes part of the model; then again.
//!    Rows are smoothed by two windows: as slow as the motion (friction, load, springs, bodies), and faster (ripple,
//!    elasticity, backlash). On a short recording, where one law hides another, two of a joint are tried together.
//! 4. A law is named only where it stands out of the variation that is there anyway (between units of the baseline, or
//!    of the recording), is larger than what the torques repeat to, and is told from rivals on other joints. Position
//!    noise times inertia and short presliding are always fitted and never named.
//! 5. Against a baseline, friction is free in the recording from the start; where it has changed it is named last.
//! 6. What was accepted is reconsidered, pruned and explained.
//!
//! Every threshold is in `rules.rs`, with the reason for its value.
//!
//! A pendulum of two links whose second joint has a spring that the model does not know:
//!
//! ```
//! use dynid_runtime::diagnosis::{Settings, Silent, StopReason, diagnose};
//! use dynid_runtime::model::{Drive, Frame, JointKind, Limits, RecursiveModel, Robot, StateSlices, torques};
//! use dynid_runtime::recording::Trajectory;
//!
//! // Its table and its base parameters: of the standard parameters those that a planar arm's torques depend on.
//! let row = |parent, d| {
//!     let kind = JointKind::Revolute;
//!     Frame { parent, kind, gamma: 0.0, b: 0.0, alpha: 0.0, d, theta: 0.0, r: 0.0 }
//! };
//! let frames = vec![row(None, 0.0), row(Some(0), 0.5)];
//! let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
//! let mut robot = Robot::with_standard_as_base("pendulum", [0.0, -9.81, 0.0], frames, drive, Limits::default());
//! let known = [
//!     ("ZZ1", 0.9), ("MX1", 2.0), ("MY1", 0.1), ("Fv1", 1.0), ("Fc1", 0.8), ("off1", 0.1),
//!     ("ZZ2", 0.3), ("MX2", 0.8), ("MY2", 0.05), ("Fv2", 0.6), ("Fc2", 0.5), ("off2", -0.2),
//! ];
//! let value = |name: &str| known.iter().find(|k| k.0 == name).map(|k| k.1);
//! robot.base = robot.base.iter().filter(|b| value(&b.name).is_some()).cloned().collect();
//! let chi: Vec<f64> = robot.base.iter().filter_map(|b| value(&b.name)).collect();
//! let model = RecursiveModel::new(robot)?;
//!
//! // Three motions of ten seconds, their torques with the spring of 4 N.m/rad and a little noise.
//! let mut noise = 1_u32;
//! let mut recorded = |name: &str, phase: f64| {
//!     let time: Vec<f64> = (0..2000).map(|t| f64::from(t) / 200.0).collect();
//!     let series = |j: f64, order: i32| -> Vec<f64> {
//!         let wave = |t: f64, w: f64, p: f64| {
//!             let quarters = f64::from(order) * std::f64::consts::FRAC_PI_2;
//!             w.powi(order) * (w * t + p + quarters).sin()
//!         };
//!         let at = |t: f64| {
//!             0.9 * wave(t, 1.3 + 0.4 * j, phase * (1.0 + j)) + 0.4 * wave(t, 3.1 - 0.5 * j, 2.0 * phase)
//!         };
//!         time.iter().map(|&t| at(t)).collect()
//!     };
//!     let [q, dq, ddq] = [0, 1, 2].map(|order| vec![series(0.0, order), series(1.0, order)]);
//!     let mut torque = torques(&model, &chi, StateSlices::new(&q, &dq, &ddq).states());
//!     torque[1].iter_mut().zip(&q[1]).for_each(|(torque, q)| *torque += 4.0 * q);
//!     for x in torque.iter_mut().flatten() {
//!         noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
//!         *x += 0.1 * (f64::from(noise) / f64::from(u32::MAX) - 0.5);
//!     }
//!     Trajectory { name: name.into(), time, position: q, velocity: None, torque, fixed: vec![] }
//! };
//! let recording = [recorded("one", 0.3), recorded("two", 1.1), recorded("three", 2.4)];
//!
//! let found = diagnose(&model, &recording, &[], &Settings::default(), &Silent)?;
//! assert_eq!(found.findings.len(), 1, "{:?}", found.verdict);
//! let spring = &found.findings[0];
//! assert_eq!((spring.effect.as_str(), spring.joints.as_slice()), ("spring", [2].as_slice()));
//! assert!((spring.parameters["k"].value - 4.0).abs() < 0.1);
//! assert!(found.held_out.after < 0.2 * found.held_out.before);
//! assert_eq!(found.search.stop, StopReason::NoneAccepted);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![allow(
    clippy::needless_range_loop,
    reason = "joints, segments and matrix entries are numbered as in the equations"
)]

mod candidates;
mod contact;
mod error;
mod explanation;
mod judging;
mod outcome;
mod predict;
mod preparation;
mod rows;
mod rules;
pub mod scoring;
mod search;
mod settings;

pub use error::{DiagnosisError, SingularDesign};
pub use outcome::{
    Alternative, CannotTell, Curve, Diagnosis, Errors, Estimated, Finding, HeldOut, Mismatch, NotJudged,
    OrderSpectrum, ParameterShift, ParameterValue, Removed, Sampling, SearchOutcome, Small, StopReason,
    TorqueSeries, Unexplained,
};
pub use predict::term_torques;
pub use settings::{Progress, Settings, Silent};

use crate::effects::EffectKind;
use crate::model::Model;
use crate::recording::Trajectory;
use contact::search::{self as contact_search, Contacts};
use contact::{moving, standing};
use explanation::explain::{Ended, explain};
use explanation::standard_model::StandardModelFit;
use explanation::standstill;
use preparation::{Prepared, nothing_moves};
use rows::fit::Fit;
use search::extended_model::ExtendedModel;
use search::state::Search;

/// Diagnoses a recording; `baseline` are motions of the same robot before it changed, empty where there are none.
///
/// With a baseline only what changed is looked for.
///
/// # Errors
/// [`DiagnosisError`] where the data cannot support an answer, or a setting cannot be.
pub fn diagnose(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnosisError> {
    let recordings = Recordings { trajectories, baseline };
    run(model, recordings, None, settings, progress)
}

/// Fits known effects, on a joint (0-based) where one is given, instead of looking for any: their shapes and
/// amplitudes come from the recording. What [`diagnose`] would ideally find.
///
/// # Errors
/// As [`diagnose`].
pub fn fit_known(
    model: &dyn Model,
    trajectories: &[Trajectory],
    baseline: &[Trajectory],
    known: &[(EffectKind, Option<usize>)],
    settings: &Settings,
) -> Result<Diagnosis, DiagnosisError> {
    let recordings = Recordings { trajectories, baseline };
    run(model, recordings, Some(known), settings, &Silent)
}

/// What is diagnosed, and the same robot before it changed.
struct Recordings<'a> {
    trajectories: &'a [Trajectory],
    baseline: &'a [Trajectory],
}

fn run(
    model: &dyn Model,
    recordings: Recordings<'_>,
    known: Option<&[(EffectKind, Option<usize>)]>,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnosisError> {
    // 1. Band, motions, checks, skew.
    progress.at(0.0, "signals");
    let prepared = Prepared::new(model, recordings.trajectories, recordings.baseline, settings)?;
    let change = !recordings.baseline.is_empty();

    if !prepared.moving.judged.contains(&true) {
        return at_rest(model, &prepared);
    }

    // 2. Windows in which something outside pushed the robot.
    progress.at(0.05, "contacts");
    let signals = &prepared.motions.signals;
    let mut contacts = contact_search::find(&prepared.context(model)?, &prepared.aligned, signals);

    // Pushes that single joints see, looked for in what is left when the search is done.
    let mut pushed: Option<Contacts> = None;
    let mut scanned = false;
    // A body that is carried all the time pushes like a hand: against a baseline, laws are tried first on all of the
    // motion, and only what still stands out then is set aside.
    let mut set_aside = !change;

    loop {
        // 3. Rows outside of these windows; all candidates on them; effects join the model while one holds.
        progress.at(0.1, "candidates");
        let known_contacts = Contacts::joined(contacts.clone().filter(|_| set_aside), pushed.clone());
        let Begun { mut search, standard, sampling } =
            begin(model, &prepared, known_contacts.as_ref(), change, progress)?;
        let settings = prepared.motions.settings();
        let report = match known {
            Some(known) => search.force(known)?,
            None => search.run(settings, progress)?,
        };

        // 4. What looked like pushes from outside may be explained by what is now in the model: then once more.
        if let Some(found) = &contacts {
            let remain = remain(found, &prepared, &search);
            if !remain {
                contacts = None;
            }
            if remain != set_aside {
                set_aside = true;
                continue;
            }
        }
        if settings.single_joint_contacts && (!scanned || pushed.is_some()) {
            let found = pushed_in_motion(model, &prepared, contacts.as_ref(), &search);
            if scanned {
                pushed = pushed.and_then(|p| moving::still_there(p, found.as_ref()));
            } else if found.is_some() {
                // What was found with the pushes among the rows is looked for again without them.
                (pushed, scanned) = (found, true);
                continue;
            }
        }
        let rest =
            standing::at_rest(&search.model.context, &prepared.moving.fitted, &prepared.motions.slowest);
        let contacts = Contacts::joined(
            Contacts::joined(contacts, pushed),
            rest.contacts(prepared.motions.signals.len()),
        );

        // 5. Numbers, errors, curves, sentences.
        progress.at(0.92, "explanations");
        let ended = Ended {
            standard: &standard,
            contacts: contacts.as_ref(),
            report,
            delay: prepared.delay,
            sampling,
        };
        let mut diagnosis = explain(&search, ended, settings)?;
        standstill::name_not_judged(&mut diagnosis, model, &prepared.moving);
        progress.at(1.0, "done");
        return Ok(diagnosis);
    }
}

/// What can be said of a robot that holds still, beside a baseline in which it moves.
fn at_rest(model: &dyn Model, prepared: &Prepared) -> Result<Diagnosis, DiagnosisError> {
    let motions = &prepared.motions;
    let context = prepared.context(model)?;
    let rest = standing::at_rest(&context, &prepared.moving.fitted, &motions.slowest);
    let sampling = motions.sampling(&motions.rows(model, None));
    let mut diagnosis = standstill::explain(&context, &rest, &prepared.chi_sigma, sampling)
        .ok_or_else(|| nothing_moves(model, &prepared.moving))?;
    standstill::name_not_judged(&mut diagnosis, model, &prepared.moving);
    Ok(diagnosis)
}

/// Pushes on single joints in what the model with its effects leaves, outside of the contacts that are known.
fn pushed_in_motion(
    model: &dyn Model,
    prepared: &Prepared,
    contacts: Option<&Contacts>,
    search: &Search<'_>,
) -> Option<Contacts> {
    let rows = prepared.motions.rows(model, contacts.map(|c| c.windows.as_slice())).fast;
    let residual = search.model.residual_on(&rows);
    moving::in_motion(&search.model.context, &rows, &residual, &search.model.fast.sigma)
}

/// What a search begins with.
struct Begun<'a> {
    /// All candidates, none of them in the model yet.
    search: Search<'a>,
    /// The standard model fitted alone.
    standard: StandardModelFit,
    /// How the rows were sampled.
    sampling: Sampling,
}

/// The standard model on the rows outside of contacts, and all candidates.
fn begin<'a>(
    model: &'a dyn Model,
    prepared: &'a Prepared,
    contacts: Option<&Contacts>,
    change: bool,
    progress: &dyn Progress,
) -> Result<Begun<'a>, DiagnosisError> {
    let motions = &prepared.motions;
    let rows = motions.rows(model, contacts.map(|c| c.windows.as_slice()));
    let sampling = motions.sampling(&rows);
    let mut context = prepared.context(model)?;
    if contacts.is_some() {
        let fit = Fit::weighted(&rows.slow, &prepared.sigma)?;
        context.update(fit.chi.iter().take(rows.slow.parameters).copied().collect());
    }
    let calibrated = change || motions.settings().cautious;
    let extended = ExtendedModel::new(context, rows.slow, rows.fast, change, calibrated)?;
    let mut search = Search::new(extended, &motions.slowest, motions.settings(), progress);
    // No law is tried where only joints that hardly move would show it.
    let judged = &prepared.moving.judged;
    for candidates in [&mut search.slow, &mut search.fast] {
        candidates.retain(|c| c.own.iter().any(|&j| judged[j]));
    }
    let standard = StandardModelFit::new(&search.model, &prepared.aligned)?;
    Ok(Begun { search, standard, sampling })
}

/// Whether contacts still stand out of what the model with its effects leaves.
fn remain(contacts: &Contacts, prepared: &Prepared, search: &Search<'_>) -> bool {
    let aligned = &prepared.aligned;
    let residual = search.model.residual_on(aligned);
    let sigma = &search.model.slow.sigma;
    contact_search::remain(contacts, aligned, &residual, sigma, &prepared.motions.signals)
}
