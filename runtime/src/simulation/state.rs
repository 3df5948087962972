//! Where a simulated robot is.

/// Whether a place of dry friction holds or slips.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// At rest, held by friction.
    Sticking,
    /// Slip velocity positive.
    Forward,
    /// Slip velocity negative.
    Backward,
}

/// Where the robot is. The first n coordinates are the joints; then one per elastic joint, its motor side.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// s.
    pub time: f64,
    /// rad or m.
    pub q: Vec<f64>,
    /// rad/s or m/s.
    pub dq: Vec<f64>,
    /// One per place of dry friction.
    pub hold: Vec<Hold>,
}

impl State {
    /// Takes over another state of the same plant, without allocating.
    pub fn copy_from(&mut self, other: &State) {
        self.time = other.time;
        self.q.copy_from_slice(&other.q);
        self.dq.copy_from_slice(&other.dq);
        self.hold.copy_from_slice(&other.hold);
    }
}
