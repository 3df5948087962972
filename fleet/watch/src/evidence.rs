//! Evidence that a series has changed, day after day: an e-process.
//!
//! A bettor who starts with 1 divides it among the days on which a change may begin and the shapes that it may have. From
//! that day on each part is multiplied by how much better a model with this change has predicted the value than the
//! model of a robot that has not changed. Under "nothing has changed" no such ratio is expected to gain, so that the
//! sum exceeds 1/a on any day, ever, with a probability of at most a (Ville 1939; Ramdas, Grünwald, Vovk and Shafer,
//! Statistical Science 38 (2023)). Mixing over the day of the beginning makes an e-detector of Shin, Ramdas and Rinaldo
//! (New England J. Statistics in Data Science 2 (2024)) one whose false alarms are bounded for all time. The ratios are
//! bounded by outliers that both models expect (Huber 1965; Saha and Ramdas, Huber-robust likelihood ratio tests, 2024).
//!
//! That ratios do not gain holds as far as the predictions of the unchanged robot are as wide as they should be; that is
//! what simulations check.

use crate::Kind;
use crate::filter::{Estimated, Filter, Outliers, Reading};

/// Part of the capital that is for the comparison with the siblings.
pub(crate) const FOR_SIBLINGS: f64 = 0.1;
/// Days after which half of the capital for changes has been placed.
const HALF_PLACED: f64 = 30.0;
/// Part of the capital for changes that began while the series calibrated.
const FOR_CALIBRATION: f64 = 0.2;
/// Most starting days that are followed at a time; of old ones neighbours are followed as one.
const MOST_STARTS: usize = 48;

/// A shape that a change may have.
#[derive(Clone, Copy, Debug)]
struct Shape {
    kind: Kind,
    /// Prior standard deviation: of a step in standard deviations of the day-to-day variation, of a drift those a day.
    size: f64,
    /// Part of the capital of a starting day.
    part: f64,
    /// The first day is believed whatever it is and nothing is bet on it: jumps of any size are seen from the second on.
    believes_first: bool,
}

/// Steps of a few standard deviations, jumps beyond all proportion, wear of a standard deviation in a month or a week.
const SHAPES: [Shape; 4] = [
    Shape { kind: Kind::Step, size: 4.0, part: 0.3, believes_first: false },
    Shape { kind: Kind::Step, size: 1e6, part: 0.2, believes_first: true },
    Shape { kind: Kind::Drift, size: 0.05, part: 0.25, believes_first: false },
    Shape { kind: Kind::Drift, size: 0.3, part: 0.25, believes_first: false },
];

/// One model with a change.
#[derive(Clone, Debug)]
struct Bet {
    kind: Kind,
    start: i64,
    ln_capital: f64,
    /// Logarithm of the likelihood ratio since `start`, days of the calibration included, weighted by the shape's part.
    ln_ratio: f64,
    /// Days that this one stands for as a beginning.
    days: f64,
    filter: Filter,
    believes_next: bool,
}

impl Bet {
    /// How far the change has gone: 1 of a step, days of a drift.
    fn gone(&self, day: i64) -> f64 {
        match self.kind {
            Kind::Drift => (day - self.start).max(-1) as f64 + 1.0,
            Kind::Step | Kind::UnlikeSiblings => f64::from(u8::from(day >= self.start)),
        }
    }
}

/// What is known of a change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Began {
    pub(crate) kind: Kind,
    pub(crate) start: i64,
    /// Days that hold nine tenths of the likelihood of all starts of this kind.
    pub(crate) between: (i64, i64),
    /// Up to the last day.
    pub(crate) change: Estimated,
    pub(crate) before: Estimated,
}

/// The bettor on one series.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    unchanged: Filter,
    bets: Vec<Bet>,
    /// Capital that has not been placed.
    reserve: f64,
    days_watched: f64,
    /// Logarithm of the e-value of the comparison with the siblings.
    pub(crate) ln_siblings: f64,
    outlier_days: f64,
    day: i64,
    calibrating: bool,
}

