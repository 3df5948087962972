//! What evidence on the rows of a window is compared with: units of motion, and what the joints' torques repeat to.

use crate::diagnosis::candidates::nuisances::friction_columns;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::white_products::Regressors;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{LEAST_PART_OF_REMAINS, REPEATS};
use std::ops::Range;
use std::sync::Arc;

/// Units of a design and the friction that is free in each of its motions.
#[derive(Clone)]
pub(in crate::diagnosis) struct Bench {
    pub units: Units,
    /// Columns of the design that are the recording's own friction, three for each joint; empty without a baseline.
    pub own_friction: Range<usize>,
    /// Friction columns of each joint on its rows; none where there is no baseline.
    pub free: Vec<Vec<Vec<f64>>>,
    /// Other laws of each joint, values on its rows, which tell how much laws of this joint vary.
    pub companions: Arc<Vec<Vec<Vec<f64>>>>,
    pub of_joint: Vec<Range<usize>>,
}

impl Bench {
    pub fn new(context: &Context<'_>, design: &Design, companions: Vec<Vec<Vec<f64>>>) -> Self {
        let units = Units::of(design);
        let change = units.change();
        let free = |j| if change { friction_columns(context, design, j) } else { Vec::new() };
        Self {
            own_friction: design.columns.len() - if change { 3 * design.joints } else { 0 }
                ..design.columns.len(),
            free: (0..design.joints).map(free).collect(),
            companions: Arc::new(companions),
            of_joint: (0..design.joints).map(|j| design.of_joint(j)).collect(),
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
        }
    }

    /// Columns that are the recording's own viscous and Coulomb friction on a joint.
    pub fn own_friction_of(&self, joint: usize) -> impl Iterator<Item = usize> + use<> {
        self.own_friction.clone().skip(3 * joint).take(2)
    }

    /// What a law's own part (`change`) amounts to on the rows of a joint in the recording that is diagnosed, where it
    /// leaves `left`.
    pub fn size(&self, design: &Design, j: usize, change: &[f64], left: &[f64]) -> Size {
        let rows: Vec<usize> =
            design.target_segments().into_iter().flat_map(|g| design.ranges[j][g].clone()).collect();
        let count = rows.len().max(1) as f64;
        let rms = |x: &[f64]| (rows.iter().map(|&r| x[r] * x[r]).sum::<f64>() / count).sqrt();
        // What is the same two rows later, whose windows do not overlap, is no noise: where little of it is left, the
        // torques repeat better than usual.
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
        let least = rms(left) / count.sqrt();
        let needed = if units.change() {
            // Between days torques differ by more than one day shows.
            (REPEATS * rms(&design.y)).min(slow.max(least))
        } else {
            // One day tells of itself only.
            let part = LEAST_PART_OF_REMAINS;
            slow.max((part / (1.0 - part)).sqrt() * rms(left))
        };
        Size { law: rms(change), needed: needed.max(f64::MIN_POSITIVE) }
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

/// How large a law is on the joint where it stands out most, N.m or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Size {
    /// Root mean square of what nothing else can make of it.
    pub law: f64,
    /// How large it must be to be named: what the joint's torques repeat to; without a baseline what stays unexplained of
    /// them besides noise, and a part of what stays with the noise.
    pub needed: f64,
}
