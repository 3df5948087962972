//! A robot as bodies on joints, each in a frame of its own: what URDF and MJCF both say.

use std::fmt;

use nalgebra::{Rotation3, Vector3};

use crate::between::{PointSpring, point_springs};
use crate::body::Body;
use crate::document::Urdf;
use crate::joint::JointType;
use crate::pose::Pose;
use crate::screw::Screw;
use crate::tree::Tree;
use dynid_description::{CouplingLaw, Frame, JointKind, Motion, ParameterKind, Robot};

/// A robot as bodies on joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    /// Its name.
    pub name: String,
    /// Gravity in the frame of the base, m/s2.
    pub gravity: Vector3<f64>,
    /// Name of the link that does not move.
    pub base: String,
    /// Bodies, parents before children.
    pub segments: Vec<Segment>,
    /// Friction between links and springs.
    pub tendons: Vec<Tendon>,
    /// Springs between points.
    pub between: Vec<PointSpring>,
}

/// What moves with another joint: q = multiplier * q of that joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The segment whose joint has the variable.
    pub segment: usize,
    /// Of a revolute joint a whole number, of a prismatic one m/rad or 1.
    pub multiplier: f64,
}

/// Friction and a spring on a combination of joint positions: a fixed tendon of MJCF.
#[derive(Debug, Clone, PartialEq)]
pub struct Tendon {
    /// Its name.
    pub name: String,
    /// Segments and coefficients.
    pub terms: Vec<(usize, f64)>,
    /// Viscous friction, not below 0.
    pub damping: f64,
    /// Coulomb friction, not below 0.
    pub friction: f64,
    /// Stiffness, not below 0.
    pub stiffness: f64,
    /// Where the spring is at rest.
    pub rest: f64,
}

/// A joint and the body that it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Name of the link.
    pub link: String,
    /// Name of the joint.
    pub joint: String,
    /// The segment that carries it; `None` for the base.
    pub parent: Option<usize>,
    /// Its frame in that of its carrier, the joint at 0.
    pub origin: Pose,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Unit vector in its frame.
    pub axis: Vector3<f64>,
    /// rad or m; `None` where it is not limited.
    pub position: Option<[f64; 2]>,
    /// rad/s or m/s.
    pub velocity: Option<f64>,
    /// N.m or N.
    pub effort: Option<f64>,
    /// About the origin of its frame.
    pub body: Body,
    /// Viscous friction, not below 0.
    pub damping: f64,
    /// Coulomb friction, not below 0.
    pub friction: f64,
    /// Rotor inertia at the joint.
    pub armature: f64,
    /// What moves its joint, where that has no variable of its own.
    pub mimic: Option<Mimic>,
    /// Further joints about the same axis, one behind the other, which move with others: a frame that moves with a sum of
    /// joint variables is moved by as many joints.
    pub further: Vec<Mimic>,
}

/// Standard parameters of one frame as a body.
pub fn body_of_frame(robot: &Robot, standard: &[f64], frame: usize) -> Body {
    Body::from_parameters(&ParameterKind::INERTIAL.map(|kind| value(robot, standard, frame, kind)))
}

/// One standard parameter; 0 where the frame has none of this kind.
pub fn value(robot: &Robot, standard: &[f64], frame: usize, kind: ParameterKind) -> f64 {
    let at = robot.standard.iter().position(|p| p.frame == frame && p.kind == kind);
    at.and_then(|k| standard.get(k)).copied().unwrap_or(0.0)
}

/// What moves a frame, with joints in the place of their segments: its axis along or against z, what its own joint mimics where
/// it has no variable of its own, and what further joints about this axis mimic.
fn moved(motion: &Motion, own: Option<usize>) -> (f64, Option<Mimic>, Vec<Mimic>) {
    let mimic = |segment: usize, multiplier: f64| Mimic { segment, multiplier };
    let coefficient = own.and_then(|own| motion.terms.iter().find(|t| t.0 == own)).map_or(1.0, |t| t.1);
    let axis = coefficient.signum();
    let mut further: Vec<Mimic> = Vec::new();
    if let (Some(own), true) = (own, coefficient.abs() != 1.0) {
        further.push(mimic(own, coefficient.abs() - 1.0));
    }
    further
        .extend(motion.terms.iter().filter(|t| Some(t.0) != own).map(|&(joint, c)| mimic(joint, axis * c)));
    let first = (own.is_none() && !further.is_empty()).then(|| further.remove(0));
    (axis, first, further)
}

/// Pose of a frame of the table in its parent's, its joint at 0.
fn row_pose(frame: &Frame) -> Pose {
    let Frame { gamma, b, alpha, d, theta, r, .. } = *frame;
    Screw { gamma, b, alpha, d, theta, r }.pose()
}

