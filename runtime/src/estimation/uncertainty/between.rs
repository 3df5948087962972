//! Parameters that differ between motions by more than the noise within them: random effects.

use crate::statistics::moderation::{Prior, Variance};
use nalgebra::{DMatrix, DVector};

/// Fewer motions do not tell how much they differ.
const FEWEST: usize = 3;
/// The normal deviate that one of a hundred exceeds.
const ONE_OF_A_HUNDRED: f64 = 2.326;

/// The part of one motion in the equations ZT V W chi = ZT V Y.
#[derive(Debug, Clone)]
pub(super) struct MotionPart {
    /// ZT V W of its rows.
    pub information: DMatrix<f64>,
    /// Covariance of ZT V e of its rows, for noise e as it is within motions.
    pub spread: DMatrix<f64>,
    /// ZT V Y of its rows.
    pub right: DVector<f64>,
}

/// For each unknown the factor, 1 at least, by which the motions make its variance larger than the noise within them does.
///
/// With A the sum of the information A_m of the motions, motion m moves the estimate by A^-1 s_m, s_m = ZT V (Y - W chi)
/// of its rows. These add up to zero, and noise within the motions gives them the covariance A^-1 [(E - A_m A^-1) B_m
/// (E - A_m A^-1)T + A_m A^-1 (B - B_m) A^-T A_mT] A^-T, B_m that of ZT V e. The sum of their squares over what that
/// makes expected is 1 on average where nothing but noise differs, and else what a parameter's own change from motion to
/// motion adds (DerSimonian and Laird 1986, as a factor: Birge 1932). Few motions give few degrees of freedom: the
/// unknowns lend each other theirs ([`Prior`]), all of them where they do not differ. One that stands out by more than
/// noise makes of a hundred is not made smaller by the others.
///
/// Ones for fewer than three motions.
pub(super) fn factors(parts: &[MotionPart], unknowns: usize) -> Vec<f64> {
    let ones = vec![1.0; unknowns];
    if parts.len() < FEWEST {
        return ones;
    }
    let zero = DMatrix::<f64>::zeros(unknowns, unknowns);
    let information = parts.iter().fold(zero.clone(), |sum, p| sum + &p.information);
    let spread = parts.iter().fold(zero, |sum, p| sum + &p.spread);
    let right = parts.iter().fold(DVector::<f64>::zeros(unknowns), |sum, p| sum + &p.right);
    let Some(inverse) = information.try_inverse() else { return ones };
    let chi = &inverse * right;
    // Of each unknown: squares as they are, as they are expected, and the squares of the latter.
    let mut found = vec![0.0; unknowns];
    let mut expected = vec![0.0; unknowns];
    let mut squared = vec![0.0; unknowns];
    for part in parts {
        let moved = &inverse * (&part.right - &part.information * &chi);
        let share = &inverse * &part.information;
        let own = &inverse * &part.spread * inverse.transpose();
        let others = &inverse * (&spread - &part.spread) * inverse.transpose();
        let kept = DMatrix::identity(unknowns, unknowns) - &share;
        let (of_own, of_others) = (&kept * own, &share * others);
        for l in 0..unknowns {
            let variance = of_own.row(l).dot(&kept.row(l)) + of_others.row(l).dot(&share.row(l));
            found[l] += moved[l].powi(2);
            expected[l] += variance;
            squared[l] += variance * variance;
        }
    }
    // As many degrees of freedom as equal parts would have (Satterthwaite 1946), one less for the mean.
    let motions = parts.len() as f64;
    let squares = |l: usize| {
        let equal = expected[l].powi(2) / squared[l];
        let freedom = equal * (motions - 1.0) / motions;
        Variance { value: found[l] / expected[l], freedom }
    };
    let all: Vec<Variance> = (0..unknowns).map(squares).collect();
    if all.iter().any(|s| !(s.value.is_finite() && s.freedom.is_finite())) {
        return ones;
    }
    let Some(prior) = Prior::of_groups(&all) else { return ones };
    let factor = |own: Variance| {
        let stands_out = own.value > rare_mean_square(own.freedom);
        prior.moderate(own).value.max(if stands_out { own.value } else { 1.0 })
    };
    all.into_iter().map(factor).collect()
}

/// What the mean square of so many normal deviates exceeds in one of a hundred (Wilson and Hilferty 1931).
fn rare_mean_square(freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    (1.0 - spread + ONE_OF_A_HUNDRED * spread.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    const MOTIONS: usize = 8;
    const ROWS: usize = 60;
    /// As many as of a small robot.
    const UNKNOWNS: usize = 12;
    const LAST: usize = UNKNOWNS - 1;

    /// Motions with noise of 1; the last unknown changes from motion to motion by `change`.
    fn drawn(seed: u64, change: f64) -> (Vec<MotionPart>, DVector<f64>) {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let mut parts = Vec::new();
        for _ in 0..MOTIONS {
            let own = change * draw();
            let w = DMatrix::from_fn(ROWS, UNKNOWNS, |_, _| draw());
            let y = DVector::from_fn(ROWS, |t, _| own * w[(t, LAST)] + draw());
            let information = w.tr_mul(&w);
            parts.push(MotionPart { spread: information.clone(), right: w.tr_mul(&y), information });
        }
        let information =
            parts.iter().fold(DMatrix::zeros(UNKNOWNS, UNKNOWNS), |sum, p| sum + &p.information);
        let right = parts.iter().fold(DVector::zeros(UNKNOWNS), |sum, p| sum + &p.right);
        let chi = information.try_inverse().expect("independent columns") * right;
        (parts, chi)
    }

    #[test]
    fn intervals_hold_for_what_changes_between_motions_and_for_what_it_disturbs() {
        let (mut inside, mut before, mut others) = (0, 0, 0);
        let seeds = 300;
        for seed in 0..seeds {
            let (parts, chi) = drawn(seed, 1.0);
            let factors = factors(&parts, UNKNOWNS);
            let information =
                parts.iter().fold(DMatrix::zeros(UNKNOWNS, UNKNOWNS), |sum, p| sum + &p.information);
            let inverse = information.try_inverse().expect("independent columns");
            let sigma = inverse[(LAST, LAST)].sqrt();
            before += usize::from(chi[LAST].abs() < 1.96 * sigma);
            inside += usize::from(chi[LAST].abs() < 1.96 * sigma * factors[LAST].sqrt());
            let own = |l: &usize| chi[*l].abs() < 1.96 * (inverse[(*l, *l)] * factors[*l]).sqrt();
            others += (0..LAST).filter(own).count();
        }
        let share = |count: usize| count as f64 / seeds as f64;
        assert!(share(before) < 0.5, "{}", share(before));
        // Eight motions have seven degrees of freedom: an interval of 1.96 sigma holds in 91 of 100.
        assert!((0.88..=0.97).contains(&share(inside)), "{}", share(inside));
        // What changes is noise for the others: it doubles the mean square in their equations.
        let others = share(others) / LAST as f64;
        assert!((0.9..=0.97).contains(&others), "{others}");
    }

    #[test]
    fn motions_that_differ_by_noise_alone_hardly_change_an_interval() {
        let seeds = 200;
        let mean = |seed| {
            factors(&drawn(seed, 0.0).0, UNKNOWNS).iter().map(|f| f.sqrt()).sum::<f64>() / UNKNOWNS as f64
        };
        let all: f64 = (0..seeds).map(mean).sum::<f64>() / seeds as f64;
        assert!((1.0..1.1).contains(&all), "{all}");
        assert_eq!(factors(&drawn(1, 3.0).0[..2], UNKNOWNS), vec![1.0; UNKNOWNS]);
    }
}
