//! Contact with a robot that moves: stretches of 0.15 to 2.4 s in which a joint's residual leans to one side.
//!
//! Half waves of many lengths are fitted to the white residual (`white`), and how far the largest of their amplitudes, in
//! standard deviations, goes in a few seconds is read off the recording's own stretches, as an extreme value law (Gumbel) of their squares. Squares of normal deviates
//! have the exponential tail that this law belongs to, and a heavier tail shows as a larger scale.

use crate::diagnosis::contact::largest::Law;
use crate::diagnosis::contact::memory::{Spread, widening};
use crate::diagnosis::contact::white::{Motion, Scratch, White};
use crate::diagnosis::rules::{
    LARGEST_PUSHED_FRACTION, SCAN_EDGE, SCAN_FILLED, SCAN_IMPACT, SCAN_LEAST_ROWS, SCAN_LEAST_STRETCHES,
    SCAN_LENGTHS, SCAN_OWN_STRETCHES, SCAN_SHORTEST, SCAN_STEPS, SCAN_STRETCH, SCAN_TOGETHER,
};

/// Rows of one joint: for each motion their places on the grid of rows, increasing, and their residual.
pub(in crate::diagnosis) struct Track {
    /// 0-based.
    pub joint: usize,
    /// Motion by motion, with whether it belongs to the recording that is diagnosed.
    pub motions: Vec<(bool, Vec<(usize, f64)>)>,
    /// Curves over the joint's own state that the residual is judged beside, over the rows of all motions.
    pub beside: Vec<Vec<f64>>,
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
    /// Amplitude of the half wave over its standard deviation, squared.
    pub square: f64,
    /// Probability that one of all windows of the recording comes as far by accident.
    pub doubt: f64,
}

/// One joint, ready to be scanned.
struct Scanned {
    joint: usize,
    /// From one place to the next, s.
    step: f64,
    white: White,
    /// How much wider than one the deviations of each length spread.
    wider: Vec<f64>,
    law: Law,
}

/// What the residual of every joint does by itself.
pub(in crate::diagnosis) struct Noise {
    /// Spread of means and law of the largest of them, by joint; `None` where there are too few rows.
    joints: Vec<Option<(Spread, Law)>>,
    /// Stretches of all joints.
    stretches: usize,
}

impl Noise {
    /// Standard deviation of a mean of a joint's residual over so many rows.
    pub fn sigma(&self, joint: usize, rows: usize) -> Option<f64> {
        self.joints.get(joint)?.as_ref().map(|(spread, _)| spread.of_mean(rows))
    }

    /// Probability that a mean as many standard deviations from zero is an accident.
    pub fn doubt(&self, joint: usize, deviations: f64) -> f64 {
        let law = self.joints.get(joint).and_then(Option::as_ref).map(|(_, law)| *law);
        law.map_or(1.0, |law| law.tail(deviations * deviations, self.stretches))
    }
}

/// Windows of one motion with their squared deviations: from a place on, by the length's number.
type Seen = Vec<(f64, usize, usize)>;

/// Windows in which joints are pushed, most certain first, none overlapping another on its joint; and what the residuals
/// do by themselves.
///
/// `step` is the time from one place to the next, s. With a baseline of at least as many stretches as the recording,
/// the law comes from the baseline.
pub(in crate::diagnosis) fn scan(tracks: &[Track], step: f64, level: f64) -> (Vec<Pushed>, Noise) {
    let lengths = lengths(step);
    let mut joints = Vec::new();
    let mut all = Vec::new();
    let mut stretches = 0;
    for track in tracks {
        let Some((scanned, seen)) = Scanned::of(track, &lengths, step) else { continue };
        let largest = |wanted: bool| -> Vec<Stretch> {
            let motions = scanned.white.motions.iter().zip(&seen);
            let chosen = motions.filter(|(m, _)| m.is_target == wanted);
            chosen.flat_map(|(m, seen)| largest(m, seen, &lengths, step)).collect()
        };
        let (before, now) = (largest(false), largest(true));
        stretches += now.len();
        let from = if before.len() >= now.len().max(SCAN_LEAST_STRETCHES) { before } else { now };
        all.extend(from.iter().map(|s| s.largest));
        joints.push((scanned, seen, from));
    }
    let common = Law::of(&mut all);
    let mut noise = Noise { joints: tracks.iter().map(|_| None).collect(), stretches: stretches.max(1) };
    let mut found: Vec<Pushed> = Vec::new();
    for (mut scanned, seen, from) in joints {
        if let Some(common) = common {
            let mut own: Vec<f64> = from.iter().map(|s| s.largest).collect();
            let count = own.len() as f64;
            scanned.law = Law::of(&mut own).map_or(common, |own| own.mean(count, common, SCAN_OWN_STRETCHES));
            let (law, look) = (scanned.law, Beyond { stretches, step, level });
            let candidates = look.pushes(&scanned, &seen, &lengths);
            let (candidates, law) = look.and_others(&scanned, law, candidates, &from);
            scanned.law = law;
            found.extend(candidates);
        }
        let Some(k) = tracks.iter().position(|t| t.joint == scanned.joint) else { continue };
        // What the residual does by itself is told by the rows outside of pushes.
        let is_pushed = |motion: usize, place: usize| {
            let own = found.iter().filter(|p| p.joint == scanned.joint && p.motion == motion);
            own.into_iter().any(|p| (p.places[0]..=p.places[1]).contains(&place))
        };
        let outside = |(m, rows): (usize, &(bool, Vec<(usize, f64)>))| -> Vec<(usize, f64)> {
            rows.1.iter().copied().filter(|(place, _)| !is_pushed(m, *place)).collect()
        };
        let rows: Vec<Vec<(usize, f64)>> = tracks[k].motions.iter().enumerate().map(outside).collect();
        let rows: Vec<&[(usize, f64)]> = rows.iter().map(Vec::as_slice).collect();
        noise.joints[k] = Spread::of(&rows, &lengths).map(|spread| (spread, scanned.law));
    }
    found.sort_by(|a, b| a.doubt.total_cmp(&b.doubt).then(b.square.total_cmp(&a.square)));
    (found, noise)
}

