//! Evidence that is measured by the variation that is there anyway: between units of the baseline, or between
//! stretches of the recording itself.
//!
//! A residual that is made white by an autoregression still differs from one stretch to the next by more than its own
//! memory tells: temperature, positions visited, what no column describes. How large the statistic Q of a law is where
//! nothing has changed is therefore measured: Q/k of the same law in every unit, each predicted from other motion,
//! has mean lambda; F = (Q/k) / lambda follows Fisher's distribution with k and as many degrees of freedom as lambda
//! has, as a random effect of the units would have it (Laird and Ware 1982). A dozen units know a lambda badly: it is
//! moderated by those of other laws on the same joint.

use crate::diagnosis::judging::changes::{changes_of_companions, of_kind, own_parts, prior, variance_of};
use crate::diagnosis::judging::compared::{Compared, undisturbed, with_other_units};
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::judging::uneven_noise::of_noise;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::wald::Wald;
use crate::diagnosis::judging::white_products::{Background, Products, WithLaw, sum};
use crate::diagnosis::rules::{LEVEL_OF_KIND, LEVEL_OF_SIGNS};
use crate::statistics::moderation::Variance;
use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal};

/// A law's statistic in the recording and its variation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Calibrated {
    /// Wald's statistic in a residual made white.
    pub squares: f64,
    /// Numbers of the law that the motion determines.
    pub numbers: usize,
    /// Mean of the statistic for each number where nothing has changed, at least 1.
    pub lambda: f64,
    /// Degrees of freedom that this mean is known with.
    pub freedom: f64,
    /// Where noise is not of one size: the share of the statistic that signs at random leave (`uneven_noise`).
    pub of_signs: Option<f64>,
    /// Part of the level that this test of two has; 1 where it is the only one.
    pub level: f64,
    /// Least Wald statistic where one unit of the recording is left out; 0 where the law then turns round.
    pub without_any: f64,
}

impl Calibrated {
    /// How sure it is that the law is there.
    pub fn evidence(&self) -> Evidence {
        self.of(self.squares)
    }

    /// How sure it is whichever unit of the recording is left out.
    pub fn evidence_without_any(&self) -> Evidence {
        self.of(self.without_any)
    }

    fn of(&self, squares: f64) -> Evidence {
        let mut by_variance = Evidence::fisher(squares / self.lambda, self.numbers, self.freedom);
        by_variance.p_value = (by_variance.p_value / self.level).min(1.0);
        let Some(share) = self.of_signs else { return by_variance };
        let by_signs = Evidence::fisher(squares * share, self.numbers, f64::INFINITY);
        // The better of two tests, which share the level (weighted Bonferroni; Genovese, Roeder and Wasserman 2006).
        let p_value =
            (by_variance.p_value / (1.0 - LEVEL_OF_SIGNS)).min(by_signs.p_value / LEVEL_OF_SIGNS).min(1.0);
        Evidence { p_value, ..by_variance }
    }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}

/// A law that is judged.
pub(in crate::diagnosis) struct Law<'a> {
    /// Its columns over all rows.
    pub columns: &'a [Vec<f64>],
    /// What the model with the law leaves.
    pub residual: &'a [f64],
    /// Whether it may be there in all motions, so that only what differs in the recording counts.
    pub common: bool,
    /// Whether it is a trend: a number of the model that changes with time.
    pub is_trend: bool,
    /// A trend of one joint is no more than an accident of how this number differs from unit to unit, which within one unit
    /// does not show. The first so many companions of its joint are the columns of such numbers.
    pub trend_of: usize,
}

