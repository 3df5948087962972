//! Rows from messages that each tell a part: signals of one stamp are put together.

use std::collections::VecDeque;

use crate::recording::Rows;

/// Stamps that are waited for at once: publishers of one clock are a few messages apart.
const MOST_WAITING: usize = 64;

/// Rows that are being put together.
pub(super) struct Merge {
    /// The row of the message that is being read.
    row: Vec<f64>,
    /// Rows that still lack signals, with their stamp and the number of their first message.
    waiting: VecDeque<(i64, u64, Vec<f64>)>,
    /// How often each signal was there.
    pub seen: Vec<u64>,
    /// Rows that were complete, and rows that never were.
    pub complete: u64,
    pub incomplete: u64,
    /// Whether rows that lack signals are rows too.
    pub partial: bool,
}

impl Merge {
    pub fn new(columns: usize, partial: bool) -> Self {
        Self {
            row: vec![f64::NAN; columns],
            waiting: VecDeque::new(),
            seen: vec![0; columns],
            complete: 0,
            incomplete: 0,
            partial,
        }
    }

    /// Clears the row of the next message.
    pub fn begin(&mut self) {
        self.row.fill(f64::NAN);
    }

    /// A signal of the message.
    pub fn put(&mut self, slot: usize, value: f64) {
        self.row[slot] = value;
    }

    /// Ends a message; `times` are the columns that every message has. Appends the row to `rows` if nothing lacks.
    pub fn end(&mut self, stamp: i64, line: u64, times: &[(usize, f64)], rows: &mut Rows) {
        let mut any = false;
        for (value, seen) in self.row.iter().zip(&mut self.seen) {
            *seen += u64::from(!value.is_nan());
            any |= !value.is_nan();
        }
        if !any {
            // It tells of other joints.
            return;
        }
        for &(slot, value) in times {
            self.row[slot] = value;
            self.seen[slot] += 1;
        }
        if self.partial || self.row.iter().all(|value| !value.is_nan()) {
            push(rows, &self.row, line);
            self.complete += 1;
            return;
        }
        match self.waiting.iter().position(|(other, ..)| *other == stamp) {
            Some(at) => {
                let (_, first, other) = &mut self.waiting[at];
                for (value, new) in other.iter_mut().zip(&self.row).filter(|(value, _)| value.is_nan()) {
                    *value = *new;
                }
                if other.iter().all(|value| !value.is_nan()) {
                    push(rows, other, *first);
                    self.complete += 1;
                    self.waiting.remove(at);
                }
            }
            None => {
                if self.waiting.len() == MOST_WAITING {
                    self.waiting.pop_front();
                    self.incomplete += 1;
                }
                self.waiting.push_back((stamp, line, self.row.clone()));
            }
        }
    }

    /// What still waits at the end of the log stays incomplete.
    pub fn finish(&mut self) {
        self.incomplete += self.waiting.len() as u64;
        self.waiting.clear();
    }
}

fn push(rows: &mut Rows, row: &[f64], line: u64) {
    for (column, value) in rows.columns.iter_mut().zip(row) {
        column.push(*value);
    }
    rows.lines.push(line);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_one_stamp_are_put_together_and_other_joints_are_passed_over() {
        let (mut merge, mut rows) = (Merge::new(3, false), Rows::new(3));
        let mut message = |line, stamp, signals: &[(usize, f64)], rows: &mut Rows| {
            merge.begin();
            signals.iter().for_each(|&(slot, value)| merge.put(slot, value));
            merge.end(stamp, line, &[(0, stamp as f64)], rows);
            (merge.complete, merge.incomplete)
        };
        message(1, 10, &[(1, 1.0)], &mut rows);
        message(2, 11, &[(1, 3.0)], &mut rows);
        message(3, 10, &[], &mut rows);
        message(4, 10, &[(2, 2.0)], &mut rows);
        assert_eq!(message(5, 11, &[(2, 4.0)], &mut rows), (2, 0));
        assert_eq!(rows.columns, [[10.0, 11.0], [1.0, 3.0], [2.0, 4.0]]);
        assert_eq!(rows.lines, [1, 2]);
        for stamp in 100..200 {
            message(6, stamp, &[(1, 0.0)], &mut rows);
        }
        merge.finish();
        assert_eq!((merge.complete, merge.incomplete, merge.seen[1]), (2, 100, 102));
    }
}