/// Rotor inertia that each joint feels of its own acceleration: the diagonal of the drive's inertia matrix.
///
/// With a diagonal gear it is Ia. Coupled motors (Gautier and Briot, equation 26) also have terms between joints.
pub fn armatures(robot: &Robot, standard: &[f64]) -> Vec<f64> {
    let n = robot.joints();
    let frames = robot.joint_of_frame();
    let ia: Vec<f64> = (0..frames.len())
        .filter(|&f| frames[f].is_some())
        .map(|f| value(robot, standard, f, ParameterKind::Ia))
        .collect();
    let gear =
        |m: usize, j: usize| robot.drive.gear.get(m * n + j).copied().unwrap_or(f64::from(u8::from(m == j)));
    let squares = nalgebra::DMatrix::from_fn(n, n, |j, m| gear(m, j) * gear(m, j));
    let right = nalgebra::DVector::from_column_slice(&ia);
    match squares.clone().lu().solve(&right) {
        Some(motors) => (squares * motors).iter().copied().collect(),
        None => ia,
    }
}

/// Friction between links and springs of a table, but for springs between points.
fn tendons(robot: &Robot, standard: &[f64], segment_of: &[usize]) -> Vec<Tendon> {
    let tendon = |(k, coupling): (usize, &dynid_description::Coupling)| {
        let value = |kind: ParameterKind| {
            let at = robot.standard.iter().position(|p| p.coupling == Some(k) && p.kind == kind);
            at.and_then(|at| standard.get(at)).copied().unwrap_or(0.0)
        };
        let terms = coupling.terms.iter().filter_map(|&(joint, c)| Some((*segment_of.get(joint)?, c)));
        let stiffness = value(ParameterKind::K).max(0.0);
        let rest = match coupling.law {
            CouplingLaw::SpringAt(rest) => rest,
            _ if stiffness > 0.0 => value(ParameterKind::KR) / stiffness,
            _ => 0.0,
        };
        let kind = if coupling.law == CouplingLaw::Friction { "friction" } else { "spring" };
        Tendon {
            name: format!("{kind}{}", coupling.name),
            terms: terms.collect(),
            damping: value(ParameterKind::Fvc).max(0.0),
            friction: value(ParameterKind::Fcc).max(0.0),
            stiffness,
            rest,
        }
    };
    let is_tendon = |(_, c): &(usize, &dynid_description::Coupling)| c.law.between().is_none();
    robot.couplings.iter().enumerate().filter(is_tendon).map(tendon).collect()
}

impl Skeleton {
    /// A table and its standard parameters. Fixed frames are part of what carries them, those on the base are left out. A frame
    /// that moves with several joint variables has several joints about its axis, of which all but one mimic others.
    pub fn of_table(robot: &Robot, standard: &[f64]) -> Skeleton {
        let joints = robot.joint_of_frame();
        let armature = armatures(robot, standard);
        let motions = robot.motions();
        let mut segments: Vec<Segment> = Vec::new();
        // The segment of each joint.
        let mut segment_of: Vec<usize> = Vec::new();
        // For each frame the segment that carries it, and its pose there.
        let mut carried: Vec<(Option<usize>, Pose)> = Vec::new();
        for (k, frame) in robot.frames.iter().enumerate() {
            let (carrier, pose) =
                frame.parent.and_then(|p| carried.get(p)).copied().unwrap_or((None, Pose::identity()));
            let origin = pose.then(&row_pose(frame));
            let body = body_of_frame(robot, standard, k);
            let own = joints[k];
            if motions[k].kind == JointKind::Fixed {
                if let Some(carrier) = carrier {
                    segments[carrier].body = segments[carrier].body.with(&body.seen_from(&origin));
                }
                carried.push((carrier, origin));
                continue;
            }
            let number = k + 1;
            let limit = |limits: &[[f64; 2]]| own.and_then(|j| limits.get(j).copied());
            let largest = |limits: &[[f64; 2]]| limit(limits).map(|[low, high]| low.abs().max(high.abs()));
            let (axis, mimic, further) = moved(&motions[k], own);
            segments.push(Segment {
                link: format!("link{number}"),
                joint: format!("joint{number}"),
                parent: carrier,
                origin,
                kind: motions[k].kind,
                axis: Vector3::z() * axis,
                position: limit(&robot.limits.position),
                velocity: largest(&robot.limits.velocity),
                effort: largest(&robot.limits.torque),
                body,
                damping: value(robot, standard, k, ParameterKind::Fv).max(0.0),
                friction: value(robot, standard, k, ParameterKind::Fc).max(0.0),
                armature: own.and_then(|j| armature.get(j).copied()).unwrap_or_default(),
                mimic,
                further,
            });
            segment_of.extend(own.map(|_| segments.len() - 1));
            carried.push((Some(segments.len() - 1), Pose::identity()));
        }
        for segment in &mut segments {
            for mimic in segment.mimic.iter_mut().chain(&mut segment.further) {
                mimic.segment = segment_of.get(mimic.segment).copied().unwrap_or_default();
            }
        }
        let gravity = Vector3::from(robot.gravity);
        let tendons = tendons(robot, standard, &segment_of);
        let between = point_springs(robot, standard, &carried);
        Skeleton {
            name: robot.name.to_string(),
            gravity,
            base: "base".to_owned(),
            segments,
            tendons,
            between,
        }
    }

