//! Which series are alarmed: online control of false discoveries over robots, parameters and days.
//!
//! Each series is one hypothesis, "nothing has changed so far", with an e-process and a weight; the weights of all series
//! that may ever come sum to at most 1. Every day the weighted e-BH procedure is applied (Wang and Ramdas, JRSS-B 84 (2022);
//! online with such weights: Fischer, Xu and Ramdas, arXiv:2407.20683): the largest k series with
//! weight * e >= 1 / (k * level). Evidence of an alarmed series is frozen, so that alarms are never taken back.
//!
//! Why the false discovery rate of all alarms up to any day, a random one included, is at most the level: a stopped
//! e-process is an e-process; with V false ones among R alarms each has 1 <= level * R * weight * e, so that
//! V / R <= level * (sum of weight * e over series in which nothing has changed), and the expectation of this sum at any
//! stopping time is at most 1. Dependence between series is of no account, as long as each is an e-process with respect to
//! the past of all.

/// Part of the weight that is for series that are there before the first alarm is possible; the rest is for all that come
/// later.
const FOUNDERS: f64 = 0.8;

/// Weight of a series, given out as they come.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weights {
    founders: f64,
    known: f64,
}

impl Weights {
    /// Logarithm of the weight of each of `count` series that are new on one day; the first call is for the founders.
    ///
    /// Of later ones the k-th series of all has the part n / (k (k - 1)), n founders: it sums to 1 over all k > n. Those of
    /// one day share theirs.
    pub(crate) fn next(&mut self, count: usize) -> f64 {
        let new = count.max(1) as f64;
        if self.known == 0.0 {
            self.founders = new;
            self.known = new;
            return (FOUNDERS / new).ln();
        }
        let before = self.known;
        self.known += new;
        ((1.0 - FOUNDERS) * self.founders * (1.0 / before - 1.0 / self.known) / new).ln()
    }
}

/// Number of series that e-BH rejects and the logarithm of weight * e that they reach, from those of all series.
pub(crate) fn rejected(ln_weighted: &[f64], level: f64) -> (usize, f64) {
    let mut sorted: Vec<f64> = ln_weighted.iter().copied().filter(|e| !e.is_nan()).collect();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let least = |k: usize| -(k as f64 * level).ln();
    let count = (1..=sorted.len()).rev().find(|&k| sorted[k - 1] >= least(k)).unwrap_or(0);
    (count, if count > 0 { least(count) } else { f64::INFINITY })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_at_most_one_however_many_robots_come() {
        let mut weights = Weights::default();
        let total: f64 =
            [1000, 1, 50, 3000, 1, 100_000].iter().map(|&n| n as f64 * weights.next(n).exp()).sum();
        assert!(total <= 1.0 + 1e-12 && total > 0.9, "{total}");
    }

    #[test]
    fn more_alarms_ask_for_less_evidence_each() {
        let one = [200.0_f64.ln(), 0.0, 0.0];
        assert_eq!(rejected(&one, 0.01).0, 1);
        let two = [60.0_f64.ln(), 55.0_f64.ln(), 0.0];
        assert_eq!(rejected(&two, 0.01).0, 2);
        assert_eq!(rejected(&[60.0_f64.ln(), 0.0], 0.01).0, 0);
        assert_eq!(rejected(&[], 0.05).0, 0);
    }
}
