//! Errors on motion that was held out.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::folds::forward_cuts;
use crate::diagnosis::judging::hull::{Beyond, Curve};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::outcome::Errors;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::LEFT_OPEN_AT_MOST;

/// Squares of the held-out residual and of the torque.
pub(in crate::diagnosis) struct HeldOutSquares {
    /// Residual, per joint.
    pub left: Vec<f64>,
    /// Torque, per joint.
    pub whole: Vec<f64>,
    /// Per held-out segment: its index, residual and torque of all joints.
    pub by_segment: Vec<(usize, f64, f64)>,
}

/// Segments that are fitted, and those that the fit predicts.
type Split = (Vec<bool>, Vec<usize>);

impl HeldOutSquares {
    /// Predicts held-out motion with the columns of a design: every motion, or stretch, once from the others; a single motion
    /// forward in time, from two instants on, where these show something of it; where `from_baseline` is set, the new motion from
    /// the baseline alone, where that does. Rows of which one of the `curves` says nothing are left out, whether it is in the
    /// design or not; so are those of which the others tell nothing ([`Design::is_told`]).
    ///
    /// # Errors
    /// [`SingularDesign`] where a split has no fit.
    pub fn of(
        design: &Design,
        sigma: &[f64],
        from_baseline: bool,
        curves: &[Curve],
    ) -> Result<Self, SingularDesign> {
        let n = design.joints;
        let from_baseline = from_baseline && baseline_tells(design, sigma);
        let mut out = Self { left: vec![0.0; n], whole: vec![0.0; n], by_segment: Vec::new() };
        // A curve that is a change says nothing where only the baseline is fitted: its rows are those that it is judged
        // on.
        let judged = if from_baseline && !curves.is_empty() { splits(design, false) } else { Vec::new() };
        for (train, test) in splits(design, from_baseline) {
            let beyond = if from_baseline { Vec::new() } else { Beyond::each(design, curves, &train) };
            let fit = Fit::new(design, sigma, train)?;
            for g in test {
                let own = judged.iter().find(|(_, test)| test.contains(&g));
                match own.map(|(train, _)| Beyond::each(design, curves, train)) {
                    Some(own) => out.add(design, &fit, g, &own),
                    None => out.add(design, &fit, g, &beyond),
                }
            }
        }
        Ok(out)
    }

    fn add(&mut self, design: &Design, fit: &Fit, segment: usize, beyond: &[Beyond]) {
        let (mut left, mut whole) = (0.0, 0.0);
        for j in (0..design.joints).filter(|&j| design.is_told(j, segment)) {
            // y is what is left of the torque after terms of fixed amplitude: close enough as a reference.
            let (squares, torque) = if beyond.iter().any(|beyond| beyond.joint == j) {
                let seen = |r: &usize| !beyond.iter().any(|beyond| beyond.contains(*r));
                let rows: Vec<usize> = design.ranges[j][segment].clone().filter(seen).collect();
                let squares = fit.residual_on(design, &rows).iter().map(|left| left * left).sum();
                (squares, rows.iter().map(|&r| design.torque(r).powi(2)).sum())
            } else {
                (fit.squares(design, j, segment), design.torque_squares(j, segment))
            };
            self.left[j] += squares;
            self.whole[j] += torque;
            left += squares;
            whole += torque;
        }
        self.by_segment.push((segment, left, whole));
    }

    /// Relative errors, all joints together and joint by joint.
    pub fn errors(&self) -> Errors {
        Errors::of_squares(&self.left, &self.whole)
    }

    /// Relative error of some joints together.
    pub fn error_on(&self, joints: &[usize]) -> f64 {
        let pick = |x: &[f64]| joints.iter().map(|&j| x[j]).sum::<f64>();
        (pick(&self.left) / pick(&self.whole).max(1e-300)).sqrt()
    }
}

impl Regression {
    /// Errors on held-out motion with everything that is in the regression, on rows that these curves say something of.
    ///
    /// # Errors
    /// As [`HeldOutSquares::of`].
    pub fn held_out(&self, from_baseline: bool, curves: &[Curve]) -> Result<HeldOutSquares, SingularDesign> {
        HeldOutSquares::of(&self.design, &self.sigma, from_baseline, curves)
    }
}

/// Whether a baseline tells of the parameters that the new motion needs: what it leaves open of them would else be all of the
/// error.
fn baseline_tells(design: &Design, sigma: &[f64]) -> bool {
    let targets = design.target_segments();
    let is_old = design.segments.iter().map(|s| !s.is_target).collect();
    Fit::new(design, sigma, is_old).is_ok_and(|baseline| {
        baseline.variance_of_prediction(design, &targets).iter().all(|open| *open <= LEFT_OPEN_AT_MOST)
    })
}

