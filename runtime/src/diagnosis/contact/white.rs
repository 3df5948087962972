//! The residual of one joint made white, and pushes looked for in it by a matched filter.
//!
//! The torque of a push rises and falls like half a sine wave. Its amplitude at a time and of a length is estimated by
//! generalised least squares: an autoregression makes the residual and the half wave white (Cochrane and Orcutt 1949), the size of
//! its noise (`uneven`) of one size, and both are taken orthogonal to smooth curves over the joint's own state (Frisch and Waugh 1933). What repeats with
//! position, speed or load is then no push, and a push in a state that no other part of the motion visits has nothing
//! left that would tell it. Both are taken orthogonal to the columns of the model, too, on all joints together
//! (`absorbed`): a fit takes over a part of every push, and of the noise, and what it leaves is smaller than either.

use crate::diagnosis::contact::memory::Memory;
use crate::diagnosis::contact::pushed::half_wave;
use crate::diagnosis::contact::spread::spread;
use crate::diagnosis::contact::track::Track;
use crate::diagnosis::contact::uneven::{Sizes, sizes_of_noise};
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{SCAN_FILLED, SCAN_LEFT_BY_MODEL, SCAN_OWN_SHAPE, SCAN_PRESENT};
use crate::statistics::student::as_normal;
use std::ops::Range;

/// Rows of one motion.
#[derive(Clone)]
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
#[derive(Clone)]
pub(in crate::diagnosis) struct White {
    pub motions: Vec<Motion>,
    memory: Memory,
    /// Standard deviation of the noise of each row, in that of all.
    deviations: Vec<f64>,
    /// How many sizes these grow with.
    grows_with: usize,
    /// First row of the stretch of neighbouring rows that each row is in, and the row after its last.
    stretch: Vec<[usize; 2]>,
    /// Residual beside the curves and the pushes, its noise of one size, with all that it remembers.
    pub(super) even: Vec<f64>,
    /// White residual, in its own standard deviations, orthogonal to the curves.
    pub(super) residual: Vec<f64>,
    /// White curves, orthonormal.
    curves: Vec<Vec<f64>>,
    /// This joint's part of white columns that are orthonormal over all joints, those that are zero here left out: what the fit
    /// of a model takes over.
    pub(super) absorbed: Vec<Vec<f64>>,
    /// Standard deviation of the white residual, N.m or N.
    pub(super) sigma: f64,
    /// Number of rows that the curves and the model leave free.
    free: f64,
}

