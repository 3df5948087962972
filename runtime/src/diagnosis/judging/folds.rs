//! How a recording is split into motion that is fitted and motion that is predicted.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::FORWARD_CUTS;

/// A split: the fit to some segments, and the segments that it predicts.
#[derive(Clone)]
pub(in crate::diagnosis) struct Fold {
    /// Segments that are held out.
    pub test: Vec<bool>,
    /// Fit to all others.
    pub fit: Fit,
}

impl Fold {
    /// Segments that are held out.
    pub fn held(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.test.len()).filter(|&g| self.test[g])
    }
}

/// Every segment of the recording that is diagnosed held out once: a whole motion, a stretch of one, or of all.
///
/// # Errors
/// [`SingularDesign`] where a fold has no fit.
pub(in crate::diagnosis) fn folds(design: &Design, sigma: &[f64]) -> Result<Vec<Fold>, SingularDesign> {
    let fold = |held: Vec<usize>| {
        let test: Vec<bool> = (0..design.segments.len()).map(|g| held.contains(&g)).collect();
        let train: Vec<bool> = test.iter().map(|t| !t).collect();
        Ok(Fold { test, fit: Fit::new(design, sigma, train)? })
    };
    design.held_out_together().into_iter().map(fold).collect()
}

/// Where a single motion of so many segments is cut: what comes before is fitted, and predicts what comes after.
pub(in crate::diagnosis) fn forward_cuts(segments: usize) -> [usize; 2] {
    FORWARD_CUTS.map(|eighths| (segments * eighths / 8).max(1))
}

#[cfg(test)]
mod tests {
    use super::forward_cuts;

    #[test]
    fn a_single_motion_is_cut_at_five_and_six_eighths() {
        assert_eq!(forward_cuts(8), [5, 6]);
        assert_eq!(forward_cuts(4), [2, 3]);
        assert_eq!(forward_cuts(1), [1, 1]);
    }
}
