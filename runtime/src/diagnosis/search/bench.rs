//! What evidence on the rows of a window is compared with: units of motion, and what the joints' torques repeat to.

use crate::diagnosis::candidates::nuisances::friction_columns;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::outcome::BetweenMotions;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::REPEATS;
use crate::statistics::moderation::Variance;
use std::ops::Range;
use std::sync::Arc;

/// Units of a design and the friction that is free in each of its motions.
#[derive(Clone)]
pub(in crate::diagnosis) struct Bench {
    pub units: Units,
    /// Columns of the design that are the recording's own friction, three for each joint; empty where only one recording is known.
    pub own_friction: Range<usize>,
    /// Friction columns of each joint on its rows; none where only one recording is known.
    pub friction: Vec<Vec<Vec<f64>>>,
    /// Those that are free in every motion: against a baseline all of them.
    pub free: Vec<Vec<Vec<f64>>>,
    /// Other laws of each joint, values on its rows, which tell how much laws of this joint vary.
    pub companions: Arc<Vec<Vec<Vec<f64>>>>,
    pub of_joint: Vec<Range<usize>>,
    /// How much a reference knows laws of each joint to differ between motions as long as the recording's, and friction.
    between_motions: Vec<Option<Variance>>,
    pub friction_between_motions: Vec<Option<Variance>>,
}

impl Bench {
    pub fn new(context: &Context<'_>, design: &Design, companions: Vec<Vec<Vec<f64>>>, change: bool) -> Self {
        let units = Units::of(design);
        let friction = |j| if change { friction_columns(context, design, j) } else { Vec::new() };
        let friction: Vec<Vec<Vec<f64>>> = (0..design.joints).map(friction).collect();
        // A baseline's own motions say it better.
        let known = context.reference.as_ref().filter(|_| !units.change());
        let known = known.map_or(&[][..], |reference| reference.between_motions());
        let (laws, friction_differs) = known
            .iter()
            .take(design.joints)
            .map(|joint| split(joint.as_ref(), units.target_duration))
            .unzip();
        Self {
            own_friction: design.columns.len() - if change { 3 * design.joints } else { 0 }
                ..design.columns.len(),
            free: if units.change() { friction.clone() } else { vec![Vec::new(); design.joints] },
            friction,
            companions: Arc::new(companions),
            of_joint: (0..design.joints).map(|j| design.of_joint(j)).collect(),
            between_motions: laws,
            friction_between_motions: friction_differs,
            units,
        }
    }

    /// What laws on the rows of a design are judged against.
    pub fn regressors<'b>(&'b self, design: &'b Design) -> Regressors<'b> {
        Regressors {
            shared: &design.columns,
            y: &design.y,
            free: &self.free,
            companions: &self.companions,
            of_joint: &self.of_joint,
            prior: design.prior.as_deref(),
            between_motions: &self.between_motions,
        }
    }

    /// Columns that are the recording's own viscous and Coulomb friction on a joint.
    pub fn own_friction_of(&self, joint: usize) -> Range<usize> {
        let first = self.own_friction.start + 3 * joint;
        first.min(self.own_friction.end)..(first + 2).min(self.own_friction.end)
    }

    /// What a law's own part (`change`) amounts to on the rows of a joint in the recording that is diagnosed, where it
    /// leaves `left`.
    fn size(&self, design: &Design, j: usize, change: &[f64], left: &[f64]) -> Size {
        let segments = design.target_segments().into_iter();
        let rows: Vec<usize> = segments.flat_map(|g| design.ranges[j][g].clone()).collect();
        let size = if self.units.change() {
            self.since_baseline(design, &rows, j, [change, left])
        } else {
            where_it_acts(&rows, change, left)
        };
        Size { needed: size.needed.max(f64::MIN_POSITIVE), ..size }
    }

