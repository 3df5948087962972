//! How much a healthy robot's estimates vary from day to day, and how long they remember.
//!
//! A robot's own variance, known from some ten days, is moderated by that of its siblings (Smyth, Statistical Applications
//! in Genetics and Molecular Biology 3 (2004), section 6). The memory is that of all siblings: white noise beside an AR(1),
//! by the likelihood of all their residuals, each robot with a level and a scale of its own: autocorrelations of fourteen days
//! are biased towards none (Marriott and Pope 1954), likelihoods with an unknown level are not.

use crate::filter::{Filter, Outliers, Reading};
use crate::memory::Memory;
use crate::robust::{median, qn};

/// Most siblings whose residuals tell the memory.
const MOST_SIBLINGS: usize = 100;
/// Degrees of freedom of the siblings' common scale for one of them, while the memory is looked for.
const SCALE_DOF: f64 = 1.0;
/// Variance of the level while the memory is looked for: the level must tell nothing of it.
const ANY_LEVEL: f64 = 100.0;
/// Variance of the level while the scale is looked for: the first day may be an outlier.
const NEAR_MEDIAN: f64 = 9.0;
/// What is added to the factor a day. Without it the memory of 400 siblings with 0.8 is found as 0.77 from fourteen days,
/// since each one's scale is known little better than its memory.
const MARGIN: f64 = 0.05;
/// Fraction of days that tell nothing, while the memory is looked for.
const OUTLIERS: f64 = 0.02;
/// Siblings that the assumption of a moderate memory (half of the variance, 0.8 a day) is worth, by its correlation from
/// one day to the next. It decides where there are no siblings and hardly matters where there are ten.
const ASSUMED_SIBLINGS: f64 = 2.0;
const ASSUMED: Memory = Memory { share: 0.5, rho: 0.8 };
/// Where among the memories that fit the one is that is believed.
const CAUTION: f64 = 0.8;
/// Largest number of degrees of freedom that siblings lend.
const MOST_LENT: f64 = 60.0;

/// What siblings say of a robot's variation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dispersion {
    /// Typical variance.
    variance: f64,
    /// Degrees of freedom that it is worth for one robot.
    dof: f64,
    pub(crate) memory: Memory,
}

/// A robot's variation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Standard deviation, larger than zero.
    pub(crate) sigma: f64,
    /// What is known of the variance before the robot's own days, in units of `sigma` squared.
    pub(crate) prior: f64,
    /// Degrees of freedom that this is known with.
    pub(crate) prior_dof: f64,
}

impl Dispersion {
    /// From residuals of siblings, each with its day, less what covariates and days explain.
    pub(crate) fn estimate(robots: &[Vec<(i64, f64)>]) -> Self {
        let centred: Vec<Vec<(i64, f64)>> = robots.iter().map(|r| centred(r)).collect();
        let scales: Vec<Option<f64>> = centred.iter().map(|r| own_scale(r)).collect();
        let typical = median(&scales.iter().copied().flatten().collect::<Vec<_>>()).unwrap_or(1.0);
        let step = centred.len().div_ceil(MOST_SIBLINGS).max(1);
        let standardised: Vec<Vec<(i64, f64)>> = centred
            .iter()
            .step_by(step)
            .map(|r| r.iter().map(|(d, e)| (*d, e / typical)).collect())
            .collect();
        let memory = memory(&standardised);
        let variances: Vec<(f64, f64)> = centred
            .iter()
            .map(|r| innovation_variance(r, typical, memory))
            .filter(|(v, dof)| *v > 0.0 && *dof > 1.0)
            .collect();
        let (variance, dof) = lent(&variances);
        Self { variance, dof, memory }
    }

