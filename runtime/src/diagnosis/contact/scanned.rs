//! The joints of a recording beside the model and what may be pushes: what their half waves do, and the laws of the largest.

use crate::diagnosis::contact::absorbed::{Amplitude, put_beside};
use crate::diagnosis::contact::common::Common;
use crate::diagnosis::contact::half_waves::{HalfWaves, lengths, stretches};
use crate::diagnosis::contact::largest::{Chances, Law};
use crate::diagnosis::contact::memory::Spread;
use crate::diagnosis::contact::noise::{Noise, Own};
use crate::diagnosis::contact::pushed::Candidate;
use crate::diagnosis::contact::track::Track;
use crate::diagnosis::contact::white::{Scratch, White};
use crate::diagnosis::rules::{
    LARGEST_PUSHED_FRACTION, SCAN_LEAST_ROWS, SCAN_LEAST_STRETCHES, SCAN_LEFT_BY_MODEL, SCAN_OWN_STRETCHES,
    SCAN_TOGETHER,
};

/// The joints of a recording with what may be pushes.
pub(super) struct Scanned<'a> {
    pub lengths: Vec<usize>,
    /// From one place to the next, s.
    pub step: f64,
    pub joints: Vec<Joint<'a>>,
    pub chances: Chances,
    /// Whether the recording has so few stretches that the laws are those of its baseline.
    as_before: bool,
    pub candidates: Vec<Candidate>,
}

/// One joint that is scanned.
pub(super) struct Joint<'a> {
    pub track: &'a Track,
    /// Its rows, whitened with all candidates among them.
    rows: White,
    /// The same beside the model and the candidates.
    pub waves: HalfWaves,
    /// What its largest windows do by themselves; `None` where there are too few of all joints.
    pub law: Option<Law>,
}

impl Joint<'_> {
    /// Places that may be pushed, as long as pushes are an exception.
    pub fn most_pushed(&self) -> f64 {
        LARGEST_PUSHED_FRACTION * self.waves.targets() as f64
    }
}

impl<'a> Scanned<'a> {
    /// Without any candidate.
    pub fn of(tracks: &'a [Track], step: f64) -> Self {
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
    pub fn look(&mut self) {
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
                let deviations = amplitude.deviations / joint.waves.widths.of(places.len());
                Some(joint.waves.white().as_normal(deviations, places.len()))
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
    pub fn fit_laws(&mut self, of: fn(&mut [f64]) -> Option<Law>) -> Vec<Vec<f64>> {
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

    /// How what joints do away from candidates goes together.
    pub fn common(&self) -> Common {
        let waves: Vec<&HalfWaves> = self.joints.iter().map(|joint| &joint.waves).collect();
        Common::of(&waves, &self.lengths, |(motion, places)| !self.is_near(motion, places))
    }

    /// Whether places of a motion are next to a candidate.
    pub fn is_near(&self, motion: usize, places: [usize; 2]) -> bool {
        self.candidates.iter().any(|c| c.pushed.is_near(motion, places, self.gap()))
    }

    /// Places between pushes that are two.
    fn gap(&self) -> usize {
        (SCAN_TOGETHER / self.step) as usize
    }

    /// What the residuals do by themselves away from candidates, with half waves beside the model alone: the size of their noise
    /// is what is left beside the candidates, too, as a fit spreads a push over all rows.
    pub fn noise(self, tracks: &[Track]) -> Noise {
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
