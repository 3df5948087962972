//! A series' next value predicted from those before: level, slopes over temperature and load, the memory of day-to-day
//! variation, and one change, all at once (Kalman filter, with the scale of the noise unknown: West and Harrison, Bayesian
//! Forecasting and Dynamic Models, 1997, section 4.6).
//!
//! Everything is in standard deviations of the robot's day-to-day variation.

use crate::memory::Memory;
use statrs::function::gamma::ln_gamma;

/// Level, temperature, load, memory, change.
const STATES: usize = 5;
const MEMORY: usize = 3;
const CHANGE: usize = 4;
/// Most degrees of freedom of the scale: what is older than so many days is forgotten.
const MOST_DOF: f64 = 100.0;
/// Prior variance of the level about the median of the calibration.
const LEVEL_VARIANCE: f64 = 9.0;

/// A day as the filter sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    pub(crate) day: i64,
    pub(crate) value: f64,
    /// Standardised temperature and load.
    pub(crate) covariates: [f64; 2],
    /// Variance of this day beside the usual: of its estimate, of what is common to the siblings.
    pub(crate) extra_variance: f64,
}

/// The prediction of a reading: a Student t distribution, mixed with an outlier's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prediction {
    pub(crate) mean: f64,
    /// Covariance of the states with the value, over the scale.
    gain: [f64; STATES],
    /// Variances over the scale: of what the states do not know, and of what is new on this day.
    known: f64,
    fresh: f64,
    /// Both.
    variance: f64,
    scale: f64,
    dof: f64,
}

/// The mixture with which a day tells nothing: how often, and about what centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outliers {
    pub(crate) fraction: f64,
    pub(crate) centre: f64,
}

impl Outliers {
    /// Half-width of the Cauchy density of outliers: as wide as anything that is still drawn on one page.
    const WIDTH: f64 = 10.0;

    /// Logarithm of fraction times density.
    fn ln_density(self, value: f64) -> f64 {
        let z = (value - self.centre) / Self::WIDTH;
        (self.fraction / (std::f64::consts::PI * Self::WIDTH)).ln() - (z * z).ln_1p()
    }
}

impl Prediction {
    /// Square of the error over its variance, but for the scale.
    pub(crate) fn squared_error(&self, value: f64) -> f64 {
        (value - self.mean).powi(2) / self.variance
    }

    /// Logarithm of the density of `value` times the fraction of days that tell something.
    fn ln_inlier(&self, value: f64, fraction: f64) -> f64 {
        let squared = (value - self.mean).powi(2) / (self.variance * self.scale);
        (1.0 - fraction).ln() + ln_t_constant(self.dof)
            - 0.5 * (self.variance * self.scale).ln()
            - 0.5 * (self.dof + 1.0) * (squared / self.dof).ln_1p()
    }

    /// Logarithm of the density of `value`, and the probability that it is no outlier.
    pub(crate) fn judge(&self, value: f64, outliers: Outliers) -> (f64, f64) {
        let inlier = self.ln_inlier(value, outliers.fraction);
        let outlier = outliers.ln_density(value);
        let larger = inlier.max(outlier);
        let total = larger + ((inlier - larger).exp() + (outlier - larger).exp()).ln();
        (total, (inlier - total).exp())
    }
}

/// Logarithm of the constant of Student's t density. From five degrees of freedom on by Stirling's series of the ratio of
/// gamma functions, whose next term is below 2e-5.
fn ln_t_constant(dof: f64) -> f64 {
    if dof >= 5.0 {
        return -0.5 * std::f64::consts::TAU.ln() - 0.25 / dof + 1.0 / (24.0 * dof.powi(3));
    }
    ln_gamma(0.5 * (dof + 1.0)) - ln_gamma(0.5 * dof) - 0.5 * (dof * std::f64::consts::PI).ln()
}

/// State of the filter.
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    mean: [f64; STATES],
    /// Over the scale.
    covariance: [[f64; STATES]; STATES],
    scale: f64,
    dof: f64,
    memory: Memory,
    day: Option<i64>,
}

/// Mean and standard deviation of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimated {
    pub(crate) mean: f64,
    pub(crate) sigma: f64,
}

impl Filter {
    /// Before the first reading, without a change: slopes with their variances as the siblings have them, and the variance
    /// of the noise with its degrees of freedom.
    pub(crate) fn new(slopes: [(f64, f64); 2], memory: Memory, (scale, dof): (f64, f64)) -> Self {
        let variances = [LEVEL_VARIANCE, slopes[0].1, slopes[1].1, memory.share, 0.0];
        let mut covariance = [[0.0; STATES]; STATES];
        (0..STATES).for_each(|k| covariance[k][k] = variances[k]);
        let mean = [0.0, slopes[0].0, slopes[1].0, 0.0, 0.0];
        Self { mean, covariance, scale, dof: dof.clamp(1.0, MOST_DOF), memory, day: None }
    }

    /// The same with another variance of the level about zero.
    pub(crate) fn with_level_variance(mut self, variance: f64) -> Self {
        self.covariance[0][0] = variance;
        self
    }

    /// The filter of a robot that may change from now on, by this standard deviation a unit.
    pub(crate) fn with_change(&self, size: f64) -> Self {
        let mut changed = self.clone();
        changed.covariance[CHANGE][CHANGE] = size * size;
        changed
    }

