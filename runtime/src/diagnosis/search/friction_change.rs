//! Friction that differs between a baseline and the recording.
//!
//! It differs between any two days, so it is free in the recording from the start and counts as evidence for nothing
//! else. What is left of it when everything else has been found is named joint by joint, where it is more than a few
//! per cent of the friction and more than the baseline's own units differ by.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::calibration::{Law, calibrate};
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::judging::white_products::{Background, Regressors};
use crate::diagnosis::rules::LEAST_FRICTION_CHANGE;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, Place, SmoothingWindow};
use nalgebra::{DMatrix, DVector};

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
        let shared: Vec<Vec<f64>> = (0..design.columns.len())
            .filter(|k| !bench.own_friction.contains(k))
            .map(|k| design.columns[k].clone())
            .collect();
        let regressors = Regressors {
            shared: &shared,
            y: &design.y,
            free: &bench.free,
            companions: &bench.companions,
            of_joint: &bench.of_joint,
        };
        let residual = regression.residual();
        let background = Background::new(&bench.units, &regressors, &residual, self.threads);
        let changed: Vec<(usize, Evidence)> = (0..joints)
            .filter(|&j| !settings.excluded.contains(&(EffectKind::FrictionLevelChange, Place::Joint(j))))
            .filter_map(|j| {
                let evidence = self.friction_evidence(j, &shared, &background, &residual)?;
                let sure = evidence.confidence(joints) >= settings.least_confidence;
                (sure && self.friction_change(j) >= LEAST_FRICTION_CHANGE).then_some((j, evidence))
            })
            .collect();
        for (j, evidence) in changed {
            let confidence = evidence.confidence(joints);
            self.take_friction_change(j, evidence.significance, confidence)?;
        }
        Ok(())
    }

    /// Makes the change of a joint's friction a term of the model.
    ///
    /// # Errors
    /// As [`Self::name_friction_changes`].
    pub(in crate::diagnosis) fn take_friction_change(
        &mut self,
        joint: usize,
        significance: f64,
        confidence: f64,
    ) -> Result<(), SingularDesign> {
        let before = self.friction_of_baseline(joint);
        let variances = self.model.slow.fit.variances();
        let chi = &self.model.slow.fit.chi;
        let ratios = self.own_friction(joint).map(|k| chi[k].abs() / variances[k].max(1e-300).sqrt());
        let white = ratios.fold(0.0, f64::max);
        let inflation = if significance > 0.0 { (white / significance).max(1.0) } else { 1.0 };
        for window in [SmoothingWindow::Slow, SmoothingWindow::Fast] {
            let columns: Vec<usize> = self.model.bench(window).own_friction_of(joint).collect();
            let regression = match window {
                SmoothingWindow::Slow => &mut self.model.slow,
                SmoothingWindow::Fast => &mut self.model.fast,
            };
            regression.silence(columns.into_iter());
        }
        self.model.terms.push(Accepted {
            effect: EffectKind::FrictionLevelChange,
            place: Place::Joint(joint),
            own: vec![joint],
            shows_on: vec![joint],
            shape: before.to_vec(),
            fixed: None,
            significance,
            confidence,
            inflation,
            explained_fraction: 0.0,
            rivals: Vec::new(),
        });
        self.refit_and_update()
    }

    fn own_friction(&self, joint: usize) -> impl Iterator<Item = usize> {
        self.model.benches[0].own_friction_of(joint)
    }

    /// Evidence that the viscous and Coulomb friction of a joint differ from the baseline's, against what they differ by
    /// between its units.
    fn friction_evidence(
        &self,
        joint: usize,
        shared: &[Vec<f64>],
        background: &Background,
        residual: &[f64],
    ) -> Option<Evidence> {
        let bench = self.model.bench(SmoothingWindow::Slow);
        let design = &self.model.slow.design;
        let range = design.of_joint(joint);
        let law: Vec<Vec<f64>> = bench.free[joint][..2]
            .iter()
            .map(|on_joint| {
                let mut column = vec![0.0; design.rows.len()];
                column[range.clone()].copy_from_slice(on_joint);
                column
            })
            .collect();
        let mut free = bench.free.clone();
        free[joint].drain(..2);
        let regressors = Regressors {
            shared,
            y: &design.y,
            free: &free,
            companions: &bench.companions,
            of_joint: &bench.of_joint,
        };
        let law = Law { columns: &law, residual, common: false, trend_of: 0 };
        let found = calibrate(&bench.units, &regressors, background, &law)?;
        Some(found.evidence())
    }

    /// Change of a joint's friction torque in the recording, as a share of the friction torque of the baseline.
    fn friction_change(&self, joint: usize) -> f64 {
        let regression = &self.model.slow;
        let design = &regression.design;
        let [viscous, coulomb] = self.friction_of_baseline(joint);
        let own: Vec<f64> = self.own_friction(joint).map(|k| regression.fit.chi[k]).collect();
        let [by_speed, level] = own[..] else { return 0.0 };
        let columns = &self.model.bench(SmoothingWindow::Slow).free[joint];
        let (mut changed, mut whole) = (0.0, 0.0);
        for (row, r) in design.of_joint(joint).enumerate() {
            if self.model.context.signals[design.rows[r].signal].is_target {
                changed += (by_speed * columns[0][row] + level * columns[1][row]).powi(2);
                whole += (viscous * columns[0][row] + coulomb * columns[1][row]).powi(2);
            }
        }
        if whole > 0.0 { (changed / whole).sqrt() } else { 0.0 }
    }

    /// Viscous and Coulomb coefficients that the model has for a joint.
    fn friction_of_baseline(&self, joint: usize) -> [f64; 2] {
        let design = &self.model.slow.design;
        let mut friction = Vec::new();
        for (k, torques) in self.model.context.torques.iter().enumerate() {
            design.sample(joint, k, &torques.friction[joint], &mut friction);
        }
        let columns = &self.model.bench(SmoothingWindow::Slow).free[joint][..2];
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let g = DMatrix::from_fn(2, 2, |a, b| product(&columns[a], &columns[b]));
        let v = DVector::from_fn(2, |a, _| product(&columns[a], &friction));
        g.lu().solve(&v).map_or([0.0; 2], |x| [x[0], x[1]])
    }
}
