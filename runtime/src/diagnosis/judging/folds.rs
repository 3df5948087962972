//! How a recording is split into motion that is fitted and motion that is predicted.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;

/// Motion that is fitted and motion that is predicted.
pub(in crate::diagnosis) struct Fold {
    pub train: Vec<bool>,
    pub test: Vec<bool>,
    pub fit: Fit,
}

/// How the recording is split: every motion once held back, or, for a single motion, every stretch of it.
pub(in crate::diagnosis) fn folds(design: &Design, sigma: &[f64]) -> Vec<Fold> {
    let targets: Vec<usize> = (0..design.segments.len()).filter(|&g| design.segments[g].is_target).collect();
    targets
        .iter()
        .map(|&held| {
            let test: Vec<bool> = (0..design.segments.len()).map(|g| g == held).collect();
            let train: Vec<bool> = test.iter().map(|t| !t).collect();
            let fit = Fit::new(design, sigma, |g| train[g]);
            Fold { train, test, fit }
        })
        .collect()
}

/// Whether all segments are stretches of one motion.
pub(in crate::diagnosis) fn single_motion(design: &Design) -> bool {
    design.segments.windows(2).all(|s| s[0].signal == s[1].signal)
}

/// Where a single motion of so many segments is cut: what comes before is fitted, and predicts what comes after.
pub(in crate::diagnosis) fn cuts(segments: usize) -> [usize; 2] {
    [5, 6].map(|eighths| (segments * eighths / 8).max(1))
}
