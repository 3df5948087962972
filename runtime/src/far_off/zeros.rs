//! Zeros of several encoders that are off together, as where the controller counts angles from other postures than the table.

use super::descent::Descent;
use super::instants::{Instants, Number, Wrong};
use super::{AS_LITTLE, LEAVES};
use crate::model::{JointKind, Model};
use crate::parallel;
use nalgebra::DVector;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Quarters of a turn that a zero is tried at beside nothing: as conventions differ. Numerics: torques are waves of one to four a
/// turn over an angle, and from the next quarter steps lead to what is between.
const QUARTERS: [f64; 3] = [FRAC_PI_2, -FRAC_PI_2, PI];
/// Most joints that are tried together. Numerics: steps find others beside these.
const TOGETHER: usize = 3;
/// Starts from which steps are made, beside nothing. Numerics.
const STARTS: usize = 3;
/// Least change of the sum of logarithms by an angle whose joint says anything about its zero. Numerics: turned about a vertical
/// first axis a robot is the same.
const SEEN: f64 = 1e-3;

/// Zeros that are off, with what they leave.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Zeros {
    /// Joints (0-based) that are beyond where their encoders see them, and by how much, rad.
    pub of: Vec<(usize, f64)>,
    /// Sum over the joints of the logarithms of the part of their squares that is left.
    pub sum: f64,
    /// For each of them the joints whose zeros leave as little in its place.
    pub rivals: Vec<Vec<usize>>,
}

/// The zeros that leave least, each of which leaves less than half of a joint of what the others leave, and no joint more than the
/// robot as it is described; `None` where there are none.
pub(crate) fn zeros(model: &dyn Model, instants: &Instants, threads: usize) -> Option<Zeros> {
    let search = Search::new(model, instants)?;
    let joints = search.joints_that_tell();
    let trials = trials(&joints);
    let mut tried: Vec<(f64, usize)> = parallel::map(threads, trials.len(), |k| (search.sum(&trials[k]), k));
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    // From the best quarters of turns, and from nothing, steps lead to the zeros.
    let starts: Vec<Vec<(usize, f64)>> = std::iter::once(Vec::new())
        .chain(tried.iter().take(STARTS).map(|&(_, k)| trials[k].clone()))
        .map(|start| joints.iter().map(|&j| (j, of_joint(&start, j))).collect())
        .collect();
    let ends = parallel::map(threads, starts.len(), |k| search.settled(&starts[k]));
    let best = ends.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (found, sum) = search.needed(best, threads);
    if found.is_empty() || !search.residual(&found).is_some_and(|r| search.descent.worsens_none(&r)) {
        return None;
    }
    let rivals = parallel::map(threads, found.len(), |k| search.rivals(&joints, (&found, sum), k));
    let of = found.iter().map(|&(joint, by)| (joint, by - TAU * (by / TAU).round())).collect();
    Some(Zeros { of, sum, rivals })
}

fn of_joint(zeros: &[(usize, f64)], joint: usize) -> f64 {
    zeros.iter().find(|(j, _)| *j == joint).map_or(0.0, |(_, by)| *by)
}

/// Every choice of quarters of a turn for up to three joints.
fn trials(joints: &[usize]) -> Vec<Vec<(usize, f64)>> {
    let mut all: Vec<Vec<(usize, f64)>> = vec![Vec::new()];
    for &joint in joints {
        let longer: Vec<Vec<(usize, f64)>> = all
            .iter()
            .filter(|chosen| chosen.len() < TOGETHER)
            .flat_map(|chosen| QUARTERS.map(|by| [&chosen[..], &[(joint, by)]].concat()))
            .collect();
        all.extend(longer);
    }
    all.split_off(1)
}

struct Search<'a> {
    model: &'a dyn Model,
    instants: &'a Instants,
    descent: Descent<'a>,
}

