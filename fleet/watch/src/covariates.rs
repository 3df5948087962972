//! What temperature and load do to a parameter, and what all siblings have in common on a day.
//!
//! Siblings share the slope, up to a spread that is estimated: fourteen days of one robot do not tell it. Levels of robots
//! and effects of days are taken out by Tukey's median polish (Exploratory Data Analysis, 1977), so that a season which
//! all siblings feel is not taken for a slope, and without temperatures is taken out all the same.

use crate::clean::Day;
use crate::robust::{median, qn};
use std::collections::BTreeMap;

/// Rounds of polish and regression; both have settled to a few per cent of a standard deviation by then.
const ROUNDS: usize = 6;
/// Deviations from which on a residual counts less in the slope (Huber 1964: 95 % efficiency).
const HUBER: f64 = 1.345;
/// Median of the square of a standard normal deviate.
const MEDIAN_OF_SQUARES: f64 = 0.454_94;

/// Effects of days that siblings share: the effect and the number of robots it is known from.
pub(crate) type DayEffects = BTreeMap<i64, (f64, usize)>;

/// What siblings share. Slopes are per standardised covariate.
#[derive(Clone, Debug)]
pub(crate) struct Covariates {
    /// Which covariates are known: temperature, load.
    pub(crate) known: [bool; 2],
    centre: [f64; 2],
    scale: [f64; 2],
    /// Mean slope of the siblings.
    pub(crate) slope: [f64; 2],
    /// Variance of a robot's slope about it.
    pub(crate) slope_variance: [f64; 2],
    /// Effects of the days of the calibration.
    pub(crate) effects: DayEffects,
}

impl Covariates {
    /// Covariates of a day, standardised; a missing one is at the centre.
    pub(crate) fn of(&self, day: &Day) -> [f64; 2] {
        [0, 1].map(|k| match day.covariates[k] {
            Some(x) if self.known[k] => (x - self.centre[k]) / self.scale[k],
            _ => 0.0,
        })
    }

    /// Units of covariate `k` in one of its standardised ones.
    pub(crate) fn scale(&self, k: usize) -> f64 {
        self.scale[k]
    }

    /// Variance that comes from covariates that are known otherwise and missing on this day.
    pub(crate) fn missing_variance(&self, day: &Day) -> f64 {
        (0..2)
            .filter(|&k| self.known[k] && day.covariates[k].is_none())
            .map(|k| self.slope[k].powi(2) + self.slope_variance[k])
            .sum()
    }

    /// A day's value without what the siblings' slope and `effects` explain.
    pub(crate) fn corrected(&self, day: &Day, effects: &DayEffects) -> f64 {
        let x = self.of(day);
        day.value - effects.get(&day.day).map_or(0.0, |e| e.0) - self.slope[0] * x[0] - self.slope[1] * x[1]
    }

    /// Estimates all of this from the first days of siblings. Effects of days are those of days on which at least
    /// `least_siblings` have an estimate.
    pub(crate) fn estimate(robots: &[&[Day]], known: [bool; 2], least_siblings: usize) -> Self {
        let all = |k: usize| -> Vec<f64> {
            if known[k] {
                robots.iter().copied().flatten().filter_map(|d| d.covariates[k]).collect()
            } else {
                vec![]
            }
        };
        let mut shared = Self {
            known,
            centre: [0, 1].map(|k| median(&all(k)).unwrap_or(0.0)),
            scale: [0, 1].map(|k| qn(&all(k)).filter(|s| *s > 0.0).unwrap_or(1.0)),
            slope: [0.0; 2],
            slope_variance: [0.0; 2],
            effects: DayEffects::new(),
        };
        let table = Table::new(robots, least_siblings);
        let x: [Vec<Vec<f64>>; 2] = [0, 1].map(|k| {
            table.polish(robots.iter().map(|r| r.iter().map(|d| shared.of(d)[k]).collect()).collect()).0
        });
        for _ in 0..ROUNDS {
            let none = DayEffects::new();
            let values =
                robots.iter().map(|r| r.iter().map(|d| shared.corrected(d, &none)).collect()).collect();
            let (residuals, effects) = table.polish(values);
            shared.effects = table.effects(&effects);
            for k in (0..2).filter(|&k| known[k]) {
                shared.slope[k] += common_slope(&residuals, &x[k]);
                shared.slope_variance[k] =
                    spread_of_slopes(&residuals, &x[k], robots.len() >= least_siblings)
                        + if robots.len() < least_siblings { shared.slope[k].powi(2) } else { 0.0 };
            }
        }
        shared
    }
}

/// Which robot has an estimate on which day.
struct Table {
    /// Index of the day, robot by robot.
    columns: Vec<Vec<usize>>,
    days: Vec<i64>,
    counts: Vec<usize>,
    least: usize,
}

