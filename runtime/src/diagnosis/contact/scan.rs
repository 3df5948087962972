//! Contact with a robot that moves: stretches of 0.15 to 2.4 s in which the residual of joints leans to one side.
//!
//! Half waves of many lengths are fitted to the white residual of every joint (`half_waves`), and how far the largest of their
//! amplitudes, in standard deviations, goes in a few seconds is read off the recording's own stretches, as an extreme value law
//! (Gumbel) of their squares (`largest`). A push is felt by all joints at the same time while their noise is their own: what
//! joints feel in one window adds up. What may be a push on any joint tells nothing of these laws.

use crate::diagnosis::contact::absorbed::put_beside;
use crate::diagnosis::contact::half_waves::{HalfWaves, Refined, Window, lengths};
use crate::diagnosis::contact::largest::{Law, doubt};
use crate::diagnosis::contact::memory::Spread;
use crate::diagnosis::contact::white::{Scratch, White};
use crate::diagnosis::rules::{
    LARGEST_PUSHED_FRACTION, SCAN_LEAST_ROWS, SCAN_LEAST_STRETCHES, SCAN_OWN_STRETCHES, SCAN_SUSPECT,
    SCAN_TOGETHER,
};
use std::ops::Range;

/// Rows of one joint: for each motion their places on the grid of rows, increasing, and their residual.
pub(in crate::diagnosis) struct Track {
    /// 0-based.
    pub joint: usize,
    /// Motion by motion, with whether it belongs to the recording that is diagnosed.
    pub motions: Vec<(bool, Vec<(usize, f64)>)>,
    /// Curves over the joint's own state that the residual is judged beside, over the rows of all motions.
    pub beside: Vec<Vec<f64>>,
    /// Columns of the model that leaves the residual, the same number for all joints, over the rows of all motions; empty
    /// where a column is zero on this joint.
    pub columns: Vec<Vec<f64>>,
}

/// A window in which joints are pushed.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Pushed {
    /// The one that tells most of it, 0-based.
    pub joint: usize,
    pub motion: usize,
    /// First and last place.
    pub places: [usize; 2],
    /// Standard deviations of both, in places.
    pub edges: [f64; 2],
    /// Amplitude of the half wave over its standard deviation, squared.
    pub square: f64,
    /// Probability that in one of all windows of the recording all joints together come as far by accident.
    pub doubt: f64,
}

/// What the residual of every joint does by itself.
pub(in crate::diagnosis) struct Noise {
    /// By joint; `None` where there are too few rows.
    joints: Vec<Option<Own>>,
    chances: Chances,
}

/// The same of one joint.
struct Own {
    /// Of means of the residual as it is.
    spread: Spread,
    /// Beside the model.
    waves: HalfWaves,
    law: Law,
}

/// How many joints and stretches a recording has.
#[derive(Debug, Clone, Copy)]
struct Chances {
    joints: usize,
    /// Of all joints.
    stretches: usize,
}

impl Chances {
    /// Probability that the surprise of a joint comes this far by accident.
    fn of_one(self, surprise: f64) -> f64 {
        doubt(surprise, 1, self.stretches as f64)
    }

    /// The same of the sum over all joints.
    fn of_all(self, surprise: f64) -> f64 {
        doubt(surprise, self.joints, self.stretches as f64 / self.joints as f64)
    }
}

impl Noise {
    /// Standard deviation of a mean of a joint's residual over so many rows.
    pub fn sigma(&self, joint: usize, rows: usize) -> Option<f64> {
        self.joints.get(joint)?.as_ref().map(|own| own.spread.of_mean(rows))
    }

    /// Mean of what pushes a joint over places of a motion, N.m or N, and its standard deviation, beside all that the model
    /// makes of it; `None` where too few rows tell.
    pub fn pushed(&self, joint: usize, motion: usize, places: [usize; 2]) -> Option<[f64; 2]> {
        self.joints.get(joint)?.as_ref()?.waves.mean(motion, places[0]..places[1] + 1)
    }

