//! A robot against those with the same table.

use crate::robust::{median, qn};
use crate::types::SiblingComparison;
use statrs::function::gamma::ln_gamma;

/// Degrees of freedom of the levels of healthy siblings: tails heavier than Gaussian ones, since a few dozen siblings
/// do not show their tails.
const TAILS: f64 = 12.0;
/// Robust deviations of which a robot that is unlike its siblings is off: the scale of the Cauchy distribution bet on.
const UNLIKE: f64 = 6.0;

/// More robots than this and one of them does not matter in the centre and spread of all.
const MANY: usize = 40;

/// The levels of robots with one table.
pub(crate) struct Levels {
    levels: Vec<f64>,
    /// Centre and spread of all, where they are many.
    all: Option<(f64, f64)>,
}

impl Levels {
    pub(crate) fn new(levels: Vec<f64>) -> Self {
        let all = if levels.len() > MANY { median(&levels).zip(qn(&levels)) } else { None };
        Self { levels, all }
    }

    /// Where a robot with the level `own` stands, which is `place` among the levels; `None` where there are fewer than two
    /// others. The spread counts as at least the level's own standard deviation.
    pub(crate) fn compare(&self, place: usize, own: f64, own_sigma: f64) -> Option<SiblingComparison> {
        let others = || -> Vec<f64> {
            self.levels.iter().enumerate().filter(|(k, _)| *k != place).map(|(_, l)| *l).collect()
        };
        let (centre, spread) = match self.all {
            Some(all) => all,
            None => (median(&others())?, qn(&others())?),
        };
        let width = spread.max(own_sigma);
        let deviations = if width > 0.0 { (own - centre) / width } else { 0.0 };
        Some(SiblingComparison { siblings: self.levels.len() - 1, centre, spread, deviations })
    }
}

/// Logarithm of the e-value of a comparison: a likelihood ratio of a wide distribution to that of healthy siblings, whose
/// levels are exchangeable. It is one look at one number; it cannot grow with the days, since levels of healthy robots
/// differ for good.
pub(crate) fn ln_e_value(comparison: &SiblingComparison) -> f64 {
    let dof = TAILS.min(comparison.siblings as f64 - 1.0).max(1.0);
    let z = comparison.deviations;
    let healthy = ln_gamma(0.5 * (dof + 1.0))
        - ln_gamma(0.5 * dof)
        - 0.5 * (dof * std::f64::consts::PI).ln()
        - 0.5 * (dof + 1.0) * (z * z / dof).ln_1p();
    let unlike = -(std::f64::consts::PI * UNLIKE).ln() - (z / UNLIKE).powi(2).ln_1p();
    if z.is_finite() { unlike - healthy } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    #[test]
    fn the_e_value_of_healthy_siblings_is_one_on_average_or_less() {
        let mut noise = Noise::new(14);
        let mean = (0..4000)
            .map(|_| {
                let levels: Vec<f64> = (0..20).map(|_| noise.normal()).collect();
                let comparison =
                    Levels::new(levels.clone()).compare(0, levels[0], 0.0).expect("many siblings");
                ln_e_value(&comparison).exp()
            })
            .sum::<f64>()
            / 4000.0;
        assert!(mean < 1.1, "{mean}");
    }

    #[test]
    fn fifteen_deviations_are_evidence_and_three_are_not() {
        let siblings: Vec<f64> = (0..60).map(|k| f64::from(k % 9)).collect();
        let at = |own: f64| {
            ln_e_value(&Levels::new(siblings.clone()).compare(0, own, 0.0).expect("many siblings"))
        };
        let spread = qn(&siblings).expect("many siblings");
        assert!(at(4.0 + 15.0 * spread) > 10.0, "{}", at(4.0 + 15.0 * spread));
        assert!(at(4.0 + 3.0 * spread) < 3.0, "{}", at(4.0 + 3.0 * spread));
    }
}
