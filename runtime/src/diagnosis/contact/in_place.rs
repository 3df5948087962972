//! A push in the place of a law that shows in one passage only.

use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::contact::half_waves::lengths;
use crate::diagnosis::contact::pushed::{Pushed, half_wave};
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{NEARLY_AS_MUCH, SCAN_EDGE, SCAN_STEPS};
use std::ops::Range;

/// Half a wave on joints at the same time.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct HalfWave {
    /// The one that tells most of it, 0-based.
    pub joint: usize,
    pub motion: usize,
    /// On the grid of the rows of the regression.
    pub places: Range<usize>,
    /// Squares that it takes away, in units of the noise.
    pub gain: f64,
}

impl HalfWave {
    /// As a push on other rows, given the samples from one row to the next of these and of those; it is an accident with this
    /// probability.
    pub fn as_push(&self, [own, other]: [usize; 2], doubt: f64) -> Pushed {
        let on_other = |place: usize| place * own / other.max(1);
        // A push need not be half a wave.
        let edge = SCAN_EDGE * on_other(self.places.len()) as f64;
        Pushed {
            joint: self.joint,
            motion: self.motion,
            places: [self.places.start, self.places.end].map(on_other),
            edges: [edge; 2],
            square: self.gain,
            doubt,
        }
    }
}

/// The half wave of so many places, at most, with an amplitude of its own on each of these joints, that explains most, where that is
/// nearly as much as the law of these columns does. The law need not show most where it is: a push that is no part of the model bends
/// the rest of it.
///
/// # Errors
/// [`SingularDesign`] where there is no fit without the law.
pub(in crate::diagnosis) fn half_wave_in_place(
    regression: &Regression,
    law: Range<usize>,
    joints: &[usize],
    longest: usize,
) -> Result<Option<HalfWave>, SingularDesign> {
    let (design, fit) = regression.without(law)?;
    let of_law = fit.weighted_squares(&design) - regression.fit.weighted_squares(&regression.design);
    let mut best: Option<HalfWave> = None;
    for (motion, places) in windows(&design, longest) {
        let columns = joints.iter().map(|&j| vec![(j, on_rows(&design, j, motion, &places))]).collect();
        let mut trial = Trial::new(&design, Vec::new(), columns);
        trial.needed = 1;
        let Some((amplitude, gain)) = fit.project_out(&trial).and_then(|part| part.solve_beside(&[])) else {
            continue;
        };
        if best.as_ref().is_none_or(|best| gain > best.gain) {
            let size = |k: usize| amplitude[k].abs() / regression.sigma[joints[k]];
            let most = (0..joints.len()).max_by(|a, b| size(*a).total_cmp(&size(*b)));
            let Some(joint) = most.map(|k| joints[k]) else { continue };
            best = Some(HalfWave { joint, motion, places, gain });
        }
    }
    Ok(best.filter(|wave| wave.gain >= NEARLY_AS_MUCH * of_law))
}

/// Windows of the recording, by motion, of many lengths up to the longest.
fn windows(design: &Design, longest: usize) -> Vec<(usize, Range<usize>)> {
    let lengths: Vec<usize> = lengths(design.step).into_iter().filter(|length| *length <= longest).collect();
    let mut windows = Vec::new();
    for (motion, span) in design.target_spans() {
        for &length in &lengths {
            let last = (span.end + 1).saturating_sub(length);
            let from = (span.start..last).step_by((length / SCAN_STEPS).max(1));
            windows.extend(from.map(|from| (motion, from..from + length)));
        }
    }
    windows
}

/// Half a wave over places of a motion on the rows of a joint.
fn on_rows(design: &Design, joint: usize, motion: usize, places: &Range<usize>) -> Vec<f64> {
    let value = |r: usize| {
        if design.rows[r].signal == motion { half_wave(design.place(r), places) } else { 0.0 }
    };
    design.of_joint(joint).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const ROWS: usize = 500;

    /// What takes the place, on two joints, of a law on the first that is `torque` of each row of one motion.
    fn in_place_of(torque: impl Fn(usize) -> f64) -> Option<HalfWave> {
        let mut rng = Pcg64::seed_from_u64(3);
        let mut columns: Vec<Vec<f64>> = (0..2).map(|_| correlated(&mut rng, 2 * ROWS, 0.9)).collect();
        columns.push((0..2 * ROWS).map(|r| if r < ROWS { torque(r) } else { 0.0 }).collect());
        let y = (0..2 * ROWS).map(|r| columns[0][r] + columns[2][r] + 0.2 * normal(&mut rng)).collect();
        let design = Design::made_up(2, &[(0, true)], ROWS, columns, y);
        let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
        half_wave_in_place(&regression, 2..3, &[0, 1], 120).expect("regular")
    }

    #[test]
    fn what_leans_once_is_half_a_wave() {
        let plateau = |r: usize| if (200..280).contains(&r) { 1.0 } else { 0.0 };
        let wave = in_place_of(plateau).expect("a half wave makes four fifths of a plateau");
        assert_eq!((wave.joint, wave.motion), (0, 0));
        assert!(wave.places.start.abs_diff(195) <= 15 && wave.places.end.abs_diff(285) <= 15, "{wave:?}");
        let push = wave.as_push([5, 2], 0.01);
        assert_eq!(push.places, [wave.places.start, wave.places.end].map(|place| 5 * place / 2));
    }

    #[test]
    fn what_swings_is_none() {
        let swings = |r: usize| if (200..280).contains(&r) { (0.4 * r as f64).sin() } else { 0.0 };
        assert_eq!(in_place_of(swings), None);
    }
}
