//! What each innovation of the noise weighs in the scores of an estimate.

use super::noise::Noise;
use super::series::Series;
use super::solved::Solved;
use nalgebra::{DMatrix, DVector};

/// Innovations from before a motion that still matter in it, at most.
const LONGEST_MEMORY: usize = 400;

/// What each innovation of an equation's noise weighs in its scores.
pub(super) struct Innovations<'a> {
    pub equation: usize,
    /// The rows, and those of the instruments.
    pub w: &'a Series,
    pub z: &'a Series,
    /// Weight of a row, in units of that which the noise gives it.
    pub weight: f64,
    /// For innovations of variance 1, a column for each of `z`.
    pub weights: DMatrix<f64>,
    /// Variance of each innovation, where it is not 1.
    pub variances: Option<DVector<f64>>,
}

impl<'a> Innovations<'a> {
    /// `uneven`: the rows over their standard deviations, and these, where they differ from row to row.
    pub fn of(
        w: &'a Series,
        z: &'a Series,
        uneven: Option<(&Series, &[f64])>,
        solved: &Solved<'_>,
        noise: &Noise,
    ) -> Self {
        let weight = (solved.errors[w.group] / solved.weights[w.group]).powi(2);
        let model = &noise.equations[w.equation];
        let before = model.memory(LONGEST_MEMORY);
        let mut weights = DMatrix::zeros(z.w.nrows() + before, z.places.len());
        for (column, mut out) in z.w.column_iter().zip(weights.column_iter_mut()) {
            let mut column: Vec<f64> = column.iter().map(|x| weight * x).collect();
            if let Some((_, deviations)) = uneven {
                column.iter_mut().zip(deviations).for_each(|(x, deviation)| *x *= deviation);
            }
            out.copy_from(&DVector::from_vec(model.weights_of_innovations(&column, before)));
        }
        // What is left of the differences between rows each innovation tells by itself.
        let variances = uneven.map(|(even, _)| {
            let earlier = std::iter::repeat_n(1.0, before);
            DVector::from_iterator(weights.nrows(), earlier.chain(noise.own_squares(even)))
        });
        Self { equation: w.equation, w, z, weight, weights, variances }
    }

    /// The weights of the innovations as they are.
    pub fn scaled(&self) -> DMatrix<f64> {
        let mut scaled = self.weights.clone();
        if let Some(variances) = &self.variances {
            scaled.row_iter_mut().zip(variances.iter()).for_each(|(mut row, v)| row.scale_mut(v.sqrt()));
        }
        scaled
    }

    /// How much an innovation of variance 1 moves each unknown, which are `inverse` times the scores.
    pub fn moves(&self, inverse: &DMatrix<f64>) -> DMatrix<f64> {
        &self.weights * inverse.select_columns(&self.z.places).transpose()
    }
}
