//! What the motion of a recording allows to be concluded: which joints move enough to be judged, and which columns of
//! the standard model it determines.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{LEAST_ROWS, UNDETERMINED};
use crate::estimation::ROUNDING;

/// How much each joint moves.
pub(in crate::diagnosis) struct Moving {
    /// Rows of each joint in the recording that is diagnosed.
    pub rows: Vec<usize>,
    /// Joints with enough rows in the recording that is diagnosed: laws are looked for on them.
    pub judged: Vec<bool>,
    /// Joints with enough rows in it or in the baseline: they take part in the fit.
    pub fitted: Vec<bool>,
    /// Joints whose dry friction is known: from the fit, or from a reference.
    pub friction_known: Vec<bool>,
}

impl Moving {
    /// Of all rows, and of what a reference knows.
    pub fn of(design: &Design, known: Option<Vec<bool>>) -> Self {
        let rows: Vec<usize> =
            (0..design.joints).map(|j| design.count(j, |g| design.segments[g].is_target)).collect();
        let fitted: Vec<bool> = (0..design.joints).map(|j| design.of_joint(j).len() >= LEAST_ROWS).collect();
        let known = known.unwrap_or_else(|| vec![false; design.joints]);
        Self {
            friction_known: fitted.iter().zip(known).map(|(fitted, known)| *fitted || known).collect(),
            judged: rows.iter().map(|&r| r >= LEAST_ROWS).collect(),
            fitted,
            rows,
        }
    }

    /// Joints, 0-based, on which nothing can be said.
    pub fn not_judged(&self) -> Vec<usize> {
        (0..self.judged.len()).filter(|&j| !self.judged[j]).collect()
    }
}

/// The base parameters that the rows do not determine beside the others: taken one by one, always the one of which most
/// is left, those of which nothing is left when the others are in.
///
/// Where two columns are the same on all rows, one of them is kept: what it stands for then is their sum.
pub(in crate::diagnosis) fn left_over(design: &Design, sigma: &[f64]) -> Vec<usize> {
    let p = design.parameters;
    let mut gram = vec![0.0; p * p];
    for (j, s) in sigma.iter().enumerate() {
        for segment in 0..design.segments.len() {
            for (i, sum) in gram.chunks_exact_mut(p).enumerate() {
                let row = design.gram(j, segment).row(i);
                sum.iter_mut().zip(row).for_each(|(sum, x)| *sum += x / (s * s));
            }
        }
    }
    undetermined(&gram, p)
}

/// The columns that a pivoted Cholesky factorisation of their inner products leaves over (Higham, Accuracy and
/// Stability of Numerical Algorithms, 10.3).
fn undetermined(gram: &[f64], p: usize) -> Vec<usize> {
    let norm: Vec<f64> = (0..p).map(|k| gram[k * p + k].max(0.0).sqrt()).collect();
    let scaled =
        |i: usize, k: usize| if norm[i] * norm[k] > 0.0 { gram[i * p + k] / norm[i] / norm[k] } else { 0.0 };
    let least = ROUNDING * norm.iter().copied().fold(0.0, f64::max);
    let mut left: Vec<f64> = norm.iter().map(|n| f64::from(*n > least)).collect();
    let mut taken = vec![false; p];
    let mut factor: Vec<Vec<f64>> = Vec::new();
    while let Some(pivot) = (0..p)
        .filter(|&k| !taken[k] && left[k] > UNDETERMINED * UNDETERMINED)
        .max_by(|&a, &b| left[a].total_cmp(&left[b]).then(b.cmp(&a)))
    {
        let root = left[pivot].sqrt();
        let mut column = vec![0.0; p];
        for k in (0..p).filter(|&k| !taken[k]) {
            let made: f64 = factor.iter().map(|f| f[pivot] * f[k]).sum();
            column[k] = (scaled(pivot, k) - made) / root;
            left[k] -= column[k] * column[k];
        }
        taken[pivot] = true;
        factor.push(column);
    }
    (0..p).filter(|&k| !taken[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gram(columns: &[[f64; 6]]) -> Vec<f64> {
        let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        columns.iter().flat_map(|a| columns.iter().map(|b| dot(a, b)).collect::<Vec<_>>()).collect()
    }

    #[test]
    fn of_columns_that_make_each_other_all_but_one_are_kept() {
        let a = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let b = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
        let c: [f64; 6] = std::array::from_fn(|k| a[k] - 3.0 * b[k]);
        let d = [1e6, 0.0, 0.0, 0.0, 0.0, 0.0];
        let nothing = [0.0; 6];
        let over = undetermined(&gram(&[a, b, c, d, nothing]), 5);
        assert_eq!(over.len(), 2);
        assert!(over.contains(&4) && !over.contains(&3));
    }

    #[test]
    fn what_is_determined_is_kept_whatever_its_unit() {
        let columns: Vec<[f64; 6]> = (0..6)
            .map(|k| std::array::from_fn(|i| if i == k { 10f64.powi(k as i32 * 2 - 6) } else { 0.0 }))
            .collect();
        assert_eq!(undetermined(&gram(&columns), 6), Vec::<usize>::new());
        let rounding: [f64; 6] = std::array::from_fn(|i| 1e-16 * (i as f64 - 2.5));
        assert_eq!(undetermined(&gram(&[columns[0], columns[3], rounding]), 3), [2]);
    }
}
