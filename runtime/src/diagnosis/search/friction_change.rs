//! Friction that differs between a baseline and the recording.
//!
//! It differs between any two days, so it is free in the recording from the start and counts as evidence for nothing
//! else. What is left of it when everything else has been found is named joint by joint, where it is more than a few
//! per cent of the friction and more than the baseline's own units differ by.
//!
//! On a joint that carries little but its friction, a drive gain that is off by a factor looks like friction that has
//! changed. What each of the two explains beside the other tells them apart; where neither does, both are said.

use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::calibration::{Calibrated, Law, beside, calibrate};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::judging::white_products::Background;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rows::signals::ModelTorques;
use crate::diagnosis::rules::{LEAST_FRICTION_CHANGE, TOLD_APART};
use crate::diagnosis::search::bench::{Bench, Size};
use crate::diagnosis::search::certainty::of_amplitudes;
use crate::diagnosis::search::in_place_of_level::InPlaceOfLevel;
use crate::diagnosis::search::small_law::SmallLaw;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::{Accepted, Rival};
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, Form, Place, SmoothingWindow};
use crate::parallel;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// The law that friction which has changed is told from.
const DRIVE_GAIN: EffectKind = EffectKind::TorqueConstantError;

/// Columns of a design but for some, and what is known of them.
struct Others {
    columns: Vec<Vec<f64>>,
    prior: Option<Prior>,
}

impl Others {
    fn of(design: &Design, without: &Range<usize>) -> Self {
        let kept = (0..design.columns.len()).filter(|k| !without.contains(k));
        Self {
            columns: kept.map(|k| design.columns[k].clone()).collect(),
            prior: design.prior.as_deref().map(|prior| prior.without(without)),
        }
    }

    fn regressors<'b>(&'b self, bench: &'b Bench, design: &'b Design) -> Regressors<'b> {
        Regressors { shared: &self.columns, prior: self.prior.as_ref(), ..bench.regressors(design) }
    }
}

/// What has changed on a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    Friction,
    /// Every torque by one factor.
    DriveGain,
    /// One of the two, and the motion does not tell which.
    Either,
}

/// A joint on which something has changed, and how sure that is.
pub(super) struct Changed {
    pub joint: usize,
    change: Change,
    pub significance: f64,
    pub confidence: f64,
}

