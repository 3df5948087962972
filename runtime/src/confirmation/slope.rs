//! How much of what a law predicts is there on motion that it was not fitted to.
//!
//! Let r be what the model without the law leaves of the measured torque, and d what the law changes in the prediction.
//! The slope beta of the regression of r on d is 1 where the law is right and 0 where it is nothing (the calibration
//! regression of a forecast: Mincer and Zarnowitz 1969). Neighbouring rows share their errors: its standard deviation
//! is that of sums over units of a few seconds (Liang and Zeger 1986).

use super::intervals::Intervals;
use crate::prediction::{Evaluation, JointRows};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Units that are wanted. Statistics: nine degrees of freedom, beyond which Student's quantile hardly falls.
const UNITS: f64 = 10.0;
/// Shortest unit, s. Mechanics: longer than what residuals of moving robots remember.
const SHORTEST_UNIT: f64 = 1.0;
/// Level at which a slope is told from 0. Statistics: with all joints and with its own, a law that other motion chose has
/// two chances of one in forty.
const LEVEL: f64 = 0.025;

/// Slope at which a law changes nothing: squares of the residual that go are proportional to 2 beta - 1.
const NEUTRAL: f64 = 0.5;

/// Part of a factor by which it may seem to differ in another motion: inertia and friction that are a few per cent off
/// change what seems to be multiplied. Judgement.
const SAME: f64 = 0.1;

/// The part of a law that other motion shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slope {
    /// 1 where all of it is there, 0 where nothing of it is.
    pub value: f64,
    /// Its standard deviation; `None` where fewer than three units show the law.
    pub sigma: Option<f64>,
    /// Units that show it.
    pub units: usize,
}

/// What a slope says of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Judgement {
    /// It is there, or the motion does not tell.
    Stands,
    /// Less than half of it is there: without it the motion is predicted better.
    Harms,
    /// It cannot be told from nothing, although all of it would have been.
    NotSeen,
}

impl Slope {
    /// Of what changes from model `without` to model `with` of an evaluation, on all joints or on some, but for rows
    /// that the law's `intervals` leave out; `None` where that is nothing.
    pub(super) fn of(
        evaluation: &Evaluation,
        [without, with]: [usize; 2],
        joints: Option<&[usize]>,
        intervals: &Intervals<'_>,
    ) -> Option<Self> {
        let weights = weights(evaluation, without);
        let length = unit_length(&evaluation.rows);
        let mut sums: Vec<(usize, i64, [f64; 2])> = Vec::new();
        for rows in evaluation.rows.iter().filter(|r| joints.is_none_or(|own| own.contains(&r.joint))) {
            for t in (0..rows.used.len()).filter(|&t| rows.used[t] && !intervals.leave_out(rows, t)) {
                let d = rows.predicted[with][t] - rows.predicted[without][t];
                let r = rows.measured[t] - rows.predicted[without][t];
                let w = weights[rows.joint];
                let unit = ((rows.time[t] - rows.time[0]) / length) as i64;
                let key = (rows.trajectory, unit);
                // Joints are listed one after another: what was there first is near the end of the motion's units.
                match sums.iter_mut().rfind(|s| (s.0, s.1) == key) {
                    Some((_, _, sum)) => *sum = [sum[0] + w * r * d, sum[1] + w * d * d],
                    None => sums.push((key.0, key.1, [w * r * d, w * d * d])),
                }
            }
        }
        Self::from_sums(&sums.iter().map(|s| s.2).collect::<Vec<_>>())
    }

    /// From the sums of r d and d d over each unit.
    fn from_sums(sums: &[[f64; 2]]) -> Option<Self> {
        let shown: Vec<&[f64; 2]> = sums.iter().filter(|s| s[1] > 0.0).collect();
        let [product, square] = shown.iter().fold([0.0, 0.0], |t, s| [t[0] + s[0], t[1] + s[1]]);
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        let value = product / square;
        let units = shown.len();
        let sigma = (units >= 3).then(|| {
            let scatter: f64 = shown.iter().map(|s| (s[0] - value * s[1]).powi(2)).sum();
            (scatter * units as f64 / (units - 1) as f64).sqrt() / square
        });
        Some(Self { value, sigma, units })
    }

    /// What it says of the law.
    pub(super) fn judgement(&self) -> Judgement {
        if self.value < NEUTRAL {
            return Judgement::Harms;
        }
        match self.margin() {
            Some(margin) if self.value < margin && margin <= 1.0 => Judgement::NotSeen,
            _ => Judgement::Stands,
        }
    }

    /// Whether all of the law may be there.
    pub(super) fn may_be_whole(&self) -> bool {
        self.margin().is_none_or(|margin| (self.value - 1.0).abs() <= margin)
    }

    /// Whether it is not by accident that the motion is predicted better without the law.
    pub(super) fn certainly_harms(&self) -> bool {
        self.margin().is_some_and(|margin| self.value < NEUTRAL - margin)
    }

