//! Variances that are known from few units each, moderated by those of their kind.
//!
//! A variance s2 of d degrees of freedom follows chi-squared around the true one; where the true ones of several
//! quantities scatter as a scaled inverse chi-squared of d0 degrees of freedom around s02, s2 / s02 follows Fisher's
//! distribution with d and d0 degrees of freedom, the best estimate of each true one is `(d0 s02 + d s2) / (d0 + d)`,
//! and a ratio over it follows Fisher's distribution with d0 + d degrees of freedom (Smyth 2004, sections 3 and 4).
//! Both d0 and s02 are those of the largest likelihood. (Smyth's own estimate, by moments of logarithms, looks at the
//! small variances most, which with few degrees of freedom say least.)

use statrs::function::gamma::ln_gamma;

/// A variance that is known from few units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Variance {
    pub value: f64,
    /// Degrees of freedom that it is known with.
    pub freedom: f64,
}

/// Where variances of a kind scatter around, and how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prior {
    pub variance: f64,
    /// Degrees of freedom that it is worth.
    pub freedom: f64,
}

impl Variance {
    /// The mean of squares, with the degrees of freedom that are left in them: rows less the trace of their part of the
    /// hat matrix. One without freedom counts for nothing.
    pub fn of_squares(sum: f64, freedom: f64) -> Self {
        Self { value: if freedom > 0.0 { sum / freedom } else { 0.0 }, freedom: freedom.max(0.0) }
    }
}

impl Prior {
    /// Of independent variances of groups. Where fewer than three can say how much they differ, all together are worth
    /// one degree of freedom: without it a group that its own rows do not determine would be believed to have no error.
    /// `None` where nothing is left in any group.
    pub fn of_groups(groups: &[Variance]) -> Option<Self> {
        let freedom: f64 = groups.iter().map(|g| g.freedom).sum();
        let sum: f64 = groups.iter().map(|g| g.freedom * g.value).sum();
        if !(sum > 0.0 && sum.is_finite() && freedom > 0.0) {
            return None;
        }
        Some(Self::of(groups, &|_, _| 0.0).unwrap_or(Self { variance: sum / freedom, freedom: 1.0 }))
    }

    /// Of variances that were seen, with the correlation of each two of them; none where fewer than three say anything.
    ///
    /// Variances that are correlated scatter less than their number says, and their mean is known as well as that of
    /// `count^2 / sum of correlations` independent ones, which is the most that it is worth.
    pub fn of(seen: &[Variance], correlation: &dyn Fn(usize, usize) -> f64) -> Option<Self> {
        let known: Vec<usize> = (0..seen.len())
            .filter(|&i| seen[i].value > 0.0 && seen[i].value.is_finite() && seen[i].freedom >= 1.0)
            .collect();
        if known.len() < 3 {
            return None;
        }
        let freedom = known.iter().map(|&i| seen[i].freedom).sum::<f64>() / known.len() as f64;
        let most = independent(known.len(), &|i, k| correlation(known[i], known[k])) * freedom;
        let known: Vec<Variance> = known.into_iter().map(|i| seen[i]).collect();
        let at = |freedom: f64| {
            let (variance, likelihood) = most_likely_variance(&known, freedom);
            (Self { variance, freedom }, likelihood)
        };
        // From the most on downwards, down to one degree of freedom: how many they are hardly matters more closely.
        let steps = (most.max(1.0).ln() / 1.3_f64.ln()).ceil() as i32;
        let all = (0..=steps).map(|k| at((most * 1.3_f64.powi(-k)).max(1.0)));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(prior, _)| prior)
    }

    /// A variance: its own and that of its kind, each by its degrees of freedom.
    pub fn moderate(&self, own: Variance) -> Variance {
        let sum = self.freedom + own.freedom;
        Variance { value: (self.freedom * self.variance + own.freedom * own.value) / sum, freedom: sum }
    }
}

/// As many independent variances have a mean that is known as well as that of so many which are correlated.
pub(crate) fn independent(count: usize, correlation: &dyn Fn(usize, usize) -> f64) -> f64 {
    let with = |i: usize| (0..count).map(|k| if i == k { 1.0 } else { correlation(i, k) }).sum::<f64>();
    let correlations: f64 = (0..count).map(with).sum();
    let count = count as f64;
    count * count / correlations.max(count)
}

/// What variances are in units of the mean squares of what they are errors of: lent to a quantity whose fit leaves less
/// than one degree of freedom. It does not tell its error, and would else be interpolated and outweigh all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lent {
    relative: f64,
}