impl White {
    /// From the rows of a joint. What `pushes` over all of these rows are is not what the residual remembers. `None` where it has
    /// no spread.
    pub fn of(track: &Track, pushes: &[Vec<f64>]) -> Option<Self> {
        let (mut kept, mut raw, mut stretch) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (is_target, rows)) in track.motions.iter().enumerate() {
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
        let beside = |more: &[Vec<f64>]| orthonormal([&track.beside, more].concat());
        let Sizes { deviations, grows_with } = sizes_of_noise(&without(&raw, &beside(pushes)), &track.sizes);
        let even = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
            columns.iter().map(|x| x.iter().zip(&deviations).map(|(x, d)| x / d).collect()).collect()
        };
        let (raw, curves, pushes) = (even(&[raw]).concat(), even(&track.beside), even(pushes));
        let left = without(&raw, &orthonormal(curves.clone()));
        let unpushed = without(&raw, &orthonormal([curves.clone(), pushes].concat()));
        let neighbours: Vec<Vec<(usize, f64)>> = kept.iter().map(|m| m.rows(&unpushed)).collect();
        let neighbours: Vec<&[(usize, f64)]> = neighbours.iter().map(Vec::as_slice).collect();
        let memory = Memory::of(&neighbours)?;
        let mut white = Self {
            motions: kept,
            memory,
            deviations,
            grows_with,
            stretch,
            even: Vec::new(),
            residual: Vec::new(),
            curves: Vec::new(),
            absorbed: Vec::new(),
            sigma: 1.0,
            free: 1.0,
        };
        white.curves = orthonormal(curves.iter().map(|c| white.whitened(c)).collect());
        white.residual = without(&white.whitened(&left), &white.curves);
        white.even = unpushed;
        white.scale().then_some(white)
    }

    /// Divides the residual by its standard deviation, if it has one: of as many rows as the curves and the model leave free.
    pub(super) fn scale(&mut self) -> bool {
        let rows = self.residual.len() as f64;
        let absorbed: f64 = self.absorbed.iter().flatten().map(|x| x * x).sum();
        self.free = (rows - self.curves.len() as f64 - absorbed).max(1.0);
        let sigma = spread(self.residual.iter().copied()) * (rows / self.free).sqrt();
        let has_spread = sigma.is_finite() && sigma > 0.0;
        if has_spread {
            self.residual.iter_mut().for_each(|x| *x /= sigma);
            self.sigma *= sigma;
        }
        has_spread
    }

    /// The normal deviate that is passed as often as the amplitude of a half wave over so many places is `deviations` of its
    /// standard deviations from zero: these are known as well as a level, a variance function and the memory are that are
    /// estimated from the rows. The logarithm of the variance of what is slow has itself the variance 4 p / n by an
    /// autoregression of order p of n rows (Berk 1974), that of half waves no more than by as many of them as the rows hold,
    /// and each of the other numbers adds 2 / n.
    pub(super) fn as_normal(&self, deviations: f64, places: usize) -> f64 {
        let numbers = 1 + self.grows_with + places.min(2 * self.order());
        as_normal(deviations, self.free / numbers as f64)
    }

    /// With noise of the size that another residual of these rows has.
    pub(super) fn in_noise_of(mut self, other: &Self) -> Self {
        let ratio = self.sigma / other.sigma;
        self.residual.iter_mut().for_each(|x| *x *= ratio);
        self.sigma = other.sigma;
        self
    }

    /// A column over all rows, white, orthogonal to the curves, in standard deviations of the residual.
    pub(super) fn column(&self, x: &[f64]) -> Vec<f64> {
        let even: Vec<f64> = x.iter().zip(&self.deviations).map(|(x, d)| x / d).collect();
        let mut column = without(&self.whitened(&even), &self.curves);
        column.iter_mut().for_each(|x| *x /= self.sigma);
        column
    }

    /// Innovations of a series over all rows whose noise is of one size.
    fn whitened(&self, x: &[f64]) -> Vec<f64> {
        (0..x.len()).map(|t| self.memory.innovation(t - self.stretch[t][0], |back| x[t - back])).collect()
    }

    /// Order of the autoregression of what it remembers.
    pub(super) fn order(&self) -> usize {
        self.memory.order()
    }

    /// First row of the stretch of neighbouring rows that a row is in, and the row after its last.
    pub(super) fn stretch(&self, row: usize) -> [usize; 2] {
        self.stretch[row]
    }

    /// Rows of a motion within places.
    fn within(&self, motion: usize, places: &Range<usize>) -> Range<usize> {
        let m = &self.motions[motion];
        let at = |place: usize| m.first + m.places.partition_point(|p| *p < place);
        at(places.start)..at(places.end)
    }

    /// Place of a row of a motion.
    fn place(&self, motion: usize, row: usize) -> usize {
        let m = &self.motions[motion];
        m.places[row - m.first]
    }

    /// Rows of a motion within places, and the half wave over these places at them, its noise of one size; `None` where too few
    /// of its rows are there. `wave` is overwritten.
    pub(super) fn even_half_wave(
        &self,
        motion: usize,
        places: &Range<usize>,
        wave: &mut Vec<f64>,
    ) -> Option<Range<usize>> {
        let rows = self.within(motion, places);
        if (rows.len() as f64) < SCAN_PRESENT * places.len() as f64 || rows.len() < 2 {
            return None;
        }
        wave.clear();
        let place = |r: usize| self.place(motion, r);
        wave.extend(rows.clone().map(|r| half_wave(place(r), places) / self.deviations[r]));
        Some(rows)
    }

    /// The half wave over places of a motion, over all rows.
    pub fn of_half_wave(&self, motion: usize, places: Range<usize>) -> Vec<f64> {
        let mut rows = vec![0.0; self.residual.len()];
        for r in self.within(motion, &places) {
            rows[r] = half_wave(self.place(motion, r), &places);
        }
        rows
    }

    /// Amplitude of the half wave over places of a motion, N.m or N, and its standard deviation; `None` where too few of its rows
    /// are there, or the curves over the joint's state or the model make most of it. `scratch` is kept between calls.
    pub fn half_wave(&self, motion: usize, places: Range<usize>, scratch: &mut Scratch) -> Option<[f64; 2]> {
        let rows = self.even_half_wave(motion, &places, &mut scratch.wave)?;
        let reach = (rows.end + self.memory.order()).min(self.stretch[rows.end - 1][1]);
        scratch.wave.resize(reach - rows.start, 0.0);
        scratch.white.clear();
        for t in rows.start..reach {
            let wave =
                |back: usize| if t - back < rows.start { 0.0 } else { scratch.wave[t - back - rows.start] };
            scratch.white.push(self.memory.innovation(t - self.stretch[t][0], wave));
        }
        let product = |x: &[f64]| dot(&x[rows.start..reach], &scratch.white);
        let whole = dot(&scratch.white, &scratch.white);
        let made = |columns: &[Vec<f64>]| columns.iter().map(|c| product(c).powi(2)).sum::<f64>();
        let own = whole - made(&self.curves);
        if !own.is_finite() || own <= SCAN_OWN_SHAPE * whole {
            return None;
        }
        let left = own - made(&self.absorbed);
        let amplitude = || [self.sigma * product(&self.residual) / left, self.sigma / left.sqrt()];
        (left > SCAN_LEFT_BY_MODEL * own).then(amplitude)
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

    /// Whether enough of these places have rows to tell what the largest window there does.
    pub(super) fn is_filled(&self, places: Range<usize>) -> bool {
        let before = |place: usize| self.places.partition_point(|p| *p < place);
        (before(places.end) - before(places.start)) as f64 >= SCAN_FILLED * places.len() as f64
    }

    /// Its places with values of a series over all rows of the joint.
    pub fn rows(&self, series: &[f64]) -> Vec<(usize, f64)> {
        self.places.iter().copied().zip(series[self.first..].iter().copied()).collect()
    }
}

/// Orthonormal columns that span the same (modified Gram and Schmidt, twice).
fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let norm = |x: &[f64]| dot(x, x).sqrt();
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
        let part = dot(column, &left);
        left.iter_mut().zip(column).for_each(|(x, c)| *x -= part * c);
    }
    left
}
