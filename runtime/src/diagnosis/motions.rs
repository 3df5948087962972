//! The motions of a diagnosis: their band and windows, filtered signals, speeds of standstill, and the rows of both
//! windows.

use super::error::{DiagnosisError, SingularDesign};
use super::judging::folds::{forward_cuts, untold};
use super::outcome::Sampling;
use super::rows::design::Design;
use super::rows::fit::Fit;
use super::rows::prior::Prior;
use super::rows::scales::top_speeds;
use super::rows::selection::{Cut, RowSelection};
use super::rows::signals::{Signals, directions};
use super::rules;
use super::settings::{Settings, fitted_to, given_speeds};
use crate::model::Model;
use crate::recording::Trajectory;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The motions with everything that decides where rows are.
#[derive(Clone)]
pub(super) struct Motions {
    /// Motions of the baseline, then those of the recording that is diagnosed.
    pub signals: Vec<Signals>,
    /// Settings with the windows of this recording's band.
    settings: Settings,
    /// Cut-off of the filter of positions and torques, Hz.
    cutoff: f64,
    /// Speeds of standstill for slow rows, per joint.
    pub slowest: Vec<f64>,
    /// The same for fast rows.
    slowest_fast: Vec<f64>,
    /// Those that the outcome tells: also of joints that hold still.
    standstill_speeds: Vec<f64>,
    /// Base parameters that nothing determines, and that are left out.
    pub left_over: Vec<usize>,
    /// What a reference says of the base parameters.
    prior: Option<Arc<Prior>>,
    /// Linear forms of dq whose sign enters each joint's row.
    directions: Vec<Vec<Vec<f64>>>,
    /// How the motions of the recording that is diagnosed are held out.
    cut: Cut,
    /// Joints and segments that what is not held out with them does not tell.
    untold: Arc<BTreeSet<(usize, usize)>>,
    /// Whether the recording has no rows to spare: slow effects are then smoothed no more than fast ones.
    short: bool,
}

/// Stretches of all motions, held out together.
const STRETCHES: Cut = Cut { segments: rules::SEGMENTS_OF_FEW_MOTIONS, together: true, ..Cut::NOT };

/// In how many motions the joint moves that moves in fewest: for at least a part of the time that it does where it moves most.
fn least_motions_of_a_joint(signals: &[Signals], slowest: &[f64]) -> usize {
    let of_joint = |(j, slowest): (usize, &f64)| {
        let moving = |s: &Signals| s.dq[j].iter().filter(|v| v.abs() > *slowest).count() as f64 / s.rate;
        let times: Vec<f64> = signals.iter().map(moving).collect();
        let most = times.iter().copied().fold(0.0, f64::max);
        let moves = times.iter().filter(|time| **time > rules::MOVES_IN_MOTION * most).count();
        (most > 0.0).then_some(moves)
    };
    slowest.iter().enumerate().filter_map(of_joint).min().unwrap_or(signals.len())
}

/// The rows of both windows.
pub(super) struct Rows {
    pub slow: Design,
    pub fast: Design,
}

impl Motions {
    /// Chooses the band, filters the motions, and finds the speeds of standstill.
    pub fn new(
        model: &dyn Model,
        trajectories: &[Trajectory],
        baseline: &[Trajectory],
        settings: &Settings,
    ) -> Result<Self, DiagnosisError> {
        let n = model.robot().joints();
        let (cutoff, settings) = fitted_to(settings, trajectories)?;
        let given = given_speeds(&settings, n)?;
        let old = baseline.iter().map(|t| Signals::new(t, false, 0.0, cutoff));
        let new = trajectories.iter().map(|t| Signals::new(t, true, 0.0, cutoff));
        let mut signals: Vec<Signals> = old.chain(new).collect::<Result<_, _>>()?;
        if let Some(reference) = &settings.reference {
            let known = reference.torques(model, &signals)?;
            let unknown = reference.unknown(model, &signals)?;
            for ((motion, known), unknown) in signals.iter_mut().zip(known).zip(unknown) {
                motion.set_delay(reference.delay())?;
                motion.take_out(known);
                motion.unknown = unknown;
            }
        }
        // The rows of a baseline say what a reference was identified from.
        let reference = settings.reference.as_ref().filter(|_| baseline.is_empty());
        let prior = reference.and_then(|r| r.prior_of_parameters(&model.robot().fixed_base()));
        let (slowest, slowest_fast) = match given {
            Some(speeds) => (speeds.clone(), speeds),
            None => {
                let mut slow: Vec<f64> =
                    top_speeds(signals.iter(), n).iter().map(|v| settings.standstill * v).collect();
                // Where nothing moves, the reference knows what is slow.
                let before = settings.reference.as_ref().and_then(|r| r.standstill()).unwrap_or_default();
                slow.iter_mut().zip(before).for_each(|(slow, before)| *slow = slow.max(*before));
                let fast = slow.iter().map(|v| v / rules::FAST_STANDSTILL_DIVISOR).collect();
                (slow, fast)
            }
        };
        let duration: f64 = signals.iter().map(|s| s.len() as f64 / s.rate).sum();
        let count = trajectories.len();
        let cut = if count < rules::ENOUGH_MOTIONS {
            Cut { segments: rules::SEGMENTS_OF_FEW_MOTIONS / count, ..Cut::NOT }
        } else if least_motions_of_a_joint(&signals[baseline.len()..], &slowest) < rules::ENOUGH_MOTIONS {
            STRETCHES
        } else {
            Cut::NOT
        };
        Ok(Self {
            signals,
            settings,
            cutoff,
            standstill_speeds: slowest.clone(),
            left_over: Vec::new(),
            prior: prior.map(Arc::new),
            slowest,
            slowest_fast,
            directions: directions(model.robot()),
            cut,
            untold: Arc::default(),
            short: duration < rules::SHORT_RECORDING,
        })
    }