    /// The part of a URDF that a tree is, with its own names and frames. A joint that mimics another with an offset is where it
    /// stands when the other is at 0.
    pub(crate) fn of_tree(urdf: &Urdf, tree: &Tree, gravity: Vector3<f64>) -> Skeleton {
        let segment = |moving: &crate::tree::Moving| {
            let joint = &urdf.joints[moving.joint];
            let is_length = joint.kind == JointType::Prismatic;
            let master = |f: crate::tree::Follows| {
                let segment = tree.bodies.iter().position(|body| body.joint == f.joint)?;
                Some(Mimic { segment, multiplier: f.multiplier })
            };
            let offset = moving.follows.map_or(0.0, |f| f.offset);
            let stands = match is_length {
                true => Pose { translation: joint.axis * offset, ..Pose::identity() },
                false => Pose { rotation: *Rotation3::new(joint.axis * offset).matrix(), ..Pose::identity() },
            };
            Segment {
                link: urdf.links[joint.child].name.clone(),
                joint: joint.name.clone(),
                parent: moving.parent,
                origin: moving.origin.then(&stands),
                kind: if is_length { JointKind::Prismatic } else { JointKind::Revolute },
                axis: joint.axis,
                position: joint.limit.position,
                velocity: joint.limit.velocity,
                effort: joint.limit.effort,
                body: urdf.carried(moving),
                damping: joint.damping.unwrap_or(0.0).max(0.0),
                friction: joint.friction.unwrap_or(0.0).max(0.0),
                armature: 0.0,
                mimic: moving.follows.and_then(master),
                further: Vec::new(),
            }
        };
        Skeleton {
            name: urdf.name.clone(),
            gravity,
            base: urdf.links[tree.base].name.clone(),
            segments: tree.bodies.iter().map(segment).collect(),
            tendons: Vec::new(),
            between: Vec::new(),
        }
    }

    /// Poses of the segments in the base, every joint at 0.
    pub fn poses(&self) -> Vec<Pose> {
        poses(&self.segments)
    }
}

/// Poses of segments in the base, every joint at 0.
fn poses(segments: &[Segment]) -> Vec<Pose> {
    let mut poses: Vec<Pose> = Vec::new();
    for segment in segments {
        let carrier = segment.parent.and_then(|p| poses.get(p)).copied().unwrap_or_else(Pose::identity);
        poses.push(carrier.then(&segment.origin));
    }
    poses
}

/// Why a table and a template are not the same robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unlike(pub(crate) String);

impl fmt::Display for Unlike {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unlike {}

/// Axes of one robot in two descriptions may be this far apart, rad and m: right angles that are written as 1.57.
const APART: f64 = 5e-3;

/// For each segment of `template` the pose of `table`'s in its frame.
///
/// # Errors
/// The first joint whose axis is elsewhere, or moves otherwise.
pub(crate) fn matched(table: &[Segment], template: &Skeleton) -> Result<Vec<Pose>, Unlike> {
    let (ours, theirs) = (table.len(), template.segments.len());
    if ours != theirs {
        return Err(Unlike(format!(
            "the model has {ours} joints, the template {theirs} from '{}' on: --base and --tip choose those of the model",
            template.base
        )));
    }
    let poses: Vec<(Pose, Pose)> = poses(table).into_iter().zip(template.poses()).collect();
    for (k, (pose, other)) in poses.iter().enumerate() {
        let (own, named) = (&table[k], &template.segments[k]);
        let unlike = |what: String| {
            Unlike(format!(
                "joint {} of the model is not '{}' of the template: {what}",
                own.joint.trim_start_matches("joint"),
                named.joint
            ))
        };
        if own.kind != named.kind || own.parent != named.parent {
            return Err(unlike("one is revolute and one prismatic, or another link carries it".to_owned()));
        }
        let same = match (own.mimic, named.mimic) {
            (Some(a), Some(b)) => a.segment == b.segment && (a.multiplier - b.multiplier).abs() < APART,
            (a, b) => a.is_none() && b.is_none(),
        };
        if !same {
            return Err(unlike(
                "one moves by itself and one with another joint (mimic), or they move with other joints; a template from \
                 which the model's table was imported has the same"
                    .to_owned(),
            ));
        }
        let (axis, other_axis) = (pose.rotation * own.axis, other.rotation * named.axis);
        let angle = axis.cross(&other_axis).norm().atan2(axis.dot(&other_axis));
        let between = pose.translation - other.translation;
        let gap = (between - other_axis * between.dot(&other_axis)).norm();
        let is_off = own.kind == JointKind::Revolute && gap > APART;
        if angle > APART || is_off {
            return Err(unlike(format!("their axes are {angle:.3} rad and {gap:.3} m apart")));
        }
    }
    Ok(poses.iter().map(|(pose, other)| other.inverse().then(pose)).collect())
}