/// Judges a law beside a model.
pub(in crate::diagnosis) fn calibrate(
    units: &Units,
    regressors: &Regressors<'_>,
    background: &Background,
    law: &Law<'_>,
) -> Option<Calibrated> {
    let WithLaw { products, whitening } = background.with(units, regressors, law.columns, law.residual);
    let (p, k, common) = (regressors.shared.len(), law.columns.len(), law.common);
    let change = units.change();
    let whole = products.whole(units, regressors, p + k);
    let part = judged_part(units, &products);
    let found = Wald::of(&whole, &part, (p, k), common && change)?;
    // Without a baseline the law is in all units, and in each it may be another.
    let common = common || !change;
    let m = if common { p + k } else { p };
    let of_units = |compared: Vec<Compared>| {
        let own: Vec<f64> = compared
            .iter()
            .flat_map(|c| c.units.iter().filter_map(|&u| c.wald(&products.units[u], (p, k))))
            .map(|wald| wald.mean())
            .collect();
        let others = changes_of_companions(&compared, (&products.units, products.companions), p + k);
        (compared, own, others)
    };
    let (mut compared, mut own, mut others) = of_units(undisturbed(units, &products, &whole, m));
    if change && own.is_empty() && others.iter().all(|changes| variance_of(changes).is_none()) {
        // One motion of a baseline alone that moves the joint is a baseline of one motion.
        (compared, own, others) = of_units(with_other_units(units, &products, m));
    }
    let levels: Vec<f64> = (others.iter().take(law.trend_of).filter_map(|changes| variance_of(changes)))
        .map(|v| v.value)
        .collect();
    // A level that differs from unit to unit remembers: a trend over a motion of n units is that of a random walk.
    let walk = |level: f64| 1.0 + (level - 1.0).max(0.0) * units.of_a_motion();
    let mut variance = Variance {
        value: mean(&own).max(if levels.is_empty() { 0.0 } else { walk(mean(&levels)) }),
        freedom: own.len().saturating_sub(1).max(1) as f64,
    };
    // A torque that no unit reaches says nothing of how a law of it differs between them: those of its kind do.
    let unseen = own.is_empty() && levels.is_empty();
    if (unseen || variance.value > 0.0)
        && let Some(own_parts) = own_parts(&compared[0], &compared[0].whole, (others.len(), p + k))
        && let Some(prior) = prior(&own_parts, &others)
    {
        let freedom = if unseen { 0.0 } else { variance.freedom };
        variance = prior.moderate(Variance { freedom, ..variance });
    }
    // What differs between units is constant within one: it grows with the motion that is looked at.
    let longer = if change { (units.target_duration / units.duration.max(1e-9)).max(1.0) } else { 1.0 };
    let own = Variance { value: 1.0 + (variance.value - 1.0).max(0.0) * longer, ..variance };
    let known = between_motions(regressors, law).filter(|between| between.value > own.value);
    let lambda = known.unwrap_or(own);
    let without_any = if law.is_trend && !change {
        without_any(&whole, &products.units, &found, (p, k))
    } else {
        found.squares
    };
    let (squares, numbers) = (found.squares, found.numbers);
    let by = |Variance { value: lambda, freedom }: Variance, level: f64| Calibrated {
        squares,
        numbers,
        lambda,
        freedom,
        of_signs: None,
        level,
        without_any,
    };
    // Units of a baseline may be much shorter than the recording. What all laws of the kind change by in that is another measure.
    let of_kind = (change && !law.is_trend)
        .then(|| of_kind((&whole, &part), products.companions, (p, k), common))
        .flatten();
    let between = match of_kind {
        Some(of_kind) => {
            let [units, kind] = [by(lambda, 1.0 - LEVEL_OF_KIND), by(of_kind, LEVEL_OF_KIND)];
            if kind.evidence().p_value < units.evidence().p_value { kind } else { units }
        }
        None => by(lambda, 1.0),
    };
    // Noise that is loud where the law is large leaves doubt that no other unit or law shows.
    let uneven = of_noise(units, regressors, law, (&found, &whitening)).map(|noise| Calibrated {
        lambda: noise.variance.value.max(1.0),
        freedom: noise.variance.freedom,
        of_signs: Some(noise.of_signs),
        level: 1.0,
        ..between
    });
    Some(uneven.filter(|uneven| uneven.evidence().p_value > between.evidence().p_value).unwrap_or(between))
}

