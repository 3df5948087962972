//! A series under watch: from raw numbers to readings of its filter and back.

use crate::clean::Day;
use crate::covariates::{Covariates, DayEffects};
use crate::dispersion::{Dispersion, Scale};
use crate::evidence::{Began, Evidence};
use crate::filter::{Estimated, Filter, Reading};
use crate::robust::median;
use std::f64::consts::FRAC_PI_2;

/// A day's estimate counts less where its stated standard deviation is more than so many times the usual one, by what it
/// is more. Standard deviations of a short recording are themselves known to a third or so: days that state a small one
/// are not better than others.
const DOUBTFUL: f64 = 1.5;

/// What robots with one table have in common in one parameter, and the same covariates.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) covariates: Covariates,
    pub(crate) dispersion: Dispersion,
    /// Effects of all days so far, those of the calibration included.
    pub(crate) effects: DayEffects,
}

impl Group {
    /// From the first days of siblings.
    pub(crate) fn calibrate(robots: &[&[Day]], known: [bool; 2], least_siblings: usize) -> Self {
        let covariates = Covariates::estimate(robots, known, least_siblings);
        let residuals: Vec<Vec<(i64, f64)>> =
            robots.iter().map(|r| residuals(r, &covariates, &covariates.effects)).collect();
        let effects = covariates.effects.clone();
        Self { dispersion: Dispersion::estimate(&residuals), covariates, effects }
    }
}

fn residuals(days: &[Day], covariates: &Covariates, effects: &DayEffects) -> Vec<(i64, f64)> {
    days.iter().map(|d| (d.day, covariates.corrected(d, effects))).collect()
}

/// A series that has been calibrated.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    /// Value at which readings are zero.
    centre: f64,
    pub(crate) scale: Scale,
    /// Typical standard deviation that the estimates state.
    stated: f64,
    pub(crate) evidence: Evidence,
    /// Level when the calibration ended.
    pub(crate) level: Estimated,
}

impl Member {
    /// Calibrates on these days.
    pub(crate) fn calibrate(days: &[Day], group: &Group, outlier_days: f64) -> Self {
        let residuals = residuals(days, &group.covariates, &group.effects);
        let centre = median(&residuals.iter().map(|r| r.1).collect::<Vec<_>>()).unwrap_or(0.0);
        let stated = median(&days.iter().map(|d| d.sigma).collect::<Vec<_>>()).unwrap_or(0.0);
        let scale = group.dispersion.of(&residuals, stated, centre.abs());
        let sigma = scale.sigma;
        let slope = |k: usize| {
            (group.covariates.slope[k] / sigma, group.covariates.slope_variance[k] / (sigma * sigma))
        };
        let filter =
            Filter::new([slope(0), slope(1)], group.dispersion.memory, (scale.prior, scale.prior_dof));
        let mut member = Self {
            centre,
            scale,
            stated,
            evidence: Evidence::new(filter.clone(), &[], outlier_days),
            level: Estimated { mean: centre, sigma },
        };
        let readings: Vec<Reading> = days.iter().map(|d| member.reading(d, group)).collect();
        member.evidence = Evidence::new(filter, &readings, outlier_days);
        member.level = member.in_units(member.evidence.unchanged().level(), centre);
        member
    }

    /// A day in standard deviations, without what is common to the siblings on it.
    pub(crate) fn reading(&self, day: &Day, group: &Group) -> Reading {
        let (common, siblings) = group.effects.get(&day.day).copied().unwrap_or((0.0, 0));
        let variance = self.scale.sigma.powi(2);
        let doubtful = DOUBTFUL * self.stated;
        let estimate = (day.sigma * day.sigma - doubtful * doubtful).max(0.0) / variance;
        // The variance of a median is pi / 2 that of a mean.
        let of_common = if siblings > 0 { FRAC_PI_2 / siblings as f64 } else { 0.0 };
        Reading {
            day: day.day,
            value: (day.value - common - self.centre) / self.scale.sigma,
            covariates: group.covariates.of(day),
            extra_variance: estimate + of_common + group.covariates.missing_variance(day) / variance,
        }
    }

    /// How much a day's value is above what this robot was expected to have, in the series' unit.
    pub(crate) fn surprise(&self, day: &Day, group: &Group) -> f64 {
        let reading = self.reading(day, group);
        let mut filter = self.evidence.unchanged().clone();
        filter.advance(day.day);
        (reading.value - filter.predict(&reading, 0.0).mean) * self.scale.sigma
    }

    /// A day's value without covariates and what is common to the siblings.
    pub(crate) fn corrected(&self, day: &Day, group: &Group) -> f64 {
        let reading = self.reading(day, group);
        let filter = self.evidence.best();
        let explained: f64 = (0..2).map(|k| filter.slope(k).mean * reading.covariates[k]).sum();
        self.centre + (reading.value - explained) * self.scale.sigma
    }

    /// Slope over covariate `k` in the series' unit a unit of the covariate.
    pub(crate) fn slope(&self, k: usize, group: &Group) -> Option<(f64, f64)> {
        let slope = self.evidence.best().slope(k);
        let unit = self.scale.sigma / group.covariates.scale(k);
        group.covariates.known[k].then_some((slope.mean * unit, slope.sigma * unit))
    }

    /// Change and level before it, in the series' unit.
    pub(crate) fn sizes(&self, began: &Began) -> (Estimated, Estimated) {
        (self.in_units(began.change, 0.0), self.in_units(began.before, self.centre))
    }

    fn in_units(&self, x: Estimated, centre: f64) -> Estimated {
        Estimated { mean: centre + x.mean * self.scale.sigma, sigma: x.sigma * self.scale.sigma }
    }
}
