//! Contact with a robot that moves: stretches of 0.15 to 2.4 s in which a joint's residual leans to one side.
//!
//! Means of the residual over windows of many lengths are compared with what such means do by themselves: their
//! variance follows from how long the residual remembers, and how far the largest of them goes in a few seconds is read
//! off the recording's own stretches, as an extreme value law (Gumbel) of their squares. Squares of normal deviates
//! have the exponential tail that this law belongs to, and a heavier tail shows as a larger scale.

use crate::diagnosis::contact::memory::Spread;
use crate::diagnosis::rules::{
    LARGEST_PUSHED_FRACTION, SCAN_LEAST_ROWS, SCAN_LEAST_STRETCHES, SCAN_LENGTHS, SCAN_LEVEL,
    SCAN_NORMAL_SCALE, SCAN_OWN_STRETCHES, SCAN_PRESENT, SCAN_STRETCH, SCAN_TOGETHER,
};

/// Rows of one joint: for each motion their places on the grid of rows, increasing, and their residual.
pub(in crate::diagnosis) struct Track {
    /// 0-based.
    pub joint: usize,
    /// Motion by motion, with whether it belongs to the recording that is diagnosed.
    pub motions: Vec<(bool, Vec<(usize, f64)>)>,
}

impl Track {
    /// The residual of a motion from the first of two places to the last.
    pub fn inside(&self, motion: usize, places: [usize; 2]) -> Vec<f64> {
        let rows = self.motions[motion].1.iter();
        rows.filter(|(place, _)| (places[0]..=places[1]).contains(place)).map(|(_, r)| *r).collect()
    }
}

/// A window in which one joint is pushed.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Pushed {
    /// 0-based.
    pub joint: usize,
    pub motion: usize,
    /// First and last place.
    pub places: [usize; 2],
    /// Standard deviations of both, in places.
    pub edges: [f64; 2],
    /// Mean of the residual, and its standard deviation.
    pub mean: f64,
    pub sigma: f64,
    /// Probability that one of all windows of the recording comes as far by accident.
    pub doubt: f64,
}

/// How far the largest squared mean of a stretch goes: Gumbel's law.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Law {
    location: f64,
    scale: f64,
}

impl Law {
    /// From the quartiles, which a few pushed stretches hardly move.
    fn of(largest: &mut [f64]) -> Option<Self> {
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

    fn mean(self, own: f64, other: Self, others: f64) -> Self {
        let mean = |a: f64, b: f64| (own * a + others * b) / (own + others);
        Self { location: mean(self.location, other.location), scale: mean(self.scale, other.scale) }
    }

    /// Probability that the largest of so many stretches passes a square.
    fn tail(self, square: f64, stretches: usize) -> f64 {
        -(-(stretches as f64) * (-(square - self.location) / self.scale).exp()).exp_m1()
    }
}

/// Sums over the rows of one motion, so that every window's mean is two look-ups.
struct Sums {
    motion: usize,
    /// Count and sum of the rows before each place.
    count: Vec<usize>,
    sum: Vec<f64>,
}

impl Sums {
    fn new(motion: usize, rows: &[(usize, f64)]) -> Self {
        let places = rows.last().map_or(0, |r| r.0 + 1);
        let (mut count, mut sum) = (vec![0; places + 1], vec![0.0; places + 1]);
        for &(place, x) in rows {
            count[place + 1] = 1;
            sum[place + 1] = x;
        }
        for k in 0..places {
            count[k + 1] += count[k];
            sum[k + 1] += sum[k];
        }
        Self { motion, count, sum }
    }

    fn places(&self) -> usize {
        self.count.len() - 1
    }