impl Evidence {
    /// After the days of the calibration, on which nothing is bet. `calibration` must not be empty for a change during it
    /// to be seen.
    pub(crate) fn new(unchanged: Filter, calibration: &[Reading], outlier_days: f64) -> Self {
        let mut evidence = Self {
            unchanged,
            bets: Vec::new(),
            reserve: 1.0 - FOR_SIBLINGS,
            days_watched: 0.0,
            ln_siblings: 0.0,
            outlier_days,
            day: i64::MIN,
            calibrating: true,
        };
        // All days of the calibration are there at once: an outlier on its first day is told by those that follow.
        let screen = evidence.unchanged.clone().with_level_variance(0.0);
        let starts = [0, calibration.len() / 3, 2 * calibration.len() / 3];
        let capital = FOR_CALIBRATION * evidence.reserve;
        for (k, reading) in calibration.iter().enumerate() {
            // A step needs days before it.
            let drift_only = k == 0;
            if starts.contains(&k) {
                let each = 1.0 / starts.len() as f64;
                evidence.place(reading.day, capital * each, calibration.len() as f64 * each, drift_only);
            }
            let screened = screen
                .predict(reading, 0.0)
                .judge(reading.value, Outliers { fraction: outlier_days, centre: 0.0 })
                .1;
            evidence.learn(reading, screened);
        }
        evidence.reserve -= capital;
        evidence.calibrating = false;
        evidence
    }

    /// Bets on one more day and learns from it.
    pub(crate) fn observe(&mut self, reading: &Reading) {
        let before = HALF_PLACED / (HALF_PLACED + self.days_watched);
        self.days_watched += 1.0;
        let after = HALF_PLACED / (HALF_PLACED + self.days_watched);
        let capital = (1.0 - FOR_SIBLINGS) * (1.0 - FOR_CALIBRATION) * (before - after);
        self.reserve -= capital;
        self.place(reading.day, capital, 1.0, false);
        self.thin();
        self.learn(reading, 1.0);
    }

    /// Takes a day in with at most this weight.
    fn learn(&mut self, reading: &Reading, most: f64) {
        self.day = reading.day;
        self.unchanged.advance(reading.day);
        let prediction = self.unchanged.predict(reading, 0.0);
        let outliers = Outliers { fraction: self.outlier_days, centre: prediction.mean };
        let (ln_unchanged, weight) = prediction.judge(reading.value, outliers);
        self.unchanged.update(reading.value, &prediction, weight.min(most));
        for bet in &mut self.bets {
            let gone = bet.gone(reading.day);
            bet.filter.advance(reading.day);
            if std::mem::take(&mut bet.believes_next) {
                bet.filter.believe(reading, gone);
                continue;
            }
            let prediction = bet.filter.predict(reading, gone);
            let (ln_changed, weight) = prediction.judge(reading.value, outliers);
            bet.filter.update(reading.value, &prediction, weight.min(most));
            bet.ln_ratio += ln_changed - ln_unchanged;
            if !self.calibrating {
                bet.ln_capital += ln_changed - ln_unchanged;
            }
        }
    }

    /// Logarithm of the e-value: all capital, placed or not.
    pub(crate) fn ln_e_value(&self) -> f64 {
        let parts = self.bets.iter().map(|b| b.ln_capital);
        let rest = [self.reserve.max(0.0).ln(), FOR_SIBLINGS.ln() + self.ln_siblings];
        ln_sum(parts.chain(rest))
    }

    /// The filter of a robot that has not changed.
    pub(crate) fn unchanged(&self) -> &Filter {
        &self.unchanged
    }

    /// The filter that has predicted best: with the change that [`Self::began`] tells, or the unchanged one while there is
    /// no evidence.
    pub(crate) fn best(&self) -> &Filter {
        match self.strongest() {
            Some(bet) if self.ln_e_value() > 0.0 => &bet.filter,
            _ => &self.unchanged,
        }
    }

    /// The most likely change; `None` where the comparison with the siblings has the most capital, or nothing was placed.
    pub(crate) fn began(&self) -> Option<Began> {
        let bet = self.strongest()?;
        if FOR_SIBLINGS.ln() + self.ln_siblings > bet.ln_capital {
            return None;
        }
        let starts = self.starts(bet.kind);
        let gone = bet.gone(self.day);
        let change = bet.filter.change();
        Some(Began {
            kind: bet.kind,
            start: bet.start,
            between: central(&starts, 0.05),
            change: Estimated { mean: change.mean * gone, sigma: change.sigma * gone },
            before: bet.filter.level(),
        })
    }