    /// Whether another size than that of the law is certain, which is itself known to a relative standard deviation.
    pub(super) fn certainly_differs(&self, known: f64) -> bool {
        let both = Self { sigma: self.sigma.map(|sigma| sigma.hypot(known)), ..*self };
        both.margin().is_some_and(|margin| (self.value - 1.0).abs() > SAME + margin)
    }

    /// What a slope differs by from the true one only in rare cases; `None` where that is not known.
    fn margin(&self) -> Option<f64> {
        let student = StudentsT::new(0.0, 1.0, self.units.checked_sub(1)? as f64).ok()?;
        Some(student.inverse_cdf(1.0 - LEVEL) * self.sigma?)
    }
}

/// One over the mean square that a model leaves of each joint: a joint with small torques counts as much as any.
fn weights(evaluation: &Evaluation, model: usize) -> Vec<f64> {
    let joints = evaluation.rows.iter().map(|r| r.joint + 1).max().unwrap_or(0);
    let mut sums = vec![(0.0, 0_usize); joints];
    for rows in &evaluation.rows {
        for t in (0..rows.used.len()).filter(|&t| rows.used[t]) {
            let sum = &mut sums[rows.joint];
            *sum = (sum.0 + (rows.measured[t] - rows.predicted[model][t]).powi(2), sum.1 + 1);
        }
    }
    sums.iter().map(|&(squares, rows)| if squares > 0.0 { rows as f64 / squares } else { 0.0 }).collect()
}

/// Length of a unit of motion, s.
fn unit_length(rows: &[JointRows]) -> f64 {
    let first_joint = rows.iter().filter(|r| r.joint == 0);
    let duration: f64 = first_joint.filter_map(|r| Some(r.time.last()? - r.time.first()?)).sum();
    (duration / UNITS).max(SHORTEST_UNIT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// Sums over units of a law of size 1 of which `there` is there, in noise that makes its slope `sigma` uncertain.
    fn slope(there: f64, sigma: f64, units: usize, rng: &mut Pcg64) -> Slope {
        let sums: Vec<[f64; 2]> = (0..units)
            .map(|_| {
                let noise: f64 = StandardNormal.sample(rng);
                [there + sigma * (units as f64).sqrt() * noise, 1.0]
            })
            .collect();
        Slope::from_sums(&sums).expect("units that show the law")
    }

    #[test]
    fn slopes_and_their_deviations_are_those_of_a_regression_on_unit_means() {
        // numpy: x = [2, 1, 4], r = [1.8, 1.3, 3.6] per unit, weights x: value = sum(r) / sum(x) of the sums.
        let slope = Slope::from_sums(&[[1.8, 2.0], [1.3, 1.0], [3.6, 4.0]]).expect("three units");
        assert!((slope.value - 6.7 / 7.0).abs() < 1e-12);
        let errors = [1.8 - 2.0 * slope.value, 1.3 - slope.value, 3.6 - 4.0 * slope.value];
        let scatter: f64 = errors.iter().map(|e| e * e).sum::<f64>() * 1.5;
        assert!((slope.sigma.expect("three units") - scatter.sqrt() / 7.0).abs() < 1e-12);
        assert_eq!(Slope::from_sums(&[[0.0, 0.0]]), None);
        assert_eq!(Slope::from_sums(&[[1.0, 1.0], [1.0, 1.0]]).and_then(|s| s.sigma), None);
    }

    #[test]
    fn a_law_that_is_not_there_passes_in_no_more_than_one_case_of_forty() {
        let mut rng = Pcg64::seed_from_u64(1);
        let passes = (0..2000).filter(|_| slope(0.0, 0.3, 8, &mut rng).judgement() == Judgement::Stands);
        assert!(passes.count() <= 75);
    }

    #[test]
    fn a_law_that_is_there_stands_where_the_motion_shows_it_and_where_it_shows_nothing() {
        let mut rng = Pcg64::seed_from_u64(2);
        let stands = |sigma: f64, rng: &mut Pcg64| {
            (0..500).filter(|_| slope(1.0, sigma, 8, rng).judgement() == Judgement::Stands).count()
        };
        assert!(stands(0.1, &mut rng) >= 495);
        assert!(stands(0.2, &mut rng) >= 480);
        // Half of them come out below one half by accident; none of the others is called unseen.
        let unclear = stands(3.0, &mut rng);
        assert!((200..350).contains(&unclear), "{unclear}");
    }

    #[test]
    fn a_factor_of_another_size_is_told_and_one_of_the_same_size_is_not() {
        let mut rng = Pcg64::seed_from_u64(3);
        let mut differs = |there: f64, known: f64| {
            (0..1000).filter(|_| slope(there, 0.1, 8, &mut rng).certainly_differs(known)).count()
        };
        assert!(differs(1.0, 0.0) < 10);
        assert!(differs(1.1, 0.0) < 40, "a tenth is allowed");
        assert!(differs(0.55, 0.0) > 800);
        assert!(differs(0.55, 0.3) < 50, "a factor that is itself known badly may be of that size");
    }
}
