//! Half waves of many lengths in the white residual of one joint.

use crate::diagnosis::contact::memory::widening;
use crate::diagnosis::contact::pushed::Pushed;
use crate::diagnosis::contact::white::{Motion, Scratch, White};
use crate::diagnosis::rules::{
    SCAN_EDGE, SCAN_IMPACT, SCAN_LENGTHS, SCAN_LONGEST, SCAN_SHORTEST, SCAN_STEPS, SCAN_STRETCH,
};

/// How much wider than its standard deviation the half waves of each length spread.
#[derive(Clone)]
pub(super) struct Widths {
    /// Lengths of windows, places.
    lengths: Vec<usize>,
    wider: Vec<f64>,
}

impl Widths {
    /// Of half waves over so many places.
    pub fn of(&self, places: usize) -> f64 {
        let length = self.lengths.iter().rposition(|length| *length <= places).unwrap_or(0);
        self.wider.get(length).copied().unwrap_or(1.0)
    }
}

/// One joint with all of its windows.
pub(super) struct HalfWaves {
    white: White,
    pub widths: Widths,
    /// Windows of each motion.
    windows: Vec<Vec<Window>>,
    /// From one place to the next, s.
    step: f64,
}

/// A window of the grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Amplitude of its half wave as a normal deviate.
    pub deviation: f64,
    /// First place.
    pub from: usize,
    /// Number of its length.
    pub length: usize,
}

impl Window {
    /// Squared deviation of its half wave's amplitude from zero.
    pub fn square(&self) -> f64 {
        self.deviation * self.deviation
    }
}

/// The window whose half wave fits best.
pub(super) struct Refined {
    /// Squared deviation, or what else windows were compared by.
    pub square: f64,
    /// First place.
    pub from: usize,
    /// The place after its last.
    pub to: usize,
    /// Standard deviations of both, in places.
    pub edges: [f64; 2],
}

impl Refined {
    /// The best of windows `(square, from, to)` that were tried, with how well its edges are known: as far as the square falls by
    /// one, and as far as pushes that are no half waves begin and end elsewhere. `step` is the time from one place to the next, s.
    /// `None` where what fits best is over too soon, or lasts too long.
    pub fn best_of(tried: &[(f64, usize, usize)], step: f64) -> Option<Self> {
        let (square, from, to) = tried.iter().copied().max_by(|x, y| x.0.total_cmp(&y.0))?;
        // What is over sooner is an impact, and none where the rows are too far apart to tell.
        let [shortest, longest] = [SCAN_IMPACT, SCAN_LONGEST].map(|lasts| (lasts / step) as usize);
        if !(shortest..=longest.max(shortest)).contains(&(to - from)) {
            return None;
        }
        let near = || tried.iter().filter(|t| t.0 >= square - 1.0);
        let width = |edge: fn(&(f64, usize, usize)) -> usize| {
            let (low, high) =
                near().map(edge).fold((usize::MAX, 0), |(low, high), x| (low.min(x), high.max(x)));
            (0.5 * high.saturating_sub(low) as f64).max(0.5).hypot(SCAN_EDGE * (to - from) as f64)
        };
        Some(Self { square, from, to, edges: [width(|t| t.1), width(|t| t.2)] })
    }

    /// As a push of a joint in a motion, before it is judged.
    pub fn as_push(&self, joint: usize, motion: usize) -> Pushed {
        let Self { square, from, to, edges } = *self;
        Pushed { joint, motion, places: [from, to - 1], edges, square, doubt: 1.0 }
    }
}

/// Lengths of windows in rows, each once; `step` is the time from one to the next, s.
pub(super) fn lengths(step: f64) -> Vec<usize> {
    let mut lengths: Vec<usize> =
        SCAN_LENGTHS.iter().map(|l| ((l / step).round() as usize).max(SCAN_SHORTEST)).collect();
    lengths.dedup();
    lengths
}

/// Places of the stretches that largest windows are taken of.
fn stretch(step: f64) -> usize {
    ((SCAN_STRETCH / step).round() as usize).max(1)
}

/// Number of stretches of a recording that have enough rows.
pub(super) fn stretches(white: &White, step: f64) -> usize {
    let length = stretch(step);
    let of_motion = |motion: &Motion| {
        let filled = |k: &usize| motion.is_filled(k * length..(k + 1) * length);
        (0..motion.length() / length).filter(filled).count()
    };
    white.motions.iter().filter(|m| m.is_target).map(of_motion).sum()
}