    /// Of the kind with the most capital and its most likely start the most likely shape.
    fn strongest(&self) -> Option<&Bet> {
        let of = |kind: Kind| ln_sum(self.bets.iter().filter(|b| b.kind == kind).map(|b| b.ln_capital));
        let kind = if of(Kind::Drift) > of(Kind::Step) { Kind::Drift } else { Kind::Step };
        let start = self.starts(kind).into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
        self.bets
            .iter()
            .filter(|b| b.kind == kind && b.start == start)
            .max_by(|a, b| a.ln_ratio.total_cmp(&b.ln_ratio))
    }

    /// Starting days, the logarithm of their likelihood and the days they stand for, in ascending order.
    fn starts(&self, kind: Kind) -> Vec<(i64, f64, f64)> {
        let bets: Vec<&Bet> = self.bets.iter().filter(|b| b.kind == kind).collect();
        bets.chunk_by(|a, b| a.start == b.start)
            .map(|same| (same[0].start, ln_sum(same.iter().map(|b| b.ln_ratio)), same[0].days))
            .collect()
    }

    fn place(&mut self, day: i64, capital: f64, days: f64, drift_only: bool) {
        let shapes = || SHAPES.iter().filter(|s| !drift_only || s.kind == Kind::Drift);
        let parts: f64 = shapes().map(|s| s.part).sum();
        for shape in shapes() {
            self.bets.push(Bet {
                kind: shape.kind,
                start: day,
                ln_capital: (capital * shape.part / parts).ln(),
                ln_ratio: (shape.part / parts).ln(),
                days,
                filter: self.unchanged.with_change(shape.size),
                believes_next: shape.believes_first,
            });
        }
    }

    /// Where too many starting days are followed, the one that is nearest to its neighbours, for its age, hands its
    /// capital to the next one. Capital may be moved at any time; none is made.
    fn thin(&mut self) {
        let mut starts: Vec<i64> = self.bets.iter().map(|b| b.start).collect();
        starts.dedup();
        if starts.len() <= MOST_STARTS {
            return;
        }
        let newest = starts[starts.len() - 1];
        let crowding = |w: &[i64]| (w[2] - w[0]) as f64 / ((newest - w[1]) as f64 + 5.0);
        let Some(w) = starts.windows(3).min_by(|a, b| crowding(a).total_cmp(&crowding(b))) else { return };
        let (gone, heir) = (w[1], w[2]);
        let (left, mut kept): (Vec<Bet>, Vec<Bet>) =
            std::mem::take(&mut self.bets).into_iter().partition(|b| b.start == gone);
        for bet in left {
            let same = |b: &&mut Bet| b.start == heir && b.kind == bet.kind;
            if let Some(other) = kept.iter_mut().find(same) {
                other.ln_capital = ln_sum([other.ln_capital, bet.ln_capital]);
                other.days += bet.days;
            }
        }
        self.bets = kept;
    }
}

/// Logarithm of a sum of exponentials.
fn ln_sum(terms: impl IntoIterator<Item = f64>) -> f64 {
    let terms: Vec<f64> = terms.into_iter().collect();
    let largest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return largest;
    }
    largest + terms.iter().map(|t| (t - largest).exp()).sum::<f64>().ln()
}

/// Days between which all but `tail` on either side of the likelihood lies.
fn central(starts: &[(i64, f64, f64)], tail: f64) -> (i64, i64) {
    let weight = |s: &(i64, f64, f64)| s.1 + s.2.ln();
    let total = ln_sum(starts.iter().map(weight));
    let mut below = 0.0;
    let (mut from, mut to) = (starts.first().map_or(0, |s| s.0), starts.last().map_or(0, |s| s.0));
    for start in starts {
        let part = (weight(start) - total).exp();
        if below < tail && below + part >= tail {
            from = start.0;
        }
        if below < 1.0 - tail && below + part >= 1.0 - tail {
            to = start.0;
        }
        below += part;
    }
    (from, to)
}

#[cfg(test)]
#[path = "evidence_tests.rs"]
mod tests;
