//! Axes with round ticks.

/// A linear axis that maps data to pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// Covers the finite values given, widened a little, and maps them to the pixels `from..to`.
    pub(super) fn covering(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (mut low, mut high) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let span = high - low;
        // A constant still needs an interval around it.
        let margin = if span > 0.0 { 0.04 * span } else { 0.5 * low.abs().max(1.0) };
        Self { low: low - margin, high: high + margin, from, to }
    }

    /// Least and largest value.
    pub(super) fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Pixel of a value.
    pub(super) fn pixel(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// About `count` ticks at multiples of 1, 2 or 5 times a power of ten, with their labels.
    pub(super) fn ticks(&self, count: usize) -> Vec<(f64, String)> {
        let raw = (self.high - self.low) / count.max(1) as f64;
        let decade = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .into_iter()
            .map(|m| m * decade)
            .find(|s| *s >= raw)
            .unwrap_or(10.0 * decade);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        (first..=last)
            .map(|k| {
                let value = k as f64 * step;
                let label = if !(1e-6..1e6).contains(&step) {
                    format!("{value:.1e}")
                } else {
                    format!("{value:.decimals$}")
                };
                (value, label)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = Axis::covering([0.0, 7.3].into_iter(), 0.0, 100.0);
        let labels: Vec<String> = axis.ticks(5).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0", "2", "4", "6"]);
    }

    #[test]
    fn a_constant_or_nothing_at_all_still_gives_an_axis() {
        for values in [vec![3.0, 3.0], vec![], vec![f64::NAN]] {
            let axis = Axis::covering(values.into_iter(), 0.0, 100.0);
            assert!(!axis.ticks(5).is_empty());
            assert!(axis.pixel(0.3).is_finite());
        }
    }
}
