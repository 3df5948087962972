//! The skew of the torques behind the positions: measured before anything else, and how well it is known.

use crate::diagnosis::candidates::trial::delay_columns;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{DELAY_DEVIATION, LONGEST_BLOCK};

/// Skew of the torques behind the positions.
pub(in crate::diagnosis) struct Skew {
    /// s.
    pub value: f64,
    /// Its standard deviation, s: that of the fit, or as blocks of motion differ, whichever is larger.
    pub sigma: f64,
    pub evidence: Evidence,
    /// Degrees of freedom of that standard deviation.
    freedom: f64,
}

/// How much skews differ between motions, beyond the errors that they are known with, and how well their mean is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct BetweenMotions {
    /// Of sampling, s²: a motion begins anywhere within a sample of the clock of the torques.
    of_sampling: f64,
    /// Of everything else, s².
    variance: f64,
    /// Of their mean by the errors that they are known with, s²: slow motions hardly show a skew.
    of_mean: f64,
    motions: usize,
}

impl Skew {
    /// Of the motions that are wanted, in a design without a column for it.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn of(
        context: &Context<'_>,
        design: Design,
        wanted: impl Fn(usize) -> bool,
    ) -> Result<Self, SingularDesign> {
        let alike = vec![1.0; design.joints];
        Self::beyond(0.0, context, (design, &alike), wanted)
    }

    /// Of the recording beside its baseline, as well known as what its motions say beyond all others: `before` has been taken out
    /// of them, on a design that has everything but a skew of theirs.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn of_target(
        context: &Context<'_>,
        (design, sigma): (&Design, &[f64]),
        before: f64,
    ) -> Result<Self, SingularDesign> {
        Self::beyond(before, context, (design.clone(), sigma), |k| context.signals[k].is_target)
    }

    /// All of a skew of which so much has been taken out of the motions that are wanted.
    fn beyond(
        before: f64,
        context: &Context<'_>,
        (mut design, sigma): (Design, &[f64]),
        wanted: impl Fn(usize) -> bool,
    ) -> Result<Self, SingularDesign> {
        for column in delay_columns(context, &design, wanted) {
            design.push(column);
        }
        design.refresh();
        let fit = Fit::weighted(&design, sigma)?;
        let column = design.columns.len() - 1;
        Ok(Self::known(before + fit.chi[column], (&design, &fit), column))
    }

    /// A skew that is known as well as the parameter of a column is.
    pub fn known(value: f64, (design, fit): (&Design, &Fit), column: usize) -> Self {
        let white = fit.variances()[column].max(0.0);
        let rows = design.rows_within(LONGEST_BLOCK);
        let by_blocks = fit.variance_by_blocks(design, &fit.residual(design), column, rows);
        let (variance, widened, freedom) = match by_blocks {
            Some(seen) => (white.max(seen.variance), white.max(seen.widened()), seen.freedom),
            None => (white, white, f64::INFINITY),
        };
        let evidence = Evidence::student(value.abs() / variance.sqrt().max(1e-300), freedom);
        Self { value, sigma: widened.sqrt(), evidence, freedom }
    }

    /// The same as the difference from motions whose own skews differ so much: another motion of that kind would have another
    /// one too, and the mean of few is not known better. Degrees of freedom by Satterthwaite (1946). What sampling makes of it has
    /// bounds, which no normal number has.
    pub fn beside(self, others: BetweenMotions) -> Self {
        let n = (others.motions as f64).max(1.0);
        let beside_mean = 1.0 + 1.0 / n;
        let own = self.sigma * self.sigma;
        let between = others.variance * beside_mean;
        let unbounded = own + others.of_mean + between;
        let uncertain = own * own / self.freedom + between * between / (n - 1.0).max(1.0);
        let freedom = unbounded * unbounded / uncertain;
        let beyond = |of_sampling: f64| {
            let left = self.value.abs() - of_sampling;
            Evidence::student(left / unbounded.sqrt().max(1e-300), freedom).p_value
        };
        let by_sampling = DifferenceBySampling::new((3.0 * others.of_sampling).sqrt(), others.motions.max(1));
        let p_value = by_sampling.parts().map(|(of_sampling, part)| part * beyond(of_sampling)).sum();
        let sigma = (unbounded + others.of_sampling * beside_mean).sqrt();
        let significance = self.value.abs() / sigma.max(1e-300);
        Self { sigma, evidence: Evidence { significance, p_value, comparisons: 1 }, freedom, ..self }
    }

    /// One minus the probability that there is none and it comes as far, in one direction or the other.
    pub fn confidence(&self) -> f64 {
        self.evidence.confidence(2)
    }

    /// What is to be expected of all skew, s, where so much of it was taken out of the motions before and skews are zero within
    /// a standard deviation of so much: the best linear prediction, next to nothing where a skew is hardly known.
    pub fn expected(&self, before: f64, deviation: f64) -> f64 {
        let known = deviation * deviation / (deviation * deviation + self.sigma * self.sigma);
        known * (before + self.value)
    }
}

