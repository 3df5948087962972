//! Whether what a law explains could as well be a law at another place, a simpler one, or noise.

use crate::diagnosis::candidates::position_noise::position_noise;
use crate::diagnosis::candidates::ringing::ringing;
use crate::diagnosis::judging::calibration::{Beside, Calibrated, beside, rival_p_value};
use crate::diagnosis::rules::{COMPARABLE, LEAST_KEPT, MOST_COMPARED, NOISE_MISSED, TOLD_APART};
use crate::diagnosis::search::gate::{Gate, RoundEvidence};
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::state::Search;
use crate::effects::{Form, ToldBy};
use crate::parallel;

/// How a candidate stands against rivals at other places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::diagnosis) enum Standing {
    /// It explains more than each of them, and not by accident.
    Ahead,
    /// It cannot be told from this one of the round.
    Tied(usize),
    /// One of them explains more.
    Beaten,
}

/// What a number must gain where the best of so many candidates is taken (Foster and George 1994).
pub(super) fn penalty(candidates: usize) -> f64 {
    2.0 * (candidates.max(2) as f64).ln()
}

impl Search<'_> {
    /// How a candidate of a round stands against rivals at other places, which reach it through the parameters that
    /// joints share: by what they explain of all joints in a residual made white. A law that is certain beside another, and
    /// much the same as without it, has no rival in it: they explain different things.
    pub(in crate::diagnosis) fn standing(
        &self,
        round: &RoundEvidence,
        ranked: &[Ranked],
        candidate: usize,
        least_confidence: f64,
    ) -> Standing {
        let law = self.of(&ranked[candidate]).1;
        let Some(own) = self.gate(round, ranked, candidate) else { return Standing::Beaten };
        let (gain, window) = (ranked[candidate].verdict.gain, ranked[candidate].window);
        let mut rivals: Vec<usize> = (0..ranked.len())
            .filter(|&k| ranked[k].window == window && ranked[k].verdict.gain > COMPARABLE * gain)
            .filter(|&k| !self.of(&ranked[k]).1.acts_where(law))
            // What would itself not be named beside a simpler law is no rival of others.
            .filter(|&k| self.is_told_from_simpler(round, ranked, k, least_confidence))
            .collect();
        rivals.sort_by(|&a, &b| ranked[b].verdict.gain.total_cmp(&ranked[a].verdict.gain));
        rivals.truncate(MOST_COMPARED);
        let penalty = penalty(self.tries());
        let worth = |c: &Calibrated| c.squares - penalty * c.numbers as f64;
        let standings = parallel::map(self.threads(), rivals.len(), |r| {
            let Some(other) = self.gate(round, ranked, rivals[r]) else { return Standing::Ahead };
            let ahead = worth(&own.calibrated) - worth(&other.calibrated);
            if rival_p_value(&own.calibrated, &other.calibrated, ahead) <= TOLD_APART
                || self.stands_beside(
                    round,
                    &ranked[candidate],
                    own,
                    &self.columns(&ranked[rivals[r]]),
                    least_confidence,
                )
            {
                Standing::Ahead
            } else if ahead < -penalty {
                Standing::Beaten
            } else {
                Standing::Tied(rivals[r])
            }
        });
        if standings.contains(&Standing::Beaten) {
            return Standing::Beaten;
        }
        standings.into_iter().rfind(|s| *s != Standing::Ahead).unwrap_or(Standing::Ahead)
    }

    /// Whether what a candidate has beyond each of the simpler laws that it must be told from is certain, on all of its
    /// joints at once: at equal evidence the simpler law is named.
    pub(in crate::diagnosis) fn is_told_from_simpler(
        &self,
        round: &RoundEvidence,
        ranked: &[Ranked],
        candidate: usize,
        least_confidence: f64,
    ) -> bool {
        let law = self.of(&ranked[candidate]).1;
        if law.effect.properties().special_case.is_none_or(|case| case.told_by != ToldBy::Certainty) {
            return true;
        }
        let Some(own) = self.gate(round, ranked, candidate) else { return false };
        *round.told[candidate].get_or_init(|| {
            law.effect.special_cases().all(|simpler| {
                let is_simpler = |r: &&Ranked| {
                    let other = self.of(r).1;
                    let within = other.own.iter().all(|j| law.own.contains(j));
                    r.window == ranked[candidate].window && other.effect == simpler && within
                };
                let columns: Vec<Vec<f64>> =
                    ranked.iter().filter(is_simpler).flat_map(|r| self.columns(r)).collect();
                columns.is_empty()
                    || self.certain_beside(round, &ranked[candidate], own, &columns, least_confidence)
            })
        })
    }

    /// Whether a compliant transmission is more than noise of the positions and than ringing that motions happen to begin
    /// with: it must explain what neither can, and not merely what the noise's columns miss of it.
    pub(in crate::diagnosis) fn is_told_from_noise(
        &self,
        round: &RoundEvidence,
        ranked: &[Ranked],
        candidate: usize,
        least_confidence: f64,
    ) -> bool {
        let (regression, law) = self.of(&ranked[candidate]);
        let (Form::Compliance(_), Some(joint)) = (law.effect.form(), law.place.joint()) else { return true };
        let Some(own) = self.gate(round, ranked, candidate) else { return false };
        let (context, design) = (&self.model.context, &regression.design);
        let noise = round.noise.get_or_init(|| position_noise(context, design));
        let left = self.left_beside(round, &ranked[candidate], own, noise);
        if left.is_none_or(|left| left.evidence.squares < NOISE_MISSED * own.calibrated.squares) {
            return false;
        }
        let shape = &law.trials[ranked[candidate].verdict.trial].shape;
        let both = [&noise[..], &ringing(context, design, joint, shape)].concat();
        self.certain_beside(round, &ranked[candidate], own, &both, least_confidence)
    }

    /// Whether a candidate is certain beside a rival, given as columns over all rows, too.
    fn certain_beside(
        &self,
        round: &RoundEvidence,
        candidate: &Ranked,
        own: &Gate,
        rival: &[Vec<f64>],
        least_confidence: f64,
    ) -> bool {
        let left = self.left_beside(round, candidate, own, rival);
        left.is_some_and(|left| self.is_certain(&left, least_confidence))
    }

    /// Whether it also is much the same law there. Two laws that share what they explain may leave a difference that is as
    /// certain, and is neither of them: a factor on the torque of one joint turns round beside that of another.
    fn stands_beside(
        &self,
        round: &RoundEvidence,
        candidate: &Ranked,
        own: &Gate,
        rival: &[Vec<f64>],
        least_confidence: f64,
    ) -> bool {
        let left = self.left_beside(round, candidate, own, rival);
        left.is_some_and(|left| left.kept >= LEAST_KEPT && self.is_certain(&left, least_confidence))
    }

    fn is_certain(&self, left: &Beside, least_confidence: f64) -> bool {
        left.evidence.evidence().confidence(self.tries()) >= least_confidence
    }

    /// The evidence for a candidate beside a rival, given as columns over all rows.
    fn left_beside(
        &self,
        round: &RoundEvidence,
        candidate: &Ranked,
        own: &Gate,
        rival: &[Vec<f64>],
    ) -> Option<Beside> {
        let (bench, design) = (self.model.bench(candidate.window), &self.of(candidate).0.design);
        let background = round.of(candidate.window).get()?;
        let columns = self.columns(candidate);
        let law = self.law(candidate, &columns, &own.left);
        beside(&bench.units, &bench.regressors(design), background, &law, &own.calibrated, rival)
    }
}
