//! What acts on several joints at once: friction between links or of a tendon, springs known by design.

use crate::{Frame, JointKind, ParameterKind};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Friction or a spring on a linear combination of joint positions s = sum of c q: its torque on each joint is c times that
/// on s, so that no power is lost between them.
///
/// s is an angle where every joint of it is one; otherwise it is a length, and the coefficient of an angle is m/rad. Of a spring
/// between two points s is their distance, a function of the joint positions that is not linear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// What stands behind the kind in the names of its parameters: `6_7` of `Fvc6_7`, `_belt` of `K_belt`.
    pub name: Cow<'static, str>,
    /// Joint index and coefficient, ascending joints, no coefficient 0; of a spring between points the joints that its length
    /// changes with, each with 1.
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
    /// K l - KR along the line between two points, l being their distance.
    Between(Between),
}

/// Two points, each fixed in a frame, and what is known of the spring between them: a coil spring, of which K is the
/// stiffness and KR that times the free length; a gas spring, whose thrust KR - K l rises by K for each metre that it is
/// pushed in; with K = 0 a constant force.
///
/// Where the points meet the force has no direction: it counts as 0 there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Between {
    /// The frame of each point, 0-based index in `Robot::frames`; `None` is the base.
    pub frames: [Option<usize>; 2],
    /// The points in their frames, m.
    pub points: [[f64; 3]; 2],
    /// The length at rest, m, where it is known: then KR is K times it and no parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<f64>,
}

impl CouplingLaw {
    /// The parameters that the law has, in order.
    pub fn parameters(self) -> &'static [ParameterKind] {
        match self {
            CouplingLaw::Friction => &[ParameterKind::Fvc, ParameterKind::Fcc],
            CouplingLaw::Spring => &[ParameterKind::K, ParameterKind::KR],
            CouplingLaw::SpringAt(_) => &[ParameterKind::K],
            CouplingLaw::Between(Between { rest: None, .. }) => &[ParameterKind::K, ParameterKind::KR],
            CouplingLaw::Between(_) => &[ParameterKind::K],
        }
    }

    /// The points of a spring between two.
    pub fn between(self) -> Option<Between> {
        if let CouplingLaw::Between(between) = self { Some(between) } else { None }
    }

    /// Where a spring is at rest, rad or m; `None` where KR says it, or for friction.
    pub fn rest(self) -> Option<f64> {
        match self {
            CouplingLaw::SpringAt(rest) => Some(rest),
            CouplingLaw::Between(between) => between.rest,
            _ => None,
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

    /// The combination as it is read, the joints by their numbers: `q6 - q7`; of a spring between points what it is.
    pub fn combination(&self, number: impl Fn(usize) -> usize) -> String {
        if let Some(Between { frames, points, .. }) = self.law.between() {
            let point = |k: usize| {
                let [x, y, z] = points[k];
                format!("({x}, {y}, {z}) of frame {}", frames[k].map_or(0, |frame| frame + 1))
            };
            return format!("distance of {} and {}", point(0), point(1));
        }
        crate::Motion { kind: JointKind::Revolute, terms: self.terms.to_vec() }.entry(number, "0")
    }
}
