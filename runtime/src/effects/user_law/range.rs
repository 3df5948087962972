//! The ranges that the shapes of a law are searched in.

use super::expression::no_constant;
use super::{LawError, wrong};
use crate::effects::shape::{ShapeSearch, Step};
use std::collections::BTreeMap;

/// Values of one, two or three shapes in a grid: each 1.3 or more apart where the range is one of a decade, and some
/// hundred trials at most.
const GRID: [usize; 3] = [9, 7, 5];

/// The range that a shape is searched in.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Range {
    pub name: String,
    pub low: f64,
    pub high: f64,
}

/// Values of each of so many shapes.
fn count(shapes: usize) -> usize {
    GRID[shapes.clamp(1, GRID.len()) - 1]
}

/// Every combination of values over the ranges.
pub(super) fn grid(ranges: &[Range]) -> Vec<Vec<f64>> {
    let count = count(ranges.len());
    let mut grid = vec![Vec::new()];
    for range in ranges {
        let values: Vec<f64> = (0..count).map(|k| range.at(k as f64 / (count - 1) as f64)).collect();
        let with = |shape: &Vec<f64>| {
            let longer = |x: &f64| shape.iter().copied().chain([*x]).collect();
            values.iter().map(longer).collect::<Vec<Vec<f64>>>()
        };
        grid = grid.iter().flat_map(with).collect();
    }
    grid
}

/// How values between those of the grid are searched.
pub(super) fn shape_search(ranges: &[Range]) -> ShapeSearch {
    let count = count(ranges.len());
    ShapeSearch {
        steps: ranges.iter().map(|range| range.step(count)).collect(),
        bounds: ranges.iter().map(|range| [range.low, range.high]).collect(),
        together: Vec::new(),
    }
}

/// Whether each number of a shape is in its range.
pub(super) fn hold(ranges: &[Range], shape: &[f64]) -> bool {
    let within = |(x, range): (&f64, &Range)| (range.low..=range.high).contains(x);
    shape.len() == ranges.len() && shape.iter().zip(ranges).all(within)
}

impl Range {
    /// A value of the range: 0 is its low end, 1 its high one.
    fn at(&self, share: f64) -> f64 {
        let between = if self.low > 0.0 {
            self.low * (self.high / self.low).powf(share)
        } else {
            self.low + share * (self.high - self.low)
        };
        between.clamp(self.low, self.high)
    }

    /// Between neighbours of a grid of so many values.
    fn step(&self, count: usize) -> Step {
        let steps = (count - 1) as f64;
        if self.low > 0.0 {
            Step::Times((self.high / self.low).powf(1.0 / steps))
        } else {
            Step::Move((self.high - self.low) / steps)
        }
    }
}

/// The ranges that were declared, checked.
pub(super) fn ranges(shapes: &BTreeMap<String, [f64; 2]>) -> Result<Vec<Range>, LawError> {
    if shapes.len() > GRID.len() {
        let message = format!("more than {} constants that are searched; fix one of them", GRID.len());
        return wrong("shapes", message);
    }
    let of = |(name, [low, high]): (&String, &[f64; 2])| {
        if let Some(why) = no_constant(name) {
            return wrong("shapes", why);
        }
        if !(low.is_finite() && high.is_finite() && low < high) {
            return wrong(
                "shapes",
                format!("{name}: [{low}, {high}]: expected a range [low, high] with low < high"),
            );
        }
        Ok(Range { name: name.clone(), low: *low, high: *high })
    };
    shapes.iter().map(of).collect()
}
