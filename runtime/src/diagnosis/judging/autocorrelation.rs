//! How long a residual remembers.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::UNCORRELATED;

/// Rows of a joint, motion by motion: their place in the motion, counted in rows, and their index in the design.
#[derive(Debug, Clone, Default)]
pub(in crate::diagnosis) struct Places(Vec<Vec<(usize, usize)>>);

impl Places {
    /// Where the rows of a joint are.
    pub fn of(design: &Design, joint: usize) -> Self {
        let motions = design.segments.iter().map(|s| s.signal + 1).max().unwrap_or(0);
        let motion = |signal: usize| {
            let rows = design.of_signal(joint, signal).into_iter().flat_map(|(range, _)| range);
            rows.map(|r| (design.place(r), r)).collect()
        };
        Self((0..motions).map(motion).collect())
    }

    /// Motion by motion: place and row.
    pub fn motions(&self) -> &[Vec<(usize, usize)>] {
        &self.0
    }
}

/// The lag, in rows, from which on values are uncorrelated; `longest` where they never are.
pub(in crate::diagnosis) fn decorrelation_lag(places: &Places, values: &[f64], longest: usize) -> usize {
    (1..longest).find(|&lag| autocorrelation(places, values, lag) < UNCORRELATED).unwrap_or(longest)
}

/// Correlation of values with themselves `lag` places later, over pairs of places that are there.
fn autocorrelation(places: &Places, values: &[f64], lag: usize) -> f64 {
    let (mut products, mut pairs, mut squares, mut rows) = (0.0, 0, 0.0, 0);
    for motion in &places.0 {
        let mut later = motion.iter().peekable();
        for &(place, r) in motion {
            squares += values[r] * values[r];
            rows += 1;
            while later.next_if(|(l, _)| *l < place + lag).is_some() {}
            if let Some((_, other)) = later.peek().filter(|(l, _)| *l == place + lag) {
                products += values[r] * values[*other];
                pairs += 1;
            }
        }
    }
    if pairs == 0 || squares == 0.0 { 0.0 } else { products / pairs as f64 / (squares / rows as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_looks_at_pairs_of_rows_that_are_there() {
        // A square wave of period 4, with rows missing: 1 after four rows, -1 after two, nothing after one.
        let values: Vec<f64> = (0..400).map(|k| if k % 4 < 2 { 1.0 } else { -1.0 }).collect();
        let there = Places(vec![(0..400).filter(|k| k % 37 != 0).map(|k| (k, k)).collect()]);
        assert!((autocorrelation(&there, &values, 4) - 1.0).abs() < 1e-12);
        assert!((autocorrelation(&there, &values, 2) + 1.0).abs() < 1e-12);
        assert!(autocorrelation(&there, &values, 1).abs() < 0.02);
        assert_eq!(autocorrelation(&Places(vec![vec![(0, 0), (9, 1)]]), &values, 1), 0.0);
    }
}