impl Search<'_> {
    /// Names the joints whose friction has changed since the baseline.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(in crate::diagnosis) fn name_friction_changes(
        &mut self,
        settings: &Settings,
    ) -> Result<(), SingularDesign> {
        if !self.model.change {
            return Ok(());
        }
        let (regression, bench) = (&self.model.slow, self.model.bench(SmoothingWindow::Slow));
        let design = &regression.design;
        let joints = design.joints;
        let residual = regression.residual();
        let background = |without: Range<usize>, more: Vec<Vec<f64>>| {
            let mut beside = Others::of(design, &without);
            beside.columns.extend(more);
            let regressors = beside.regressors(bench, design);
            let background = Background::new(&bench.units, &regressors, &residual, self.threads());
            (beside, background)
        };
        // Against a baseline friction is free in every motion; against a reference that of the other joints in its columns.
        let baseline = bench.units.change().then(|| background(bench.own_friction.clone(), Vec::new()));
        let beside_laws = settings.beside_laws().least_confidence;
        let on_joint = |j: usize| {
            let own = baseline.is_none().then(|| background(bench.own_friction_of(j), Vec::new()));
            let (others, beside) = own.as_ref().or(baseline.as_ref())?;
            let (mut evidence, change) = self.friction_evidence(j, others, beside, &residual)?;
            // Nor surer than the numbers allow that are shown.
            let of_numbers = of_amplitudes(&regression.fit, design, bench.own_friction_of(j), 1.0);
            let confidence = |evidence: &Evidence| evidence.confidence(joints).min(of_numbers);
            if baseline.is_some() && confidence(&evidence) >= beside_laws {
                // At speeds that only one of them has, friction that bends in both is another than what viscous and Coulomb
                // friction go on to be from those of the other.
                let (others, beside) =
                    background(bench.own_friction.clone(), self.bends_beside_level(j, design));
                evidence = self.friction_evidence(j, &others, &beside, &residual)?.0;
            }
            let confidence = confidence(&evidence);
            let sure = confidence >= beside_laws;
            let effect = match change {
                Change::Friction | Change::Either => EffectKind::FrictionLevelChange,
                Change::DriveGain => DRIVE_GAIN,
            };
            let significance = evidence.significance;
            (sure && settings.may_name(effect, Place::Joint(j))).then_some(Changed {
                joint: j,
                change,
                significance,
                confidence,
            })
        };
        let mut changed: Vec<Changed> =
            parallel::map(self.threads(), joints, on_joint).into_iter().flatten().collect();
        let of_first = settings.confidence_of_first(EffectKind::FrictionLevelChange);
        if self.model.terms.is_empty() && changed.iter().all(|c| c.confidence < of_first) {
            changed.clear();
        }
        self.small.clear();
        for found in changed {
            let joint = found.joint;
            let before = self.friction_of_baseline(joint);
            let size = self.friction_change(joint, before, true);
            if size.law < size.needed {
                let (effect, place) = (EffectKind::FrictionLevelChange, Place::Joint(joint));
                self.small.push(SmallLaw { effect, place, own: vec![joint], size });
                continue;
            }
            let nothing_else = found.change != Change::DriveGain
                && self.friction_change(joint, before, false).law < size.needed;
            if nothing_else && self.bend_in_place_of_viscous(joint)? {
                continue;
            }
            match self.in_place_of_level(&found, before, settings)? {
                InPlaceOfLevel::Law(law) => {
                    self.model.terms.push(*law);
                    self.refit_and_update()?;
                }
                InPlaceOfLevel::Level(rivals) => self.take(&found, before, rivals)?,
            }
        }
        Ok(())
    }

    /// Makes the change of a joint's friction a term of the model.
    ///
    /// # Errors
    /// As [`Self::name_friction_changes`].
    pub(in crate::diagnosis) fn take_friction_change(&mut self, joint: usize) -> Result<(), SingularDesign> {
        let before = self.friction_of_baseline(joint);
        let found = Changed { joint, change: Change::Friction, significance: 0.0, confidence: 0.5 };
        self.take(&found, before, Vec::new())
    }

    /// Makes what has changed on a joint a term of the model, in the place of friction that is free in the recording; `before` are
    /// the viscous and Coulomb coefficients of the baseline, `alike` the laws that friction which has changed cannot be told from.
    fn take(
        &mut self,
        found: &Changed,
        before: [f64; 2],
        mut alike: Vec<Rival>,
    ) -> Result<(), SingularDesign> {
        let &Changed { joint, change, significance, confidence } = found;
        let inflation = self.inflation_of_friction(joint, significance);
        self.take_over_friction(joint, 2);
        let rival = |effect| Rival {
            effect,
            place: Place::Joint(joint),
            shape: Vec::new(),
            explained_fraction: 0.0,
            difference_p_value: 1.0,
        };
        let before = before.to_vec();
        let (effect, shape, rivals) = match change {
            Change::Friction => (EffectKind::FrictionLevelChange, before, alike),
            Change::Either => {
                alike.retain(|rival| rival.effect != DRIVE_GAIN);
                alike.push(rival(DRIVE_GAIN));
                (EffectKind::FrictionLevelChange, before, alike)
            }
            Change::DriveGain => (DRIVE_GAIN, Vec::new(), Vec::new()),
        };
        self.model.terms.push(Accepted {
            effect,
            place: Place::Joint(joint),
            own: vec![joint],
            shows_on: vec![joint],
            shape,
            modes: Vec::new(),
            fixed: None,
            significance,
            confidence,
            inflation,
            explained_fraction: 0.0,
            rivals,
            is_transient: false,
        });
        self.refit_and_update()
    }

    /// Factor on the standard deviations of a change of a joint's friction that is as significant.
    pub(super) fn inflation_of_friction(&self, joint: usize, significance: f64) -> f64 {
        let variances = self.model.slow.fit.variances();
        let chi = &self.model.slow.fit.chi;
        let ratios = self.own_friction(joint).map(|k| chi[k].abs() / variances[k].max(1e-300).sqrt());
        let white = ratios.fold(0.0, f64::max);
        if significance > 0.0 { (white / significance).max(1.0) } else { 1.0 }
    }

    /// Where the friction of a joint bends, and nothing but its viscous part has changed besides, that is a part of the law: it has
    /// taken the place of it. Says whether there is such a law.
    fn bend_in_place_of_viscous(&mut self, joint: usize) -> Result<bool, SingularDesign> {
        let in_its_place = |term: &Accepted| match term.effect.form() {
            Form::Joint(law) if term.place == Place::Joint(joint) => law.in_place_of_viscous(&term.shape),
            _ => None,
        };
        let bent = self.model.terms.iter().enumerate().find_map(|(k, term)| Some((k, in_its_place(term)?)));
        let Some((k, shape)) = bent else { return Ok(false) };
        self.take_over_friction(joint, 1);
        self.model.terms[k].shape = shape;
        self.refit_and_update()?;
        Ok(true)
    }

    /// Takes the first `numbers` of the viscous and Coulomb friction of a joint out of what is free in the recording: a law has them.
    pub(super) fn take_over_friction(&mut self, joint: usize, numbers: usize) {
        for window in [SmoothingWindow::Slow, SmoothingWindow::Fast] {
            let columns = self.model.bench(window).own_friction_of(joint);
            let regression = match window {
                SmoothingWindow::Slow => &mut self.model.slow,
                SmoothingWindow::Fast => &mut self.model.fast,
            };
            regression.silence(columns.start..columns.end.min(columns.start + numbers));
        }
    }

    fn own_friction(&self, joint: usize) -> Range<usize> {
        self.model.benches[0].own_friction_of(joint)
    }

    /// Evidence that the viscous and Coulomb friction of a joint differ from the baseline's, against what they differ by
    /// between its units, and whether it is friction that has changed.
    fn friction_evidence(
        &self,
        joint: usize,
        others: &Others,
        background: &Background,
        residual: &[f64],
    ) -> Option<(Evidence, Change)> {
        let (context, bench) = (&self.model.context, self.model.bench(SmoothingWindow::Slow));
        let design = &self.model.slow.design;
        let gain = dense_columns(context, design, DRIVE_GAIN, Place::Joint(joint), &[], false);
        let mut free = bench.free.clone();
        free[joint].drain(..2.min(bench.free[joint].len()));
        let between_motions = &bench.friction_between_motions;
        let regressors = Regressors { free: &free, between_motions, ..others.regressors(bench, design) };
        let friction: Vec<Vec<f64>> =
            bench.friction[joint][..2].iter().map(|c| regressors.on_all_rows(joint, c)).collect();
        let judged = |columns| {
            let law = Law { columns, residual, common: false, is_trend: false, trend_of: 0 };
            let calibrated = calibrate(&bench.units, &regressors, background, &law)?;
            Some((law, calibrated))
        };
        let shows_beside = |(law, calibrated): &(Law<'_>, Calibrated), other: &[Vec<f64>]| {
            beside(&bench.units, &regressors, background, law, calibrated, other)
                .is_some_and(|left| left.evidence.evidence().p_value <= TOLD_APART)
        };
        let of_friction = judged(&friction)?;
        let evidence = of_friction.1.evidence();
        let change = match judged(&gain) {
            None => Change::Friction,
            Some(_) if shows_beside(&of_friction, &gain) => Change::Friction,
            Some(of_gain) if shows_beside(&of_gain, &friction) => Change::DriveGain,
            Some(_) => Change::Either,
        };
        Some((evidence, change))
    }

    /// Change of a joint's friction torque in the recording, or without `by_speed` of its Coulomb part, and what of its friction
    /// torque in the baseline is worth a name.
    fn friction_change(&self, joint: usize, [viscous, coulomb]: [f64; 2], by_speed: bool) -> Size {
        let regression = &self.model.slow;
        let design = &regression.design;
        let own: Vec<f64> = self.own_friction(joint).map(|k| regression.fit.chi[k]).collect();
        let &[of_speed, level] = &own[..] else { return Size { law: 0.0, needed: 0.0 } };
        let by_speed = if by_speed { of_speed } else { 0.0 };
        let columns = &self.model.bench(SmoothingWindow::Slow).friction[joint];
        let (mut changed, mut whole, mut count) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (row, r) in design.of_joint(joint).enumerate() {
            if self.model.context.signals[design.rows[r].signal].is_target {
                changed += (by_speed * columns[0][row] + level * columns[1][row]).powi(2);
                whole += (viscous * columns[0][row] + coulomb * columns[1][row]).powi(2);
                count += 1.0;
            }
        }
        let rms = |squares: f64| (squares / count.max(1.0)).sqrt();
        Size { law: rms(changed), needed: LEAST_FRICTION_CHANGE * rms(whole) }
    }

    /// Viscous and Coulomb coefficients that a joint had in the baseline, where those of the recording are free or a term. The
    /// model is asked, as parameters whose values are known have no columns in a design.
    fn friction_of_baseline(&self, joint: usize) -> [f64; 2] {
        let Regression { design, fit, .. } = &self.model.slow;
        let mut friction = Vec::new();
        let context = &self.model.context;
        // Those of the context are of all motion as long as nothing has been found beside them.
        let chi = &fit.chi.as_slice()[..design.parameters];
        for (k, signals) in context.signals.iter().enumerate() {
            let torques = ModelTorques::new(context.model, chi, signals);
            design.sample(joint, k, &torques.friction[joint], &mut friction);
        }
        let columns = &self.model.bench(SmoothingWindow::Slow).friction[joint][..2];
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let g = DMatrix::from_fn(2, 2, |a, b| product(&columns[a], &columns[b]));
        let v = DVector::from_fn(2, |a, _| product(&columns[a], &friction));
        g.lu().solve(&v).map_or([0.0; 2], |x| [x[0], x[1]])
    }
}
