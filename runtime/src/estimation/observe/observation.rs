//! What an observation holds.

use super::error::ObserveError;
use super::rows::Rows;
use super::select::LeftOut;
use super::settings::Equations;
use crate::estimation::Factor;
use nalgebra::DMatrix;

/// The rows of one equation in one trajectory, or in one block of its time.
#[derive(Debug, Clone, PartialEq)]
pub struct EquationFactor {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint, or 0 for the power model.
    pub equation: usize,
    /// Unknown of each column of the factor, ascending.
    pub columns: Vec<usize>,
    /// R of [W Y], of what the moments leave at which dry friction changes its sign: they are unknown, and eliminated.
    pub factor: Factor,
    /// What they take: further rows of [W Y], which count in errors and not in the fit. Of whole groups only.
    pub reversals: Vec<Vec<f64>>,
}

/// The equations of one stretch of one trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeBlock {
    /// Index of the motion.
    pub trajectory: usize,
    /// First and last row centre, s.
    pub time: [f64; 2],
    /// One per equation.
    pub equations: Vec<EquationFactor>,
}

/// Motions as equations in the unknowns: nothing is kept but orthogonal factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// What is observed.
    pub equations: Equations,
    /// Names of the base parameters, then of the extra unknowns.
    pub unknowns: Vec<String>,
    /// How many of the unknowns are base parameters.
    pub base: usize,
    /// Unknowns whose values are known beforehand, ascending, with them: base parameters of which only known standard ones are
    /// part.
    pub fixed: Vec<(usize, f64)>,
    /// Which unknowns have columns without measuring errors: constants, and the sign of the speed.
    pub exact: Vec<bool>,
    /// Name of each motion.
    pub trajectories: Vec<String>,
    /// Rows a second, for each motion, Hz.
    pub rates: Vec<f64>,
    /// Band of the rows, for each motion, Hz.
    pub bands: Vec<f64>,
    /// For each motion and equation, all its rows.
    pub groups: Vec<EquationFactor>,
    /// The same rows by blocks of time: for what residuals have in common over time, and for resampling.
    pub blocks: Vec<TimeBlock>,
    /// For each motion and equation, in the order of `groups`: what was used and what was not.
    pub left_out: Vec<LeftOut>,
    /// Samples of the motions that were read, all joints counted once.
    pub samples: usize,
    /// For each group, in the order of `groups`, what the noise of the accelerations is expected to have added to WT W of
    /// its rows; where that noise is known.
    pub noise_of_columns: Option<Vec<DMatrix<f64>>>,
    /// The decimated rows, in the order of `groups`, where they were asked for.
    pub rows: Option<Vec<Rows>>,
}

impl EquationFactor {
    /// The same rows with Y less the columns of known unknowns, and without these columns.
    fn without(&self, fixed: &[(usize, f64)]) -> EquationFactor {
        let place =
            |&(unknown, value): &(usize, f64)| Some((self.columns.binary_search(&unknown).ok()?, value));
        let held: Vec<(usize, f64)> = fixed.iter().filter_map(place).collect();
        let is_free = |unknown: &usize| fixed.iter().all(|(known, _)| known != unknown);
        let columns: Vec<usize> = self.columns.iter().copied().filter(is_free).collect();
        let hold = |row: &Vec<f64>| {
            let y = row[self.columns.len()] - held.iter().map(|&(l, value)| value * row[l]).sum::<f64>();
            let left = (0..self.columns.len()).filter(|l| is_free(&self.columns[*l])).map(|l| row[l]);
            left.chain([y]).collect()
        };
        let reversals = self.reversals.iter().map(hold).collect();
        EquationFactor { columns, factor: self.factor.hold(&held), reversals, ..*self }
    }

    /// R of [W Y] of all rows, with what the moments of the reversals take.
    pub(crate) fn of_all_rows(&self) -> Factor {
        let mut all = self.factor.clone();
        let stride = self.reversals.len().next_multiple_of(4);
        let mut block = vec![0.0; (self.columns.len() + 1) * stride];
        for (i, row) in self.reversals.iter().enumerate() {
            row.iter().enumerate().for_each(|(l, x)| block[l * stride + i] = *x);
        }
        all.push(self.reversals.len(), stride, &mut block);
        all
    }

