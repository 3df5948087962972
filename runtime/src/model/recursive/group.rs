//! Samples four at a time.

use super::error::MAX_FRAMES;
use super::kinematics::Link;
use crate::model::{LANES, Lanes, Number, States};

/// Samples that are evaluated together.
#[derive(Clone, Copy)]
pub(super) struct Group {
    pub first: usize,
    pub count: usize,
}

impl Group {
    pub fn write(self, column: &mut [f64], value: Lanes) {
        column[self.first..self.first + self.count].copy_from_slice(&value.to_array()[..self.count]);
    }

    pub fn add(self, column: &mut [f64], value: Lanes) {
        let column = &mut column[self.first..self.first + self.count];
        for (x, y) in column.iter_mut().zip(value.to_array()) {
            *x += y;
        }
    }
}

/// Evaluates all samples, four at a time; a last group that is not full repeats its last sample.
pub(super) fn each_group(
    links: &[Link<f64>],
    states: States<'_>,
    mut evaluate: impl FnMut(&[Link<Lanes>], Group, &[Lanes], &[Lanes], &[Lanes]),
) {
    let n = states.q.len();
    let samples = states.samples();
    let Some(last) = links.last() else { return };
    let lifted: [Link<Lanes>; MAX_FRAMES] = std::array::from_fn(|k| Link::lift(links.get(k).unwrap_or(last)));
    let mut state = [[Lanes::constant(0.0); MAX_FRAMES]; 3];
    for first in (0..samples).step_by(LANES) {
        let count = LANES.min(samples - first);
        for (one, all) in state.iter_mut().zip([states.q, states.dq, states.ddq]) {
            for (value, signal) in one.iter_mut().zip(all) {
                *value = Lanes::new(std::array::from_fn(|k| signal[first + k.min(count - 1)]));
            }
        }
        let [q, dq, ddq] = &state;
        evaluate(&lifted[..links.len()], Group { first, count }, &q[..n], &dq[..n], &ddq[..n]);
    }
}

/// Sets the samples of the first `columns` columns of a block to zero.
pub(super) fn clear(out: &mut [f64], stride: usize, columns: usize, states: &States<'_>) {
    let samples = states.samples();
    for column in 0..columns {
        out[column * stride..][..samples].fill(0.0);
    }
}
