//! How a recording is split into motion that is fitted and motion that is predicted.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{FORWARD_CUTS, LEFT_OPEN_BY_OTHERS};
use std::collections::BTreeSet;

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

    /// Those of them whose torques of a joint the others tell.
    pub fn told<'a>(&'a self, design: &'a Design, joint: usize) -> impl Iterator<Item = usize> + 'a {
        self.held().filter(move |&g| design.is_told(joint, g))
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

/// Joints and segments whose torques the motion that is not held out with them does not tell: a stretch may have the only fast or
/// far motion of a joint. What the parameters leave open there is more than the noise, so that a prediction tells of them and
/// not of laws. Of a joint of which nothing would be told at all, all is.
///
/// # Errors
/// As [`folds`].
pub(in crate::diagnosis) fn untold(
    design: &Design,
    sigma: &[f64],
) -> Result<BTreeSet<(usize, usize)>, SingularDesign> {
    let mut untold = BTreeSet::new();
    for fold in folds(design, sigma)? {
        let held: Vec<usize> = fold.held().collect();
        let left_open = fold.fit.variance_of_prediction(design, &held);
        let joints = (0..design.joints).filter(|&j| left_open[j] > LEFT_OPEN_BY_OTHERS);
        untold.extend(joints.flat_map(|j| held.iter().map(move |&g| (j, g))));
    }
    let targets = design.target_segments();
    for j in 0..design.joints {
        if targets.iter().all(|&g| untold.contains(&(j, g))) {
            untold.retain(|&(joint, _)| joint != j);
        }
    }
    Ok(untold)
}

/// Where a single motion of so many segments is cut: what comes before is fitted, and predicts what comes after.
pub(in crate::diagnosis) fn forward_cuts(segments: usize) -> [usize; 2] {
    FORWARD_CUTS.map(|eighths| (segments * eighths / 8).max(1))
}

#[cfg(test)]
mod tests {
    use super::{forward_cuts, untold};
    use crate::diagnosis::rows::design::Design;
    use std::collections::BTreeSet;

    /// Two joints of three motions. The parameter of the first one is seen in all of them, that of the second `beside` the last
    /// one, where it counts most, and in that.
    fn untold_of_joints(beside: f64) -> BTreeSet<(usize, usize)> {
        let size = |r: usize| match r / 10 {
            0..3 => [1.0, 0.0],
            3 | 4 => [0.0, beside],
            _ => [0.0, 1.0],
        };
        let column = |k: usize| (0..60).map(|r| size(r)[k]).collect();
        let motions = [(0, true), (1, true), (2, true)];
        let design = Design::made_up(2, &motions, 10, vec![column(0), column(1)], vec![1.0; 60]);
        untold(&design, &[1.0, 1.0]).expect("a small problem is regular")
    }

    #[test]
    fn a_motion_with_most_of_what_shows_a_parameter_is_not_told_by_the_others() {
        // 20 rows of 0.2 know it to 1 / 0.8 of the variance of the noise, 20 rows of 0.3 to 1 / 1.8.
        assert_eq!(untold_of_joints(0.2), BTreeSet::from([(1, 2)]));
        assert!(untold_of_joints(0.3).is_empty());
    }

    #[test]
    fn of_a_joint_that_one_motion_alone_shows_all_is_judged() {
        let column: Vec<f64> = (0..30).map(|r| f64::from(u8::from(r < 10))).collect();
        let design = Design::made_up(1, &[(0, true), (1, true), (2, true)], 10, vec![column], vec![1.0; 30]);
        let untold = untold(&design, &[1.0]).expect("a small problem is regular");
        // The others bear nothing of it, and predict each other.
        assert_eq!(untold, BTreeSet::from([(0, 0)]));
        let one = Design::made_up(1, &[(0, true)], 10, vec![vec![1.0; 10]], vec![1.0; 10]);
        assert!(super::untold(&one, &[1.0]).expect("a small problem is regular").is_empty());
    }

    #[test]
    fn a_single_motion_is_cut_at_five_and_six_eighths() {
        assert_eq!(forward_cuts(8), [5, 6]);
        assert_eq!(forward_cuts(4), [2, 3]);
        assert_eq!(forward_cuts(1), [1, 1]);
    }
}
