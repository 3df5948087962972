//! Signals of many samples.

/// Signals of many samples, joint by joint: `q[j][t]`. All slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct States<'a> {
    /// Positions, rad or m.
    pub q: &'a [&'a [f64]],
    /// Velocities.
    pub dq: &'a [&'a [f64]],
    /// Accelerations.
    pub ddq: &'a [&'a [f64]],
}

/// Signals that are held as vectors, as [`States`] borrows them.
#[derive(Debug, Clone)]
pub struct StateSlices<'a> {
    signals: [Vec<&'a [f64]>; 3],
}

impl<'a> StateSlices<'a> {
    /// Positions, velocities and accelerations, each `[j][t]`.
    pub fn new(q: &'a [Vec<f64>], dq: &'a [Vec<f64>], ddq: &'a [Vec<f64>]) -> Self {
        Self { signals: [q, dq, ddq].map(|signal| signal.iter().map(Vec::as_slice).collect()) }
    }

    /// What the functions of a [`Model`](super::Model) take.
    pub fn states(&self) -> States<'_> {
        let [q, dq, ddq] = &self.signals;
        States { q, dq, ddq }
    }
}

impl States<'_> {
    /// Samples of each signal.
    pub fn samples(&self) -> usize {
        self.q.first().map_or(0, |q| q.len())
    }
}