    /// Probability that the means of joints, `(joint, standard deviations from zero)`, come as far in one of all windows of
    /// the recording by accident.
    pub fn doubt(&self, means: impl Iterator<Item = (usize, f64)>) -> f64 {
        let surprise = |(joint, deviations): (usize, f64)| {
            Some(self.joints.get(joint)?.as_ref()?.law.surprise(deviations * deviations))
        };
        let surprise = means.filter_map(surprise).sum();
        if surprise > 0.0 { self.chances.of_all(surprise) } else { 1.0 }
    }
}

/// Windows in which joints are pushed, most certain first, none next to another; and what the residuals do by themselves.
///
/// `step` is the time from one place to the next, s. With a baseline of at least as many stretches as the recording,
/// the law comes from the baseline.
pub(in crate::diagnosis) fn scan(tracks: &[Track], step: f64, level: f64) -> (Vec<Pushed>, Noise) {
    let mut scan = Scan::of(tracks, step);
    // A push bends the fit of the model, and what it leaves elsewhere: the next largest is looked for beside it.
    while let Some(candidate) = scan.surest() {
        scan.candidates.push(candidate);
        scan.look();
    }
    // Beside what may be pushes, what all other windows do is what the residual does by itself. What is no push by that is one
    // of them.
    while scan.drop_accidents(level) {
        scan.look();
    }
    let mut found = scan.pushes();
    let noise = scan.noise(tracks);
    found.sort_by(|a, b| a.doubt.total_cmp(&b.doubt).then(b.square.total_cmp(&a.square)));
    (found, noise)
}

/// The joints of a recording with what may be pushes.
struct Scan<'a> {
    lengths: Vec<usize>,
    /// From one place to the next, s.
    step: f64,
    joints: Vec<Joint<'a>>,
    chances: Chances,
    candidates: Vec<Candidate>,
}

/// One joint that is scanned.
struct Joint<'a> {
    track: &'a Track,
    /// Its rows, whitened with all candidates among them.
    rows: White,
    /// The same beside the candidates.
    waves: HalfWaves,
    /// What its largest windows do by themselves; `None` where there are too few of all joints.
    law: Option<Law>,
}

/// What may be a push.
#[derive(Clone)]
struct Candidate {
    pushed: Pushed,
    /// Number of the length of the grid that is next to its own.
    length: usize,
}

impl Candidate {
    fn places(&self) -> Range<usize> {
        self.pushed.places[0]..self.pushed.places[1] + 1
    }
}

impl Pushed {
    /// Whether places of a motion are next to it.
    fn is_near(&self, motion: usize, [from, to]: [usize; 2], gap: usize) -> bool {
        self.motion == motion && from <= self.places[1] + gap && self.places[0] <= to + gap
    }
}

impl<'a> Scan<'a> {
    /// Without any candidate.
    fn of(tracks: &'a [Track], step: f64) -> Self {
        let lengths = lengths(step);
        let enough = |t: &&Track| t.motions.iter().map(|m| m.1.len()).sum::<usize>() >= SCAN_LEAST_ROWS;
        let mut joints = Vec::new();
        for track in tracks.iter().filter(enough) {
            if let Some(white) = White::of(&track.motions, &track.beside, &[]) {
                joints.push(Joint {
                    track,
                    waves: HalfWaves::of(white.clone(), &[], step),
                    rows: white,
                    law: None,
                });
            }
        }
        let chances = Chances { joints: joints.len(), stretches: 1 };
        let mut scan = Self { lengths, step, joints, chances, candidates: Vec::new() };
        scan.look();
        let stretches = |joint: &Joint<'_>| joint.waves.largest(true, |_| true).len();
        scan.chances.stretches = scan.joints.iter().map(stretches).sum::<usize>().max(1);
        scan
    }

    /// Looks at all windows beside the model and the candidates: their half waves, and the laws of those away from candidates.
    fn look(&mut self) {
        let whites = self.whites(&self.candidates, &self.candidates);
        for (joint, white) in self.joints.iter_mut().zip(whites) {
            joint.waves = HalfWaves::of(white, &self.lengths, self.step);
        }
        self.fit_laws(Law::of);
    }

