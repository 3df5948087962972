//! Variances of many groups that lend each other degrees of freedom.

use super::gamma::{digamma, inverse_trigamma, trigamma};

/// A group with fewer degrees of freedom says nothing about how much the groups differ.
const TELLING: f64 = 1.0;
/// Fewest groups that say how much they differ.
const FEWEST: usize = 3;
/// What all groups together say counts as one degree of freedom at least: without a bound a group that its own rows
/// do not determine would be believed to have no error.
const LEAST_PRIOR: f64 = 1.0;

/// The sum of squares of a group, and the degrees of freedom that are left in it: rows less the trace of its part of
/// the hat matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimation) struct Squares {
    pub sum: f64,
    pub freedom: f64,
}

/// What the groups have in common: the scaled inverse chi-squared distribution that their variances come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimation) struct Prior {
    pub variance: f64,
    /// What the groups together count as, in degrees of freedom; infinite where they do not differ.
    pub freedom: f64,
}

impl Prior {
    /// From the groups' mean squares, by the moments of their logarithms (Smyth 2004, Statistical Applications in
    /// Genetics and Molecular Biology 3, section 6.2). Where too few groups have freedom left to tell how much they
    /// differ, the prior is the pooled variance. `None` where nothing is left in any group.
    pub fn of(groups: &[Squares]) -> Option<Prior> {
        let sum: f64 = groups.iter().map(|g| g.sum).sum();
        let all: f64 = groups.iter().map(|g| g.freedom.max(0.0)).sum();
        if !(sum > 0.0 && all > 0.0) {
            return None;
        }
        let pooled = Prior { variance: sum / all, freedom: LEAST_PRIOR };
        let telling: Vec<&Squares> = groups.iter().filter(|g| g.freedom >= TELLING && g.sum > 0.0).collect();
        if telling.len() < FEWEST {
            return Some(pooled);
        }
        // The logarithm of chi-squared over its freedom d has the mean psi(d/2) - ln(d/2).
        let offset = |d: f64| digamma(0.5 * d) - (0.5 * d).ln();
        let logs: Vec<f64> = telling.iter().map(|g| (g.sum / g.freedom).ln() - offset(g.freedom)).collect();
        let count = telling.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let scatter = logs.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let by_chance = telling.iter().map(|g| trigamma(0.5 * g.freedom)).sum::<f64>() / count;
        let excess = scatter - by_chance;
        if excess <= 0.0 {
            return Some(Prior { freedom: f64::INFINITY, ..pooled });
        }
        let freedom = 2.0 * inverse_trigamma(excess);
        let variance = (mean + offset(freedom)).exp();
        Some(Prior { variance, freedom: freedom.max(LEAST_PRIOR) })
    }

    /// The variance of a group: its own and the prior's, each by its degrees of freedom.
    pub fn moderate(&self, group: Squares) -> f64 {
        if self.freedom.is_infinite() {
            return self.variance;
        }
        let own = group.freedom.max(0.0);
        (self.freedom * self.variance + group.sum) / (self.freedom + own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{ChiSquared, Distribution};
    use rand_pcg::Pcg64;

    /// Groups of `freedom` whose variances are 2 times `degrees` over a chi-squared of `degrees`.
    fn drawn(count: usize, freedom: f64, degrees: Option<f64>) -> Vec<Squares> {
        let mut random = Pcg64::seed_from_u64(4);
        let own = ChiSquared::new(freedom).expect("positive");
        (0..count)
            .map(|_| {
                let variance = degrees
                    .map_or(2.0, |d| 2.0 * d / ChiSquared::new(d).expect("positive").sample(&mut random));
                Squares { sum: variance * own.sample(&mut random), freedom }
            })
            .collect()
    }

    #[test]
    fn the_prior_that_variances_were_drawn_from_is_found() {
        let prior = Prior::of(&drawn(4000, 6.0, Some(8.0))).expect("groups");
        assert!((prior.freedom - 8.0).abs() < 0.8 && (prior.variance - 2.0).abs() < 0.1, "{prior:?}");
    }

    #[test]
    fn groups_that_do_not_differ_share_one_variance() {
        let groups = drawn(4000, 6.0, None);
        let prior = Prior::of(&groups).expect("groups");
        assert!(prior.freedom > 200.0 && (prior.moderate(groups[0]) - 2.0).abs() < 0.2, "{prior:?}");
    }

    #[test]
    fn a_group_without_freedom_has_the_variance_of_the_others() {
        let mut groups = drawn(5, 40.0, None);
        groups.push(Squares { sum: 1e-18, freedom: 1e-9 });
        let prior = Prior::of(&groups).expect("groups");
        assert!(prior.moderate(groups[5]) > 0.5);
    }

    #[test]
    fn nothing_left_is_no_variance() {
        assert_eq!(Prior::of(&[Squares { sum: 0.0, freedom: 3.0 }]), None);
        assert_eq!(Prior::of(&[]), None);
    }
}
