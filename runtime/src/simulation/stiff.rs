//! The linear system of a step that is safe with stiff drives.

use super::lu::lu_solve;

/// Memory of a [`Scheme::Rosenbrock2`] step: derivatives of the accelerations, row-major with one row a coordinate,
/// and the factored matrix of the step.
#[derive(Debug, Clone, Default)]
pub(super) struct Stiff {
    pub by_position: Vec<f64>,
    pub by_velocity: Vec<f64>,
    pub matrix: Vec<f64>,
    pub pivots: Vec<usize>,
    pub shifted: Vec<f64>,
}

impl Stiff {
    pub fn new(freedom: usize) -> Self {
        let square = || vec![0.0; freedom * freedom];
        Self {
            by_position: square(),
            by_velocity: square(),
            matrix: square(),
            pivots: vec![0; freedom],
            shifted: vec![0.0; freedom],
        }
    }
}

impl Stiff {
    /// The accelerations' part of (E - s·J)⁻¹·(`upper`, `lower`); that of the positions is upper + s times it.
    pub fn solve(&self, s: f64, upper: &[f64], lower: &[f64], out: &mut [f64]) {
        let d = out.len();
        for r in 0..d {
            let row = &self.by_position[r * d..][..d];
            out[r] = lower[r] + s * row.iter().zip(upper).map(|(a, x)| a * x).sum::<f64>();
        }
        lu_solve(d, &self.matrix, &self.pivots, out);
    }
}
