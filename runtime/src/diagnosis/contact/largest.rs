//! How far the largest squares of many windows go by accident: an extreme value law, fitted to stretches of a residual.

use crate::diagnosis::rules::{SCAN_FEWEST_STRETCHES, SCAN_INDEPENDENT, SCAN_LONGER_TAIL, SCAN_NORMAL_SCALE};
use statrs::distribution::{ContinuousCDF, Erlang};

/// Mean of Gumbel's law, in its scale from its location.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// Variance of the scale by probability-weighted moments, of one stretch, over its square (Hosking, Wallis and Wood 1985).
const VARIANCE_OF_SCALE: f64 = 0.8046;

/// How far the largest squared mean of a stretch goes: Gumbel's law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Law {
    location: f64,
    scale: f64,
}

impl Law {
    /// Of normal deviates in a stretch with some thirty independent windows.
    pub const NORMAL: Self = Self { location: 8.0, scale: SCAN_NORMAL_SCALE };

    /// From the quartiles, which a few pushed stretches hardly move.
    pub fn of(largest: &mut [f64]) -> Option<Self> {
        if largest.len() < SCAN_FEWEST_STRETCHES {
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

    /// From all of them, by probability-weighted moments (Hosking 1990): twice as sure as quartiles, where none is pushed.
    pub fn of_unpushed(largest: &mut [f64]) -> Option<Self> {
        if largest.len() < SCAN_FEWEST_STRETCHES {
            return None;
        }
        largest.sort_by(f64::total_cmp);
        let count = largest.len() as f64;
        let mean = largest.iter().sum::<f64>() / count;
        let weighted = largest.iter().enumerate().map(|(i, x)| i as f64 * x).sum::<f64>();
        let second = 2.0 * weighted / (count * (count - 1.0)) - mean;
        let scale = (second / std::f64::consts::LN_2).max(SCAN_NORMAL_SCALE);
        Some(Self { location: mean - EULER_GAMMA * scale, scale })
    }

    /// With a longer tail where the larger ones of these surely pass their upper quartile by more than the law has it:
    /// excesses of an exponential tail have its scale as their mean.
    pub fn with_tail(self, largest: &mut [f64]) -> Self {
        largest.sort_by(f64::total_cmp);
        let first = largest.len() * 3 / 4;
        let Some(quartile) = first.checked_sub(1).map(|k| largest[k]) else { return self };
        let count = (largest.len() - first) as f64;
        let excess = largest[first..].iter().map(|x| x - quartile).sum::<f64>() / count;
        // The sum of so many follows Erlang's law.
        let surely = Erlang::new(largest.len() as u64 - first as u64, 1.0)
            .is_ok_and(|law| law.sf(count * excess / self.scale) < SCAN_LONGER_TAIL);
        Self { scale: if surely { excess } else { self.scale }, ..self }
    }

    /// Of two laws that count as so many stretches.
    pub fn mean(self, own: f64, other: Self, others: f64) -> Self {
        let mean = |a: f64, b: f64| (own * a + others * b) / (own + others);
        Self { location: mean(self.location, other.location), scale: mean(self.scale, other.scale) }
    }

    /// How far a square passes what the largest of a stretch mostly is, in scales of the tail: of a stretch of noise it is
    /// x with a density of exp(-x). Zero for all but one window of a stretch.
    pub fn surprise(self, square: f64) -> f64 {
        ((square - self.location) / self.scale).max(0.0)
    }
}

/// How many windows a recording has, and how well their law is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chances {
    pub joints: usize,
    /// Of all joints.
    pub stretches: usize,
    /// Stretches that the laws are from.
    pub known: usize,
}

impl Chances {
    /// Probability that the surprise of a joint comes this far by accident.
    pub fn of_one(self, surprise: f64) -> f64 {
        doubt(self.beyond_doubt(surprise), 1, self.stretches as f64)
    }

    /// The same of the sum over all joints.
    pub fn of_all(self, surprise: f64) -> f64 {
        doubt(self.beyond_doubt(surprise), self.joints, self.stretches as f64 / self.joints.max(1) as f64)
    }

