//! Essential parameters: the paper's elimination of what the data hardly determine.

use super::Factor;
use super::solve::back_substitute;

/// The unknowns that are left, and those that were cancelled in their order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Elimination {
    pub kept: Vec<usize>,
    pub cancelled: Vec<usize>,
}

/// Cancels the parameter with the largest relative standard deviation and solves again, until the largest is less
/// than `r_sigma` times the smallest (the paper's V.B, after Gautier 1991 and Pham and Gautier 1991).
///
/// `factor` has the unknowns `active`, whose columns are independent; `inflation` is by how much the standard deviation of
/// each is larger than (18) has it.
pub(super) fn eliminate(factor: &Factor, active: &[usize], r_sigma: f64, inflation: &[f64]) -> Elimination {
    let mut kept = active.to_vec();
    let mut cancelled = Vec::new();
    let mut inflation = inflation.to_vec();
    let mut reduced = factor.clone();
    while kept.len() > 1 {
        let (chi, variance) = back_substitute(&reduced);
        // The common factor sigma_rho does not change ratios.
        let relative: Vec<f64> = chi
            .iter()
            .zip(&variance)
            .zip(&inflation)
            .map(|((x, v), i)| if *x == 0.0 { f64::INFINITY } else { i * v.sqrt() / x.abs() })
            .collect();
        let smallest = relative.iter().copied().fold(f64::INFINITY, f64::min);
        let Some((worst, largest)) = relative.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
        else {
            break;
        };
        if largest < r_sigma * smallest {
            break;
        }
        cancelled.push(kept.remove(worst));
        inflation.remove(worst);
        let columns: Vec<usize> = (0..relative.len()).filter(|&l| l != worst).collect();
        reduced = reduced.select(&columns);
    }
    Elimination { kept, cancelled }
}
