//! What acts on several joints at once: friction between links or of a tendon, springs known by design.

use crate::{Frame, JointKind, ParameterKind};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Friction or a spring on a linear combination of joint positions s = sum of c q: its torque on each joint is c times that
/// on s, so that no power is lost between them.
///
/// s is an angle where every joint of it is one; otherwise it is a length, and the coefficient of an angle is m/rad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// What stands behind the kind in the names of its parameters: `6_7` of `Fvc6_7`, `_belt` of `K_belt`.
    pub name: Cow<'static, str>,
    /// Joint index and coefficient, ascending joints, no coefficient 0.
    pub terms: Cow<'static, [(usize, f64)]>,
    /// What acts on s.
    pub law: CouplingLaw,
}

/// What acts on a combination of joints.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CouplingLaw {
    /// Fvc ds + Fcc sign(ds).
    Friction,
    /// K s - KR, where K s0 = KR, the position at rest, is a parameter too.
    Spring,
    /// K (s - s0) with the position at rest s0 known, rad or m.
    #[serde(rename = "spring_at")]
    SpringAt(f64),
}

impl CouplingLaw {
    /// The parameters that the law has, in order.
    pub fn parameters(self) -> &'static [ParameterKind] {
        match self {
            CouplingLaw::Friction => &[ParameterKind::Fvc, ParameterKind::Fcc],
            CouplingLaw::Spring => &[ParameterKind::K, ParameterKind::KR],
            CouplingLaw::SpringAt(_) => &[ParameterKind::K],
        }
    }
}

impl Coupling {
    /// The frame that its parameters are counted with: the own frame of its last length, where it has one, or of its last
    /// angle. The units of its parameters are those of this joint. `None` where it names no joint of the table.
    pub fn frame(&self, frames: &[Frame]) -> Option<usize> {
        let joints: Vec<usize> = (0..frames.len()).filter(|&k| frames[k].kind != JointKind::Fixed).collect();
        let own = self.terms.iter().filter_map(|&(joint, _)| joints.get(joint).copied());
        own.max_by_key(|&frame| (frames[frame].kind == JointKind::Prismatic, frame))
    }

    /// The combination as it is read, the joints by their numbers: `q6 - q7`.
    pub fn combination(&self, number: impl Fn(usize) -> usize) -> String {
        crate::Motion { kind: JointKind::Revolute, terms: self.terms.to_vec() }.entry(number, "0")
    }
}