    /// Against what the torques repeat to from day to day, or where this shows that they repeat better, to what is left
    /// that is no noise: what is the same two rows later, whose windows do not overlap.
    fn since_baseline(&self, design: &Design, rows: &[usize], j: usize, [change, left]: [&[f64]; 2]) -> Size {
        let count = rows.len().max(1) as f64;
        let rms = |x: &dyn Fn(usize) -> f64| (rows.iter().map(|&r| x(r) * x(r)).sum::<f64>() / count).sqrt();
        let units = &self.units;
        let of_target = |r: usize| {
            units.units.iter().zip(&units.rows[j]).any(|(unit, rows)| unit.target && rows.contains(&r))
        };
        let (mut products, mut pairs) = (0.0, 0_usize);
        for stretch in units.stretches[j].iter().filter(|s| of_target(s.start)) {
            for t in stretch.start + 2..stretch.end {
                products += left[t] * left[t - 2];
                pairs += 1;
            }
        }
        let slow = (products / pairs.max(1) as f64).max(0.0).sqrt();
        let least = rms(&|r| left[r]) / count.sqrt();
        let torque = rms(&|r| design.torque(r));
        Size { law: rms(&|r| change[r]), needed: (REPEATS * torque).min(slow.max(least)) }
    }

    /// The size of a law on the joint where it stands out most of these.
    pub fn largest_size(
        &self,
        design: &Design,
        joints: &[usize],
        change: &[f64],
        left: &[f64],
    ) -> Option<Size> {
        let sizes = joints.iter().map(|&j| self.size(design, j, change, left));
        sizes.max_by(|a, b| (a.law / a.needed).total_cmp(&(b.law / b.needed)))
    }
}

/// Mean statistics of laws and of friction in motions of a duration (s), from those of stretches: what differs between
/// motions is constant within one, and grows with it.
fn split(joint: Option<&BetweenMotions>, duration: f64) -> (Option<Variance>, Option<Variance>) {
    let Some(known) = joint else { return (None, None) };
    let longer = (duration / known.stretch).max(1.0);
    let of = |value: f64, freedom| Some(Variance { value: 1.0 + (value - 1.0).max(0.0) * longer, freedom });
    (of(known.laws, known.laws_freedom), of(known.friction, known.friction_freedom))
}

/// Against what is left where the law acts: both are means over rows that count by the law's own squares, so that one which
/// acts near rest or in bursts is not diluted by all other motion.
fn where_it_acts(rows: &[usize], change: &[f64], left: &[f64]) -> Size {
    let squares: f64 = rows.iter().map(|&r| change[r] * change[r]).sum();
    let mean = |x: &[f64]| {
        let sum: f64 = rows.iter().map(|&r| (change[r] * x[r]).powi(2)).sum();
        if squares > 0.0 { (sum / squares).sqrt() } else { 0.0 }
    };
    Size { law: mean(change), needed: mean(left) }
}

/// How large a law is on the joint where it stands out most, N.m or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Size {
    /// Root mean square of what nothing else can make of it; without a baseline where it acts.
    pub law: f64,
    /// How large it must be to be named: what the joint's torques repeat to; without a baseline what stays of them where the
    /// law acts.
    pub needed: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const ROWS: usize = 400;

    fn every(first: usize, step: usize, value: f64) -> Vec<f64> {
        (0..ROWS).map(|r| if r % step == first { value } else { 0.0 }).collect()
    }

    #[test]
    fn a_law_that_acts_all_the_time_has_its_root_mean_square_and_so_has_what_it_leaves() {
        let rows: Vec<usize> = (0..ROWS).collect();
        let size = where_it_acts(&rows, &vec![0.3; ROWS], &every(0, 4, 1.0));
        assert_relative_eq!(size.law, 0.3, max_relative = 1e-12);
        assert_relative_eq!(size.needed, 0.5, max_relative = 1e-12);
    }

    #[test]
    fn a_law_in_bursts_is_not_diluted_by_motion_in_which_it_does_not_act() {
        let rows: Vec<usize> = (0..ROWS).collect();
        let noise: Vec<f64> = (0..ROWS).map(|r| if (r / 20) % 2 == 0 { 0.6 } else { -0.6 }).collect();
        let size = where_it_acts(&rows, &every(3, 20, 1.0), &noise);
        assert_relative_eq!(size.law, 1.0, max_relative = 1e-12);
        assert_relative_eq!(size.needed, 0.6, max_relative = 1e-12);
    }

    #[test]
    fn what_stays_where_a_law_does_not_act_does_not_count_against_it() {
        let rows: Vec<usize> = (0..ROWS).collect();
        let size = where_it_acts(&rows, &every(3, 20, 1.0), &every(4, 20, 50.0));
        assert_relative_eq!(size.needed, 0.0);
    }

    #[test]
    fn a_law_that_is_nothing_has_no_size() {
        let size = where_it_acts(&[0, 1], &[0.0, 0.0], &[1.0, 1.0]);
        assert_eq!((size.law, size.needed), (0.0, 0.0));
    }
}