/// What a law explains that another one in the model does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Beside {
    /// The same evidence with the other one in the model.
    pub evidence: Calibrated,
    /// Part of its torque that is still there: 1 where the two have nothing in common, below 0 where it has turned.
    pub kept: f64,
}

/// A law with another one in the model, given as its columns over all rows.
pub(in crate::diagnosis) fn beside(
    units: &Units,
    regressors: &Regressors<'_>,
    background: &Background,
    law: &Law<'_>,
    calibrated: &Calibrated,
    other: &[Vec<f64>],
) -> Option<Beside> {
    let (p, k, o) = (regressors.shared.len(), law.columns.len(), other.len());
    let both: Vec<Vec<f64>> = other.iter().chain(law.columns).cloned().collect();
    let products = background.with(units, regressors, &both, law.residual).products;
    let mut whole = products.whole(units, regressors, p + o + k);
    let part = judged_part(units, &products);
    let alone: Vec<usize> = (0..whole.nrows()).filter(|i| !(p..p + o).contains(i)).collect();
    let without = |m: &DMatrix<f64>| m.select_rows(&alone).select_columns(&alone);
    let common = law.common && units.change();
    let before = Wald::of(&without(&whole), &without(&part), (p, k), common)?;
    if units.change() {
        // A change is not there before it.
        for i in p..p + o {
            whole.set_row(i, &part.row(i));
            whole.set_column(i, &part.column(i));
        }
    }
    let found = Wald::of(&whole, &part, (p + o, k), common)?;
    let kept = before.product(&found.amplitude) / before.squares.max(f64::MIN_POSITIVE);
    let evidence = Calibrated { squares: found.squares, numbers: found.numbers, ..*calibrated };
    Some(Beside { evidence, kept })
}

/// Probability that a law is ahead of a rival by `ahead` squares only by accident.
///
/// Where one of two laws that are not nested is true, the difference of what they explain has a standard deviation of
/// at most twice the root of what the true one explains (Cox 1961; the two have nothing in common at worst), all in
/// units of the variation that is there anyway, that of the law which varies more.
pub(in crate::diagnosis) fn rival_p_value(law: &Calibrated, rival: &Calibrated, ahead: f64) -> f64 {
    let lambda = law.lambda.max(rival.lambda);
    let deviation = 2.0 * (lambda * law.squares).max(f64::MIN_POSITIVE).sqrt();
    Normal::standard().sf(ahead / deviation)
}

/// The part of the motion that a law is judged in: against a baseline the recording, else all of it.
fn judged_part(units: &Units, products: &Products) -> DMatrix<f64> {
    if units.change() { sum(&products.files, |f| units.is_target(f)) } else { sum(&products.units, |_| true) }
}

/// How much a model of the robot before knows a law to differ between motions: on the joint of it where that is most.
fn between_motions(regressors: &Regressors<'_>, law: &Law<'_>) -> Option<Variance> {
    let known = regressors.between_motions.iter().enumerate();
    let own = known.filter(|(j, _)| regressors.acts_on(law.columns, *j)).filter_map(|(_, v)| *v);
    own.max_by(|a, b| a.value.total_cmp(&b.value))
}

/// The least statistic of a law that was found in all of the motion, where one of its units is left out; 0 where it turns round
/// without one (deletion diagnostics: Cook 1977).
fn without_any(whole: &DMatrix<f64>, units: &[DMatrix<f64>], found: &Wald, (p, k): (usize, usize)) -> f64 {
    let of_rest = |unit: &DMatrix<f64>| {
        let rest = whole - unit;
        let left = Wald::of(&rest, &rest, (p, k), false)?;
        (left.product(&found.amplitude) > 0.0).then_some(left.squares)
    };
    units.iter().map(|unit| of_rest(unit).unwrap_or(0.0)).fold(found.squares, f64::min)
}

#[cfg(test)]
#[path = "calibration_tests.rs"]
mod tests;
