//! The rows of a joint that pushes are looked for in.

use crate::diagnosis::contact::borne_once::{Load, borne_once};
use crate::diagnosis::contact::curves::curves;
use crate::diagnosis::contact::silent::Silent;
use crate::diagnosis::judging::autocorrelation::Places;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use std::collections::HashSet;
use std::ops::Range;

/// Rows of one joint, and what its residual is judged beside.
pub(in crate::diagnosis) struct Track {
    /// 0-based.
    pub joint: usize,
    /// For each motion whether it belongs to the recording that is diagnosed, the places of its rows on the grid of rows,
    /// increasing, and their residual.
    pub motions: Vec<(bool, Vec<(usize, f64)>)>,
    /// Curves over the joint's own state that the residual is judged beside, over the rows of all motions.
    pub beside: Vec<Vec<f64>>,
    /// What the size of its noise may be proportional to, over the same rows.
    pub sizes: Vec<Vec<f64>>,
    /// Columns of the model that leaves the residual, the same number for all joints, over the same rows; empty where a column
    /// is zero on this joint.
    pub columns: Vec<Vec<f64>>,
    /// Motions and places of the rows with loads that the recording has once.
    pub once: HashSet<(usize, usize)>,
}

/// What a model leaves of the torques.
pub(in crate::diagnosis) struct Left<'a> {
    /// Of every row.
    pub residual: &'a [f64],
    /// Columns on the same rows of which every joint may have its own part: what is like them is no push.
    pub beside: &'a [Vec<f64>],
    /// Columns on the same rows that the model was fitted with.
    pub fitted: &'a [Vec<f64>],
    /// Where the model says nothing.
    pub silent: &'a Silent,
}

impl Track {
    /// The rows of a joint at which the model is not silent.
    pub fn of(context: &Context<'_>, design: &Design, left: &Left<'_>, joint: usize) -> Self {
        let signals = context.signals;
        let places = Places::of(design, joint);
        let mut kept: Vec<usize> = Vec::new();
        let mut of_motion = |(k, rows): (usize, &Vec<(usize, usize)>)| {
            let silent = left.silent.samples(context, joint, k);
            let rows = rows.iter().filter(|(_, r)| !silent[design.rows[*r].centre]);
            let rows: Vec<(usize, usize)> = rows.copied().collect();
            kept.extend(rows.iter().map(|&(_, r)| r));
            (signals[k].is_target, rows.iter().map(|&(place, r)| (place, left.residual[r])).collect())
        };
        let motions = places.motions().iter().enumerate().map(&mut of_motion).collect();
        let at: Vec<(usize, usize)> =
            kept.iter().map(|&r| (design.rows[r].signal, design.rows[r].centre)).collect();
        let mut beside = curves(context, joint, &at);
        let on_kept = |column: &Vec<f64>| -> Vec<f64> { kept.iter().map(|&r| column[r]).collect() };
        beside.extend(left.beside.iter().map(on_kept));
        let of_joint = |column: &Vec<f64>| {
            if kept.iter().any(|&r| column[r] != 0.0) { on_kept(column) } else { Vec::new() }
        };
        let over = |value: &dyn Fn(usize, usize) -> f64| at.iter().map(|&(k, t)| value(k, t)).collect();
        let mut sizes: Vec<Vec<f64>> =
            vec![over(&|k, t| context.torques(k).total[joint][t]), over(&|k, t| signals[k].dq[joint][t])];
        // Noise of a position, and of a controller that sees it, is felt by every joint that its acceleration turns.
        sizes.extend((0..design.joints).map(|of| over(&|k, t| context.coupling(k, joint, of)[t])));
        let columns = left.fitted.iter().map(of_joint).collect();
        let once = places_borne_once(context, design, joint, &places);
        Self { joint, motions, beside, sizes, columns, once }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.motions.iter().map(|motion| motion.1.len()).sum()
    }

    /// Whether most of some places of a motion have loads that the recording has once.
    pub fn is_borne_once(&self, motion: usize, places: Range<usize>) -> bool {
        let once = places.clone().filter(|&place| self.once.contains(&(motion, place))).count();
        2 * once > places.len()
    }
}

/// Motions and places of the recording at which a joint has loads that it has once.
fn places_borne_once(
    context: &Context<'_>,
    design: &Design,
    joint: usize,
    places: &Places,
) -> HashSet<(usize, usize)> {
    let (mut at, mut loads) = (Vec::new(), Vec::new());
    let motions = places.motions().iter().enumerate();
    for (motion, rows) in motions.filter(|(motion, _)| context.signals[*motion].is_target) {
        for &(place, r) in rows {
            let t = design.rows[r].centre;
            let torque = context.torques(motion).total[joint][t];
            at.push((motion, place));
            loads.push(Load { motion, time: context.signals[motion].time(t), torque });
        }
    }
    at.into_iter().zip(borne_once(&loads)).filter(|(_, once)| *once).map(|(at, _)| at).collect()
}
