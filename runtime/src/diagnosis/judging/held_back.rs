//! Errors on motion that was held back.

use crate::diagnosis::judging::folds::{cuts, single_motion};
use crate::diagnosis::outcome::Errors;
use crate::diagnosis::predict::errors;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;

/// Squares of the held-out residual and of the torque, per joint, and per held-back stretch.
pub(in crate::diagnosis) struct HeldBack {
    pub left: Vec<f64>,
    pub whole: Vec<f64>,
    pub by_segment: Vec<(usize, f64, f64)>,
}

impl HeldBack {
    pub fn errors(&self) -> Errors {
        errors(&self.left, &self.whole)
    }

    pub fn error_on(&self, joints: &[usize]) -> f64 {
        let pick = |x: &[f64]| joints.iter().map(|&j| x[j]).sum::<f64>();
        (pick(&self.left) / pick(&self.whole).max(1e-300)).sqrt()
    }
}

/// Predicts held-back motion with the columns of a design: every motion once from the others; a single motion
/// forward in time, from two instants on; with a baseline, where `from_baseline` is set, from the baseline alone.
pub(in crate::diagnosis) fn hold_back(design: &Design, sigma: &[f64], from_baseline: bool) -> HeldBack {
    let n = design.joints;
    let targets: Vec<usize> = (0..design.segments.len()).filter(|&g| design.segments[g].is_target).collect();
    let without = |held: &dyn Fn(usize) -> bool| {
        let train: Vec<bool> = (0..design.segments.len()).map(|g| !held(g)).collect();
        (train, targets.iter().copied().filter(|&g| held(g)).collect::<Vec<usize>>())
    };
    let mut moved: Vec<usize> = targets.iter().map(|&g| design.segments[g].signal).collect();
    moved.dedup();
    let splits: Vec<(Vec<bool>, Vec<usize>)> = if from_baseline {
        vec![(design.segments.iter().map(|s| !s.is_target).collect(), targets.clone())]
    } else if single_motion(design) && targets.len() > 1 {
        cuts(targets.len()).map(|cut| without(&|g| targets[cut..].contains(&g))).to_vec()
    } else if moved.len() > 1 {
        moved.iter().map(|&s| without(&|g| design.segments[g].signal == s)).collect()
    } else {
        targets.iter().map(|&held| without(&|g| g == held)).collect()
    };
    let mut out = HeldBack { left: vec![0.0; n], whole: vec![0.0; n], by_segment: Vec::new() };
    let p = design.columns.len();
    for (train, test) in splits {
        let fit = Fit::new(design, sigma, |g: usize| train[g]);
        for g in test {
            let (mut left, mut whole) = (0.0, 0.0);
            for j in 0..n {
                let squares = fit.squares(design, j, g);
                // y is what is left of the torque after terms of fixed amplitude: close enough as a reference.
                let torque = design.gram[j][g][p * (p + 1) + p];
                out.left[j] += squares;
                out.whole[j] += torque;
                left += squares;
                whole += torque;
            }
            out.by_segment.push((g, left, whole));
        }
    }
    out
}
