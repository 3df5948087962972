//! The rows of an observation as time series, in units of their groups' errors.

use std::ops::Range;

use super::super::observe::{Observation, Rows};
use nalgebra::DMatrix;

/// The rows of one equation in one motion, on their grid, each divided by the error of its group.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// Place of the group in the observation.
    pub group: usize,
    /// Joint, or 0 for the power model.
    pub equation: usize,
    /// Index of the motion.
    pub trajectory: usize,
    /// Place of each column of `w` among the unknowns that are solved for.
    pub places: Vec<usize>,
    /// Columns, zero where a row is not used.
    pub w: DMatrix<f64>,
    /// Torque or power, zero where a row is not used.
    pub y: Vec<f64>,
    /// Whether a row is used.
    pub used: Vec<bool>,
    /// Stretches of used rows without a gap.
    pub segments: Vec<Range<usize>>,
}

impl Series {
    /// Those of the groups that have rows; `None` where the observation did not keep its rows. `unknowns` are those
    /// that become columns, `sigma` the error of each group.
    pub fn of(observation: &Observation, unknowns: &[usize], sigma: &[f64]) -> Option<Vec<Series>> {
        let rows = observation.rows.as_ref()?;
        if rows.len() != observation.groups.len() {
            return None;
        }
        let mut place = vec![None; observation.unknowns.len()];
        for (p, &l) in unknowns.iter().enumerate() {
            place[l] = Some(p);
        }
        let series = rows.iter().zip(sigma).enumerate().filter(|(_, (r, _))| r.used.contains(&true));
        Some(series.map(|(group, (rows, &sigma))| Self::one(group, rows, &place, 1.0 / sigma)).collect())
    }

    fn one(group: usize, rows: &Rows, place: &[Option<usize>], scale: f64) -> Series {
        let own: Vec<(usize, usize)> =
            rows.columns.iter().enumerate().filter_map(|(c, &u)| place[u].map(|p| (c, p))).collect();
        let n = rows.y.len();
        let kept = |t: usize, value: f64| if rows.used[t] { scale * value } else { 0.0 };
        let w = DMatrix::from_fn(n, own.len(), |t, c| kept(t, rows.w[own[c].0 * n + t]));
        let mut segments: Vec<Range<usize>> = Vec::new();
        for t in (0..n).filter(|&t| rows.used[t]) {
            match segments.last_mut() {
                Some(last) if last.end == t => last.end = t + 1,
                _ => segments.push(t..t + 1),
            }
        }
        Series {
            group,
            equation: rows.equation,
            trajectory: rows.trajectory,
            places: own.into_iter().map(|(_, p)| p).collect(),
            w,
            y: rows.y.iter().enumerate().map(|(t, &y)| kept(t, y)).collect(),
            used: rows.used.clone(),
            segments,
        }
    }

    /// The same rows, each divided by a number.
    pub fn divided_by(&self, divisors: &[f64]) -> Series {
        let mut even = self.clone();
        even.w.row_iter_mut().zip(divisors).for_each(|(mut row, d)| row /= *d);
        even.y.iter_mut().zip(divisors).for_each(|(y, d)| *y /= d);
        even
    }

    /// Y - W chi at the used rows, zero elsewhere; `chi` of all unknowns that are solved for.
    pub fn residual(&self, chi: &[f64]) -> Vec<f64> {
        let mut left = self.y.clone();
        for (column, &place) in self.w.column_iter().zip(&self.places) {
            for (e, w) in left.iter_mut().zip(column.iter()) {
                *e -= chi[place] * w;
            }
        }
        left
    }
}
