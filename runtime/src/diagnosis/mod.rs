//! Diagnosis: locate the mismatch between a model and a recording, name the physics that was left out, add it, and
//! show on motion that was held out that the fit got better.
//!
//! 1. The band is chosen, the motions are filtered, recordings that cannot be diagnosed are refused, times that run
//!    at another rate are corrected, and a skew between torques and positions is taken out: that of a baseline, and that
//!    of the recording, which may have another.
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
//! Every threshold is in `rules/`, with the reason for its value.
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
mod experiment;
mod explanation;
mod judging;
mod large_error;
mod motions;
mod objection;
mod outcome;
mod portrait;
mod predict;
mod preparation;
mod pushes;
mod rate;
mod reference;
mod rows;
mod rules;
pub mod scoring;
mod search;
mod settings;
mod stages;

pub use error::{DiagnosisError, SingularDesign};
pub use experiment::{Distances, Question, distances, typical_laws};
pub use outcome::{
    Alternative, BetweenMotions, CannotTell, Curve, Diagnosis, Errors, Estimated, Finding, FineLaw, HeldOut,
    Mismatch, NotJudged, OnTest, OrderSpectrum, ParameterShift, ParameterValue, Refuted, Removed, Sampling,
    SearchOutcome, Small, Standing, StopReason, TorqueSeries, Transient, Unexplained, WithoutIt,
};
pub use portrait::{Portrait, imitators, portrait};
pub use predict::{joint_scales, term_torques};
pub use reference::{NoReference, Reference};
pub use settings::{Progress, Settings, Silent};

use crate::effects::EffectKind;
use crate::model::Model;
use crate::recording::Trajectory;
pub(crate) use objection::Objection;
use stages::{Objections, Recordings};

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
    stages::run(model, recordings, None, None, settings, progress)
}

/// As [`diagnose`], without what there are `objections` to.
pub(crate) fn diagnose_despite(
    model: &dyn Model,
    [trajectories, baseline]: [&[Trajectory]; 2],
    objections: &mut Objections<'_>,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnosisError> {
    let recordings = Recordings { trajectories, baseline };
    stages::run(model, recordings, None, Some(objections), settings, progress)
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
    stages::run(model, recordings, Some(known), None, settings, &Silent)
}