impl BetweenMotions {
    /// Of the motions of a baseline, on a design that has everything but skews of theirs.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn of_baseline(
        context: &Context<'_>,
        (design, sigma): (&Design, &[f64]),
    ) -> Result<Self, SingularDesign> {
        let baseline = (0..context.signals.len()).filter(|&k| !context.signals[k].is_target);
        let mut design = design.clone();
        let first = design.columns.len();
        for k in baseline {
            for column in delay_columns(context, &design, |motion| motion == k) {
                design.push(column);
            }
        }
        design.refresh();
        let fit = Fit::weighted(&design, sigma)?;
        let seen = (first..design.columns.len()).filter(|&c| design.columns[c].iter().any(|x| *x != 0.0));
        let skews: Vec<Skew> = seen.map(|c| Skew::known(fit.chi[c], (&design, &fit), c)).collect();
        Ok(Self::of(&skews, 1.0 / context.rate()))
    }

    /// The same where the mean is known no better than this, s: a model of these motions knows it so.
    pub fn known_to(self, deviation: f64) -> Self {
        Self { of_mean: self.of_mean.max(deviation * deviation), ..self }
    }

    /// Of skews with their own errors, by moments (DerSimonian and Laird 1986), at so many seconds a `sample`.
    fn of(skews: &[Skew], sample: f64) -> Self {
        let (motions, of_sampling) = (skews.len(), sample * sample / 12.0);
        let n = motions as f64;
        let mean = skews.iter().map(|s| s.value).sum::<f64>() / n;
        let spread = skews.iter().map(|s| (s.value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let own = skews.iter().map(|s| s.sigma * s.sigma).sum::<f64>() / n;
        // A single motion says nothing of how motions differ.
        let variance = if motions < 2 { 0.0 } else { (spread - own - of_sampling).max(0.0) };
        Self { of_sampling, variance, of_mean: own / n, motions }
    }
}

/// Parts that the range of a difference by sampling is cut into. Numerics: the last holds a twenty thousandth of all.
const PARTS: usize = 200;

/// Difference of the place of a motion within a sample from the mean of those of others: a sum of uniform numbers. The mean of more
/// than six is that of six of its variance.
struct DifferenceBySampling {
    /// Half of the range of each.
    halves: Vec<f64>,
}

impl DifferenceBySampling {
    /// Where each place is within `half` of its middle.
    fn new(half: f64, others: usize) -> Self {
        let numbers = others.min(6);
        let of_each = half / ((numbers * others) as f64).sqrt();
        Self { halves: std::iter::once(half).chain(vec![of_each; numbers]).collect() }
    }

    /// Probability that it is below x: the corners of a box that lie below a plane, each with its pyramid.
    fn below(&self, x: f64) -> f64 {
        let count = self.halves.len();
        let corner = |signs: usize| {
            let negative = |i: usize| signs >> i & 1 == 1;
            let at: f64 =
                (0..count).map(|i| if negative(i) { -self.halves[i] } else { self.halves[i] }).sum();
            let sign = if signs.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * (x + at).max(0.0).powi(count as i32)
        };
        let scale: f64 = self.halves.iter().zip(1..).map(|(half, k)| 2.0 * half * f64::from(k)).product();
        (0..1 << count).map(corner).sum::<f64>() / scale
    }

    /// Middles of equal parts of its range, each with its probability.
    fn parts(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let most: f64 = self.halves.iter().sum();
        let at = move |k: usize| most * ((2 * k) as f64 / PARTS as f64 - 1.0);
        (0..PARTS).map(move |k| (0.5 * (at(k) + at(k + 1)), self.below(at(k + 1)) - self.below(at(k))))
    }
}

/// Standard deviation of skews before anything is known of one, s.
pub(in crate::diagnosis) fn usual_deviation(context: &Context<'_>) -> f64 {
    DELAY_DEVIATION.max(1.0 / context.rate())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// A skew of noise that lasts as long as a block, of which the column has the same memory.
    fn of_noise(rng: &mut Pcg64) -> Skew {
        const ROWS: usize = 600;
        let (column, y) = (correlated(rng, ROWS, 0.9), correlated(rng, ROWS, 0.9));
        let design = Design::made_up(1, &[(0, true)], ROWS, vec![column], y);
        let fit = Fit::whole(&design, &[1.0]).expect("a small problem is regular");
        Skew::known(fit.chi[0], (&design, &fit), 0)
    }

    #[test]
    fn noise_that_lasts_is_no_certain_skew() {
        let mut rng = Pcg64::seed_from_u64(41);
        let (runs, level) = (2000, 0.01);
        let told = (0..runs).filter(|_| of_noise(&mut rng).confidence() > 1.0 - level).count();
        println!("{told} of {runs}");
        assert!(told as f64 <= 2.5 * level * f64::from(runs), "{told} of {runs}");
    }

    #[test]
    fn of_a_skew_that_is_hardly_known_next_to_nothing_is_expected() {
        let known = |sigma| Skew { value: 0.02, sigma, evidence: Evidence::NONE, freedom: 30.0 };
        approx::assert_relative_eq!(known(1e-6).expected(0.01, 0.01), 0.03, max_relative = 1e-6);
        approx::assert_relative_eq!(known(0.01).expected(0.0, 0.01), 0.01, max_relative = 1e-12);
        assert!(known(1.0).expected(0.0, 0.01) < 1e-5);
    }

    #[test]
    fn a_skew_is_news_only_beyond_how_skews_differ_between_motions() {
        let one = |value: f64| {
            let evidence = Evidence::student(value / 1e-4, 30.0);
            Skew { value, sigma: 1e-4, evidence, freedom: 30.0 }
        };
        const SAMPLE: f64 = 1e-3;
        let alike = BetweenMotions::of(&[one(0.001), one(0.001), one(0.001), one(0.001)], SAMPLE);
        assert!(one(0.004).beside(alike).sigma < 0.5 * SAMPLE);
        let differing = BetweenMotions::of(&[one(-0.002), one(0.001), one(0.003), one(-0.002)], SAMPLE);
        let told = one(0.004).beside(differing);
        assert!(one(0.004).confidence() > 0.999 && told.confidence() < 0.9, "{}", told.confidence());
        // Nor where nobody knows what it was before.
        assert!(one(0.004).beside(alike.known_to(0.003)).confidence() < 0.9);
        assert!(one(0.1).beside(differing).confidence() > 0.999);
        // Of what one motion, or two that are alike, do not say sampling is known.
        for few in [&[one(0.001)][..], &[one(0.001), one(0.0012)]] {
            let few = BetweenMotions::of(few, SAMPLE);
            assert!(one(0.007).beside(few).confidence() > 0.999);
            assert!(one(0.0005).beside(few).confidence() < 0.9);
            // Sampling alone never makes more than a sample.
            assert!(one(0.0008).beside(few).confidence() < 0.99);
            assert!(one(0.0015).beside(few).confidence() > 0.999);
        }
    }

    #[test]
    fn differences_by_sampling_are_all_and_have_the_variance_of_their_parts() {
        for others in 1..6 {
            let by_sampling = DifferenceBySampling::new(0.5, others);
            let sum = |of: fn(f64) -> f64| by_sampling.parts().map(|(x, part)| part * of(x)).sum::<f64>();
            approx::assert_relative_eq!(sum(|_| 1.0), 1.0, max_relative = 1e-9);
            let variance = (1.0 + 1.0 / others as f64) / 12.0;
            approx::assert_relative_eq!(sum(|x| x * x), variance, max_relative = 1e-3);
        }
    }

    #[test]
    fn skews_that_differ_as_motions_begin_within_a_sample_are_no_news() {
        let mut rng = Pcg64::seed_from_u64(42);
        let (runs, level) = (20_000, 1e-3);
        let mut told_beside = |motions: usize| -> bool {
            let mut one = || {
                let value = rng.random_range(-0.5e-3..0.5e-3);
                Skew {
                    value,
                    sigma: 1e-5,
                    evidence: Evidence::student(value.abs() / 1e-5, 30.0),
                    freedom: 30.0,
                }
            };
            let baseline: Vec<Skew> = (0..motions).map(|_| one()).collect();
            let mean = baseline.iter().map(|s| s.value).sum::<f64>() / motions as f64;
            let new = one();
            let new = Skew { value: new.value - mean, ..new };
            new.beside(BetweenMotions::of(&baseline, 1e-3)).confidence() > 1.0 - level
        };
        for motions in [1, 2, 3, 10] {
            let told = (0..runs).filter(|_| told_beside(motions)).count();
            println!("{told} of {runs} beside {motions}");
            // The level, and three deviations of a count.
            let expected = level * f64::from(runs);
            assert!(told as f64 <= expected + 3.0 * expected.sqrt(), "{told} of {runs} beside {motions}");
        }
    }
}
