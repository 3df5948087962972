//! Central differences.

/// Half-width of a central difference: 1 is the paper's two-point difference, up to 4 the wider stencils that
/// stay exact at higher frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stencil {
    /// (x[+1] - x[-1]) / 2h, exact to order 2.
    Three,
    /// Order 4.
    Five,
    /// Order 6.
    Seven,
    /// Order 8.
    Nine,
}

impl Stencil {
    /// Weights of `x[k] - x[-k]` for k = 1, 2, ... in units of 1/h (Fornberg 1988).
    pub fn weights(self) -> &'static [f64] {
        match self {
            Self::Three => &[0.5],
            Self::Five => &[2.0 / 3.0, -1.0 / 12.0],
            Self::Seven => &[0.75, -0.15, 1.0 / 60.0],
            Self::Nine => &[0.8, -0.2, 4.0 / 105.0, -1.0 / 280.0],
        }
    }

    /// Samples it needs on each side.
    pub fn half_width(self) -> usize {
        self.weights().len()
    }

    /// What it makes of a sine of `frequency` (in units of the sampling rate), as a fraction of the true
    /// derivative: 1 is exact.
    pub fn response(self, frequency: f64) -> f64 {
        let w = 2.0 * std::f64::consts::PI * frequency;
        if w == 0.0 {
            return 1.0;
        }
        self.weights().iter().enumerate().map(|(k, c)| 2.0 * c * (w * (k + 1) as f64).sin()).sum::<f64>() / w
    }

    /// The narrowest stencil whose error stays below `tolerance` up to `frequency` (in units of the sampling
    /// rate); the widest if none does.
    pub fn accurate_to(frequency: f64, tolerance: f64) -> Self {
        [Self::Three, Self::Five, Self::Seven]
            .into_iter()
            .find(|s| (1.0 - s.response(frequency)).abs() <= tolerance)
            .unwrap_or(Self::Nine)
    }
}

/// Derivative of a uniformly sampled signal by central differences, into `out` of the same length.
///
/// At the ends the stencil is narrowed to what there is; the first and last value are one-sided. A signal of
/// one sample has derivative 0. `out` and `signal` of different lengths: the shorter counts.
pub fn central_difference(signal: &[f64], rate: f64, stencil: Stencil, out: &mut [f64]) {
    let n = signal.len().min(out.len());
    if n < 2 {
        out[..n].fill(0.0);
        return;
    }
    let stencils = [Stencil::Three, Stencil::Five, Stencil::Seven, Stencil::Nine];
    let width = stencil.half_width();
    let at = |t: usize, weights: &[f64]| -> f64 {
        weights.iter().enumerate().map(|(k, c)| c * (signal[t + k + 1] - signal[t - k - 1])).sum::<f64>()
            * rate
    };
    out[0] = (signal[1] - signal[0]) * rate;
    out[n - 1] = (signal[n - 1] - signal[n - 2]) * rate;
    let inner = width.min(n / 2)..n.saturating_sub(width);
    for t in (1..n - 1).filter(|t| !inner.contains(t)) {
        let room = t.min(n - 1 - t).min(width);
        out[t] = at(t, stencils[room - 1].weights());
    }
    if n > 2 * width {
        match stencil {
            Stencil::Three => {
                let half = 0.5 * rate;
                for (o, w) in out[1..n - 1].iter_mut().zip(signal.windows(3)) {
                    *o = (w[2] - w[0]) * half;
                }
            }
            _ => {
                let weights = stencil.weights();
                for (o, w) in out[width..n - width].iter_mut().zip(signal.windows(2 * width + 1)) {
                    let (before, after) = (w[..width].iter().rev(), &w[width + 1..]);
                    let pairs = before.zip(after).zip(weights);
                    *o = pairs.map(|((b, a), c)| c * (a - b)).sum::<f64>() * rate;
                }
            }
        }
    }
}
