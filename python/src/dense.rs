//! The inverse dynamic regressor as a dense array, by the batch engine.

use std::ops::Range;

use dynid_runtime::model::{LANES, LINE, Lanes, Line, Model, States};

/// Writes the regressor of samples one after the other: n rows of p columns each.
pub struct DenseRegressor<'a> {
    model: &'a dyn Model,
    /// For each entry of the pattern its place in a sample's matrix.
    places: Vec<usize>,
    /// Entries by lines of samples, as they are computed.
    lines: Vec<Line>,
    /// The entries of one line, entry by entry, sample by sample.
    values: Vec<f64>,
    /// Numbers of a sample's matrix.
    size: usize,
}

impl<'a> DenseRegressor<'a> {
    /// Room for a model.
    pub fn new(model: &'a dyn Model) -> Self {
        let (pattern, columns) = (model.pattern(), model.robot().base.len());
        let joints = model.robot().joints();
        let places: Vec<usize> = (0..joints)
            .flat_map(|j| {
                pattern.columns[pattern.rows[j]..pattern.rows[j + 1]].iter().map(move |c| j * columns + c)
            })
            .collect();
        let values = vec![0.0; places.len() * LINE];
        Self { model, places, lines: Vec::new(), values, size: joints * columns }
    }

    /// Writes the samples of `range`, whose states are `states`, to their places in `out`. Where that `is_fresh`, all that is
    /// not an entry of the pattern is zero already.
    ///
    /// # Panics
    /// Where `out` is too short: a bug of the caller.
    pub fn write(&mut self, range: &Range<usize>, states: States<'_>, out: &mut [f64], is_fresh: bool) {
        let (entries, size) = (self.places.len(), self.size);
        let lines = range.len().div_ceil(LINE);
        self.lines.resize(lines * entries, [Lanes::splat(0.0); LINE / LANES]);
        self.model.idm_lines(states, entries, &mut self.lines);
        for line in 0..lines {
            for (values, entry) in self.values.chunks_exact_mut(LINE).zip(&self.lines[line * entries..]) {
                for (values, lanes) in values.chunks_exact_mut(LANES).zip(entry) {
                    values.copy_from_slice(&lanes.to_array());
                }
            }
            let first = range.start + line * LINE;
            for t in 0..LINE.min(range.end - first) {
                let matrix = &mut out[(first + t) * size..][..size];
                // Just before it is written to, so that memory is gone through once.
                if !is_fresh {
                    matrix.fill(0.0);
                }
                for (place, values) in self.places.iter().zip(self.values.chunks_exact(LINE)) {
                    matrix[*place] = values[t];
                }
            }
        }
    }
}