    /// A surprise in scales that are known for sure. The scale of a law is estimated as well as from the mean of so many
    /// exponential numbers: one more of them, over that mean, passes x as often as (1 + x / n)^-n.
    fn beyond_doubt(self, surprise: f64) -> f64 {
        let numbers = self.known as f64 / VARIANCE_OF_SCALE;
        numbers * (surprise / numbers).ln_1p()
    }
}

/// Probability that the surprises of one window, summed over all joints, come this far by accident in a recording with
/// `stretches` of each joint.
///
/// In one of [`SCAN_INDEPENDENT`] windows a joint has a surprise at all, with an exponential tail; the sum over k joints that
/// have one follows Erlang's law. That several joints are looked at costs a factor of two or three.
pub(super) fn doubt(surprise: f64, joints: usize, stretches: f64) -> f64 {
    if surprise <= 0.0 {
        return 1.0;
    }
    let (mut ways, mut term, mut erlang, mut expected) = (1.0, 1.0, 0.0, 0.0);
    for k in 1..=joints {
        ways *= (joints + 1 - k) as f64 / (k as f64 * SCAN_INDEPENDENT);
        erlang += term;
        term *= surprise / k as f64;
        expected += ways * erlang;
    }
    -(-(stretches * SCAN_INDEPENDENT * expected * (-surprise).exp())).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn surprises_that_several_joints_share_by_accident_are_as_rare_as_said() {
        let mut rng = Pcg64::seed_from_u64(1);
        let (joints, stretches, runs) = (6, 10, 4000);
        let windows = stretches * SCAN_INDEPENDENT as usize;
        let mut largest: Vec<f64> = (0..runs)
            .map(|_| {
                let sum = |_| -> f64 {
                    // One window in so many has a surprise, with an exponential tail.
                    let one = |_| (-(SCAN_INDEPENDENT * rng.random::<f64>()).ln()).max(0.0);
                    (0..joints).map(one).sum()
                };
                (0..windows).map(sum).fold(0.0, f64::max)
            })
            .collect();
        largest.sort_by(f64::total_cmp);
        for share in [0.1, 0.02, 0.005] {
            let said = doubt(largest[((1.0 - share) * runs as f64) as usize], joints, stretches as f64);
            assert!((0.7 * share..1.4 * share).contains(&said), "{share}: {said}");
        }
    }

    #[test]
    fn laws_of_a_dozen_stretches_are_as_uncertain_as_they_say() {
        is_as_uncertain_as_it_says(12, 0.5);
    }

    #[test]
    fn laws_of_four_stretches_are_at_least_as_certain_as_they_say() {
        is_as_uncertain_as_it_says(4, 0.2);
    }

    /// Laws of so many stretches, whose doubts may be too large by one over `least`.
    fn is_as_uncertain_as_it_says(stretches: usize, least: f64) {
        let mut rng = Pcg64::seed_from_u64(2);
        let runs = 8000;
        let chances = Chances { joints: 1, stretches, known: stretches };
        let mut doubts: Vec<f64> = (0..runs)
            .map(|_| {
                let mut largest = || -> Vec<f64> {
                    (0..stretches).map(|_| 20.0 - 6.0 * (-rng.random::<f64>().ln()).ln()).collect()
                };
                let next = largest().into_iter().fold(0.0, f64::max);
                let law = Law::of_unpushed(&mut largest()).expect("enough stretches");
                chances.of_all(law.surprise(next))
            })
            .collect();
        doubts.sort_by(f64::total_cmp);
        for share in [0.1, 0.02, 0.005] {
            let said = doubts[(share * runs as f64) as usize];
            assert!((0.5 * share..share / least).contains(&said), "{share}: {said}");
        }
    }

    #[test]
    fn one_joint_alone_is_judged_by_its_own_law() {
        assert!((doubt(12.0, 1, 60.0) - 60.0 * (-12.0_f64).exp()).abs() < 1e-6);
        let ratio = doubt(12.0, 6, 10.0) / doubt(12.0, 1, 60.0);
        assert!((1.5..3.0).contains(&ratio), "{ratio}");
        assert_eq!(doubt(0.0, 0, 10.0), 1.0);
    }
}
