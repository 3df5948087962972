//! How much of a residual one instant tells of the next: what a push leaves, and what swings does not.

use std::ops::AddAssign;

/// Squares of the rows in windows, in units of the noise.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(in crate::diagnosis) struct Squares {
    /// Of the residual.
    pub before: f64,
    /// Of what the neighbouring instants leave of it.
    pub after: f64,
    /// Of the torque itself.
    pub torque: f64,
}

impl Squares {
    /// Whether the residual changes from row to row as much as it is large: it swings, and nothing pushes.
    pub fn swing(&self) -> bool {
        self.after > self.before
    }
}

impl AddAssign for Squares {
    fn add_assign(&mut self, other: Self) {
        self.before += other.before;
        self.after += other.after;
        self.torque += other.torque;
    }
}

/// Mean of the values before and behind one; 0 where it has none.
pub(in crate::diagnosis) fn mean_beside(values: &[f64], i: usize) -> f64 {
    let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|k| values.get(k));
    let (sum, count) = beside.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_tell_of_what_lasts_and_nothing_of_what_stands_alone() {
        assert_eq!(mean_beside(&[1.0, 5.0, 3.0], 1), 2.0);
        assert_eq!(mean_beside(&[1.0, 5.0, 3.0], 0), 5.0);
        assert_eq!(mean_beside(&[7.0], 0), 0.0);
        assert!(Squares { before: 1.0, after: 3.0, torque: 0.0 }.swing());
    }
}