    /// The variation of one robot from its own residuals. `stated` is the typical standard deviation that its estimates
    /// state: a tenth of it is the least that is believed, and a billionth of the values.
    pub(crate) fn of(&self, residuals: &[(i64, f64)], stated: f64, magnitude: f64) -> Scale {
        let least = (0.1 * stated).max(1e-9 * magnitude).max(1e-120);
        let centred = centred(residuals);
        let typical = own_scale(&centred).unwrap_or(least);
        let (own, dof) = innovation_variance(&centred, typical, self.memory);
        let variance = (self.dof * self.variance + dof * own) / (self.dof + dof).max(1.0);
        let sigma = variance.sqrt().max(least);
        if self.dof > 0.0 {
            let prior = (self.variance / (sigma * sigma)).max((least / sigma).powi(2));
            return Scale { sigma, prior, prior_dof: self.dof };
        }
        Scale { sigma, prior: 1.0, prior_dof: 1.0 }
    }
}

fn centred(residuals: &[(i64, f64)]) -> Vec<(i64, f64)> {
    let level = median(&residuals.iter().map(|r| r.1).collect::<Vec<_>>()).unwrap_or(0.0);
    residuals.iter().map(|(d, e)| (*d, e - level)).collect()
}

fn own_scale(centred: &[(i64, f64)]) -> Option<f64> {
    qn(&centred.iter().map(|r| r.1).collect::<Vec<_>>()).filter(|s| *s > 0.0)
}

/// Share and factor under which the residuals are likely. Of all, weighted by their likelihood, the one at four fifths in
/// the order of what they make of the mean of sixty days: a memory that is thought too short makes false alarms, one that
/// is thought too long late ones.
fn memory(robots: &[Vec<(i64, f64)>]) -> Memory {
    let days = robots.iter().map(Vec::len).sum::<usize>() / robots.len().max(1);
    let assumed =
        |m: Memory| -> f64 { -0.5 * ASSUMED_SIBLINGS * days as f64 * (m.at(1) - ASSUMED.at(1)).powi(2) };
    let mut grid: Vec<(Memory, f64)> = (0..=10)
        .flat_map(|s| (2..=19).map(move |r| Memory { share: 0.1 * f64::from(s), rho: 0.05 * f64::from(r) }))
        .map(|m| (m, assumed(m) + robots.iter().map(|r| ln_likelihood(r, m)).sum::<f64>()))
        .collect();
    let best = grid.iter().map(|g| g.1).fold(f64::NEG_INFINITY, f64::max);
    grid.iter_mut().for_each(|g| g.1 = (g.1 - best).exp());
    grid.sort_by(|a, b| a.0.long_run(60).total_cmp(&b.0.long_run(60)));
    let total: f64 = grid.iter().map(|g| g.1).sum();
    let mut below = 0.0;
    let at = |g: &&(Memory, f64)| {
        below += g.1;
        below >= CAUTION * total
    };
    let found = grid.iter().find(at).map_or(ASSUMED, |g| g.0);
    Memory { rho: (found.rho + MARGIN).min(0.95), ..found }
}

/// Logarithm of the likelihood of residuals in units of the siblings' scale, given the first one: of centred residuals all
/// would count a level of exactly zero as an observation, which speaks for small scales and short memories.
fn ln_likelihood(residuals: &[(i64, f64)], memory: Memory) -> f64 {
    let unit = memory.left(residuals.len()).sqrt();
    innovations(residuals, unit, memory, ANY_LEVEL).iter().skip(1).map(|i| i.ln_density + unit.ln()).sum()
}

/// Variance of the day-to-day variation and its degrees of freedom, from what one day adds to those before: innovations are
/// independent where days are not. `typical` is about the standard deviation of the residuals.
fn innovation_variance(residuals: &[(i64, f64)], typical: f64, memory: Memory) -> (f64, f64) {
    let unit = typical / memory.left(residuals.len()).sqrt();
    let innovations = innovations(residuals, 1.0 / unit, memory, NEAR_MEDIAN);
    let weights: f64 = innovations.iter().map(|i| i.weight).sum();
    let squares: f64 = innovations.iter().map(|i| i.weight * i.squared).sum();
    // The level takes one of them.
    let dof = (weights - 1.0).max(0.0);
    (if dof > 0.0 { squares / dof * unit * unit } else { 0.0 }, dof)
}

