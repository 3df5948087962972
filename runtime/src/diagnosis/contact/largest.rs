//! How far the largest squares of many windows go by accident: an extreme value law, fitted to stretches of a residual.

use crate::diagnosis::rules::{ONE_IN_TEN, SCAN_LEAST_STRETCHES, SCAN_NORMAL_SCALE};

/// How far the largest squared mean of a stretch goes: Gumbel's law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Law {
    location: f64,
    scale: f64,
}

impl Law {
    /// Of normal deviates in a stretch with some thirty independent windows.
    pub const NORMAL: Self = Self { location: 8.0, scale: SCAN_NORMAL_SCALE };

    /// From the quartiles, which a few pushed stretches hardly move.
    pub fn of(largest: &mut [f64]) -> Option<Self> {
        if largest.len() < SCAN_LEAST_STRETCHES {
            return None;
        }
        largest.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let x = share * (largest.len() - 1) as f64;
            let low = x.floor() as usize;
            let high = (low + 1).min(largest.len() - 1);
            largest[low] + (x - low as f64) * (largest[high] - largest[low])
        };
        let place = |share: f64| -(-share.ln()).ln();
        let scale = ((at(0.75) - at(0.25)) / (place(0.75) - place(0.25))).max(SCAN_NORMAL_SCALE);
        Some(Self { location: at(0.5) - scale * place(0.5), scale })
    }

    /// With a longer tail where the larger ones of these surely pass their upper quartile by more than the law has it:
    /// excesses of an exponential tail have its scale as their mean.
    pub fn with_tail(self, largest: &mut [f64]) -> Self {
        largest.sort_by(f64::total_cmp);
        let first = largest.len() * 3 / 4;
        let Some(quartile) = first.checked_sub(1).map(|k| largest[k]) else { return self };
        let count = (largest.len() - first) as f64;
        let excess = largest[first..].iter().map(|x| x - quartile).sum::<f64>() / count;
        let surely = excess > self.scale * (1.0 + ONE_IN_TEN / count.sqrt());
        Self { scale: if surely { excess } else { self.scale }, ..self }
    }

    pub fn mean(self, own: f64, other: Self, others: f64) -> Self {
        let mean = |a: f64, b: f64| (own * a + others * b) / (own + others);
        Self { location: mean(self.location, other.location), scale: mean(self.scale, other.scale) }
    }

    /// Probability that the largest of so many stretches passes a square.
    pub fn tail(self, square: f64, stretches: usize) -> f64 {
        -(-(stretches as f64) * (-(square - self.location) / self.scale).exp()).exp_m1()
    }
}
