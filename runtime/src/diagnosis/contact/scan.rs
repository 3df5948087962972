//! Contact with a robot that moves: stretches of 0.15 to 2.4 s in which the residual of joints leans to one side.
//!
//! Half waves of many lengths are fitted to the white residual of every joint (`half_waves`), and how far the largest of their
//! amplitudes, in standard deviations, goes in a few seconds is read off the recording's own stretches, as an extreme value law
//! (Gumbel) of their squares (`largest`). A push is felt by all joints at the same time: what each of them feels in one
//! window beyond what their noise has in common (`common`) adds up. What may be a push on any joint tells nothing of these laws.

use crate::diagnosis::contact::common::Common;
use crate::diagnosis::contact::half_waves::HalfWaves;
use crate::diagnosis::contact::hidden::likeliest;
use crate::diagnosis::contact::largest::Law;
use crate::diagnosis::contact::noise::Noise;
use crate::diagnosis::contact::pushed::{Candidate, Pushed};
use crate::diagnosis::contact::scanned::{Joint, Scanned};
use crate::diagnosis::contact::suspects::{Suspect, suspects};
use crate::diagnosis::contact::track::Track;
use std::cell::OnceCell;

/// What a look at the residuals of all joints finds.
pub(in crate::diagnosis) struct Scan {
    /// Windows in which joints are pushed, most certain first, none next to another.
    pub pushes: Vec<Pushed>,
    /// Pushes that something else tells, as far as what the residuals do by themselves.
    pub accidents: Vec<Pushed>,
    /// What the residuals do by themselves.
    pub noise: Noise,
}

/// Looks for windows in which joints are pushed.
///
/// `step` is the time from one place to the next, s; `level` the probability of an accident in a whole recording, up to which
/// a window is a push; `known` were pushes in another look at these rows, and are judged again; those that are `certain` are
/// not among those that are found.
pub(in crate::diagnosis) fn scan(
    tracks: &[Track],
    (known, certain): (&[Pushed], &[Pushed]),
    step: f64,
    level: f64,
) -> Scan {
    let mut scan = Scanned::of(tracks, step);
    scan.look_again_at(known, certain);
    scan.find(level);
    let mut pushes = scan.pushes();
    pushes.sort_by(|a, b| a.doubt.total_cmp(&b.doubt).then(b.square.total_cmp(&a.square)));
    let is_accident = |c: &&Candidate| c.is_certain && c.pushed.doubt > level;
    let accidents = scan.candidates.iter().filter(is_accident).map(|c| c.pushed.clone()).collect();
    Scan { pushes, accidents, noise: scan.noise(tracks) }
}

impl Scanned<'_> {
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

    /// Finds the candidates that pass a level of doubt.
    fn find(&mut self, level: f64) {
        // A push bends the fit of the model, and what it leaves elsewhere: others are looked for beside it.
        while self.add_suspect() {
            self.look();
        }
        self.drop_all_accidents(level);
        while self.uncover(level) {}
        self.drop_all_accidents(level);
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

    /// Adds the surest suspect that is next to no candidate, as long as all of them are an exception; whether there is one. Of one
    /// alone: what it bends elsewhere would be a candidate beside it, and a model can make the one of the other.
    fn add_suspect(&mut self) -> bool {
        self.fit_laws(Law::of);
        for Suspect { joint, motion, window, .. } in self.suspects() {
            let joint = &self.joints[joint];
            if !self.has_room(joint) || self.is_near(motion, joint.waves.places(window)) {
                continue;
            }
            let Some(window) = joint.waves.refined(motion, window) else { continue };
            let pushed = window.as_push(joint.track.joint, motion);
            self.candidates.push(Candidate::unfelt(pushed, false));
            return true;
        }
        false
    }

    /// Tries the window with which the residual of a joint is likeliest; whether it is a push beside all others. Else nothing is as
    /// it was with it.
    fn uncover(&mut self, level: f64) -> bool {
        let is_free = |(motion, places)| !self.is_near(motion, places);
        let joints = self.joints.iter().filter(|joint| self.has_room(joint));
        let windows = joints.filter_map(|joint| {
            let (motion, window) = likeliest(joint.waves.white(), &self.lengths, self.step, is_free)?;
            Some(window.as_push(joint.track.joint, motion))
        });
        let Some(pushed) = windows.max_by(|a, b| a.square.total_cmp(&b.square)) else { return false };
        self.candidates.push(Candidate::unfelt(pushed, false));
        self.look();
        self.judge();
        let is_push = self.candidates.last().is_some_and(|c| c.pushed.doubt <= level);
        if !is_push {
            self.candidates.pop();
            self.look();
        }
        is_push
    }

    /// Whether the candidates take so little of what a joint moves that more of them would still be an exception.
    fn has_room(&self, joint: &Joint<'_>) -> bool {
        let pushed: usize = self.candidates.iter().map(|c| c.places().len()).sum();
        pushed as f64 <= joint.most_pushed()
    }

    /// Drops candidates that are no push by what all other windows do, which those are then among.
    fn drop_all_accidents(&mut self, level: f64) {
        while self.drop_accidents(level) {
            self.look();
        }
    }

    /// Judges the candidates, and drops those that do not pass a level; whether there were any.
    fn drop_accidents(&mut self, level: f64) -> bool {
        self.judge();
        let before = self.candidates.len();
        self.candidates.retain(|c| c.is_certain || c.pushed.doubt <= level);
        self.candidates.len() < before
    }

    /// Judges the candidates by what all other windows do: beside what may be pushes, that is what the residual does by itself.
    /// Where windows that are no push stand out, as at every knock of a gear with play, the law has a longer tail.
    fn judge(&mut self) {
        let others = self.fit_laws(Law::of_unpushed);
        for (joint, mut others) in self.joints.iter_mut().zip(others) {
            joint.law = joint.law.map(|law| law.with_tail(&mut others));
        }
        let common = self.common();
        let doubt = |c: &Candidate| self.doubt(&common, c.places().len(), &c.felt);
        let doubts: Vec<f64> = self.candidates.iter().map(doubt).collect();
        self.candidates.iter_mut().zip(doubts).for_each(|(c, doubt)| c.pushed.doubt = doubt);
    }

    /// The candidates, where those of a joint take so little of the motion that they are an exception.
    fn pushes(&self) -> Vec<Pushed> {
        let of_joint = |joint: &Joint<'_>| {
            let own = self.candidates.iter().filter(|c| c.pushed.joint == joint.track.joint);
            let pushed: usize = own.clone().map(|c| c.places().len()).sum();
            let few = pushed as f64 <= joint.most_pushed();
            // There a law of the load is as good, of a motor that saturates or a gear that is pressed.
            let is_law = |c: &&Candidate| joint.track.is_borne_once(c.pushed.motion, c.places());
            let found = own.filter(|c| !c.is_certain && !is_law(c));
            if few { found.map(|c| c.pushed.clone()).collect() } else { Vec::new() }
        };
        self.joints.iter().flat_map(of_joint).collect()
    }

    /// Probability that all joints together come as far by accident as they do in a window of so many places.
    fn doubt(&self, common: &Common, places: usize, felt: &[Option<f64>]) -> f64 {
        let of_joint = |(joint, felt): (&Joint<'_>, Option<f64>)| Some(joint.law?.surprise(felt?.powi(2)));
        let alone = common.alone(places, felt);
        self.chances.of_all(self.joints.iter().zip(alone).filter_map(of_joint).sum())
    }
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