    /// Lets the memory fade up to the day of a reading.
    pub(crate) fn advance(&mut self, day: i64) {
        let gap = self.day.map_or(0, |last| (day - last).clamp(0, 10_000));
        self.day = Some(day);
        if gap == 0 {
            return;
        }
        let factor = self.memory.rho.powi(gap as i32);
        self.mean[MEMORY] *= factor;
        for k in 0..STATES {
            self.covariance[MEMORY][k] *= factor;
            self.covariance[k][MEMORY] *= factor;
        }
        self.covariance[MEMORY][MEMORY] += self.memory.share * (1.0 - factor * factor);
    }

    /// Prediction of a reading where the change has gone `change` times its unit.
    pub(crate) fn predict(&self, reading: &Reading, change: f64) -> Prediction {
        let row = row(reading, change);
        let gain = self.gain(&row);
        let mean = (0..STATES).map(|k| row[k] * self.mean[k]).sum();
        let known = (0..STATES).map(|k| row[k] * gain[k]).sum::<f64>();
        let fresh = (1.0 - self.memory.share + reading.extra_variance).max(0.02);
        let variance = (known + fresh).max(1e-6);
        Prediction { mean, gain, known, fresh, variance, scale: self.scale, dof: self.dof }
    }

    /// Takes the value of a reading in that was predicted, with a weight in [0, 1].
    pub(crate) fn update(&mut self, value: f64, prediction: &Prediction, weight: f64) {
        if weight < 1e-4 {
            return;
        }
        let Prediction { gain, known, fresh, .. } = prediction;
        let error = value - prediction.mean;
        let precision = 1.0 / (known + fresh / weight);
        for i in 0..STATES {
            let part = gain[i] * precision;
            self.mean[i] += part * error;
            for j in 0..STATES {
                self.covariance[i][j] -= part * gain[j];
            }
        }
        let squared = prediction.squared_error(value);
        self.scale = (self.dof * self.scale + weight * squared) / (self.dof + weight);
        self.dof = (self.dof + weight).min(MOST_DOF);
    }

    /// Takes a reading in whatever it is; it says nothing about the noise.
    pub(crate) fn believe(&mut self, reading: &Reading, change: f64) {
        let noise = (self.scale, self.dof);
        let prediction = self.predict(reading, change);
        self.update(reading.value, &prediction, 1.0);
        (self.scale, self.dof) = noise;
    }

    /// Level of the series before the change.
    pub(crate) fn level(&self) -> Estimated {
        self.estimated(0)
    }

    /// Slope over covariate `k`.
    pub(crate) fn slope(&self, k: usize) -> Estimated {
        self.estimated(1 + k)
    }

    /// The change a unit.
    pub(crate) fn change(&self) -> Estimated {
        self.estimated(CHANGE)
    }

    fn estimated(&self, k: usize) -> Estimated {
        Estimated { mean: self.mean[k], sigma: (self.covariance[k][k] * self.scale).max(0.0).sqrt() }
    }

    fn gain(&self, row: &[f64; STATES]) -> [f64; STATES] {
        std::array::from_fn(|i| (0..STATES).map(|j| self.covariance[i][j] * row[j]).sum())
    }
}

fn row(reading: &Reading, change: f64) -> [f64; STATES] {
    [1.0, reading.covariates[0], reading.covariates[1], 1.0, change]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    #[test]
    fn predictions_of_the_right_model_are_as_wide_as_their_errors() {
        let mut noise = Noise::new(10);
        let memory = Memory { share: 1.0, rho: 0.7 };
        let (mut count, mut outside, mut squares) = (0, 0, 0.0);
        for _ in 0..300 {
            let mut filter = Filter::new([(0.0, 0.0); 2], memory, (1.0, 30.0));
            for (day, value) in (0..).zip(noise.ar1(40, 0.7)) {
                let reading = Reading { day, value, covariates: [0.0; 2], extra_variance: 0.0 };
                filter.advance(day);
                let p = filter.predict(&reading, 0.0);
                if day >= 14 {
                    let z = (value - p.mean) / (p.variance * p.scale).sqrt();
                    count += 1;
                    squares += z * z;
                    outside += i32::from(z.abs() > 3.0);
                }
                filter.update(value, &p, 1.0);
            }
        }
        let mean = squares / f64::from(count);
        assert!((mean - 1.0).abs() < 0.06, "{mean}");
        assert!(f64::from(outside) / f64::from(count) < 0.005);
    }

    #[test]
    fn a_day_of_nonsense_moves_nothing() {
        let memory = Memory { share: 0.0, rho: 0.5 };
        let mut filter = Filter::new([(0.0, 0.0); 2], memory, (1.0, 30.0));
        let outliers = Outliers { fraction: 0.02, centre: 0.0 };
        for day in 0..30 {
            let value = if day == 20 { 1e6 } else { 0.3 * (day % 3 - 1) as f64 };
            let reading = Reading { day, value, covariates: [0.0; 2], extra_variance: 0.0 };
            filter.advance(day);
            let prediction = filter.predict(&reading, 0.0);
            filter.update(value, &prediction, prediction.judge(value, outliers).1);
        }
        assert!(filter.level().mean.abs() < 0.2, "{:?}", filter.level());
    }
}
