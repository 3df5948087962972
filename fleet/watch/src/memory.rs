//! How long day-to-day variation lasts.

/// Day-to-day variation: `share` of the variance is an AR(1) with factor `rho` a day, the rest is new every day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Memory {
    pub(crate) share: f64,
    pub(crate) rho: f64,
}

impl Memory {
    /// Autocorrelation.
    pub(crate) fn at(self, lag: usize) -> f64 {
        self.share * self.rho.powi(lag as i32)
    }

    /// Variance of the mean of n days, over that of independent days.
    pub(crate) fn long_run(self, n: usize) -> f64 {
        1.0 + 2.0 * (1..n).map(|k| (1.0 - k as f64 / n as f64) * self.at(k)).sum::<f64>()
    }

    /// Fraction of the variance that is left about the mean of n days.
    pub(crate) fn left(self, n: usize) -> f64 {
        (1.0 - self.long_run(n) / n.max(1) as f64).max(0.1)
    }
}