fn splits(design: &Design, from_baseline: bool) -> Vec<Split> {
    let segments = 0..design.segments.len();
    let targets = design.target_segments();
    let without = |held: &dyn Fn(usize) -> bool| -> Split {
        let train = segments.clone().map(|g| !held(g)).collect();
        (train, targets.iter().copied().filter(|&g| held(g)).collect())
    };
    let mut motions: Vec<usize> = targets.iter().map(|&g| design.segments[g].signal).collect();
    motions.dedup();
    if from_baseline {
        vec![(design.segments.iter().map(|s| !s.is_target).collect(), targets)]
    } else if design.is_forward() && targets.len() > 1 {
        forward_cuts(targets.len()).map(|cut| without(&|g| targets[cut..].contains(&g))).to_vec()
    } else if motions.len() > 1 && !design.together {
        motions.iter().map(|&s| without(&|g| design.segments[g].signal == s)).collect()
    } else {
        design.held_out_together().iter().map(|held| without(&|g| held.contains(&g))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::folds::folds;

    /// One joint, one column that is the torque but for a little.
    fn design(segments: &[(usize, bool)]) -> Design {
        let rows = 10 * segments.len();
        let column: Vec<f64> = (0..rows).map(|r| (0.7 * r as f64).sin()).collect();
        let y = (0..rows).map(|r| 2.0 * column[r] + 0.01 * (3.1 * r as f64).cos()).collect();
        Design::made_up(1, segments, 10, vec![column], y)
    }

    #[test]
    fn every_segment_of_the_recording_is_held_out_once_and_none_of_the_baseline() {
        let design = design(&[(0, false), (1, true), (1, true), (2, true)]);
        let folds = folds(&design, &[1.0]).expect("a small problem is regular");
        assert_eq!(folds.len(), 3);
        for g in 0..4 {
            let times = folds.iter().filter(|fold| fold.test[g]).count();
            assert_eq!(times, usize::from(design.segments[g].is_target), "segment {g}");
        }
        for fold in &folds {
            assert!(fold.test.iter().zip(&fold.fit.train).all(|(test, train)| test != train));
        }
    }

    #[test]
    fn a_single_motion_is_predicted_forward_in_time() {
        // Three stretches come after the first cut, two of them after the second.
        let held = HeldOutSquares::of(&design(&[(0, true); 8]), &[1.0], false, &[])
            .expect("a small problem is regular");
        let segments: Vec<usize> = held.by_segment.iter().map(|s| s.0).collect();
        assert_eq!(segments, [5, 6, 7, 6, 7]);
    }

    #[test]
    fn every_stretch_of_a_single_motion_is_predicted_where_what_comes_first_shows_nothing() {
        let mut design = design(&[(0, true); 8]);
        design.forward = false;
        let held = HeldOutSquares::of(&design, &[1.0], false, &[]).expect("a small problem is regular");
        assert_eq!(held.by_segment.iter().map(|s| s.0).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn of_several_motions_each_is_predicted_from_the_others() {
        let held = HeldOutSquares::of(&design(&[(0, true), (0, true), (1, true)]), &[1.0], false, &[])
            .expect("a small problem is regular");
        let mut segments: Vec<usize> = held.by_segment.iter().map(|s| s.0).collect();
        segments.sort_unstable();
        assert_eq!(segments, [0, 1, 2]);
        assert!(held.errors().relative_error.is_some_and(|error| error < 0.02));
    }

    #[test]
    fn from_a_baseline_alone_all_of_the_recording_is_predicted() {
        let held = HeldOutSquares::of(&design(&[(0, false), (1, true), (2, true)]), &[1.0], true, &[])
            .expect("a small problem is regular");
        assert_eq!(held.by_segment.iter().map(|s| s.0).collect::<Vec<_>>(), [1, 2]);
    }

    #[test]
    fn a_fit_knows_how_well_it_predicts_what_it_was_not_fitted_to() {
        // A column of size 1 in the first motion and of size 3 in the second, another that is in the second alone.
        let column: Vec<f64> = (0..20).map(|r| if r < 10 { 1.0 } else { 3.0 }).collect();
        let mut design = Design::made_up(1, &[(0, true), (1, true)], 10, vec![column], vec![1.0; 20]);
        let fit = |design: &Design| Fit::new(design, &[0.5], vec![true, false]).expect("it is regular");
        // Its parameter is known to sigma^2 / 10, and counts nine times.
        let variance = fit(&design).variance_of_prediction(&design, &[1])[0];
        assert!((variance - 0.9).abs() < 1e-6, "{variance}");
        design.push((0..20).map(|r| f64::from(u8::from(r >= 10))).collect());
        design.refresh();
        // Of a column that is no base parameter, as of a law in the second motion alone, nothing was to be told before.
        assert!((fit(&design).variance_of_prediction(&design, &[1])[0] - 0.9).abs() < 1e-6);
        design.parameters = 2;
        assert_eq!(fit(&design).variance_of_prediction(&design, &[1]), [f64::INFINITY]);
    }

    #[test]
    fn a_design_that_is_not_finite_has_no_folds() {
        let mut design = design(&[(0, true), (1, true)]);
        design.columns[0][3] = f64::NAN;
        design.refresh();
        assert_eq!(folds(&design, &[1.0]).err(), Some(SingularDesign { columns: 1 }));
    }
}