/// What counts as a push.
struct Beyond {
    /// Stretches of all joints.
    stretches: usize,
    /// From one place to the next, s.
    step: f64,
    /// Least probability that one of all windows of the recording comes as far by accident.
    level: f64,
}

impl Beyond {
    /// Windows of one joint beyond the level.
    fn pushes(&self, scanned: &Scanned, seen: &[Seen], lengths: &[usize]) -> Vec<Pushed> {
        let mut found: Vec<Pushed> = Vec::new();
        let gap = (SCAN_TOGETHER / self.step) as usize;
        for (m, seen) in seen.iter().enumerate().filter(|(m, _)| scanned.white.motions[*m].is_target) {
            let passes = |s: &&(f64, usize, usize)| scanned.law.tail(s.0, self.stretches) <= self.level;
            let mut beyond: Vec<&(f64, usize, usize)> = seen.iter().filter(passes).collect();
            beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
            for &&(_, from, k) in &beyond {
                let taken = found.iter().any(|p| {
                    p.motion == m && from <= p.places[1] + gap && p.places[0] <= from + lengths[k] + gap
                });
                if !taken {
                    found.extend(refined(scanned, m, (from, k), lengths, self.stretches));
                }
            }
        }
        found
    }

    /// The candidates of a joint that are beyond what all the rest of its motion does, and its law. Where windows that
    /// are no push stand out, as at every knock of a gear with play, the law of the largest has a longer tail; whether it
    /// has is told by the stretches without a push, so that candidates which do not pass are among them the next time.
    fn and_others(
        &self,
        scanned: &Scanned,
        before: Law,
        mut candidates: Vec<Pushed>,
        from: &[Stretch],
    ) -> (Vec<Pushed>, Law) {
        let half = (0.5 * SCAN_STRETCH / self.step) as usize;
        let mut law;
        loop {
            let pushed = |s: &&Stretch| {
                candidates.iter().any(|p| {
                    p.motion == s.motion
                        && s.places[0] <= p.places[1] + half
                        && p.places[0] <= s.places[1] + half
                })
            };
            let mut others: Vec<f64> = from.iter().filter(|s| !pushed(s)).map(|s| s.largest).collect();
            law = before.with_tail(&mut others);
            let count = candidates.len();
            candidates.iter_mut().for_each(|p| p.doubt = law.tail(p.square, self.stretches));
            candidates.retain(|p| p.doubt <= self.level);
            if candidates.len() == count {
                break;
            }
        }
        let pushed: usize = candidates.iter().map(|p| p.places[1] + 1 - p.places[0]).sum();
        let places: usize = scanned.white.motions.iter().filter(|m| m.is_target).map(Motion::length).sum();
        let few = pushed as f64 <= LARGEST_PUSHED_FRACTION * places as f64;
        (if few { candidates } else { Vec::new() }, law)
    }
}

/// Lengths of windows in rows, each once.
fn lengths(step: f64) -> Vec<usize> {
    let mut lengths: Vec<usize> =
        SCAN_LENGTHS.iter().map(|l| ((l / step).round() as usize).max(SCAN_SHORTEST)).collect();
    lengths.dedup();
    lengths
}

