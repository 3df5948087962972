//! A recording cut into units of a few seconds: what a law's evidence is compared between.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{UNIT_OF_BASELINE, UNIT_OF_ITSELF, UNITS_WANTED};
use std::ops::Range;

/// One unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Unit {
    /// Motion that it is a part of.
    pub file: usize,
    /// Whether it belongs to the recording that is diagnosed.
    pub target: bool,
}

/// Rows of all joints, cut into units.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Units {
    pub units: Vec<Unit>,
    /// Rows of each joint in each unit: `[joint][unit]`.
    pub rows: Vec<Vec<Range<usize>>>,
    /// Neighbouring rows without a gap, never across the border of a unit: `[joint][..]`.
    pub stretches: Vec<Vec<Range<usize>>>,
    /// Mean duration of a unit of the baseline, or of the recording where there is none, s.
    pub duration: f64,
    /// Mean duration of a motion of the recording, s.
    pub target_duration: f64,
}

impl Units {
    /// Units of a design: as long as the recording's motions where there is a baseline, else about ten; where joints move one after
    /// the other, about ten of each joint.
    pub fn of(design: &Design) -> Self {
        let spans = design.spans();
        let files = spans.len();
        let fresh: Vec<bool> =
            (0..files).map(|f| design.segments.iter().any(|s| s.signal == f && s.is_target)).collect();
        let seconds = |f: usize| spans[f].len() as f64 * design.step;
        let sum = |target: bool| (0..files).filter(|&f| fresh[f] == target).map(seconds).sum::<f64>();
        let motions = fresh.iter().filter(|f| **f).count().max(1) as f64;
        let target_duration = sum(true) / motions;
        let change = fresh.iter().any(|f| !f);
        // Of the joint that moves least, where joints move one after the other.
        let time_of = |target: bool, j: usize| {
            let rows = design.of_joint(j).filter(|&r| fresh[design.rows[r].signal] == target);
            rows.count() as f64 * design.step
        };
        let seconds_told = |target: bool| {
            let times = (0..design.joints).map(|j| time_of(target, j)).filter(|time| *time > 0.0);
            if design.together { times.fold(sum(target), f64::min) } else { sum(target) }
        };
        let wanted = if change {
            let [least, most] = UNIT_OF_BASELINE;
            target_duration.min(seconds_told(false) / UNITS_WANTED).clamp(least, most)
        } else {
            (seconds_told(true) / UNITS_WANTED).clamp(UNIT_OF_ITSELF[0], UNIT_OF_ITSELF[1])
        };
        let mut units = Vec::new();
        let mut first_unit = vec![0; files];
        let mut counts = vec![1; files];
        for f in 0..files {
            first_unit[f] = units.len();
            counts[f] = if change && fresh[f] { 1 } else { (seconds(f) / wanted).round().max(1.0) as usize };
            units.extend(vec![Unit { file: f, target: fresh[f] }; counts[f]]);
        }
        let cut: Vec<usize> = (0..files).filter(|&f| fresh[f] != change).collect();
        let duration = cut.iter().map(|&f| seconds(f)).sum::<f64>()
            / cut.iter().map(|&f| counts[f]).sum::<usize>().max(1) as f64;
        let place = |r: usize| {
            let (motion, place) = (design.rows[r].signal, design.place(r));
            let span = &spans[motion];
            let unit = first_unit[motion] + (place - span.start) * counts[motion] / span.len();
            (unit, place)
        };
        let (rows, stretches) =
            (0..design.joints).map(|j| of_joint(design.of_joint(j), units.len(), &place)).unzip();
        Self { units, rows, stretches, duration, target_duration }
    }

    /// Number of motions.
    pub fn files(&self) -> usize {
        self.units.iter().map(|u| u.file + 1).max().unwrap_or(0)
    }

    /// Whether these are two motions or more.
    pub fn are_several(&self, taken: impl Fn(usize) -> bool) -> bool {
        (0..self.files()).filter(|&f| taken(f)).count() > 1
    }

