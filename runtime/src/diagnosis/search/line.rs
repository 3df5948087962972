//! Torque ripple that stands out as a line in the orders of a joint: accepted beside the laws that explain a share of
//! the rows, which a line of a few per cent never does.

use crate::diagnosis::candidates::candidate::{make, smoothing_window};
use crate::diagnosis::candidates::order_line::{Line, Stroke, lines, resolution};
use crate::diagnosis::candidates::spectrum::peaks;
use crate::diagnosis::outcome::OrderSpectrum;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rules::{HIGHEST_CONFIDENCE, LINE_MULTIPLES, LINE_PICKED};
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{EffectKind, Place};
use crate::parallel;

/// The lines of one joint, and how close two orders are one.
#[derive(Debug, Clone, Default)]
pub(in crate::diagnosis) struct JointLines {
    pub lines: Vec<Line>,
    resolution: f64,
    /// Orders that were tried.
    tried: usize,
}

impl JointLines {
    fn has(&self, order: f64) -> bool {
        self.lines.iter().any(|l| (l.order - order).abs() <= self.resolution)
    }
}

/// Lines of every joint in the recording that is diagnosed, without those that its baseline has as well.
pub(in crate::diagnosis) fn all_lines(
    context: &Context<'_>,
    spectra: &[OrderSpectrum],
    slowest: &[f64],
    threads: usize,
) -> Vec<JointLines> {
    parallel::map(threads, spectra.len(), |j| {
        let residuals: Vec<(Vec<f64>, f64)> = context
            .signals
            .iter()
            .zip(&context.torques)
            .map(|(s, m)| {
                let (torque, band) = s.recorded_torque(j);
                (torque.iter().zip(&m.total[j]).map(|(y, t)| y - t).collect(), band)
            })
            .collect();
        let strokes = |target: bool| -> Vec<Stroke<'_>> {
            let wanted = context.signals.iter().zip(&residuals).filter(|(s, _)| s.is_target == target);
            wanted
                .map(|(s, (r, band))| {
                    let end = s.len().saturating_sub(s.edge_samples);
                    let inside = s.edge_samples.min(end)..end.min(r.len());
                    Stroke {
                        q: &s.q[j][inside.clone()],
                        dq: &s.dq[j][inside.clone()],
                        residual: &r[inside],
                        band: *band,
                    }
                })
                .collect()
        };
        let (now, before) = (strokes(true), strokes(false));
        let gear = spectra[j].gear;
        // Of a joint whose gear is not known there are no multiples to ask for.
        let known: Vec<f64> =
            if gear > 1.0 { LINE_MULTIPLES.iter().map(|k| k * gear).collect() } else { Vec::new() };
        let picked = peaks(&spectra[j], LINE_PICKED);
        let old = lines(&before, &known, &picked, slowest[j]);
        let resolution = resolution(&now);
        let mut new = lines(&now, &known, &picked, slowest[j]);
        new.retain(|l| old.iter().all(|o| (o.order - l.order).abs() > resolution));
        JointLines { lines: new, resolution, tried: known.len() + spectra[j].order.len() }
    })
}

impl Search<'_> {
    /// The strongest line that is not in the model yet and that held-out motion does not speak against.
    pub(in crate::diagnosis) fn next_line(&self) -> Option<Accepted> {
        let tried: usize = self.lines.iter().map(|l| l.tried).sum();
        for (j, found) in self.lines.iter().enumerate() {
            for line in &found.lines {
                let place = Place::Joint(j);
                let known = |t: &Accepted| {
                    t.effect == EffectKind::TorqueRipple
                        && t.place == place
                        && (t.shape[0] - line.order).abs() <= 3.0 * found.resolution
                };
                if self.model.terms.iter().any(known) || self.rejected.iter().any(known) {
                    continue;
                }
                let model = &self.model;
                let regression = model.regression(smoothing_window(EffectKind::TorqueRipple));
                let shape = vec![line.order];
                let candidate = make(
                    &model.context,
                    &regression.design,
                    EffectKind::TorqueRipple,
                    place,
                    std::slice::from_ref(&shape),
                    model.change,
                );
                let verdict = regression.judge(&candidate).filter(|v| v.total() > 0.0);
                let Some(verdict) = verdict else { continue };
                // Amplitudes of noise pass their median so many times once in 2^(square) orders.
                let doubt = tried as f64 * (-line.above * line.above).exp2();
                return Some(Accepted {
                    effect: EffectKind::TorqueRipple,
                    place,
                    own: vec![j],
                    shape,
                    fixed: None,
                    significance: line.amplitude / line.sigma,
                    confidence: (1.0 - doubt).clamp(0.0, HIGHEST_CONFIDENCE),
                    explained_fraction: verdict.explained_fraction,
                    rivals: Vec::new(),
                });
            }
        }
        None
    }

    /// Whether a term is a line: it stays as long as held-out motion does not speak against it.
    pub(in crate::diagnosis) fn is_line(&self, term: &Accepted) -> bool {
        let Place::Joint(j) = term.place else { return false };
        term.effect == EffectKind::TorqueRipple && self.lines.get(j).is_some_and(|l| l.has(term.shape[0]))
    }
}
