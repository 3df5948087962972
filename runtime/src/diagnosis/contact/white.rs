//! The residual of one joint made white, and pushes looked for in it by a matched filter.
//!
//! The torque of a push rises and falls like half a sine wave. Its amplitude at a time and of a length is estimated by
//! generalised least squares: an autoregression makes the residual and the half wave white (Cochrane and Orcutt 1949),
//! and both are taken orthogonal to smooth curves over the joint's own state (Frisch and Waugh 1933). What repeats with
//! position, speed or load is then no push, and a push in a state that no other part of the motion visits has nothing
//! left that would tell it.

use crate::diagnosis::contact::memory::Memory;
use crate::diagnosis::rules::{SCAN_OWN_SHAPE, SCAN_PRESENT, SIGMA_PER_MAD};
use crate::statistics::median::median;
use std::ops::Range;

/// Rows of one motion.
pub(in crate::diagnosis) struct Motion {
    /// Number of the motion.
    pub motion: usize,
    /// Whether it belongs to the recording that is diagnosed.
    pub is_target: bool,
    /// Places on the grid of rows, increasing.
    pub places: Vec<usize>,
    /// Index of its first row among all rows of the joint.
    first: usize,
}

/// One joint's rows, white.
pub(in crate::diagnosis) struct White {
    pub motions: Vec<Motion>,
    memory: Memory,
    /// First row of the stretch of neighbouring rows that each row is in, and the row after its last.
    stretch: Vec<[usize; 2]>,
    /// White residual, in its own standard deviations, orthogonal to the curves.
    residual: Vec<f64>,
    /// White curves, orthonormal.
    curves: Vec<Vec<f64>>,
}

impl White {
    /// From the rows of all motions, `(is_target, [(place, residual)])`, and columns over all of these rows that the
    /// residual is judged beside. `None` where the residual has no spread.
    pub fn of(motions: &[(bool, Vec<(usize, f64)>)], beside: &[Vec<f64>]) -> Option<Self> {
        let (mut kept, mut raw, mut stretch) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (is_target, rows)) in motions.iter().enumerate() {
            let first = raw.len();
            let places: Vec<usize> = rows.iter().map(|r| r.0).collect();
            raw.extend(rows.iter().map(|r| r.1));
            let mut start = 0;
            for end in 1..=places.len() {
                if end == places.len() || places[end] != places[end - 1] + 1 {
                    stretch.resize(first + end, [first + start, first + end]);
                    start = end;
                }
            }
            kept.push(Motion { motion: k, is_target: *is_target, places, first });
        }
        let plain = orthonormal(beside.to_vec());
        let left = without(&raw, &plain);
        let neighbours: Vec<Vec<(usize, f64)>> = kept.iter().map(|m| m.rows(&left)).collect();
        let neighbours: Vec<&[(usize, f64)]> = neighbours.iter().map(Vec::as_slice).collect();
        let memory = Memory::of(&neighbours)?;
        let mut white = Self { motions: kept, memory, stretch, residual: Vec::new(), curves: Vec::new() };
        white.curves = orthonormal(beside.iter().map(|c| white.whitened(c)).collect());
        white.residual = without(&white.whitened(&left), &white.curves);
        let mut absolute: Vec<f64> = white.residual.iter().map(|x| x.abs()).collect();
        let free = white.residual.len() as f64
            / white.residual.len().saturating_sub(white.curves.len()).max(1) as f64;
        let sigma = SIGMA_PER_MAD * median(&mut absolute) * free.sqrt();
        if !(sigma.is_finite() && sigma > 0.0) {
            return None;
        }
        white.residual.iter_mut().for_each(|x| *x /= sigma);
        Some(white)
    }

    /// Innovations of a series over all rows.
    fn whitened(&self, x: &[f64]) -> Vec<f64> {
        (0..x.len()).map(|t| self.memory.innovation(t - self.stretch[t][0], |back| x[t - back])).collect()
    }

    /// Rows of a motion within places.
    fn within(&self, motion: usize, places: &Range<usize>) -> Range<usize> {
        let m = &self.motions[motion];
        let at = |place: usize| m.first + m.places.partition_point(|p| *p < place);
        at(places.start)..at(places.end)
    }

    /// Amplitude, over its standard deviation, of the half wave over places of a motion; `None` where too few of its rows are there, or the curves over the joint's
    /// state make most of it. `scratch` is kept between calls.
    pub fn half_wave(&self, motion: usize, places: Range<usize>, scratch: &mut Scratch) -> Option<f64> {
        let length = places.len() as f64;
        let rows = self.within(motion, &places);
        if (rows.len() as f64) < SCAN_PRESENT * length || rows.len() < 2 {
            return None;
        }
        let m = &self.motions[motion];
        let reach = (rows.end + self.memory.order()).min(self.stretch[rows.end - 1][1]);
        scratch.wave.clear();
        scratch.wave.extend(rows.clone().map(|r| {
            let at = (m.places[r - m.first] - places.start) as f64 + 0.5;
            (std::f64::consts::PI * at / length).sin()
        }));
        scratch.wave.resize(reach - rows.start, 0.0);
        scratch.white.clear();
        for t in rows.start..reach {
            let wave =
                |back: usize| if t - back < rows.start { 0.0 } else { scratch.wave[t - back - rows.start] };
            scratch.white.push(self.memory.innovation(t - self.stretch[t][0], wave));
        }
        let dot =
            |x: &[f64]| x[rows.start..reach].iter().zip(&scratch.white).map(|(a, b)| a * b).sum::<f64>();
        let whole: f64 = scratch.white.iter().map(|x| x * x).sum();
        let own = whole - self.curves.iter().map(|c| dot(c).powi(2)).sum::<f64>();
        if !own.is_finite() || own <= SCAN_OWN_SHAPE * whole {
            return None;
        }
        Some(dot(&self.residual) / own.sqrt())
    }
}

/// Buffers of [`White::half_wave`].
#[derive(Default)]
pub(in crate::diagnosis) struct Scratch {
    wave: Vec<f64>,
    white: Vec<f64>,
}

impl Motion {
    /// Number of places up to its last row.
    pub fn length(&self) -> usize {
        self.places.last().map_or(0, |p| p + 1)
    }

    /// Its places with values of a series over all rows of the joint.
    pub fn rows(&self, series: &[f64]) -> Vec<(usize, f64)> {
        self.places.iter().copied().zip(series[self.first..].iter().copied()).collect()
    }
}

/// Orthonormal columns that span the same (modified Gram and Schmidt, twice).
fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let norm = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut out: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        let whole = norm(&column);
        let mut own = without(&without(&column, &out), &out);
        let left = norm(&own);
        // Rounding is no direction of its own.
        if left.is_finite() && left > 1e-6 * whole {
            own.iter_mut().for_each(|x| *x /= left);
            out.push(own);
        }
    }
    out
}

/// What orthonormal columns leave of a series.
fn without(x: &[f64], columns: &[Vec<f64>]) -> Vec<f64> {
    let mut left = x.to_vec();
    for column in columns {
        let part: f64 = column.iter().zip(&left).map(|(c, x)| c * x).sum();
        left.iter_mut().zip(column).for_each(|(x, c)| *x -= part * c);
    }
    left
}
