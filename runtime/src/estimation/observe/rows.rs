//! The decimated rows themselves, for residuals.

/// All decimated rows of one equation of one motion, used or not, less what the moments take at which dry friction changes
/// its sign.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint, or 0 for the power model.
    pub equation: usize,
    /// Sample of the motion at the centre of each row.
    pub sample: Vec<usize>,
    /// Time of that sample, s.
    pub time: Vec<f64>,
    /// Decimated torque (N.m or N) or power (W).
    pub y: Vec<f64>,
    /// Unknown of each column of `w`, ascending.
    pub columns: Vec<usize>,
    /// Decimated columns, one behind the other: column c of row t is `w[c * y.len() + t]`.
    pub w: Vec<f64>,
    /// Whether the row was used.
    pub used: Vec<bool>,
}

impl Rows {
    /// The same rows with Y less the columns of known unknowns, and without these columns.
    pub(super) fn without(&self, fixed: &[(usize, f64)]) -> Rows {
        let count = self.y.len().max(1);
        let mut free = Rows { columns: Vec::new(), w: Vec::new(), ..self.clone() };
        for (&unknown, column) in self.columns.iter().zip(self.w.chunks_exact(count)) {
            match fixed.iter().find(|(known, _)| *known == unknown) {
                Some((_, value)) => free.y.iter_mut().zip(column).for_each(|(y, w)| *y -= value * w),
                None => {
                    free.columns.push(unknown);
                    free.w.extend_from_slice(column);
                }
            }
        }
        free
    }

    /// W chi, for all unknowns of the observation.
    pub fn predict(&self, chi: &[f64]) -> Vec<f64> {
        let mut prediction = vec![0.0; self.y.len()];
        if self.y.is_empty() {
            return prediction;
        }
        for (&unknown, column) in self.columns.iter().zip(self.w.chunks_exact(self.y.len())) {
            let x = chi[unknown];
            for (p, w) in prediction.iter_mut().zip(column) {
                *p += x * w;
            }
        }
        prediction
    }

    /// Y - W chi.
    pub fn residual(&self, chi: &[f64]) -> Vec<f64> {
        let mut residual = self.predict(chi);
        for (e, y) in residual.iter_mut().zip(&self.y) {
            *e = y - *e;
        }
        residual
    }
}
