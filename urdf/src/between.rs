//! Springs between two points of a robot as bodies on joints: a spatial tendon of MJCF.

use nalgebra::Vector3;

use crate::pose::Pose;
use dynid_description::{ParameterKind, Robot};

/// A spring between two points: stiffness times what the distance is longer than at rest, along the line between them.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSpring {
    /// Its name.
    pub name: String,
    /// The segment that each point is on, `None` for the base, and the point in its frame, m.
    pub ends: [(Option<usize>, Vector3<f64>); 2],
    /// N/m, above 0.
    pub stiffness: f64,
    /// The length at rest, m, not below 0.
    pub rest: f64,
}

/// Stiffness and length at rest of the spring between points that is coupling `k` of a table; `None` for another coupling, and
/// for what is no spring with a length at rest: a constant force, and a force that falls while the spring is pulled out.
pub fn stiffness_and_rest(robot: &Robot, standard: &[f64], k: usize) -> Option<(f64, f64)> {
    let between = robot.couplings.get(k)?.law.between()?;
    let value = |kind: ParameterKind| {
        let at = robot.standard.iter().position(|p| p.coupling == Some(k) && p.kind == kind)?;
        standard.get(at).copied()
    };
    let stiffness = value(ParameterKind::K).filter(|k| *k > 0.0)?;
    let rest = match between.rest {
        Some(rest) => rest,
        None => value(ParameterKind::KR).unwrap_or(0.0) / stiffness,
    };
    (rest >= 0.0 && rest.is_finite()).then_some((stiffness, rest))
}

/// The springs between points of a table. `carried` has for each frame the segment that carries it and its pose there.
pub(crate) fn point_springs(
    robot: &Robot,
    standard: &[f64],
    carried: &[(Option<usize>, Pose)],
) -> Vec<PointSpring> {
    let one = |k: usize| {
        let coupling = &robot.couplings[k];
        let between = coupling.law.between()?;
        let (stiffness, rest) = stiffness_and_rest(robot, standard, k)?;
        let end = |i: usize| {
            let point = Vector3::from(between.points[i]);
            match between.frames[i].and_then(|frame| carried.get(frame)) {
                Some((segment, pose)) => (*segment, pose.rotation * point + pose.translation),
                None => (None, point),
            }
        };
        Some(PointSpring {
            name: format!("spring{}", coupling.name),
            ends: [end(0), end(1)],
            stiffness,
            rest,
        })
    };
    (0..robot.couplings.len()).filter_map(one).collect()
}