    /// Sum of the squares of Y - W chi over all rows, for all unknowns of the observation.
    pub(crate) fn squares_left(&self, chi: &[f64]) -> f64 {
        let own: Vec<f64> = self.columns.iter().map(|&u| chi[u]).collect();
        let left = |row: &Vec<f64>| {
            let predicted: f64 = row.iter().zip(&own).map(|(w, x)| w * x).sum();
            (row[own.len()] - predicted).powi(2)
        };
        self.factor.residual_norm(&own).powi(2) + self.reversals.iter().map(left).sum::<f64>()
    }

    /// Sum of the squares of Y over all rows.
    pub(crate) fn squares_measured(&self) -> f64 {
        let of_row = |row: &Vec<f64>| row[self.columns.len()].powi(2);
        self.factor.norm_y().powi(2) + self.reversals.iter().map(of_row).sum::<f64>()
    }
}

impl Observation {
    /// The same equations with Y less the torques or the power of what is known, whose unknowns have no columns then; `None`
    /// where nothing is.
    pub(in crate::estimation) fn without_fixed(&self) -> Option<Observation> {
        if self.fixed.is_empty() {
            return None;
        }
        let mut free = self.clone();
        for equation in free.groups.iter_mut().chain(free.blocks.iter_mut().flat_map(|b| &mut b.equations)) {
            *equation = equation.without(&self.fixed);
        }
        for rows in free.rows.iter_mut().flatten() {
            *rows = rows.without(&self.fixed);
        }
        for (noise, group) in free.noise_of_columns.iter_mut().flatten().zip(&self.groups) {
            let kept: Vec<usize> = (0..group.columns.len())
                .filter(|&c| self.fixed.iter().all(|(known, _)| *known != group.columns[c]))
                .collect();
            *noise = DMatrix::from_fn(kept.len(), kept.len(), |i, k| noise[(kept[i], kept[k])]);
        }
        Some(free)
    }

    /// Puts the known values into those of all unknowns.
    pub(in crate::estimation) fn with_fixed(&self, mut chi: Vec<f64>) -> Vec<f64> {
        self.fixed.iter().for_each(|&(unknown, value)| chi[unknown] = value);
        chi
    }

    /// Takes in the motions of another observation of the same unknowns, behind its own: a recording that is too
    /// long for the memory is read, observed and dropped piece by piece.
    ///
    /// # Errors
    /// Another model, other equations, or other extra unknowns.
    pub fn append(&mut self, mut other: Observation) -> Result<(), ObserveError> {
        if other.equations != self.equations || other.unknowns != self.unknowns {
            return Err(ObserveError::OtherUnknowns);
        }
        let before = self.trajectories.len();
        let blocks = other.blocks.iter_mut().flat_map(|b| {
            b.trajectory += before;
            &mut b.equations
        });
        for equation in blocks.chain(&mut other.groups) {
            equation.trajectory += before;
        }
        other.left_out.iter_mut().for_each(|l| l.trajectory += before);
        other.rows.iter_mut().flatten().for_each(|r| r.trajectory += before);
        self.trajectories.extend(other.trajectories);
        self.rates.extend(other.rates);
        self.bands.extend(other.bands);
        self.groups.extend(other.groups);
        self.blocks.extend(other.blocks);
        self.left_out.extend(other.left_out);
        self.noise_of_columns = match (self.noise_of_columns.take(), other.noise_of_columns) {
            (Some(mut own), Some(theirs)) => {
                own.extend(theirs);
                Some(own)
            }
            _ => None,
        };
        self.samples += other.samples;
        self.rows = match (self.rows.take(), other.rows) {
            (Some(mut own), Some(theirs)) => {
                own.extend(theirs);
                Some(own)
            }
            _ => None,
        };
        Ok(())
    }
}