/// What one day adds to those before.
struct Innovation {
    ln_density: f64,
    /// Probability that the day is no outlier.
    weight: f64,
    /// Square of the error of the prediction over its variance.
    squared: f64,
}

fn innovations(residuals: &[(i64, f64)], unit: f64, memory: Memory, level: f64) -> Vec<Innovation> {
    let mut filter = Filter::new([(0.0, 0.0); 2], memory, (1.0, SCALE_DOF)).with_level_variance(level);
    let one = |&(day, residual): &(i64, f64)| {
        let value = residual * unit;
        let reading = Reading { day, value, covariates: [0.0; 2], extra_variance: 0.0 };
        filter.advance(day);
        let prediction = filter.predict(&reading, 0.0);
        let outliers = Outliers { fraction: OUTLIERS, centre: prediction.mean };
        let (ln_density, weight) = prediction.judge(value, outliers);
        let squared = prediction.squared_error(value);
        filter.update(value, &prediction, weight);
        Innovation { ln_density, weight, squared }
    };
    residuals.iter().map(one).collect()
}

/// Typical variance of siblings and the degrees of freedom that it is worth, from variances with theirs.
fn lent(variances: &[(f64, f64)]) -> (f64, f64) {
    let logs: Vec<f64> = variances.iter().map(|v| v.0.ln()).collect();
    let (Some(centre), Some(spread), Some(own)) =
        (median(&logs), qn(&logs), median(&variances.iter().map(|v| v.1).collect::<Vec<_>>()))
    else {
        return (0.0, 0.0);
    };
    if variances.len() < 3 {
        return (0.0, 0.0);
    }
    // The logarithm of chi² / d has variance trigamma(d / 2) and mean -1 / d.
    let excess = spread * spread - trigamma(0.5 * own);
    let dof = inverse_trigamma(excess).clamp(1.0, MOST_LENT);
    ((centre + 1.0 / own - 1.0 / dof).exp(), dof)
}

fn trigamma(x: f64) -> f64 {
    let x = x.max(0.1);
    let shift: f64 = (0..6).map(|k| 1.0 / (x + f64::from(k)).powi(2)).sum();
    let y = x + 6.0;
    shift + 1.0 / y + 0.5 / (y * y) + 1.0 / (6.0 * y.powi(3))
}

/// d with trigamma(d / 2) as given, by bisection; infinity for what is not positive.
fn inverse_trigamma(value: f64) -> f64 {
    if value <= 0.0 {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.2_f64, 1e4_f64);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if trigamma(0.5 * middle) > value { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    fn siblings(noise: &mut Noise, robots: usize, rho: f64) -> Vec<Vec<(i64, f64)>> {
        (0..robots).map(|_| (0..).zip(noise.ar1(14, rho)).map(|(d, x)| (d, 3.0 * x)).collect()).collect()
    }

    #[test]
    fn the_memory_of_many_siblings_is_found_from_fourteen_days() {
        let mut noise = Noise::new(8);
        for rho in [0.0, 0.5, 0.8] {
            let found = Dispersion::estimate(&siblings(&mut noise, 100, rho));
            let lag_one = found.memory.at(1);
            println!("{rho}: {found:?}");
            assert!((lag_one - rho).abs() < 0.15, "{rho}: {:?}", found.memory);
            assert!((found.variance.sqrt() - 3.0).abs() < 0.4, "{rho}: {found:?}");
        }
    }

    #[test]
    fn a_robot_without_siblings_is_thought_to_have_a_memory() {
        let mut noise = Noise::new(9);
        let found = Dispersion::estimate(&siblings(&mut noise, 1, 0.0));
        assert!(found.memory.at(1) > 0.1, "{:?}", found.memory);
    }

    #[test]
    fn equal_values_have_a_scale_all_the_same() {
        let robots = vec![vec![(0, 1.0), (1, 1.0), (2, 1.0)]];
        let found = Dispersion::estimate(&robots);
        assert!(found.of(&robots[0], 0.0, 1.0).sigma > 0.0);
    }
}
