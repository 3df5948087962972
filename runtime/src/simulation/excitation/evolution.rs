//! Separable CMA-ES: a derivative-free search whose cost grows linearly with the number of unknowns.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// The best point.
    pub point: Vec<f64>,
    /// Its value.
    pub value: f64,
}

/// Maximises `objective` from `start` with steps of size `step` in every unknown; at most
/// `evaluations` values are computed, and `progress` is told how many so far. Deterministic for a seed.
///
/// Ros and Hansen, A simple modification in CMA-ES achieving linear time and space complexity, 2008.
pub(crate) fn maximise(
    start: &[f64],
    step: f64,
    evaluations: usize,
    seed: u64,
    objective: &mut dyn FnMut(&[f64]) -> f64,
    progress: &mut dyn FnMut(usize),
) -> Found {
    let n = start.len();
    let mut best = Found { point: start.to_vec(), value: objective(start) };
    if n == 0 {
        return best;
    }
    let Strategy { offspring, weights, effective, cs, damping, cc, c1, cmu, expected } =
        Strategy::of(n as f64);

    let mut random = Pcg64::seed_from_u64(seed);
    let mut mean = start.to_vec();
    let mut sigma = step;
    let mut variance = vec![1.0; n];
    let (mut path_sigma, mut path_c) = (vec![0.0; n], vec![0.0; n]);
    let mut used = 1;
    while used + offspring <= evaluations {
        let mut population: Vec<(f64, Vec<f64>)> = (0..offspring)
            .map(|_| {
                let y: Vec<f64> = variance
                    .iter()
                    .map(|v: &f64| {
                        let z: f64 = StandardNormal.sample(&mut random);
                        z * v.sqrt()
                    })
                    .collect();
                let x: Vec<f64> = mean.iter().zip(&y).map(|(m, y)| m + sigma * y).collect();
                let value = objective(&x);
                if value > best.value {
                    best = Found { point: x, value };
                }
                (value, y)
            })
            .collect();
        used += offspring;
        progress(used);
        // A value that is not a number is the worst.
        population.sort_by(|a, b| rank(b.0).total_cmp(&rank(a.0)));
        for i in 0..n {
            let step: f64 = weights.iter().zip(&population).map(|(w, (_, y))| w * y[i]).sum();
            mean[i] += sigma * step;
            path_sigma[i] =
                (1.0 - cs) * path_sigma[i] + (cs * (2.0 - cs) * effective).sqrt() * step / variance[i].sqrt();
            path_c[i] = (1.0 - cc) * path_c[i] + (cc * (2.0 - cc) * effective).sqrt() * step;
            let spread: f64 = weights.iter().zip(&population).map(|(w, (_, y))| w * y[i] * y[i]).sum();
            variance[i] = (1.0 - c1 - cmu) * variance[i] + c1 * path_c[i] * path_c[i] + cmu * spread;
        }
        let length = path_sigma.iter().map(|x| x * x).sum::<f64>().sqrt();
        sigma *= (cs / damping * (length / expected - 1.0)).min(1.0).exp();
        if !(1e-12..1e12).contains(&sigma) {
            break;
        }
    }
    best
}

/// The constants of the strategy, by the names of the paper.
struct Strategy {
    /// Points of a generation.
    offspring: usize,
    /// Weights of the better half.
    weights: Vec<f64>,
    /// Effective number of parents.
    effective: f64,
    /// Learning rate of the path of the step size.
    cs: f64,
    /// Damping of the step size.
    damping: f64,
    /// Learning rate of the path of the variances.
    cc: f64,
    /// Learning rate of the variances from their path.
    c1: f64,
    /// Learning rate of the variances from the better half.
    cmu: f64,
    /// Expected length of a normal vector.
    expected: f64,
}

impl Strategy {
    /// For a number of unknowns.
    fn of(size: f64) -> Self {
        let offspring = 4 + (3.0 * size.ln()) as usize;
        let parents = offspring / 2;
        let raw: Vec<f64> =
            (0..parents).map(|k| (parents as f64 + 0.5).ln() - ((k + 1) as f64).ln()).collect();
        let sum: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
        let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let cs = (effective + 2.0) / (size + effective + 5.0);
        let damping = 1.0 + cs + 2.0 * (((effective - 1.0) / (size + 1.0)).sqrt() - 1.0).max(0.0);
        let cc = (4.0 + effective / size) / (size + 4.0 + 2.0 * effective / size);
        let separable = (size + 2.0) / 3.0;
        let c1 = (separable * 2.0 / ((size + 1.3) * (size + 1.3) + effective)).min(0.5);
        let cmu = (separable * 2.0 * (effective - 2.0 + 1.0 / effective)
            / ((size + 2.0) * (size + 2.0) + effective))
            .min(1.0 - c1);
        let expected = size.sqrt() * (1.0 - 1.0 / (4.0 * size) + 1.0 / (21.0 * size * size));
        Self { offspring, weights, effective, cs, damping, cc, c1, cmu, expected }
    }
}

fn rank(value: f64) -> f64 {
    if value.is_nan() { f64::NEG_INFINITY } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bowl(x: &[f64]) -> f64 {
        -x.iter().enumerate().map(|(k, v)| (k + 1) as f64 * (v - 0.3 * k as f64).powi(2)).sum::<f64>()
    }

    #[test]
    fn the_top_of_a_badly_scaled_bowl_is_found() {
        let found = maximise(&[5.0; 20], 1.0, 8000, 1, &mut |x| bowl(x), &mut |_| {});
        assert!(found.value > -1e-6, "{}", found.value);
    }

    #[test]
    fn the_same_seed_gives_the_same_digits() {
        let run = |seed| maximise(&[1.0; 8], 0.5, 500, seed, &mut |x| bowl(x), &mut |_| {});
        assert_eq!(run(4), run(4));
        assert_ne!(run(4), run(5));
    }
}