impl Lent {
    /// Of variances, each with the mean square of what it is an error of.
    pub fn of(seen: impl Iterator<Item = (Variance, f64)>) -> Self {
        let relative: Vec<Variance> = seen
            .filter(|(_, mean_square)| *mean_square > 0.0)
            .map(|(v, mean_square)| Variance { value: v.value / mean_square, ..v })
            .collect();
        Self { relative: Prior::of_groups(&relative).map_or(0.0, |prior| prior.variance) }
    }

    /// A variance that is known with `freedom` degrees, with what it lacks to one of them.
    pub fn completed(self, value: f64, freedom: f64, mean_square: f64) -> f64 {
        if freedom < 1.0 { freedom * value + (1.0 - freedom) * self.relative * mean_square } else { value }
    }
}

/// The scale of the variances that is most likely where they scatter with so many degrees of freedom, and the
/// logarithm of its likelihood.
///
/// The slope of the likelihood by the logarithm of the scale falls throughout, and is zero between the smallest and the
/// largest variance: Newton's steps find it, and the middle where one of them would leave what is left of that range.
fn most_likely_variance(seen: &[Variance], freedom: f64) -> (f64, f64) {
    // With u = d/d0 s2/scale: the slope, and its own.
    let slopes = |ln_scale: f64| -> (f64, f64) {
        let per_scale = 1.0 / (freedom * ln_scale.exp());
        seen.iter().fold((0.0, 0.0), |(slope, bend), v| {
            let u = v.freedom * v.value * per_scale;
            let (half, part) = ((v.freedom + freedom) / 2.0, u / (1.0 + u));
            (slope + half * part - v.freedom / 2.0, bend - half * part / (1.0 + u))
        })
    };
    let values = seen.iter().map(|v| v.value.ln());
    let (mut low, mut high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let mut best = 0.5 * (low + high);
    for _ in 0..MOST_STEPS {
        let (slope, bend) = slopes(best);
        if slope > 0.0 {
            low = best
        } else {
            high = best
        }
        let newton = best - slope / bend;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let step = (next - best).abs();
        best = next;
        if step < NO_STEP {
            break;
        }
    }
    let likelihood = seen.iter().map(|v| ln_fisher(v.value.ln() - best, v.freedom, freedom) - best).sum();
    (best.exp(), likelihood)
}

/// A change of the logarithm of a variance that is none, and steps that are enough for it: Newton's double the digits, and
/// a dozen halvings lead to where they do.
const NO_STEP: f64 = 1e-10;
const MOST_STEPS: usize = 40;

/// Logarithm of Fisher's density at exp(`ln_x`).
fn ln_fisher(ln_x: f64, d: f64, d0: f64) -> f64 {
    ln_gamma((d + d0) / 2.0) - ln_gamma(d / 2.0) - ln_gamma(d0 / 2.0)
        + d / 2.0 * (d / d0).ln()
        + (d / 2.0 - 1.0) * ln_x
        - (d + d0) / 2.0 * (d / d0 * ln_x.exp()).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use rand::SeedableRng;
    use rand_distr::{ChiSquared, Distribution};
    use rand_pcg::Pcg64;

    const LOGPDF: [(f64, f64, f64, f64); 3] = [
        (0.3, 3.0, 8.0, -0.372747088475073),
        (1.7, 9.0, 40.0, -1.3937639318064328),
        (5.0, 4.0, 1.5, -3.4790863903787983),
    ];

    #[test]
    fn the_density_agrees_with_scipy() {
        // scipy.stats.f.logpdf(x, d, d0)
        for (x, d, d0, expected) in LOGPDF {
            assert_relative_eq!(ln_fisher(f64::ln(x), d, d0), expected, max_relative = 1e-9);
        }
    }

    #[test]
    fn scatter_of_true_variances_is_found_and_moderated_ones_come_nearer_to_them() {
        let mut rng = Pcg64::seed_from_u64(3);
        let (d, d0, s02) = (8.0, 12.0, 2.5);
        let inverse = ChiSquared::new(d0).expect("positive");
        let own = ChiSquared::new(d).expect("positive");
        let truth: Vec<f64> = (0..4000).map(|_| s02 * d0 / inverse.sample(&mut rng)).collect();
        let seen: Vec<Variance> =
            truth.iter().map(|v| Variance { value: v * own.sample(&mut rng) / d, freedom: d }).collect();
        let prior = Prior::of(&seen, &|_, _| 0.0).expect("many");
        assert!((prior.freedom - d0).abs() < 2.5, "{prior:?}");
        assert_relative_eq!(prior.variance, s02, max_relative = 0.05);
        let error = |guess: &dyn Fn(Variance) -> f64| -> f64 {
            seen.iter().zip(&truth).map(|(v, t)| (guess(*v) / t).ln().powi(2)).sum()
        };
        assert!(error(&|v| prior.moderate(v).value) < 0.6 * error(&|v| v.value));
    }

    #[test]
    fn variances_that_scatter_no_more_than_their_estimates_are_one_and_worth_their_independent_number() {
        let mut rng = Pcg64::seed_from_u64(4);
        let own = ChiSquared::new(9.0).expect("positive");
        let seen: Vec<Variance> =
            (0..6).map(|_| Variance { value: 4.0 + 0.01 * own.sample(&mut rng), freedom: 9.0 }).collect();
        let independent = Prior::of(&seen, &|_, _| 0.0).expect("six");
        assert_relative_eq!(independent.freedom, 54.0, max_relative = 1e-9);
        // Three pairs, alike within each.
        let pairs = Prior::of(&seen, &|i, k| f64::from(i / 2 == k / 2)).expect("six");
        assert_relative_eq!(pairs.freedom, 27.0, max_relative = 1e-9);
        assert_eq!(Prior::of(&seen[..2], &|_, _| 0.0), None);
    }

    #[test]
    fn a_group_without_freedom_has_the_variance_of_the_others() {
        let mut groups: Vec<Variance> =
            [30.0, 52.0, 41.0, 38.0].map(|s| Variance::of_squares(s, 40.0)).to_vec();
        groups.push(Variance::of_squares(1e-18, 1e-9));
        groups.push(Variance::of_squares(0.0, 0.0));
        let prior = Prior::of_groups(&groups).expect("groups");
        for last in &groups[4..] {
            assert_relative_eq!(prior.moderate(*last).value, 161.0 / 160.0, max_relative = 0.1);
        }
    }

    #[test]
    fn two_groups_lend_each_other_one_degree_of_freedom() {
        let groups = [Variance::of_squares(40.0, 40.0), Variance::of_squares(1e-20, 1e-6)];
        let prior = Prior::of_groups(&groups).expect("groups");
        assert_relative_eq!(prior.moderate(groups[1]).value, 1.0, max_relative = 1e-5);
    }

    #[test]
    fn what_leaves_no_freedom_has_the_relative_error_of_the_others() {
        let seen = [(4.0, 40.0, 100.0), (0.09, 30.0, 2.25), (1e-25, 1e-12, 25.0)];
        let seen = seen.map(|(value, freedom, square)| (Variance { value, freedom }, square));
        let lent = Lent::of(seen.into_iter());
        assert_relative_eq!(lent.completed(1e-25, 1e-12, 25.0), 1.0, max_relative = 1e-6);
        assert_relative_eq!(lent.completed(4.0, 40.0, 100.0), 4.0);
        assert_relative_eq!(lent.completed(3.0, 0.5, 25.0), 2.0, max_relative = 1e-6);
    }

    #[test]
    fn no_other_scale_is_more_likely() {
        let seen = [(0.004, 3.0), (1.0, 12.0), (2.5, 40.0), (9.0e4, 7.0)]
            .map(|(value, freedom)| Variance { value, freedom });
        for freedom in [1.0, 8.0, 300.0] {
            let (best, likelihood) = most_likely_variance(&seen, freedom);
            let at = |ln: f64| -> f64 {
                seen.iter().map(|v| ln_fisher(v.value.ln() - ln, v.freedom, freedom) - ln).sum()
            };
            assert_relative_eq!(likelihood, at(best.ln()), max_relative = 1e-12);
            let others = (-200..=400).map(|k| at(0.05 * f64::from(k)));
            assert!(others.fold(f64::NEG_INFINITY, f64::max) <= likelihood, "{freedom}: {best}");
            assert!(at(best.ln() + 1e-3) < likelihood && at(best.ln() - 1e-3) < likelihood, "{freedom}");
        }
    }

    #[test]
    fn nothing_left_is_no_variance() {
        assert_eq!(Prior::of_groups(&[Variance::of_squares(0.0, 3.0)]), None);
        assert_eq!(Prior::of_groups(&[]), None);
    }
}
