//! One motion as it was measured.

/// One continuous motion of a recording, on the joint side, in SI units. `position[j][t]` is joint j at row t.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// What a person calls it: the file, and the window where there is one.
    pub name: String,
    /// Time of each row, s, strictly increasing.
    pub time: Vec<f64>,
    /// rad or m.
    pub position: Vec<Vec<f64>>,
    /// rad/s or m/s, where it was recorded.
    pub velocity: Option<Vec<Vec<f64>>>,
    /// N.m or N.
    pub torque: Vec<Vec<f64>>,
    /// Joints (0-based) that stand still in this motion.
    pub fixed: Vec<usize>,
}
