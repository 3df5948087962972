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

impl Trajectory {
    /// The rows within a window of time, s, both ends included; `None` where there is none.
    pub fn within(&self, [from, to]: [f64; 2]) -> Option<Trajectory> {
        let first = self.time.partition_point(|&t| t < from);
        let last = self.time.partition_point(|&t| t <= to);
        if first >= last {
            return None;
        }
        let cut = |channel: &Vec<Vec<f64>>| channel.iter().map(|c| c[first..last].to_vec()).collect();
        Some(Trajectory {
            name: self.name.clone(),
            time: self.time[first..last].to_vec(),
            position: cut(&self.position),
            velocity: self.velocity.as_ref().map(cut),
            torque: cut(&self.torque),
            fixed: self.fixed.clone(),
        })
    }
}
