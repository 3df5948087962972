//! The decimated rows themselves, for residuals.

/// All decimated rows of one equation of one motion, used or not.
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
