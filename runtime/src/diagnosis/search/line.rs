//! Torque ripple that stands out as a line in the orders of a joint: looked for beside the laws that explain a share of
//! the rows, which a line of a few per cent, or one that is faster than the rows, never does.

use crate::diagnosis::candidates::order_line::{Line, Stroke, lines, resolution};
use crate::diagnosis::candidates::spectrum::peaks;
use crate::diagnosis::outcome::OrderSpectrum;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rules::{LINE_COVERED, LINE_MULTIPLES, LINE_PICKED};
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, Place};
use crate::parallel;

/// The lines of one joint, and how close two orders are one.
#[derive(Debug, Clone, Default)]
pub(in crate::diagnosis) struct JointLines {
    pub lines: Vec<Line>,
    pub resolution: f64,
    /// Standard deviation of the positions at which the joint moves, rad or m.
    pub spread: f64,
    /// Orders that motors are known to have.
    pub known: usize,
    /// All orders that were tried: those and the spectrum's.
    pub tried: usize,
    /// Rms of the torque, N.m or N.
    pub torque: f64,
}

/// Lines of every joint in the recording that is diagnosed. None where there is a baseline: whether a line is new would
/// have to be shown in motion of the baseline that could show it.
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
            .enumerate()
            .map(|(k, s)| {
                let (torque, band) = s.recorded_torque(j);
                let model = &context.torques(k).total[j];
                (torque.iter().zip(model).map(|(y, t)| y - t).collect(), band)
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
                        cutoff: s.cutoff(),
                    }
                })
                .collect()
        };
        let now = strokes(true);
        let gear = spectra[j].gear;
        // Of a joint whose gear is not known there are no multiples to ask for.
        let known: Vec<f64> =
            if gear > 1.0 { LINE_MULTIPLES.iter().map(|k| k * gear).collect() } else { Vec::new() };
        let picked = peaks(&spectra[j], LINE_PICKED);
        let resolution = resolution(&now);
        // Where a motor's angle begins differs from one start to the next, and so do the phases of its waves: what was
        // there before looks as new as what was not.
        let alone = context.reference.is_none() && context.is_alone();
        let new = if alone { lines(&now, &known, &picked, slowest[j]) } else { Vec::new() };
        let torques = context.signals.iter().filter(|s| s.is_target).flat_map(|s| &s.torque[j]);
        let (squares, count) = torques.fold((0.0, 0), |(sum, n), y| (sum + y * y, n + 1));
        JointLines {
            lines: new,
            resolution,
            spread: spread(&now, slowest[j]),
            known: known.len(),
            tried: known.len() + spectra[j].order.len(),
            torque: (squares / f64::from(count.max(1))).sqrt(),
        }
    })
}

impl Search<'_> {
    /// Lines that are certain and no part of the model, per joint that has any: strongest first.
    pub fn lines_beside_model(&self, settings: &Settings) -> Vec<(usize, Vec<&Line>)> {
        let level = 1.0 - settings.confidence_of_one_search();
        let of_joint = |j: usize| -> (usize, Vec<&Line>) {
            let found = &self.lines[j];
            let place = Place::Joint(j);
            let near = LINE_COVERED as f64 * found.resolution;
            let ripple = |t: &&Accepted| t.effect == EffectKind::TorqueRipple && t.place == place;
            let orders: Vec<f64> =
                self.model.terms.iter().filter(ripple).flat_map(|t| t.shape.iter().copied()).collect();
            let in_model = |line: &Line| orders.iter().any(|order| (order - line.order).abs() <= near);
            let sure = |line: &&Line| self.doubt(line) <= level && !in_model(line);
            (j, found.lines.iter().filter(sure).collect())
        };
        let all = (0..self.lines.len()).map(of_joint);
        all.filter(|(_, lines)| !lines.is_empty()).collect()
    }

    /// Probability that noise has a line like this one anywhere.
    pub fn doubt(&self, line: &Line) -> f64 {
        let of_all = |number: fn(&JointLines) -> usize| self.lines.iter().map(number).sum::<usize>() as f64;
        let tried = if line.known { of_all(|lines| lines.known) } else { of_all(|lines| lines.tried) };
        tried * line.p_value
    }
}

/// Standard deviation of the positions at which a joint moves faster than `slowest`.
fn spread(strokes: &[Stroke<'_>], slowest: f64) -> f64 {
    let moving = |s: &Stroke<'_>| -> Vec<f64> {
        s.q.iter().zip(s.dq).filter(|(_, v)| v.abs() > slowest).map(|(q, _)| *q).collect()
    };
    let positions: Vec<f64> = strokes.iter().flat_map(moving).collect();
    let count = positions.len().max(1) as f64;
    let mean = positions.iter().sum::<f64>() / count;
    (positions.iter().map(|q| (q - mean).powi(2)).sum::<f64>() / count).sqrt()
}
