//! Contact with a robot that moves: stretches of 0.15 to 2.4 s in which a joint's residual leans to one side.
//!
//! Half waves of many lengths are fitted to the white residual (`white`), and how far the largest of their amplitudes, in
//! standard deviations, goes in a few seconds is read off the recording's own stretches, as an extreme value law (Gumbel) of
//! their squares. Squares of normal deviates have the exponential tail that this law belongs to, and a heavier tail shows as a
//! larger scale. What may be a push tells nothing of this law.

use crate::diagnosis::contact::largest::Law;
use crate::diagnosis::contact::memory::{Spread, widening};
use crate::diagnosis::contact::white::{Motion, Scratch, White};
use crate::diagnosis::rules::{
    LARGEST_PUSHED_FRACTION, SCAN_EDGE, SCAN_FILLED, SCAN_IMPACT, SCAN_LEAST_ROWS, SCAN_LEAST_STRETCHES,
    SCAN_LENGTHS, SCAN_OWN_STRETCHES, SCAN_SHORTEST, SCAN_STEPS, SCAN_STRETCH, SCAN_SUSPECT, SCAN_TOGETHER,
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
    let mut joints: Vec<Joint<'_>> =
        tracks.iter().filter_map(|track| Joint::of(track, &lengths, step)).collect();
    let stretches = joints.iter().map(|joint| joint.stretches(true, &lengths).len()).sum::<usize>().max(1);
    // A window that may be a push says nothing of what the residual does by itself: the law is told by all others, until no
    // candidate is left that is none by it.
    fit_laws(&mut joints, &lengths);
    for joint in &mut joints {
        joint.candidates = joint.beyond(SCAN_SUSPECT, &lengths, stretches);
    }
    loop {
        let others = fit_laws(&mut joints, &lengths);
        let dropped =
            joints.iter_mut().zip(others).map(|(joint, own)| joint.drop_accidents(own, level, stretches));
        if dropped.sum::<usize>() == 0 {
            break;
        }
    }
    let of_track = |track: &Track| joints.iter().find(|j| j.track.joint == track.joint)?.noise(&lengths);
    let noise = Noise { joints: tracks.iter().map(of_track).collect(), stretches };
    let mut found: Vec<Pushed> = joints.into_iter().flat_map(Joint::pushes).collect();
    found.sort_by(|a, b| a.doubt.total_cmp(&b.doubt).then(b.square.total_cmp(&a.square)));
    (found, noise)
}

/// Whether places of a motion are next to those of a push.
fn is_near(pushes: &[Pushed], motion: usize, [from, to]: [usize; 2], gap: usize) -> bool {
    let mut own = pushes.iter().filter(|p| p.motion == motion);
    own.any(|p| from <= p.places[1] + gap && p.places[0] <= to + gap)
}

/// One joint with its windows, and those that may be pushes.
struct Joint<'a> {
    track: &'a Track,
    /// From one place to the next, s.
    step: f64,
    white: White,
    /// How much wider than one the deviations of each length spread.
    wider: Vec<f64>,
    /// Windows of each motion.
    seen: Vec<Seen>,
    candidates: Vec<Pushed>,
    /// What its largest windows do by themselves; `None` where there are too few of all joints.
    law: Option<Law>,
}

/// The law of the largest windows of each joint, from those that overlap no candidate: its own, and that of all joints. Returns
/// these windows of each joint.
fn fit_laws(joints: &mut [Joint<'_>], lengths: &[usize]) -> Vec<Vec<f64>> {
    let of_joint = |joint: &Joint<'_>| {
        let (before, now) = (joint.stretches(false, lengths), joint.stretches(true, lengths));
        if before.len() >= now.len().max(SCAN_LEAST_STRETCHES) { before } else { now }
    };
    let mut of_joints: Vec<Vec<f64>> = joints.iter().map(of_joint).collect();
    let common = Law::of(&mut of_joints.concat());
    for (joint, own) in joints.iter_mut().zip(&mut of_joints) {
        let count = own.len() as f64;
        let law = |common| Law::of(own).map_or(common, |own| own.mean(count, common, SCAN_OWN_STRETCHES));
        joint.law = common.map(law);
    }
    of_joints
}

