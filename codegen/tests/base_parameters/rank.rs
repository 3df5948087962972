//! What makes a base set right: its size is the numeric rank, and its torques are those of the standard parameters.

use crate::numeric::regressor;
use dynid_codegen::base::{BaseSet, base_set};
use dynid_codegen::robot::RobotTable;
use rand::RngExt;
use rand_pcg::Pcg64;
use std::f64::consts::PI;

/// Standard columns at enough random states for every rank to show.
pub fn observations(robot: &RobotTable, set: &BaseSet, random: &mut Pcg64) -> nalgebra::DMatrix<f64> {
    let n = robot.joint_frames().len();
    let states = 2 + 3 * set.standard.len() / n;
    let mut rows = nalgebra::DMatrix::zeros(states * n, set.standard.len());
    for s in 0..states {
        let mut draw = |size: f64| (0..n).map(|_| random.random_range(-size..size)).collect::<Vec<f64>>();
        let (q, dq, ddq) = (draw(PI), draw(2.0), draw(3.0));
        rows.rows_mut(s * n, n).copy_from(&regressor(robot, &q, &dq, &ddq));
    }
    rows
}

/// Numeric rank with columns scaled, and the gap: the smallest singular value that counts over the largest that does
/// not.
pub fn rank(matrix: &nalgebra::DMatrix<f64>) -> (usize, f64) {
    let norms: Vec<f64> = matrix.column_iter().map(|c| c.norm()).collect();
    let kept: Vec<usize> = (0..norms.len()).filter(|&k| norms[k] > 1e-10).collect();
    let scaled =
        nalgebra::DMatrix::from_fn(matrix.nrows(), kept.len(), |i, k| matrix[(i, kept[k])] / norms[kept[k]]);
    let triangle = scaled.qr().unpack_r();
    let mut singular: Vec<f64> = triangle.singular_values().iter().copied().collect();
    singular.sort_by(|a, b| b.total_cmp(a));
    let rank = singular.iter().filter(|&&s| s > 1e-10 * singular[0]).count();
    let below = singular.get(rank).copied().unwrap_or(1e-16).max(1e-16);
    (rank, singular[rank - 1] / below)
}

/// What makes a base set right; `Err` says what is wrong.
pub fn check(robot: &RobotTable, random: &mut Pcg64) -> Result<(), String> {
    let set = base_set(robot);
    let rows = observations(robot, &set, random);
    // What is known to be 0 is no column.
    let mut rows = rows;
    robot.known.iter().for_each(|&k| rows.column_mut(k).fill(0.0));
    let (rank, gap) = rank(&rows);
    if set.base.len() != rank {
        return Err(format!("{} base parameters, numeric rank {rank} (gap {gap:.1e})", set.base.len()));
    }
    let chi_st = nalgebra::DVector::from_fn(set.standard.len(), |_, _| random.random_range(-1.0..1.0));
    let expected = &rows * &chi_st;
    let mut torque = nalgebra::DVector::zeros(rows.nrows());
    let mut largest = 1.0_f64;
    for parameter in &set.base {
        let chi: f64 = parameter.combination.iter().map(|&(k, c)| c * chi_st[k]).sum();
        largest = parameter.combination.iter().fold(largest, |m, &(_, c)| m.max(c.abs()));
        torque.axpy(chi, &rows.column(parameter.standard), 1.0);
    }
    let error = (torque - &expected).amax() / (expected.amax() + 1e-3);
    if error > 1e-9 {
        return Err(format!("torques differ by {error:.1e} (largest coefficient {largest:.1e})"));
    }
    Ok(())
}
