//! Contact with a robot that moves: stretches of 0.15 to 2.4 s in which the residual of joints leans to one side.
//!
//! Half waves of many lengths are fitted to the white residual of every joint (`half_waves`), and how far the largest of their
//! amplitudes, in standard deviations, goes in a few seconds is read off the recording's own stretches, as an extreme value law
//! (Gumbel) of their squares (`largest`). A push is felt by all joints at the same time: what each of them feels in one
//! window beyond what their noise has in common (`common`) adds up. What may be a push on any joint tells nothing of these laws.

use crate::diagnosis::contact::absorbed::{Amplitude, put_beside};
use crate::diagnosis::contact::common::Common;
use crate::diagnosis::contact::half_waves::{HalfWaves, Refined, lengths, stretches};
use crate::diagnosis::contact::largest::{Chances, Law};
use crate::diagnosis::contact::memory::Spread;
use crate::diagnosis::contact::noise::{Noise, Own};
use crate::diagnosis::contact::suspects::{Suspect, suspects};
use crate::diagnosis::contact::track::Track;
use crate::diagnosis::contact::white::{Scratch, White};
use crate::diagnosis::rules::{
    LARGEST_PUSHED_FRACTION, SCAN_LEAST_ROWS, SCAN_LEAST_STRETCHES, SCAN_LEFT_BY_MODEL, SCAN_OWN_STRETCHES,
    SCAN_TOGETHER,
};
use std::cell::OnceCell;
use std::ops::Range;

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

/// Windows in which joints are pushed, most certain first, none next to another; and what the residuals do by themselves.
///
/// `step` is the time from one place to the next, s; `level` the probability of an accident in a whole recording, up to which
/// a window is a push; `known` were pushes in another look at these rows, and are judged again; those that are `certain` are
/// not, nor are they among those that are found.
pub(in crate::diagnosis) fn scan(
    tracks: &[Track],
    (known, certain): (&[Pushed], &[Pushed]),
    step: f64,
    level: f64,
) -> (Vec<Pushed>, Noise) {
    let mut scan = Scan::of(tracks, step);
    scan.look_again_at(known, certain);
    // A push bends the fit of the model, and what it leaves elsewhere: others are looked for beside it.
    while scan.add_suspect() {
        scan.look();
    }
    // Beside what may be pushes, what all other windows do is what the residual does by itself. What is no push by that is one
    // of them.
    while scan.drop_accidents(level) {
        scan.look();
    }
    let mut found = scan.pushes();
    found.sort_by(|a, b| a.doubt.total_cmp(&b.doubt).then(b.square.total_cmp(&a.square)));
    (found, scan.noise(tracks))
}

/// The joints of a recording with what may be pushes.
struct Scan<'a> {
    lengths: Vec<usize>,
    /// From one place to the next, s.
    step: f64,
    joints: Vec<Joint<'a>>,
    chances: Chances,
    /// Whether the recording has so few stretches that the laws are those of its baseline.
    as_before: bool,
    candidates: Vec<Candidate>,
}

/// One joint that is scanned.
struct Joint<'a> {
    track: &'a Track,
    /// Its rows, whitened with all candidates among them.
    rows: White,
    /// The same beside the model and the candidates.
    waves: HalfWaves,
    /// What its largest windows do by themselves; `None` where there are too few of all joints.
    law: Option<Law>,
}

/// What may be a push.
#[derive(Clone)]
struct Candidate {
    pushed: Pushed,
    /// Whether something else tells that it is one.
    is_certain: bool,
    /// What each joint that is scanned feels, in standard deviations, beside the model and the other candidates.
    felt: Vec<Option<f64>>,
}

impl Candidate {
    /// Before any look at what joints feel of it.
    fn unfelt(pushed: Pushed, is_certain: bool) -> Self {
        Self { pushed, is_certain, felt: Vec::new() }
    }

    fn places(&self) -> Range<usize> {
        self.pushed.places[0]..self.pushed.places[1] + 1
    }
}

impl Pushed {
    /// Whether both have a place in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.is_near(other.motion, other.places, 0)
    }

    /// Whether places of a motion are next to it.
    fn is_near(&self, motion: usize, [from, to]: [usize; 2], gap: usize) -> bool {
        self.motion == motion && from <= self.places[1] + gap && self.places[0] <= to + gap
    }
}

impl<'a> Scan<'a> {
    /// Without any candidate.
    fn of(tracks: &'a [Track], step: f64) -> Self {
        let mut joints = Vec::new();
        for track in tracks.iter().filter(|track| track.rows() >= SCAN_LEAST_ROWS) {
            if let Some(white) = White::of(track, &[]) {
                let waves = HalfWaves::of(white.clone(), &[], step, false);
                joints.push(Joint { track, rows: white, waves, law: None });
            }
        }
        let stretches = joints.iter().map(|joint| stretches(&joint.rows, step)).sum::<usize>();
        let chances = Chances { joints: joints.len(), stretches: stretches.max(1), known: stretches.max(1) };
        let as_before = stretches < SCAN_LEAST_STRETCHES;
        let mut scan =
            Self { lengths: lengths(step), step, joints, chances, as_before, candidates: Vec::new() };
        scan.look();
        scan
    }