impl<'a> Joint<'a> {
    /// With the windows of every motion, and nothing found yet. `None` where there are too few rows.
    fn of(track: &'a Track, lengths: &[usize], step: f64) -> Option<Self> {
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
        Some(Self { track, step, white, wider, seen, candidates: Vec::new(), law: None })
    }

    /// The largest squared deviation of a window in each stretch of the recording, or of its baseline, that overlaps no
    /// candidate.
    fn stretches(&self, target: bool, lengths: &[usize]) -> Vec<f64> {
        let motions = self.white.motions.iter().zip(&self.seen).filter(|(m, _)| m.is_target == target);
        motions
            .flat_map(|(motion, seen)| {
                let is_free = |&(_, from, k): &(f64, usize, usize)| {
                    !is_near(&self.candidates, motion.motion, [from, from + lengths[k]], self.gap())
                };
                largest(motion, seen.iter().filter(|w| is_free(w)), lengths, self.step)
            })
            .collect()
    }

    /// Places between pushes that are two.
    fn gap(&self) -> usize {
        (SCAN_TOGETHER / self.step) as usize
    }

    /// Windows beyond a level, the largest first, none next to another.
    fn beyond(&self, level: f64, lengths: &[usize], stretches: usize) -> Vec<Pushed> {
        let Some(law) = self.law else { return Vec::new() };
        let (gap, mut found) = (self.gap(), Vec::new());
        for (m, seen) in self.seen.iter().enumerate().filter(|(m, _)| self.white.motions[*m].is_target) {
            let passes = |s: &&(f64, usize, usize)| law.tail(s.0, stretches) <= level;
            let mut beyond: Vec<&(f64, usize, usize)> = seen.iter().filter(passes).collect();
            beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
            for &&(_, from, k) in &beyond {
                if !is_near(&found, m, [from, from + lengths[k]], gap) {
                    found.extend(self.refined(m, (from, k), lengths));
                }
            }
        }
        found
    }

    /// The window of any length near one of the grid whose half wave fits best, not judged yet, with how well its edges are
    /// known: as far as the squared deviation falls by one, and as far as pushes of other shapes begin and end elsewhere.
    fn refined(&self, motion: usize, (from, k): (usize, usize), lengths: &[usize]) -> Option<Pushed> {
        let (white, length) = (&self.white, lengths[k]);
        let (reach, to) = ((length / 2).max(2), from + length);
        let fine = (length / (2 * SCAN_STEPS)).max(1);
        let mut scratch = Scratch::default();
        let mut tried: Vec<(f64, usize, usize)> = Vec::new();
        for a in (from.saturating_sub(reach)..=from + reach).step_by(fine) {
            for b in
                (to.saturating_sub(reach)..=(to + reach).min(white.motions[motion].length())).step_by(fine)
            {
                if b >= a + length.div_ceil(2).max(SCAN_SHORTEST)
                    && let Some(wave) = white.half_wave(motion, a..b, &mut scratch)
                {
                    tried.push(((wave / self.wider[k]).powi(2), a, b));
                }
            }
        }
        // What is over sooner is an impact, and none where the rows are too far apart to tell.
        let shortest = (SCAN_IMPACT / self.step) as usize;
        let best =
            tried.iter().copied().max_by(|x, y| x.0.total_cmp(&y.0)).filter(|t| t.2 - t.1 >= shortest)?;
        let near: Vec<&(f64, usize, usize)> = tried.iter().filter(|t| t.0 >= best.0 - 1.0).collect();
        let width = |edge: fn(&(f64, usize, usize)) -> usize| {
            let (low, high) = near.iter().fold((usize::MAX, 0), |(l, h), t| (l.min(edge(t)), h.max(edge(t))));
            // A push need not be a half wave.
            (0.5 * high.saturating_sub(low) as f64).max(0.5).hypot(SCAN_EDGE * (best.2 - best.1) as f64)
        };
        Some(Pushed {
            joint: self.track.joint,
            motion: white.motions[motion].motion,
            places: [best.1, best.2.saturating_sub(1)],
            edges: [width(|t| t.1), width(|t| t.2)],
            square: best.0,
            doubt: 1.0,
        })
    }

