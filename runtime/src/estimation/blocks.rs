//! Standard deviations that stand errors which last: the delete-one-block jackknife.

use super::observe::Observation;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Fewest blocks that say something about a spread.
const FEWEST: usize = 5;

/// Standard deviation of each active parameter from leaving out one block of time after the other.
///
/// chi without block b is chi - (WT W - W_bT W_b)^-1 W_bT e_b. The spread of these estimates, by the formula of the
/// grouped jackknife (Efron and Stein 1981; in regression known as CR3, MacKinnon and White 1985), allows any
/// correlation of the errors within a block and between joints; it tends to be on the large side. `None`: too few
/// blocks, or a block that alone determines a parameter.
pub(super) fn block_sigmas(
    observation: &Observation,
    active: &[usize],
    sigma: &[f64],
    chi: &[f64],
) -> Option<Vec<f64>> {
    let k = active.len();
    let mut place = vec![None; observation.unknowns.len()];
    for (p, &l) in active.iter().enumerate() {
        place[l] = Some(p);
    }
    let equations = observation.groups.iter().map(|g| g.equation + 1).max()?;
    let mut blocks = Vec::with_capacity(observation.blocks.len());
    let mut gram = DMatrix::<f64>::zeros(k, k);
    for block in &observation.blocks {
        let mut own = DMatrix::<f64>::zeros(k, k);
        let mut score = DVector::<f64>::zeros(k);
        let mut rows = 0;
        for equation in &block.equations {
            let factor = &equation.factor;
            if factor.rows() == 0 {
                continue;
            }
            rows += factor.rows();
            let weight = sigma[block.trajectory * equations + equation.equation].powi(-2);
            let columns: Vec<(usize, usize)> =
                equation.columns.iter().enumerate().filter_map(|(c, &u)| place[u].map(|p| (c, p))).collect();
            let values: Vec<f64> = equation.columns.iter().map(|&u| chi[u]).collect();
            let scores = factor.score(&values);
            for &(a, pa) in &columns {
                score[pa] += weight * scores[a];
                for &(b, pb) in columns.iter().filter(|&&(_, pb)| pb >= pa) {
                    let product: f64 = (0..=a.min(b)).map(|i| factor.r(i, a) * factor.r(i, b)).sum();
                    own[(pa, pb)] += weight * product;
                }
            }
        }
        own.fill_lower_triangle_with_upper_triangle();
        if rows > 0 {
            gram += &own;
            blocks.push((own, score));
        }
    }
    if blocks.len() < FEWEST {
        return None;
    }
    // Unit columns: what is inverted has the condition of the scaled W, squared.
    let scale = gram.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaling = DMatrix::from_diagonal(&scale);
    let mut spread = DVector::<f64>::zeros(k);
    for (own, score) in &blocks {
        let rest = &scaling * (&gram - own) * &scaling;
        let moved = Cholesky::new(rest)?.solve(&score.component_mul(&scale)).component_mul(&scale);
        spread += moved.component_mul(&moved);
    }
    let count = blocks.len() as f64;
    let sigmas: Vec<f64> = spread.iter().map(|s| (s * (count - 1.0) / count).sqrt()).collect();
    sigmas.iter().all(|s| s.is_finite()).then_some(sigmas)
}