    /// Rows of a window of this half-width, s, outside of the excluded times of each motion.
    fn design(&self, model: &dyn Model, half: f64, excluded: Option<&[Vec<[f64; 2]>]>) -> Design {
        let nothing = vec![Vec::new(); self.signals.len()];
        let fast = half < self.settings.slow_window;
        let selection = RowSelection {
            half,
            slowest: if fast { &self.slowest_fast } else { &self.slowest },
            directions: &self.directions,
            cut: self.cut,
            excluded: excluded.unwrap_or(&nothing),
        };
        let mut design = Design::new(model, &self.signals, &selection);
        design.prior.clone_from(&self.prior);
        design.untold.clone_from(&self.untold);
        if !self.left_over.is_empty() {
            design.leave_out(&self.left_over);
        }
        design
    }

    /// Holds stretches out where whole motions cannot be, nor what comes later in a single one: parameters that the others do not
    /// determine would be judged instead of laws. `design` are rows of all motions, with the noise of each joint. Says whether
    /// anything is held out otherwise from now on.
    pub fn hold_out_what_others_show(&mut self, design: &Design, sigma: &[f64]) -> bool {
        if self.cut.together {
            return false;
        }
        let segments = || 0..design.segments.len();
        let left_open = |held: &dyn Fn(usize) -> bool, fitted: &dyn Fn(usize) -> bool| {
            let Ok(others) = Fit::new(design, sigma, segments().map(fitted).collect()) else {
                return f64::INFINITY;
            };
            let held: Vec<usize> = segments().filter(|&g| held(g)).collect();
            others.variance_of_prediction(design, &held).into_iter().fold(0.0, f64::max)
        };
        if design.is_single_motion() {
            let shows_nothing =
                |cut: &usize| left_open(&|g| g >= *cut, &|g| g < *cut) > rules::LEFT_OPEN_AT_MOST;
            self.cut.forward = !forward_cuts(segments().len()).iter().any(shows_nothing);
            return !self.cut.forward;
        }
        let targets: Vec<usize> = (0..self.signals.len()).filter(|&k| self.signals[k].is_target).collect();
        let is_left_open = |held: &usize| {
            let of = |g: usize| design.segments[g].signal;
            let is_other = |g: usize| design.segments[g].is_target && of(g) != *held;
            left_open(&|g| of(g) == *held, &is_other) > rules::LEFT_OPEN_BY_OTHERS
        };
        if targets.len() < 2 || !targets.iter().any(is_left_open) {
            return false;
        }
        self.cut = STRETCHES;
        true
    }

    /// Leaves what the motion that is not held out with it does not tell out of what laws are judged by, see
    /// [`untold`]. `design` as above.
    ///
    /// # Errors
    /// [`SingularDesign`] where a part of the motion has no fit.
    pub fn leave_out_untold(&mut self, design: &mut Design, sigma: &[f64]) -> Result<(), SingularDesign> {
        // There laws are judged beside parameters of all of it, and it is predicted forward.
        if design.is_single_motion() {
            return Ok(());
        }
        self.untold = Arc::new(untold(design, sigma)?);
        design.untold.clone_from(&self.untold);
        Ok(())
    }

    /// Those of the recording that is diagnosed, without its baseline.
    pub fn of_target(&self) -> Self {
        let targets = self.signals.iter().filter(|s| s.is_target);
        Self { signals: targets.cloned().collect(), untold: Arc::default(), ..self.clone() }
    }

    /// The same motions in a time that runs so many times faster.
    pub fn faster(&self, factor: f64) -> Self {
        let speeds = |slowest: &[f64]| slowest.iter().map(|v| factor * v).collect();
        Self {
            signals: self.signals.iter().map(|s| s.faster(factor)).collect(),
            slowest: speeds(&self.slowest),
            slowest_fast: speeds(&self.slowest_fast),
            settings: Settings {
                slow_window: self.settings.slow_window / factor,
                fast_window: self.settings.fast_window / factor,
                ..self.settings.clone()
            },
            ..self.clone()
        }
    }

    /// Leaves out all rows of joints that do not move: what such a joint seems to do is noise.
    pub fn hold_still(&mut self, moving: &[bool]) {
        for speeds in [&mut self.slowest, &mut self.slowest_fast] {
            for (speed, _) in speeds.iter_mut().zip(moving).filter(|(_, moving)| !**moving) {
                *speed = f64::INFINITY;
            }
        }
    }

    /// Slow rows that leave nothing out but standstills.
    pub fn aligned(&self, model: &dyn Model) -> Design {
        self.design(model, self.settings.slow_window, None)
    }

    /// The rows of both windows, outside of the excluded times of each motion.
    pub fn rows(&self, model: &dyn Model, excluded: Option<&[Vec<[f64; 2]>]>) -> Rows {
        let fast = self.design(model, self.settings.fast_window, excluded);
        let slow =
            if self.short { fast.clone() } else { self.design(model, self.settings.slow_window, excluded) };
        Rows { slow, fast }
    }

    /// Settings with the windows of this recording's band.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the outcome tells of band, windows and rows.
    pub fn sampling(&self, rows: &Rows) -> Sampling {
        let fast_window = self.settings.fast_window;
        let slow_window = if self.short { fast_window } else { self.settings.slow_window };
        Sampling {
            band: 0.5 / fast_window,
            slow_band: 0.5 / slow_window,
            cutoff: self.cutoff,
            fast_window,
            slow_window,
            standstill_speeds: self.standstill_speeds.clone(),
            fast_rows: rows.fast.rows.len(),
            slow_rows: rows.slow.rows.len(),
        }
    }
}