    /// Drops the candidates that do not pass a level by what all `others` do, and says how many these are. Where windows that
    /// are no push stand out, as at every knock of a gear with play, the law has a longer tail.
    fn drop_accidents(&mut self, mut others: Vec<f64>, level: f64, stretches: usize) -> usize {
        let before = self.candidates.len();
        self.law = self.law.map(|law| law.with_tail(&mut others));
        let law = self.law;
        self.candidates
            .iter_mut()
            .for_each(|p| p.doubt = law.map_or(1.0, |law| law.tail(p.square, stretches)));
        self.candidates.retain(|p| p.doubt <= level);
        before - self.candidates.len()
    }

    /// What its residual does by itself outside of its candidates; `None` where it has too few rows there.
    fn noise(&self, lengths: &[usize]) -> Option<(Spread, Law)> {
        let outside = |m: usize| -> Vec<(usize, f64)> {
            let is_pushed = |place: usize| is_near(&self.candidates, m, [place; 2], 0);
            self.track.motions[m].1.iter().copied().filter(|(place, _)| !is_pushed(*place)).collect()
        };
        let rows: Vec<Vec<(usize, f64)>> = (0..self.track.motions.len()).map(outside).collect();
        let rows: Vec<&[(usize, f64)]> = rows.iter().map(Vec::as_slice).collect();
        Spread::of(&rows, lengths).map(|spread| (spread, self.law.unwrap_or(Law::NORMAL)))
    }

    /// The candidates, where they take so little of the motion that they are an exception.
    fn pushes(self) -> Vec<Pushed> {
        let pushed: usize = self.candidates.iter().map(|p| p.places[1] + 1 - p.places[0]).sum();
        let targets = self.white.motions.iter().filter(|m| m.is_target);
        let places: usize = targets.map(Motion::length).sum();
        let few = pushed as f64 <= LARGEST_PUSHED_FRACTION * places as f64;
        if few { self.candidates } else { Vec::new() }
    }
}

/// Lengths of windows in rows, each once.
fn lengths(step: f64) -> Vec<usize> {
    let mut lengths: Vec<usize> =
        SCAN_LENGTHS.iter().map(|l| ((l / step).round() as usize).max(SCAN_SHORTEST)).collect();
    lengths.dedup();
    lengths
}

/// Windows of several joints that are one push, in the order of time.
pub(in crate::diagnosis) fn together(mut pushed: Vec<Pushed>, step: f64) -> Vec<Vec<Pushed>> {
    let gap = (SCAN_TOGETHER / step) as usize;
    pushed.sort_by_key(|p| (p.motion, p.places[0]));
    let mut groups: Vec<Vec<Pushed>> = Vec::new();
    for p in pushed {
        match groups.last_mut().filter(|g| is_near(g, p.motion, p.places, gap)) {
            Some(group) => group.push(p),
            None => groups.push(vec![p]),
        }
    }
    groups
}

/// Largest squared deviation of these windows of a motion in each stretch of it that has enough rows.
fn largest<'a>(
    motion: &Motion,
    windows: impl Iterator<Item = &'a (f64, usize, usize)>,
    lengths: &[usize],
    step: f64,
) -> Vec<f64> {
    let stretch = ((SCAN_STRETCH / step).round() as usize).max(1);
    let mut out = vec![None::<f64>; motion.length() / stretch];
    for &(square, from, k) in windows {
        if let Some(slot) = out.get_mut((from + lengths[k] / 2) / stretch) {
            *slot = Some(slot.map_or(square, |x| x.max(square)));
        }
    }
    let before = |place: usize| motion.places.partition_point(|p| *p < place);
    let filled = |k: usize| before((k + 1) * stretch) - before(k * stretch);
    let is_filled = |k: usize| filled(k) as f64 >= SCAN_FILLED * stretch as f64;
    (0..out.len()).filter(|&k| is_filled(k)).filter_map(|k| out[k]).collect()
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
