//! Accepted effects as part of a model: their torques on any motion, and the errors of a model with them.

use super::error::DiagnosisError;
use super::outcome::{Errors, Estimated};
use super::rows::context::{Context, scales};
use super::rows::design::Design;
use super::rows::selection::RowSelection;
use super::rows::signals::{ModelTorques, Signals, directions};
use super::settings::Settings;
use crate::effects::{EffectTerm, Place};
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::Motion;

/// Torques of terms on a motion, to be added to those of the standard model: `[j][t]`, N.m or N.
///
/// `chi` are the base parameters that were identified together with the terms. Contacts belong to the recording they
/// were seen in and add nothing.
pub fn term_torques(
    model: &dyn Model,
    chi: &[f64],
    terms: &[EffectTerm],
    motion: &Motion,
) -> Result<Vec<Vec<f64>>, DiagnosisError> {
    let signals = [Signals::of_motion(motion)];
    let mut all = torques_on(model, chi, terms, &signals)?;
    Ok(all.pop().unwrap_or_default())
}

/// The same for several motions: `[motion][j][t]`.
fn torques_on(
    model: &dyn Model,
    chi: &[f64],
    terms: &[EffectTerm],
    signals: &[Signals],
) -> Result<Vec<Vec<Vec<f64>>>, DiagnosisError> {
    let n = model.robot().joints();
    let mut out: Vec<Vec<Vec<f64>>> = signals.iter().map(|s| vec![vec![0.0; s.len()]; n]).collect();
    if terms.is_empty() {
        return Ok(out);
    }
    let mut context = Context::new(model, signals, scales(model, signals, chi), chi.to_vec())?;
    for term in terms {
        if let (Place::Joint(j), Some(scale)) = (term.place, term.scale)
            && j < n
        {
            context.scales[j] = scale.into();
        }
        let mut amplitude = term.amplitude.clone();
        if let Some((j, known)) = term.transmission() {
            context.transmissions = vec![(j, known)];
            amplitude = vec![1.0];
        }
        for (k, torque) in out.iter_mut().enumerate() {
            for (column, a) in context.series(k, term.effect, term.place, &term.shape).iter().zip(&amplitude)
            {
                for (j, values) in column {
                    torque[*j].iter_mut().zip(values).for_each(|(t, v)| *t += a * v);
                }
            }
        }
    }
    Ok(out)
}

/// Relative errors of a model with terms on other recordings: rows where joints move, smoothed with the fast window
/// (25 Hz with the default settings, less where the recording holds less). `delay` is the skew of the torques that is known, s.
pub fn predict_errors(
    model: &dyn Model,
    parameters: &Estimated,
    terms: &[EffectTerm],
    delay: f64,
    trajectories: &[Trajectory],
    slowest: &[f64],
    settings: &Settings,
) -> Result<Errors, DiagnosisError> {
    let (cutoff, settings) = super::settings::fitted_to(settings, trajectories)?;
    let signals: Vec<Signals> =
        trajectories.iter().map(|t| Signals::new(t, true, delay, cutoff)).collect::<Result<_, _>>()?;
    let forms = directions(model.robot());
    let nothing = vec![Vec::new(); signals.len()];
    let selection = RowSelection {
        half: settings.fast_window,
        slowest,
        directions: &forms,
        segments: 1,
        excluded: &nothing,
    };
    let design = Design::new(model, &signals, &selection);
    let added = torques_on(model, &parameters.chi, terms, &signals)?;
    let n = design.joints;
    let (mut left, mut whole) = (vec![0.0; n], vec![0.0; n]);
    for (k, s) in signals.iter().enumerate() {
        let standard = ModelTorques::new(model, &parameters.chi, s);
        for j in 0..n {
            let series: Vec<f64> =
                (0..s.len()).map(|t| s.torque[j][t] - standard.total[j][t] - added[k][j][t]).collect();
            for (range, _) in design.of_signal(j, k) {
                for r in range {
                    left[j] += design.smooth(k, &series, design.rows[r].centre).powi(2);
                    whole[j] += design.y[r].powi(2);
                }
            }
        }
    }
    Ok(Errors::of_squares(&left, &whole))
}