    /// The residuals beside the model and half waves of each joint for these candidates, where `pushes` are not what a residual
    /// remembers.
    fn whites(&self, pushes: &[Candidate], candidates: &[Candidate]) -> Vec<White> {
        let half_wave =
            |joint: &Joint<'_>, c: &Candidate| joint.rows.of_half_wave(c.pushed.motion, c.places());
        let white = |joint: &Joint<'_>| {
            let pushes: Vec<Vec<f64>> = pushes.iter().map(|c| half_wave(joint, c)).collect();
            let Track { motions, beside, .. } = joint.track;
            White::of(motions, beside, &pushes).unwrap_or_else(|| joint.rows.clone())
        };
        let mut whites: Vec<White> = self.joints.iter().map(white).collect();
        let columns = |j: usize| {
            let mut columns = self.joints[j].track.columns.clone();
            for candidate in candidates {
                let own = |k| if k == j { half_wave(&self.joints[j], candidate) } else { Vec::new() };
                columns.extend((0..self.joints.len()).map(own));
            }
            columns
        };
        let columns: Vec<Vec<Vec<f64>>> = (0..self.joints.len()).map(columns).collect();
        put_beside(&mut whites, &columns);
        whites
    }

    /// The law of the largest windows of each joint, from those away from candidates: its own, and that of all joints. Returns
    /// these windows of each joint.
    fn fit_laws(&mut self, of: fn(&mut [f64]) -> Option<Law>) -> Vec<Vec<f64>> {
        // What laws that are nearly right leave is in the recording, and not in its baseline.
        let own = self.largest(true);
        let mut of_joints =
            if own.concat().len() >= SCAN_LEAST_STRETCHES { own } else { self.largest(false) };
        let common = of(&mut of_joints.concat());
        for (joint, own) in self.joints.iter_mut().zip(&mut of_joints) {
            let count = own.len() as f64;
            let law = |common| of(own).map_or(common, |own| own.mean(count, common, SCAN_OWN_STRETCHES));
            joint.law = common.map(law);
        }
        of_joints
    }

    /// The largest squared deviation of each stretch of the recording, or of its baseline, away from candidates, joint by joint.
    fn largest(&self, target: bool) -> Vec<Vec<f64>> {
        let is_free = |(motion, places)| !self.is_near(motion, places, self.gap());
        self.joints.iter().map(|joint| joint.waves.largest(target, is_free)).collect()
    }

    /// Places between pushes that are two.
    fn gap(&self) -> usize {
        (SCAN_TOGETHER / self.step) as usize
    }

    /// Whether places of a motion are next to a candidate.
    fn is_near(&self, motion: usize, places: [usize; 2], gap: usize) -> bool {
        self.candidates.iter().any(|c| c.pushed.is_near(motion, places, gap))
    }

    /// Of the windows in which one joint does what it does by accident in one of [`SCAN_SUSPECT`] recordings the surest; as long
    /// as all of them are an exception.
    fn surest(&self) -> Option<Candidate> {
        let mut beyond: Vec<(f64, &Joint<'_>, usize, Window)> = Vec::new();
        for joint in &self.joints {
            let Some(law) = joint.law else { continue };
            let surprise = |(motion, w): (usize, Window)| (law.surprise(w.square), joint, motion, w);
            let windows = joint.waves.of_targets().map(surprise);
            beyond.extend(windows.filter(|(surprise, ..)| self.chances.of_one(*surprise) <= SCAN_SUSPECT));
        }
        beyond.retain(|(_, joint, motion, w)| !self.is_near(*motion, joint.waves.places(*w), self.gap()));
        beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
        let pushed: usize = self.candidates.iter().map(|c| c.pushed.places[1] + 1 - c.pushed.places[0]).sum();
        let is_exception =
            |joint: &Joint<'_>| pushed as f64 <= LARGEST_PUSHED_FRACTION * joint.waves.targets() as f64;
        beyond.into_iter().filter(|(_, joint, ..)| is_exception(joint)).find_map(
            |(_, joint, motion, window)| {
                let Refined { square, from, to, edges } = joint.waves.refined(motion, window)?;
                let (joint, places) = (joint.track.joint, [from, to - 1]);
                let pushed = Pushed { joint, motion, places, edges, square, doubt: 1.0 };
                Some(Candidate { pushed, length: window.length })
            },
        )
    }

    /// Judges the candidates by what all other windows do, and drops those that do not pass a level; whether there were any. Where
    /// windows that are no push stand out, as at every knock of a gear with play, the law has a longer tail.
    fn drop_accidents(&mut self, level: f64) -> bool {
        let others = self.fit_laws(Law::of_unpushed);
        for (joint, mut others) in self.joints.iter_mut().zip(others) {
            joint.law = joint.law.map(|law| law.with_tail(&mut others));
        }
        let before = self.candidates.len();
        for k in 0..before {
            let mut others = self.candidates.clone();
            let candidate = others.remove(k);
            self.candidates[k].pushed.doubt = self.chances.of_all(self.surprise(&candidate, &others));
        }
        self.candidates.retain(|c| c.pushed.doubt <= level);
        self.candidates.len() < before
    }

    /// The candidates, where those of a joint take so little of the motion that they are an exception.
    fn pushes(&self) -> Vec<Pushed> {
        let of_joint = |joint: &Joint<'_>| {
            let own = self.candidates.iter().map(|c| &c.pushed).filter(|p| p.joint == joint.track.joint);
            let pushed: usize = own.clone().map(|p| p.places[1] + 1 - p.places[0]).sum();
            let few = pushed as f64 <= LARGEST_PUSHED_FRACTION * joint.waves.targets() as f64;
            if few { own.cloned().collect() } else { Vec::new() }
        };
        self.joints.iter().flat_map(of_joint).collect()
    }

    /// How far what all joints feel of a candidate, beside the model and the others, passes what they do by themselves.
    fn surprise(&self, candidate: &Candidate, others: &[Candidate]) -> f64 {
        let mut scratch = Scratch::default();
        let whites = self.whites(&self.candidates, others);
        let of_joint = |(joint, white): (&Joint<'_>, White)| {
            let wave = white.half_wave(candidate.pushed.motion, candidate.places(), &mut scratch)?;
            // In units of what such windows spread by without it.
            let deviation = wave[0] / wave[1] * white.sigma / joint.waves.spread(candidate.length);
            Some(joint.law?.surprise(deviation * deviation))
        };
        self.joints.iter().zip(whites).filter_map(of_joint).sum()
    }

    /// What the residuals do by themselves away from candidates, with half waves beside the model alone.
    fn noise(mut self, tracks: &[Track]) -> Noise {
        let spreads: Vec<Option<Spread>> = self.joints.iter().map(|joint| self.spread(joint.track)).collect();
        let whites = self.whites(&self.candidates, &[]);
        let mut joints: Vec<Option<Own>> = tracks.iter().map(|_| None).collect();
        for ((joint, white), spread) in self.joints.drain(..).zip(whites).zip(spreads) {
            let waves = HalfWaves::of(white, &self.lengths, self.step);
            let law = joint.law.unwrap_or(Law::NORMAL);
            if let Some(place) = joints.get_mut(joint.track.joint) {
                *place = spread.map(|spread| Own { spread, waves, law });
            }
        }
        Noise { joints, chances: self.chances }
    }

    /// How far means of the residual of a joint wander away from candidates; `None` where it has too few rows there.
    fn spread(&self, track: &Track) -> Option<Spread> {
        let away = |motion: usize| -> Vec<(usize, f64)> {
            let is_free = |place: usize| !self.is_near(motion, [place; 2], 0);
            track.motions[motion].1.iter().copied().filter(|(place, _)| is_free(*place)).collect()
        };
        let rows: Vec<Vec<(usize, f64)>> = (0..track.motions.len()).map(away).collect();
        let rows: Vec<&[(usize, f64)]> = rows.iter().map(Vec::as_slice).collect();
        Spread::of(&rows, &self.lengths)
    }
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