impl HalfWaves {
    /// All windows of these lengths in the recording, and in its `baseline` where that is asked for; `step` is the time from one
    /// place to the next, s.
    pub fn of(white: White, lengths: &[usize], step: f64, baseline: bool) -> Self {
        let asked = |motion: &Motion| motion.is_target || baseline;
        let rows: usize = white.motions.iter().filter(|m| asked(m)).map(|m| m.places.len()).sum();
        let mut windows: Vec<Vec<Window>> = vec![Vec::new(); white.motions.len()];
        let mut wider = Vec::with_capacity(lengths.len());
        let mut scratch = Scratch::default();
        for (k, &length) in lengths.iter().enumerate() {
            let mut deviations = Vec::new();
            let from = windows.iter().map(Vec::len).collect::<Vec<_>>();
            for (m, windows) in windows.iter_mut().enumerate() {
                if !asked(&white.motions[m]) {
                    continue;
                }
                let last = (white.motions[m].length() + 1).saturating_sub(length);
                for from in (0..last).step_by((length / SCAN_STEPS).max(1)) {
                    if let Some([wave, sigma]) = white.half_wave(m, from..from + length, &mut scratch) {
                        windows.push(Window { deviation: wave / sigma, from, length: k });
                        deviations.push(wave / sigma);
                    }
                }
            }
            let factor = widening(&mut deviations, 1.0, rows as f64 / length as f64);
            for (windows, from) in windows.iter_mut().zip(from) {
                windows[from..]
                    .iter_mut()
                    .for_each(|w| w.deviation = white.as_normal(w.deviation / factor, length));
            }
            wider.push(factor);
        }
        Self { white, widths: Widths { lengths: lengths.to_vec(), wider }, windows, step }
    }

    /// The residual that they are in.
    pub fn white(&self) -> &White {
        &self.white
    }

    /// Places of the recording that is diagnosed.
    pub fn targets(&self) -> usize {
        self.white.motions.iter().filter(|m| m.is_target).map(Motion::length).sum()
    }

    /// First place of a window, and the one after its last.
    pub fn places(&self, window: Window) -> [usize; 2] {
        [window.from, window.from + self.widths.lengths[window.length]]
    }

    /// Windows of the recording that is diagnosed, each with the number of its motion.
    pub fn of_targets(&self) -> impl Iterator<Item = (usize, Window)> {
        let motions = self.white.motions.iter().zip(&self.windows).filter(|(m, _)| m.is_target);
        motions.flat_map(|(m, windows)| windows.iter().map(|window| (m.motion, *window)))
    }

    /// Windows of one of the lengths, `(motion, places)`, that are free: motion and first place, increasing, and deviation.
    pub fn of_length(
        &self,
        length: usize,
        is_free: impl Fn((usize, [usize; 2])) -> bool,
    ) -> Vec<([usize; 2], f64)> {
        let motions = self.white.motions.iter().zip(&self.windows);
        let of_motion = |(motion, windows): (&Motion, &Vec<Window>)| {
            let these = windows.iter().filter(|w| w.length == length);
            let free = these.filter(|w| is_free((motion.motion, self.places(**w))));
            free.map(|w| ([motion.motion, w.from], w.deviation)).collect::<Vec<_>>()
        };
        motions.flat_map(of_motion).collect()
    }

    /// The largest squared deviation of a window in each stretch of the recording, or of its baseline, that has enough rows;
    /// of windows, `(motion, places)`, that are free.
    pub fn largest(&self, target: bool, is_free: impl Fn((usize, [usize; 2])) -> bool) -> Vec<f64> {
        let motions = self.white.motions.iter().zip(&self.windows).filter(|(m, _)| m.is_target == target);
        let of_motion = |(motion, windows): (&Motion, &Vec<Window>)| {
            let stretch = stretch(self.step);
            let mut out = vec![None::<f64>; motion.length() / stretch];
            for w in windows.iter().filter(|w| is_free((motion.motion, self.places(**w)))) {
                if let Some(slot) = out.get_mut((w.from + self.widths.lengths[w.length] / 2) / stretch) {
                    *slot = Some(slot.map_or(w.square(), |x| x.max(w.square())));
                }
            }
            let is_filled = |k: &usize| motion.is_filled(k * stretch..(k + 1) * stretch);
            (0..out.len()).filter(is_filled).filter_map(|k| out[k]).collect::<Vec<f64>>()
        };
        motions.flat_map(of_motion).collect()
    }

    /// The window of any length near one of the grid whose half wave fits best, with how well its edges are known: as far as
    /// the squared deviation falls by one, and as far as pushes of other shapes begin and end elsewhere. `None` where what fits
    /// best is over too soon, or lasts too long.
    pub fn refined(&self, motion: usize, window: Window) -> Option<Refined> {
        let (white, length) = (&self.white, self.widths.lengths[window.length]);
        let [from, to] = self.places(window);
        let reach = (length / 2).max(2);
        let fine = (length / (2 * SCAN_STEPS)).max(1);
        let mut scratch = Scratch::default();
        let mut tried: Vec<(f64, usize, usize)> = Vec::new();
        for a in (from.saturating_sub(reach)..=from + reach).step_by(fine) {
            for b in
                (to.saturating_sub(reach)..=(to + reach).min(white.motions[motion].length())).step_by(fine)
            {
                if b >= a + length.div_ceil(2).max(SCAN_SHORTEST)
                    && let Some([wave, sigma]) = white.half_wave(motion, a..b, &mut scratch)
                {
                    tried.push(((wave / (sigma * self.widths.wider[window.length])).powi(2), a, b));
                }
            }
        }
        Refined::best_of(&tried, self.step)
    }
}
