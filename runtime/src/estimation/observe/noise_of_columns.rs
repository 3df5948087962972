//! What noise in the accelerations adds to WT W.

use super::prepared::Prepared;
use super::settings::Equations;
use crate::model::Model;
use nalgebra::DMatrix;

/// Most rows of a motion at which it is worked out: it varies as slowly as the robot moves.
const MOST_ROWS: usize = 200;

/// For each motion and equation the expectation of dWT dW over its used rows, dW what noise of the given variances in
/// the accelerations of the joints makes of W; `None` where there is no noise to speak of.
///
/// W is linear in the accelerations, so that dW is their noise times its derivative, exactly. Noise in the speeds and
/// positions adds terms that are smaller by the squares of the frequencies of the band.
pub(super) fn noise_of_columns(
    model: &dyn Model,
    prepared: &[Prepared<'_>],
    equations: Equations,
    variance: &[f64],
) -> Option<Vec<DMatrix<f64>>> {
    let n = model.robot().joints();
    if variance.len() != n || variance.iter().all(|&v| v == 0.0) {
        return None;
    }
    let mut slopes = Slopes::new(model);
    let mut added = Vec::new();
    for p in prepared {
        let centres: Vec<usize> = p.grid.centres().collect();
        let step = centres.len().div_ceil(MOST_ROWS).max(1);
        let mut sums: Vec<DMatrix<f64>> =
            p.equations.iter().map(|e| DMatrix::zeros(e.unknowns.len(), e.unknowns.len())).collect();
        let mut counts = vec![0usize; sums.len()];
        let still: Vec<bool> = p.motion.ddq.iter().map(|ddq| ddq.iter().all(|&x| x == 0.0)).collect();
        for row in (step / 2..centres.len()).step_by(step) {
            let used: Vec<bool> = p.selection.iter().map(|s| s.used[row]).collect();
            if !used.contains(&true) {
                continue;
            }
            let at = centres[row];
            let q: Vec<f64> = p.motion.q.iter().map(|q| q[at]).collect();
            let dq: Vec<f64> = p.motion.dq.iter().map(|dq| dq[at]).collect();
            slopes.at(&q);
            for k in (0..n).filter(|&k| variance[k] > 0.0 && !still[k]) {
                slopes.by_acceleration(k);
                for (equation, sum) in sums.iter_mut().enumerate().filter(|(e, _)| used[*e]) {
                    let slope = match equations {
                        Equations::Torque => slopes.of_torque(equation),
                        Equations::Power { .. } => slopes.of_power(&dq),
                    };
                    add_product(sum, variance[k], &slope);
                }
            }
            used.iter().zip(&mut counts).for_each(|(&used, count)| *count += usize::from(used));
        }
        for ((sum, count), selection) in sums.into_iter().zip(counts).zip(&p.selection) {
            let share = selection.left_out.used as f64 / count.max(1) as f64;
            added.push(sum * share);
        }
    }
    Some(added)
}

/// How the entries of IDM change with the acceleration of one joint, which they are linear in.
struct Slopes<'a> {
    model: &'a dyn Model,
    q: Vec<f64>,
    /// Neither speed nor acceleration.
    rest: Vec<f64>,
    unit: Vec<f64>,
    /// Entries of IDM at rest, and with the acceleration 1 of the joint.
    without: Vec<f64>,
    with: Vec<f64>,
}

impl<'a> Slopes<'a> {
    fn new(model: &'a dyn Model) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        let (joints, entries) = (model.robot().joints(), model.pattern().columns.len());
        Self {
            model,
            q: zeros(joints),
            rest: zeros(joints),
            unit: zeros(joints),
            without: zeros(entries),
            with: zeros(entries),
        }
    }

    fn at(&mut self, q: &[f64]) {
        self.q.copy_from_slice(q);
        self.model.idm(q, &self.rest, &self.rest, &mut self.without);
    }

    fn by_acceleration(&mut self, joint: usize) {
        self.unit.fill(0.0);
        self.unit[joint] = 1.0;
        self.model.idm(&self.q, &self.rest, &self.unit, &mut self.with);
    }

    /// Of a joint's torque, for the base parameters of its row.
    fn of_torque(&self, joint: usize) -> Vec<f64> {
        let pattern = self.model.pattern();
        (pattern.rows[joint]..pattern.rows[joint + 1]).map(|entry| self.slope(entry)).collect()
    }

    /// Of the power at these speeds, for all base parameters.
    fn of_power(&self, dq: &[f64]) -> Vec<f64> {
        let pattern = self.model.pattern();
        let mut slopes = vec![0.0; self.model.robot().base.len()];
        for (joint, &speed) in dq.iter().enumerate() {
            for entry in pattern.rows[joint]..pattern.rows[joint + 1] {
                slopes[pattern.columns[entry]] += speed * self.slope(entry);
            }
        }
        slopes
    }

    fn slope(&self, entry: usize) -> f64 {
        self.with[entry] - self.without[entry]
    }
}

/// Adds `factor x xT`; few of x are not zero.
fn add_product(sum: &mut DMatrix<f64>, factor: f64, x: &[f64]) {
    let moved: Vec<(usize, f64)> = x.iter().copied().enumerate().filter(|(_, s)| *s != 0.0).collect();
    for &(a, x) in &moved {
        for &(b, y) in &moved {
            sum[(a, b)] += factor * x * y;
        }
    }
}