    /// Looks at all windows beside the model and the candidates: their half waves, and what joints feel of the candidates.
    fn look(&mut self) {
        let (whites, amplitudes) = self.whites(&self.candidates);
        for (joint, white) in self.joints.iter_mut().zip(whites) {
            joint.waves = HalfWaves::of(white, &self.lengths, self.step, self.as_before);
        }
        let mut scratch = Scratch::default();
        for (candidate, amplitudes) in self.candidates.iter_mut().zip(amplitudes) {
            let (motion, places) = (candidate.pushed.motion, candidate.places());
            let felt = |(joint, amplitude): (&Joint<'_>, Option<Amplitude>)| {
                let amplitude = amplitude.filter(|amplitude| amplitude.left > SCAN_LEFT_BY_MODEL)?;
                // Where rows are missing, or curves over the joint's state are like it, nothing tells.
                joint.rows.half_wave(motion, places.clone(), &mut scratch)?;
                Some(amplitude.deviations / joint.waves.widths.of(places.len()))
            };
            candidate.felt = self.joints.iter().zip(amplitudes).map(felt).collect();
        }
    }

    /// The residuals beside the model and half waves of each joint for these candidates, where no candidate is what a residual
    /// remembers; and the amplitudes of these half waves, candidate by candidate.
    fn whites(&self, candidates: &[Candidate]) -> (Vec<White>, Vec<Vec<Option<Amplitude>>>) {
        let half_wave =
            |joint: &Joint<'_>, c: &Candidate| joint.rows.of_half_wave(c.pushed.motion, c.places());
        let white = |joint: &Joint<'_>| {
            if self.candidates.is_empty() {
                return joint.rows.clone();
            }
            let pushes: Vec<Vec<f64>> = self.candidates.iter().map(|c| half_wave(joint, c)).collect();
            White::of(joint.track, &pushes).unwrap_or_else(|| joint.rows.clone())
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
        let amplitudes = put_beside(&mut whites, &columns);
        let of_model = amplitudes.len() - candidates.len() * self.joints.len();
        let of_candidates = amplitudes[of_model..].chunks(self.joints.len().max(1));
        (whites, of_candidates.map(<[_]>::to_vec).collect())
    }

    /// The law of the largest windows of each joint, from those away from candidates: its own, and that of all joints. Returns
    /// these windows of each joint.
    fn fit_laws(&mut self, of: fn(&mut [f64]) -> Option<Law>) -> Vec<Vec<f64>> {
        // Of the recording where it has enough of them: what laws that are nearly right leave is not in a baseline.
        let is_free = |(motion, places)| !self.is_near(motion, places);
        let largest = |joint: &Joint<'_>| joint.waves.largest(!self.as_before, is_free);
        let mut of_joints: Vec<Vec<f64>> = self.joints.iter().map(largest).collect();
        let mut all = of_joints.concat();
        let common = of(&mut all);
        self.chances.known = all.len().max(1);
        for (joint, own) in self.joints.iter_mut().zip(&mut of_joints) {
            let count = own.len() as f64;
            let own = of(own).filter(|_| count >= SCAN_LEAST_STRETCHES as f64);
            let law = |common| own.map_or(common, |own: Law| own.mean(count, common, SCAN_OWN_STRETCHES));
            joint.law = common.map(law);
        }
        of_joints
    }

    /// Whether places of a motion are next to a candidate.
    fn is_near(&self, motion: usize, places: [usize; 2]) -> bool {
        self.candidates.iter().any(|c| c.pushed.is_near(motion, places, self.gap()))
    }

    /// Places between pushes that are two.
    fn gap(&self) -> usize {
        (SCAN_TOGETHER / self.step) as usize
    }

    /// Puts what was a push in another look, and what certainly is one, among the candidates.
    fn look_again_at(&mut self, known: &[Pushed], certain: &[Pushed]) {
        let pushes = certain.iter().map(|p| (p, true)).chain(known.iter().map(|p| (p, false)));
        let is_scanned = |(p, _): &(&Pushed, bool)| self.joints.iter().any(|j| j.track.joint == p.joint);
        let candidate = |(pushed, is_certain): (&Pushed, bool)| Candidate::unfelt(pushed.clone(), is_certain);
        self.candidates = pushes.filter(is_scanned).map(candidate).collect();
        if !self.candidates.is_empty() {
            self.look();
        }
    }

    /// What may be pushes besides, the surest first.
    fn suspects(&self) -> Vec<Suspect> {
        let joints: Vec<(Option<Law>, &HalfWaves)> =
            self.joints.iter().map(|joint| (joint.law, &joint.waves)).collect();
        let common = OnceCell::new();
        let together = |places: usize, felt: &[Option<f64>]| {
            self.doubt(common.get_or_init(|| self.common()), places, felt)
        };
        suspects(&joints, self.chances, together)
    }

