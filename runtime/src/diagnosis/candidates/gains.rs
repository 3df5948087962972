//! Gains of the drives that a body shows.
//!
//! What is wrong with the gain of a drive is part of the parameters of an unloaded robot, and cannot be told from them there.
//! A body that is taken up shows it: each joint feels the same body, and weighs it with its own gain (Gautier and Briot
//! 2014). Beside a body that was not there before, the body's torque on each joint may therefore differ by a factor that is
//! known to be near one: it is fitted and never named.

use crate::diagnosis::candidates::trial::{dense, gathered};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::GAIN_DEVIATION;
use crate::estimation::RANK_TOLERANCE;
use nalgebra::{Cholesky, DMatrix, DVector};

/// A column per joint, over all rows; none where nothing is carried that was not carried before.
pub(in crate::diagnosis) fn gain_columns(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    if context.additions().bodies.iter().all(|body| body.in_baseline) {
        return Vec::new();
    }
    let of_motion = |k: usize| {
        let torques = context.of_new_bodies(k).into_iter().enumerate();
        torques.map(|of_joint| vec![of_joint]).collect()
    };
    let silent = |k: usize| !context.signals[k].is_target;
    gathered(context, design, silent, of_motion).iter().map(|column| dense(design, column)).collect()
}

/// Information on amplitudes of a body where each joint weighs it with its own gain; `of_each_joint` is what the torque of
/// the body on one joint alone says of them. The covariance grows by what gains make of them (Sherman, Morrison, Woodbury).
pub(in crate::diagnosis) fn weighed_with_gains(
    information: &DMatrix<f64>,
    of_each_joint: &[DVector<f64>],
) -> DMatrix<f64> {
    let of_gains = DMatrix::from_columns(of_each_joint);
    let Ok(inverse) = information.clone().pseudo_inverse(RANK_TOLERANCE * information.amax()) else {
        return information.clone();
    };
    let gains = of_each_joint.len();
    let known = DMatrix::from_diagonal_element(gains, gains, GAIN_DEVIATION.powi(-2));
    match Cholesky::new(known + of_gains.transpose() * inverse * &of_gains) {
        Some(factor) => information - &of_gains * factor.solve(&of_gains.transpose()),
        None => information.clone(),
    }
}

/// How much gains differ from one, given what fits with a deviation of `before` say of those that the body shows: value and
/// variance. One step of expectation and maximisation for a variance of random effects (Laird and Ware 1982), and no more
/// than what drives have.
pub(in crate::diagnosis) fn deviation_of_gains(of: &[(f64, f64)], before: f64) -> f64 {
    if of.is_empty() {
        return before;
    }
    let mean = of.iter().map(|(value, variance)| value * value + variance).sum::<f64>() / of.len() as f64;
    mean.sqrt().min(GAIN_DEVIATION)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_take_away_what_one_joint_alone_would_tell_of_a_body() {
        // Two joints feel one number with slopes 3 and 4 in noise of one.
        let felt = |slopes: &[f64], a: f64| -> Vec<DVector<f64>> {
            slopes.iter().map(|z| DVector::from_element(1, z * z * a)).collect()
        };
        let information = DMatrix::from_element(1, 1, 25.0);
        let with_gains = weighed_with_gains(&information, &felt(&[3.0, 4.0], 2.0));
        // Its variance is 1/25, and (9 g1 + 16 g2) 2 / 25 for gains g of the deviation.
        let of_gains = (9.0_f64.powi(2) + 16.0_f64.powi(2)) * (2.0 * GAIN_DEVIATION / 25.0).powi(2);
        approx::assert_relative_eq!(1.0 / with_gains[(0, 0)], 1.0 / 25.0 + of_gains, max_relative = 1e-12);
    }

    #[test]
    fn gains_that_agree_are_known_to_and_those_that_differ_do_as_drives_do() {
        assert!(deviation_of_gains(&[(0.0, 1e-6); 3], GAIN_DEVIATION) < 0.0011);
        assert_eq!(deviation_of_gains(&[(0.2, 1e-6); 3], GAIN_DEVIATION), GAIN_DEVIATION);
        assert_eq!(deviation_of_gains(&[], 0.03), 0.03);
    }
}
