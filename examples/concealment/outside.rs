//! Physics that no law of the catalogue describes, hidden in what a torque channel records.

use dynid_runtime::recording::Trajectory;

use serde::{Deserialize, Serialize};

use crate::secret::Secret;

/// What is hidden.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// Friction that depends on the angle of another joint.
    FrictionByAnother,
    /// A cable over two joints, which pulls on both.
    Cable,
    /// Something that pushes where another joint passes a place.
    Bump,
}

impl Outside {
    /// What a secret hides.
    pub fn of(secret: &Secret) -> Self {
        let all = [Self::FrictionByAnother, Self::Cable, Self::Bump];
        all[(3.0 * secret.chance[0]) as usize % 3]
    }

    /// What a person would call it, and what a diagnosis that has no law for it would rightly say.
    pub fn described(self, secret: &Secret) -> Described {
        let (own, other) = (secret.joint.unwrap_or(0) + 1, other(secret) + 1);
        let (what, must, may) = match self {
            Self::FrictionByAnother => {
                ("friction by another angle", vec![format!("q{other}"), format!("dq{own}")], Vec::new())
            }
            Self::Cable => ("cable over two joints", vec![format!("q{other}")], vec![format!("q{own}")]),
            Self::Bump => ("bump over another angle", vec![format!("q{other}")], Vec::new()),
        };
        // A cable is a spring of either joint, with a part that depends on the other one.
        let cable = ["spring", "free_form"].iter().flat_map(|e| [own, other].map(|j| ((*e).to_owned(), j)));
        let also = if self == Self::Cable { cable.collect() } else { Vec::new() };
        Described { what: what.to_owned(), must, may, also }
    }
}

/// Physics outside of the catalogue as it should be told.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Described {
    /// What it is.
    pub what: String,
    /// Variables that must be named.
    pub must: Vec<String>,
    /// Variables that may be named besides.
    pub may: Vec<String>,
    /// Effects on joints, counted from 1, that are right besides.
    pub also: Vec<(String, usize)>,
}

impl Described {
    /// Whether a law over these variables says it.
    pub fn is_over(&self, variables: &[String]) -> bool {
        self.must.iter().all(|m| variables.contains(m))
            && variables.iter().all(|v| self.must.contains(v) || self.may.contains(v))
    }
}

/// The other joint: the one before, which as a rule has the larger torques; the second one's is the first.
pub fn other(secret: &Secret) -> usize {
    secret.joint.filter(|j| *j > 0).map_or(1, |j| j - 1)
}

/// Adds it to a recording; `size` in units of the joint's largest torque.
pub fn distort(motion: &mut Trajectory, secret: &Secret, size: f64) {
    let (own, other) = (secret.joint.unwrap_or(0), other(secret));
    let level = size * secret.most_torque;
    let sign = directions(motion, own);
    for t in 0..motion.time.len() {
        let [here, there] = [own, other].map(|j| motion.position[j][t]);
        motion.torque[own][t] += match Outside::of(secret) {
            Outside::FrictionByAnother => {
                let (order, phase) = (secret.between(1, 1.5, 2.5), secret.between(2, 0.0, 6.0));
                level * sign[t] * (order * there + phase).cos()
            }
            Outside::Cable => level * (here - there),
            Outside::Bump => {
                let (centre, width) = (secret.between(1, -0.5, 0.5), secret.between(2, 0.3, 0.7));
                level * (-((there - centre) / width).powi(2)).exp()
            }
        };
        if Outside::of(secret) == Outside::Cable {
            motion.torque[other][t] -= level * (here - there);
        }
    }
}

/// Direction of a joint over 20 ms, wide enough for the noise of an encoder.
fn directions(motion: &Trajectory, joint: usize) -> Vec<f64> {
    let q = &motion.position[joint];
    let period = motion.time.get(1).zip(motion.time.first()).map_or(1.0, |(b, a)| b - a);
    let reach = (0.01 / period).round().max(1.0) as usize;
    let last = q.len().saturating_sub(1);
    (0..q.len()).map(|t| (q[(t + reach).min(last)] - q[t.saturating_sub(reach)]).signum()).collect()
}