impl Table {
    fn new(robots: &[&[Day]], least: usize) -> Self {
        let mut index: BTreeMap<i64, usize> = robots.iter().copied().flatten().map(|d| (d.day, 0)).collect();
        index.values_mut().enumerate().for_each(|(k, slot)| *slot = k);
        let columns: Vec<Vec<usize>> =
            robots.iter().map(|r| r.iter().map(|d| index[&d.day]).collect()).collect();
        let mut counts = vec![0; index.len()];
        columns.iter().flatten().for_each(|&c| counts[c] += 1);
        Self { columns, days: index.into_keys().collect(), counts, least }
    }

    /// Residuals and effects of days; days with too few robots have effect zero.
    fn polish(&self, mut values: Vec<Vec<f64>>) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut effects = vec![0.0; self.days.len()];
        for _ in 0..ROUNDS {
            for row in &mut values {
                let level = median(row).unwrap_or(0.0);
                row.iter_mut().for_each(|v| *v -= level);
            }
            let mut by_day = vec![Vec::new(); self.days.len()];
            for (row, columns) in values.iter().zip(&self.columns) {
                row.iter().zip(columns).for_each(|(v, &c)| by_day[c].push(*v));
            }
            let steps: Vec<f64> = by_day
                .iter()
                .map(|v| if v.len() >= self.least { median(v).unwrap_or(0.0) } else { 0.0 })
                .collect();
            for (row, columns) in values.iter_mut().zip(&self.columns) {
                row.iter_mut().zip(columns).for_each(|(v, &c)| *v -= steps[c]);
            }
            effects.iter_mut().zip(&steps).for_each(|(e, s)| *e += s);
        }
        (values, effects)
    }

    fn effects(&self, effects: &[f64]) -> DayEffects {
        let each = self.days.iter().zip(effects).zip(&self.counts);
        each.filter(|(_, n)| **n >= self.least).map(|((&day, &e), &n)| (day, (e, n))).collect()
    }
}

/// Slope of all robots' residuals on the polished covariate, each robot in its own standard deviations, with Huber's
/// weights.
fn common_slope(residuals: &[Vec<f64>], x: &[Vec<f64>]) -> f64 {
    let (mut xx, mut xy) = (0.0, 0.0);
    for (row, x) in residuals.iter().zip(x) {
        let Some(scale) = qn(row).filter(|s| *s > 0.0) else { continue };
        for (r, x) in row.iter().zip(x) {
            let weight = (HUBER * scale / r.abs()).min(1.0) / scale.powi(2);
            xx += weight * x * x;
            xy += weight * x * r;
        }
    }
    if xx > 0.0 && (xy / xx).is_finite() { xy / xx } else { 0.0 }
}

/// Variance of the robots' slopes about the common one: what they vary more than their uncertainty (method of moments,
/// with medians). Of few robots it is the uncertainty itself.
fn spread_of_slopes(residuals: &[Vec<f64>], x: &[Vec<f64>], many: bool) -> f64 {
    let mut squares = Vec::new();
    let mut variances = Vec::new();
    for (row, x) in residuals.iter().zip(x) {
        let xx: f64 = x.iter().map(|x| x * x).sum();
        let (Some(scale), true) = (qn(row), xx > 0.0) else { continue };
        let slope = row.iter().zip(x).map(|(r, x)| r * x).sum::<f64>() / xx;
        squares.push(slope * slope);
        variances.push(scale * scale / xx);
    }
    let uncertainty = median(&variances).unwrap_or(0.0);
    let total = median(&squares).unwrap_or(0.0) / MEDIAN_OF_SQUARES;
    let shared = uncertainty / squares.len().max(1) as f64;
    let spread = if many { (total - uncertainty).max(0.0) + shared } else { uncertainty };
    if spread.is_finite() { spread } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    /// 40 robots, 14 days; the slope of robot r is 0.8 ± spread, the season common.
    fn robots(noise: &mut Noise, spread: f64) -> Vec<Vec<Day>> {
        (0..40)
            .map(|_| {
                let (level, slope) = (10.0 + noise.normal(), 0.8 + spread * noise.normal());
                (0..14)
                    .map(|k| {
                        let season = f64::from(k) * 0.3;
                        let temperature = 20.0 + season + 2.0 * noise.normal();
                        let value = level + slope * temperature + 0.5 * noise.normal();
                        Day { day: i64::from(k), value, sigma: 0.1, covariates: [Some(temperature), None] }
                    })
                    .collect()
            })
            .collect()
    }

    #[test]
    fn siblings_tell_the_slope_and_how_much_it_differs_between_them() {
        let mut noise = Noise::new(7);
        for spread in [0.0, 0.3] {
            let robots = robots(&mut noise, spread);
            let views: Vec<&[Day]> = robots.iter().map(Vec::as_slice).collect();
            let found = Covariates::estimate(&views, [true, false], 8);
            let per_degree = found.slope[0] / found.scale(0);
            assert!((per_degree - 0.8).abs() < 0.05 + 0.3 * spread, "{per_degree}");
            let sd = found.slope_variance[0].sqrt() / found.scale(0);
            assert!((sd - spread).abs() < 0.12, "{sd} {spread}");
        }
    }
}