impl Scanned {
    /// With the windows of every motion; the law is not known yet. `None` where there are too few rows.
    fn of(track: &Track, lengths: &[usize], step: f64) -> Option<(Self, Vec<Seen>)> {
        let rows: usize = track.motions.iter().map(|m| m.1.len()).sum();
        if rows < SCAN_LEAST_ROWS {
            return None;
        }
        let white = White::of(&track.motions, &track.beside)?;
        let mut seen: Vec<Seen> = vec![Vec::new(); white.motions.len()];
        let mut wider = Vec::with_capacity(lengths.len());
        let mut scratch = Scratch::default();
        for (k, &length) in lengths.iter().enumerate() {
            let mut deviations = Vec::new();
            let from = seen.iter().map(Vec::len).collect::<Vec<_>>();
            for (m, seen) in seen.iter_mut().enumerate() {
                let last = (white.motions[m].length() + 1).saturating_sub(length);
                for from in (0..last).step_by((length / SCAN_STEPS).max(1)) {
                    if let Some(wave) = white.half_wave(m, from..from + length, &mut scratch) {
                        seen.push((wave, from, k));
                        deviations.push(wave);
                    }
                }
            }
            let factor = widening(&mut deviations, 1.0, rows as f64 / length as f64);
            for (seen, from) in seen.iter_mut().zip(from) {
                seen[from..].iter_mut().for_each(|s| s.0 = (s.0 / factor).powi(2));
            }
            wider.push(factor);
        }
        let law = Law::NORMAL;
        Some((Self { joint: track.joint, step, white, wider, law }, seen))
    }
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

/// A stretch of one motion.
struct Stretch {
    motion: usize,
    /// First and last place.
    places: [usize; 2],
    /// Largest squared deviation of a window in it.
    largest: f64,
}

/// The stretches of a motion that have enough rows.
fn largest(motion: &Motion, seen: &Seen, lengths: &[usize], step: f64) -> Vec<Stretch> {
    let stretch = ((SCAN_STRETCH / step).round() as usize).max(1);
    let mut out = vec![None::<f64>; motion.length() / stretch];
    for &(square, from, k) in seen {
        if let Some(slot) = out.get_mut((from + lengths[k] / 2) / stretch) {
            *slot = Some(slot.map_or(square, |x| x.max(square)));
        }
    }
    let before = |place: usize| motion.places.partition_point(|p| *p < place);
    let filled = |k: usize| before((k + 1) * stretch) - before(k * stretch);
    (0..out.len())
        .filter(|&k| filled(k) as f64 >= SCAN_FILLED * stretch as f64)
        .filter_map(|k| {
            let places = [k * stretch, (k + 1) * stretch - 1];
            Some(Stretch { motion: motion.motion, places, largest: out[k]? })
        })
        .collect()
}

/// The window of any length near one of the grid whose half wave fits best, with how well its edges are known: as far
/// as the squared deviation falls by one, and as far as pushes of other shapes begin and end elsewhere.
fn refined(
    scanned: &Scanned,
    motion: usize,
    (from, k): (usize, usize),
    lengths: &[usize],
    stretches: usize,
) -> Option<Pushed> {
    let (white, length) = (&scanned.white, lengths[k]);
    let (reach, to) = ((length / 2).max(2), from + length);
    let fine = (length / (2 * SCAN_STEPS)).max(1);
    let mut scratch = Scratch::default();
    let mut tried: Vec<(f64, usize, usize)> = Vec::new();
    for a in (from.saturating_sub(reach)..=from + reach).step_by(fine) {
        for b in (to.saturating_sub(reach)..=(to + reach).min(white.motions[motion].length())).step_by(fine) {
            if b >= a + length.div_ceil(2).max(SCAN_SHORTEST)
                && let Some(wave) = white.half_wave(motion, a..b, &mut scratch)
            {
                tried.push(((wave / scanned.wider[k]).powi(2), a, b));
            }
        }
    }
    // What is over sooner is an impact, and none where the rows are too far apart to tell.
    let shortest = (SCAN_IMPACT / scanned.step) as usize;
    let best = tried.iter().copied().max_by(|x, y| x.0.total_cmp(&y.0)).filter(|t| t.2 - t.1 >= shortest)?;
    let near: Vec<&(f64, usize, usize)> = tried.iter().filter(|t| t.0 >= best.0 - 1.0).collect();
    let width = |edge: fn(&(f64, usize, usize)) -> usize| {
        let (low, high) = near.iter().fold((usize::MAX, 0), |(l, h), t| (l.min(edge(t)), h.max(edge(t))));
        // A push need not be a half wave.
        (0.5 * high.saturating_sub(low) as f64).max(0.5).hypot(SCAN_EDGE * (best.2 - best.1) as f64)
    };
    Some(Pushed {
        joint: scanned.joint,
        motion: white.motions[motion].motion,
        places: [best.1, best.2.saturating_sub(1)],
        edges: [width(|t| t.1), width(|t| t.2)],
        square: best.0,
        doubt: scanned.law.tail(best.0, stretches),
    })
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