    /// How what joints do away from candidates goes together.
    fn common(&self) -> Common {
        let waves: Vec<&HalfWaves> = self.joints.iter().map(|joint| &joint.waves).collect();
        Common::of(&waves, &self.lengths, |(motion, places)| !self.is_near(motion, places))
    }

    /// Probability that all joints together come as far by accident as they do in a window of so many places.
    fn doubt(&self, common: &Common, places: usize, felt: &[Option<f64>]) -> f64 {
        let of_joint = |(joint, felt): (&Joint<'_>, Option<f64>)| Some(joint.law?.surprise(felt?.powi(2)));
        let alone = common.alone(places, felt);
        self.chances.of_all(self.joints.iter().zip(alone).filter_map(of_joint).sum())
    }

    /// Adds the surest suspect that is next to no candidate, as long as all of them are an exception; whether there is one. Of one
    /// alone: what it bends elsewhere would be a candidate beside it, and a model can make the one of the other.
    fn add_suspect(&mut self) -> bool {
        self.fit_laws(Law::of);
        let pushed: usize = self.candidates.iter().map(|c| c.places().len()).sum();
        for Suspect { joint, motion, window, .. } in self.suspects() {
            let joint = &self.joints[joint];
            if pushed as f64 > LARGEST_PUSHED_FRACTION * joint.waves.targets() as f64
                || self.is_near(motion, joint.waves.places(window))
            {
                continue;
            }
            let Some(Refined { square, from, to, edges }) = joint.waves.refined(motion, window) else {
                continue;
            };
            let pushed = Pushed {
                joint: joint.track.joint,
                motion,
                places: [from, to - 1],
                edges,
                square,
                doubt: 1.0,
            };
            self.candidates.push(Candidate::unfelt(pushed, false));
            return true;
        }
        false
    }

    /// Judges the candidates by what all other windows do, and drops those that do not pass a level; whether there were any. Where
    /// windows that are no push stand out, as at every knock of a gear with play, the law has a longer tail.
    fn drop_accidents(&mut self, level: f64) -> bool {
        let others = self.fit_laws(Law::of_unpushed);
        for (joint, mut others) in self.joints.iter_mut().zip(others) {
            joint.law = joint.law.map(|law| law.with_tail(&mut others));
        }
        let common = self.common();
        let doubt = |c: &Candidate| self.doubt(&common, c.places().len(), &c.felt);
        let doubts: Vec<f64> = self.candidates.iter().map(doubt).collect();
        self.candidates.iter_mut().zip(doubts).for_each(|(c, doubt)| c.pushed.doubt = doubt);
        let before = self.candidates.len();
        self.candidates.retain(|c| c.is_certain || c.pushed.doubt <= level);
        self.candidates.len() < before
    }

    /// The candidates, where those of a joint take so little of the motion that they are an exception.
    fn pushes(&self) -> Vec<Pushed> {
        let of_joint = |joint: &Joint<'_>| {
            let own = self.candidates.iter().filter(|c| c.pushed.joint == joint.track.joint);
            let pushed: usize = own.clone().map(|c| c.places().len()).sum();
            let few = pushed as f64 <= LARGEST_PUSHED_FRACTION * joint.waves.targets() as f64;
            // There a law of the load is as good, of a motor that saturates or a gear that is pressed.
            let is_law = |c: &&Candidate| joint.track.is_borne_once(c.pushed.motion, c.places());
            let found = own.filter(|c| !c.is_certain && !is_law(c));
            if few { found.map(|c| c.pushed.clone()).collect() } else { Vec::new() }
        };
        self.joints.iter().flat_map(of_joint).collect()
    }

    /// What the residuals do by themselves away from candidates, with half waves beside the model alone: the size of their noise
    /// is what is left beside the candidates, too, as a fit spreads a push over all rows.
    fn noise(self, tracks: &[Track]) -> Noise {
        let mut joints: Vec<Option<Own>> = tracks.iter().map(|_| None).collect();
        let (whites, _) = self.whites(&[]);
        for (joint, white) in self.joints.iter().zip(whites) {
            let own = |spread| {
                let law = joint.law.unwrap_or(Law::NORMAL);
                let white = white.in_noise_of(joint.waves.white());
                Own { spread, white, widths: joint.waves.widths.clone(), law }
            };
            if let Some(place) = joints.get_mut(joint.track.joint) {
                *place = self.spread(joint.track).map(own);
            }
        }
        Noise { joints, chances: self.chances }
    }

    /// How far means of the residual of a joint wander away from candidates; `None` where it has too few rows there.
    fn spread(&self, track: &Track) -> Option<Spread> {
        let is_pushed = |motion: usize, place: usize| {
            self.candidates.iter().any(|c| c.pushed.is_near(motion, [place; 2], 0))
        };
        let away = |motion: usize| -> Vec<(usize, f64)> {
            track.motions[motion].1.iter().copied().filter(|(place, _)| !is_pushed(motion, *place)).collect()
        };
        let rows: Vec<Vec<(usize, f64)>> = (0..track.motions.len()).map(away).collect();
        let rows: Vec<&[(usize, f64)]> = rows.iter().map(Vec::as_slice).collect();
        Spread::of(&rows, &self.lengths)
    }
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