impl<'a> Search<'a> {
    /// `None` where every angle would leave next to nothing.
    fn new(model: &'a dyn Model, instants: &'a Instants) -> Option<Self> {
        if instants.are_few() {
            return None;
        }
        let descent = Descent::new(instants, &instants.residual(model, &[])?);
        Some(Self { model, instants, descent })
    }

    /// Revolute joints whose zeros change anything.
    fn joints_that_tell(&self) -> Vec<usize> {
        let kinds = self.model.robot().joint_kinds();
        let revolute = (0..kinds.len()).filter(|&j| kinds[j] == JointKind::Revolute);
        revolute.filter(|&j| QUARTERS.iter().any(|&by| self.sum(&[(j, by)]).abs() > SEEN)).collect()
    }

    fn residual(&self, zeros: &[(usize, f64)]) -> Option<DVector<f64>> {
        let number = |&(joint, by): &(usize, f64)| (Number { joint, wrong: Wrong::Zero }, by);
        self.instants.residual(self.model, &zeros.iter().map(number).collect::<Vec<_>>())
    }

    /// Infinite where there is no fit.
    fn sum(&self, zeros: &[(usize, f64)]) -> f64 {
        self.residual(zeros).map_or(f64::INFINITY, |residual| self.descent.sum(&residual))
    }

    /// The zeros of the same joints to which steps lead, and what they leave.
    fn settled(&self, start: &[(usize, f64)]) -> (Vec<(usize, f64)>, f64) {
        let at = |angles: &[f64]| -> Vec<(usize, f64)> {
            start.iter().zip(angles).map(|(&(joint, _), &by)| (joint, by)).collect()
        };
        let from = start.iter().map(|(_, by)| *by).collect();
        let (end, sum) = self.descent.settled(from, &|angles| self.residual(&at(angles)));
        (at(&end), sum)
    }

    /// Those zeros without which the others, put right, leave twice as much of a joint.
    fn needed(
        &self,
        (mut zeros, mut sum): (Vec<(usize, f64)>, f64),
        threads: usize,
    ) -> (Vec<(usize, f64)>, f64) {
        while !zeros.is_empty() {
            let without = parallel::map(threads, zeros.len(), |k| {
                let mut others = zeros.clone();
                others.remove(k);
                self.settled(&others)
            });
            let Some(best) = without.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if best.1 - sum > -LEAVES.ln() {
                break;
            }
            (zeros, sum) = best;
        }
        (zeros, sum)
    }

