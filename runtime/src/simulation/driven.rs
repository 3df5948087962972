//! A state of a plant under motor torques.

use super::state::{Hold, State};

/// Where a plant is evaluated: coordinates, what holds, and the torques of its motors.
#[derive(Clone, Copy)]
pub(super) struct Driven<'a> {
    /// s.
    pub time: f64,
    /// All coordinates, rad or m.
    pub q: &'a [f64],
    /// Their velocities.
    pub dq: &'a [f64],
    /// One per place of dry friction.
    pub hold: &'a [Hold],
    /// One per joint, on the joint side, N.m or N.
    pub torque: &'a [f64],
}

impl<'a> Driven<'a> {
    /// A state under these torques.
    pub fn by(state: &'a State, torque: &'a [f64]) -> Self {
        Self { time: state.time, q: &state.q, dq: &state.dq, hold: &state.hold, torque }
    }
}
