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
    let robot = model.robot();
    let n = robot.joints();
    if variance.len() != n || variance.iter().all(|&v| v == 0.0) {
        return None;
    }
    let pattern = model.pattern();
    let base = robot.base.len();
    let (mut with, mut without) = (vec![0.0; pattern.columns.len()], vec![0.0; pattern.columns.len()]);
    let mut added = Vec::new();
    for p in prepared {
        let centres: Vec<usize> = p.grid.centres().collect();
        let step = centres.len().div_ceil(MOST_ROWS).max(1);
        let mut sums: Vec<DMatrix<f64>> =
            p.equations.iter().map(|e| DMatrix::zeros(e.unknowns.len(), e.unknowns.len())).collect();
        let mut counts = vec![0usize; sums.len()];
        for row in (step / 2..centres.len()).step_by(step) {
            let used: Vec<bool> = p.selection.iter().map(|s| s.used[row]).collect();
            if !used.contains(&true) {
                continue;
            }
            let at = centres[row];
            let q: Vec<f64> = p.motion.q.iter().map(|q| q[at]).collect();
            let rest = vec![0.0; n];
            model.idm(&q, &rest, &rest, &mut without);
            for k in (0..n).filter(|k| variance[*k] > 0.0 && !p.motion.fixed.contains(k)) {
                let mut unit = vec![0.0; n];
                unit[k] = 1.0;
                model.idm(&q, &rest, &unit, &mut with);
                let slope = |entry: usize| with[entry] - without[entry];
                for (equation, sum) in sums.iter_mut().enumerate().filter(|(e, _)| used[*e]) {
                    let mut slopes = vec![0.0; sum.nrows()];
                    match equations {
                        Equations::Torque => {
                            let entries = pattern.rows[equation]..pattern.rows[equation + 1];
                            slopes.iter_mut().zip(entries).for_each(|(s, entry)| *s = slope(entry));
                        }
                        Equations::Power { .. } => {
                            for j in 0..n {
                                let speed = p.motion.dq[j][at];
                                for entry in pattern.rows[j]..pattern.rows[j + 1] {
                                    slopes[pattern.columns[entry]] += speed * slope(entry);
                                }
                            }
                        }
                    }
                    let moved: Vec<(usize, f64)> =
                        slopes.into_iter().enumerate().take(base).filter(|(_, s)| *s != 0.0).collect();
                    for &(a, x) in &moved {
                        for &(b, y) in &moved {
                            sum[(a, b)] += variance[k] * x * y;
                        }
                    }
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