    /// The joints whose zeros leave as little in the place of the `k`-th.
    fn rivals(&self, joints: &[usize], (found, sum): (&[(usize, f64)], f64), k: usize) -> Vec<usize> {
        let others: Vec<(usize, f64)> =
            found.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, zero)| *zero).collect();
        let leaves_as_little = |&other: &usize| {
            let start = |by: f64| [&others[..], &[(other, by)]].concat();
            let trials = QUARTERS.map(|by| (self.sum(&start(by)), by));
            let best = trials.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, by)| by);
            self.settled(&start(best)).1 - sum < AS_LITTLE
        };
        let free = joints.iter().copied().filter(|j| found.iter().all(|(own, _)| own != j));
        free.filter(leaves_as_little).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Drive, Frame, Limits, RecursiveModel, Robot, StateSlices, torques};
    use crate::testing::normal;
    use rand::RngExt;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    /// An arm of four joints: upright, shoulder, elbow and a wrist.
    fn arm() -> RecursiveModel {
        let base = Frame::on_base(JointKind::Revolute);
        let frames = vec![
            base,
            Frame { parent: Some(0), alpha: FRAC_PI_2, ..base },
            Frame { parent: Some(1), d: 0.5, ..base },
            Frame { parent: Some(2), alpha: -FRAC_PI_2, d: 0.1, r: 0.4, ..base },
        ];
        let drive = Drive {
            gear: (0..16).map(|k| if k % 5 == 0 { 1.0 } else { 0.0 }).collect(),
            coupled_friction: vec![].into(),
        };
        let robot = Robot::with_standard_as_base("arm", [0.0, 0.0, -9.81], frames, drive, Limits::default());
        RecursiveModel::new(robot).expect("a valid table")
    }

    /// Instants of a motion whose joints are beyond what is recorded, with noise of a hundredth of each torque.
    fn instants(model: &RecursiveModel, beyond: &[(usize, f64)], seed: u64) -> Instants {
        let mut random = Pcg64::seed_from_u64(seed);
        let (n, count) = (4, 400);
        let mut draw = |size: f64| -> Vec<Vec<f64>> {
            (0..n).map(|_| (0..count).map(|_| random.random_range(-size..size)).collect()).collect()
        };
        let states = [draw(2.5), draw(3.0), draw(12.0)];
        let chi: Vec<f64> = model
            .robot()
            .base
            .iter()
            .map(|p| match &*p.name {
                name if name.starts_with('M') && name.len() == 2 => 3.0,
                name if name.starts_with("MX") || name.starts_with("MZ") => 0.7,
                name if name.starts_with("XX") || name.starts_with("YY") || name.starts_with("ZZ") => 0.4,
                name if name.starts_with("Fv") || name.starts_with("Fc") => 2.0,
                _ => 0.0,
            })
            .collect();
        let mut q = states[0].clone();
        beyond.iter().for_each(|&(j, by)| q[j].iter_mut().for_each(|q| *q += by));
        let tau = torques(model, &chi, StateSlices::new(&q, &states[1], &states[2]).states());
        let size: Vec<f64> =
            tau.iter().map(|t| (t.iter().map(|x| x * x).sum::<f64>() / count as f64).sqrt()).collect();
        let row = |t: usize, random: &mut Pcg64| {
            (0..n).map(|j| (j, tau[j][t] + 0.01 * size[j] * normal(random))).collect()
        };
        let torques = (0..count).map(|t| row(t, &mut random)).collect();
        Instants { states, torques, sigma: size, parameters: model.robot().base.len(), known: Vec::new() }
    }

    fn found(beyond: &[(usize, f64)], seed: u64) -> Option<Zeros> {
        let model = arm();
        zeros(&model, &instants(&model, beyond, seed), 1)
    }

    #[test]
    fn two_quarters_of_a_turn_that_undo_each_other_are_found() {
        let zeros = found(&[(1, FRAC_PI_2), (2, -FRAC_PI_2)], 1).expect("two zeros");
        assert_eq!(zeros.of.iter().map(|(j, _)| *j).collect::<Vec<_>>(), [1, 2]);
        assert!(
            (zeros.of[0].1 - FRAC_PI_2).abs() < 0.02 && (zeros.of[1].1 + FRAC_PI_2).abs() < 0.02,
            "{zeros:?}"
        );
    }

    #[test]
    fn angles_between_quarters_are_found() {
        for (seed, beyond) in
            [(2, [(1, 0.3), (2, -0.4)]), (3, [(1, -0.9), (2, 2.2)]), (4, [(1, 2.8), (2, 0.7)])]
        {
            let zeros = found(&beyond, seed).expect("two zeros");
            let as_hidden = |((j, by), (own, angle)): (&(usize, f64), &(usize, f64))| {
                j == own && (by - angle).abs() < 0.02
            };
            assert!(
                zeros.of.len() == 2 && zeros.of.iter().zip(&beyond).all(as_hidden),
                "{beyond:?}: {zeros:?}"
            );
        }
    }

    #[test]
    fn zeros_that_are_right_and_those_that_nothing_tells_are_left_alone() {
        assert_eq!(found(&[], 5), None);
        // The robot turns about a vertical first axis, and the last body with its joint.
        assert_eq!(found(&[(0, 1.0), (3, 1.0)], 6), None);
    }

    #[test]
    fn a_single_zero_is_found_alone() {
        let zeros = found(&[(2, 1.3)], 7).expect("a zero");
        assert!(zeros.of.len() == 1 && zeros.of[0].0 == 2 && (zeros.of[0].1 - 1.3).abs() < 0.02, "{zeros:?}");
    }
}