    /// Mean number of units of a motion.
    pub fn of_a_motion(&self) -> f64 {
        let mut files: Vec<usize> = self.units.iter().map(|u| u.file).collect();
        files.dedup();
        self.units.len() as f64 / files.len().max(1) as f64
    }

    /// Whether a motion belongs to the recording that is diagnosed.
    pub fn is_target(&self, file: usize) -> bool {
        self.units.iter().any(|u| u.file == file && u.target)
    }

    /// Whether there is a baseline.
    pub fn change(&self) -> bool {
        self.units.iter().any(|u| !u.target)
    }
}

/// The rows of a joint in each unit, and those that follow each other in one; `place` is the unit of a row and where it
/// lies on the grid of its motion.
fn of_joint(
    rows: impl Iterator<Item = usize>,
    units: usize,
    place: &dyn Fn(usize) -> (usize, usize),
) -> (Vec<Range<usize>>, Vec<Range<usize>>) {
    let mut of_units = vec![0..0; units];
    let mut stretches: Vec<Range<usize>> = Vec::new();
    let mut before = None;
    for r in rows {
        let (unit, place) = place(r);
        let range: &mut Range<usize> = &mut of_units[unit];
        let start = if range.end == 0 { r } else { range.start };
        *range = start..r + 1;
        match stretches.last_mut() {
            Some(last) if before == Some((unit, place.wrapping_sub(1))) => last.end = r + 1,
            _ => stretches.push(r..r + 1),
        }
        before = Some((unit, place));
    }
    (of_units, stretches)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints with rows every 0.02 s, `seconds` in each segment (motion, is_target).
    fn design(segments: &[(usize, bool)], seconds: f64) -> Design {
        let rows = (seconds / 0.02) as usize;
        let all = 2 * segments.len() * rows;
        Design::made_up(2, segments, rows, vec![vec![1.0; all]], vec![0.0; all])
    }

    #[test]
    fn a_recording_on_its_own_is_cut_into_about_ten_units_of_at_least_a_second() {
        let long = Units::of(&design(&[(0, true), (0, true)], 12.0));
        assert_eq!(long.units.len(), 10);
        assert!(!long.change());
        assert!((long.duration - 2.4).abs() < 0.05, "{}", long.duration);
        let short = Units::of(&design(&[(0, true)], 4.0));
        assert_eq!(short.units.len(), 4);
    }

    #[test]
    fn a_long_baseline_has_units_as_long_as_the_recording_and_a_short_one_has_enough_of_them() {
        let long = Units::of(&design(&[(0, false), (1, false), (2, true)], 40.0));
        assert_eq!(long.units.iter().filter(|u| u.target).count(), 1);
        assert!((long.duration - 8.0).abs() < 0.1, "{}", long.duration);
        let short = Units::of(&design(&[(0, false), (1, true)], 10.0));
        assert_eq!(short.units.iter().filter(|u| !u.target).count(), 10);
        assert!((short.target_duration - 10.0).abs() < 0.1);
    }

    #[test]
    fn stretches_end_at_gaps_and_at_the_borders_of_units_and_hold_every_row_once() {
        let mut design = design(&[(0, true)], 4.0);
        for r in design.of_joint(1) {
            design.rows[r].centre += if r >= design.of_joint(1).start + 30 { 5 } else { 0 };
        }
        let units = Units::of(&design);
        for j in 0..2 {
            let rows: Vec<usize> = units.stretches[j].iter().cloned().flatten().collect();
            assert_eq!(rows, design.of_joint(j).collect::<Vec<usize>>());
            let in_units: usize = units.rows[j].iter().map(|r| r.len()).sum();
            assert_eq!(in_units, rows.len());
        }
        assert_eq!(units.stretches[0].len(), units.units.len());
        assert_eq!(units.stretches[1].len(), units.units.len() + 1);
    }
}