    /// Mean over `[from, from + length)` in standard deviations, where enough of its rows are there.
    fn deviation(&self, from: usize, length: usize, spread: &Spread) -> Option<f64> {
        let to = (from + length).min(self.places());
        let count = self.count[to] - self.count[from];
        if (count as f64) < SCAN_PRESENT * length as f64 {
            return None;
        }
        Some((self.sum[to] - self.sum[from]) / count as f64 / spread.of_mean(count))
    }
}

/// One joint, ready to be scanned.
struct Scanned {
    joint: usize,
    spread: Spread,
    /// Of the recording that is diagnosed.
    fresh: Vec<Sums>,
    law: Law,
}

/// Windows in which joints are pushed, most certain first, none overlapping another on its joint.
///
/// `step` is the time from one place to the next, s. With a baseline of at least as many stretches as the recording,
/// the law comes from the baseline.
pub(in crate::diagnosis) fn scan(tracks: &[Track], step: f64) -> Vec<Pushed> {
    let lengths: Vec<usize> = SCAN_LENGTHS.iter().map(|l| ((l / step).round() as usize).max(3)).collect();
    let mut joints = Vec::new();
    let mut all = Vec::new();
    let mut stretches = 0;
    for track in tracks {
        let rows: usize = track.motions.iter().map(|m| m.1.len()).sum();
        if rows < SCAN_LEAST_ROWS {
            continue;
        }
        let motions: Vec<&[(usize, f64)]> = track.motions.iter().map(|m| m.1.as_slice()).collect();
        let Some(spread) = Spread::of(&motions, &lengths) else { continue };
        let sums = |wanted: bool| -> Vec<Sums> {
            let motions = track.motions.iter().enumerate();
            let chosen = motions.filter(|(_, (fresh, rows))| *fresh == wanted && !rows.is_empty());
            chosen.map(|(k, (_, rows))| Sums::new(k, rows)).collect()
        };
        let (old, fresh) = (sums(false), sums(true));
        let largest = |sums: &[Sums]| -> Vec<f64> {
            sums.iter().flat_map(|s| largest(s, &spread, &lengths, step)).collect()
        };
        let (before, now) = (largest(&old), largest(&fresh));
        stretches += now.len();
        let from = if before.len() >= now.len().max(SCAN_LEAST_STRETCHES) { before } else { now };
        all.extend_from_slice(&from);
        joints.push((track.joint, spread, fresh, from));
    }
    let Some(common) = Law::of(&mut all) else { return Vec::new() };
    let joints: Vec<Scanned> = joints
        .into_iter()
        .map(|(joint, spread, fresh, mut from)| {
            let count = from.len() as f64;
            let law = Law::of(&mut from).map_or(common, |own| own.mean(count, common, SCAN_OWN_STRETCHES));
            Scanned { joint, spread, fresh, law }
        })
        .collect();
    let mut found: Vec<Pushed> = Vec::new();
    for scanned in &joints {
        let mut of_joint = pushes(scanned, &lengths, stretches, step);
        let pushed: usize = of_joint.iter().map(|p| p.places[1] + 1 - p.places[0]).sum();
        let places: usize = scanned.fresh.iter().map(Sums::places).sum();
        if pushed as f64 <= LARGEST_PUSHED_FRACTION * places as f64 {
            found.append(&mut of_joint);
        }
    }
    found.sort_by(|a, b| a.doubt.total_cmp(&b.doubt));
    found
}

/// Windows of several joints that are one push, in the order of time.
pub(in crate::diagnosis) fn together(mut pushed: Vec<Pushed>, step: f64) -> Vec<Vec<Pushed>> {
    let gap = (SCAN_TOGETHER / step) as usize;
    pushed.sort_by_key(|p| (p.motion, p.places[0]));
    let mut groups: Vec<Vec<Pushed>> = Vec::new();
    for p in pushed {
        let near = |group: &Vec<Pushed>| {
            group.iter().any(|g| {
                g.motion == p.motion && p.places[0] <= g.places[1] + gap && g.places[0] <= p.places[1] + gap
            })
        };
        match groups.last_mut().filter(|g| near(g)) {
            Some(group) => group.push(p),
            None => groups.push(vec![p]),
        }
    }
    groups
}

/// Largest squared deviation in each stretch of a motion that has enough rows.
fn largest(sums: &Sums, spread: &Spread, lengths: &[usize], step: f64) -> Vec<f64> {
    let stretch = ((SCAN_STRETCH / step).round() as usize).max(1);
    let count = sums.places() / stretch;
    let mut out = vec![None::<f64>; count];
    for &length in lengths {
        for from in 0..sums.places().saturating_sub(length) {
            let Some(slot) = out.get_mut((from + length / 2) / stretch) else { continue };
            if let Some(z) = sums.deviation(from, length, spread) {
                *slot = Some(slot.map_or(z * z, |x| x.max(z * z)));
            }
        }
    }
    let filled = |k: usize| sums.count[(k + 1) * stretch] - sums.count[k * stretch];
    (0..count).filter(|&k| 2 * filled(k) >= stretch).filter_map(|k| out[k]).collect()
}

/// Windows of one joint beyond the level.
fn pushes(scanned: &Scanned, lengths: &[usize], stretches: usize, step: f64) -> Vec<Pushed> {
    let mut found: Vec<Pushed> = Vec::new();
    for sums in &scanned.fresh {
        let mut beyond: Vec<(f64, usize, usize)> = Vec::new();
        for &length in lengths {
            for from in 0..sums.places().saturating_sub(length) {
                let Some(z) = sums.deviation(from, length, &scanned.spread) else { continue };
                if scanned.law.tail(z * z, stretches) <= SCAN_LEVEL {
                    beyond.push((z * z, from, length));
                }
            }
        }
        beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, from, length) in beyond {
            let gap = (SCAN_TOGETHER / step) as usize;
            let taken = found.iter().any(|p| {
                p.motion == sums.motion && from <= p.places[1] + gap && p.places[0] <= from + length + gap
            });
            if !taken {
                found.push(refined(scanned, sums, from, length, stretches));
            }
        }
    }
    found
}

/// The window of any length near one of the grid in which the residual leans most, with how well its edges are known:
/// as far as the squared deviation falls by one.
fn refined(scanned: &Scanned, sums: &Sums, from: usize, length: usize, stretches: usize) -> Pushed {
    let reach = (length / 2).max(2);
    let to = from + length;
    let mut tried: Vec<(f64, usize, usize)> = Vec::new();
    for a in from.saturating_sub(reach)..=from + reach {
        for b in to.saturating_sub(reach)..=(to + reach).min(sums.places()) {
            if b >= a + length.div_ceil(2).max(3)
                && let Some(z) = sums.deviation(a, b - a, &scanned.spread)
            {
                tried.push((z * z, a, b));
            }
        }
    }
    let best = tried.iter().copied().max_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or((0.0, from, to));
    let near: Vec<&(f64, usize, usize)> = tried.iter().filter(|t| t.0 >= best.0 - 1.0).collect();
    let width = |edge: fn(&(f64, usize, usize)) -> usize| {
        let (low, high) = near.iter().fold((usize::MAX, 0), |(l, h), t| (l.min(edge(t)), h.max(edge(t))));
        (0.5 * high.saturating_sub(low) as f64).max(0.5)
    };
    let count = sums.count[best.2] - sums.count[best.1];
    Pushed {
        joint: scanned.joint,
        motion: sums.motion,
        places: [best.1, best.2.saturating_sub(1)],
        edges: [width(|t| t.1), width(|t| t.2)],
        mean: (sums.sum[best.2] - sums.sum[best.1]) / count.max(1) as f64,
        sigma: scanned.spread.of_mean(count.max(1)),
        doubt: scanned.law.tail(best.0, stretches),
    }
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
