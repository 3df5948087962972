//! Rows of a file, column by column, with what is wrong with them.

use super::Reason;

/// A block of rows: `columns[c][k]` is the wanted column c at row k of the block.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// One per wanted column, in the order they were asked for; NaN where a row is at fault.
    pub columns: Vec<Vec<f64>>,
    /// Line of each row in its file, from 1.
    pub lines: Vec<u64>,
    /// Rows at fault, in order: (row of the block, why, the column concerned where there is one).
    pub faults: Vec<(usize, Reason, Option<usize>)>,
}

impl Rows {
    /// An empty block of `columns` columns.
    pub fn new(columns: usize) -> Self {
        Self { columns: vec![Vec::new(); columns], ..Self::default() }
    }

    /// Rows in the block.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Empties the block and keeps its memory.
    pub fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.lines.clear();
        self.faults.clear();
    }
}
