//! A robot as a URDF of its own.

use std::fmt::Write as _;

use nalgebra::{Rotation3, Vector3};

use crate::body::Body;
use crate::pose::Pose;
use crate::skeleton::{Mimic, Segment, Skeleton};
use crate::text::{number, plain};
use dynid_description::JointKind;

/// The URDF of a robot. Its root link `world` has gravity along -z, as every reader takes it; a URDF cannot hold how large
/// gravity is. A segment that moves with several joint variables stands behind as many joints and links without mass.
pub fn write_urdf(skeleton: &Skeleton) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    // Writing to a String cannot fail.
    let _ = writeln!(text, "<robot name=\"{}\">", escaped(&skeleton.name));
    let upright = skeleton.gravity.x == 0.0 && skeleton.gravity.y == 0.0 && skeleton.gravity.z <= 0.0;
    let base = escaped(&skeleton.base);
    if !upright {
        let pose = Pose { rotation: upright_rotation(&skeleton.gravity), translation: Vector3::zeros() };
        text.push_str("  <link name=\"world\"/>\n  <joint name=\"world_to_base\" type=\"fixed\">\n");
        let _ = writeln!(
            text,
            "    <parent link=\"world\"/>\n    <child link=\"{base}\"/>\n    {}\n  </joint>",
            origin(&pose)
        );
    }
    let _ = writeln!(text, "  <link name=\"{base}\"/>");
    for segment in &skeleton.segments {
        joints(&mut text, skeleton, segment);
        let _ = writeln!(text, "  <link name=\"{}\">", escaped(&segment.link));
        if let Some(inertial) = inertial(&segment.body, "    ", "\n") {
            let _ = writeln!(text, "    {inertial}");
        }
        text.push_str("  </link>\n");
    }
    text + "</robot>\n"
}

/// Name of a joint about the axis of a segment that mimics another one.
fn further_name(skeleton: &Skeleton, segment: &Segment, mimic: &Mimic) -> String {
    format!("{}_with_{}", segment.joint, skeleton.segments[mimic.segment].joint)
}

/// The joint of a segment, and the further ones about its axis with the links between them.
fn joints(text: &mut String, skeleton: &Skeleton, segment: &Segment) {
    let parent = segment.parent.map_or(&skeleton.base, |p| &skeleton.segments[p].link);
    let names: Vec<String> = segment.further.iter().map(|m| further_name(skeleton, segment, m)).collect();
    // Behind each joint but the last stands a link that is named after the next one.
    let link = |place: usize| names.get(place).map_or(segment.link.clone(), |next| format!("before_{next}"));
    joint(text, skeleton, segment, [parent, &link(0)]);
    for (k, (name, mimic)) in names.iter().zip(&segment.further).enumerate() {
        let _ = writeln!(text, "  <link name=\"{}\"/>", escaped(&link(k)));
        let moved = Segment {
            joint: name.clone(),
            origin: Pose::identity(),
            position: None,
            velocity: None,
            effort: None,
            damping: 0.0,
            friction: 0.0,
            mimic: Some(*mimic),
            ..segment.clone()
        };
        joint(text, skeleton, &moved, [&link(k), &link(k + 1)]);
    }
}

fn joint(text: &mut String, skeleton: &Skeleton, segment: &Segment, [parent, child]: [&str; 2]) {
    let kind = match (segment.kind, segment.position) {
        (JointKind::Prismatic, _) => "prismatic",
        (_, Some(_)) => "revolute",
        (_, None) => "continuous",
    };
    let _ = writeln!(text, "  <joint name=\"{}\" type=\"{kind}\">", escaped(&segment.joint));
    let _ = writeln!(
        text,
        "    <parent link=\"{}\"/>\n    <child link=\"{}\"/>",
        escaped(parent),
        escaped(child)
    );
    let axis = segment.axis;
    let _ = writeln!(
        text,
        "    {}\n    <axis xyz=\"{} {} {}\"/>",
        origin(&segment.origin),
        plain(axis.x),
        plain(axis.y),
        plain(axis.z)
    );
    let position = segment.position.map_or_else(String::new, |[low, high]| {
        format!("lower=\"{}\" upper=\"{}\" ", plain(low), plain(high))
    });
    // Readers demand both; 0 is read as not known.
    let (effort, velocity) = (segment.effort.unwrap_or(0.0), segment.velocity.unwrap_or(0.0));
    let _ = writeln!(
        text,
        "    <limit {position}effort=\"{}\" velocity=\"{}\"/>",
        plain(effort),
        plain(velocity)
    );
    if let Some(mimic) = &segment.mimic {
        let master = escaped(&skeleton.segments[mimic.segment].joint);
        let _ = writeln!(text, "    <mimic joint=\"{master}\" multiplier=\"{}\"/>", plain(mimic.multiplier));
    }
    if segment.damping != 0.0 || segment.friction != 0.0 {
        let _ = writeln!(
            text,
            "    <dynamics damping=\"{}\" friction=\"{}\"/>",
            plain(segment.damping),
            plain(segment.friction)
        );
    }
    text.push_str("  </joint>\n");
}

fn origin(pose: &Pose) -> String {
    let [x, y, z] = [pose.translation.x, pose.translation.y, pose.translation.z].map(plain);
    let [roll, pitch, yaw] = pose.rpy().map(plain);
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

/// The `<inertial>` of a body, lines after the first indented; `None` where there is no mass.
pub(crate) fn inertial(body: &Body, indent: &str, newline: &str) -> Option<String> {
    let (mass, c, i) = body.centred()?;
    let line = |text: String| format!("{newline}{indent}  {text}");
    let moments = format!(
        "<inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>",
        plain(i[(0, 0)]),
        plain(i[(0, 1)]),
        plain(i[(0, 2)]),
        plain(i[(1, 1)]),
        plain(i[(1, 2)]),
        plain(i[(2, 2)])
    );
    Some(format!(
        "<inertial>{}{}{}{newline}{indent}</inertial>",
        line(format!("<origin xyz=\"{} {} {}\" rpy=\"0 0 0\"/>", plain(c.x), plain(c.y), plain(c.z))),
        line(format!("<mass value=\"{}\"/>", number(mass))),
        line(moments)
    ))
}

/// The rotation that puts gravity along -z.
fn upright_rotation(gravity: &Vector3<f64>) -> nalgebra::Matrix3<f64> {
    match Rotation3::rotation_between(gravity, &-Vector3::z()) {
        Some(rotation) => *rotation.matrix(),
        None => crate::pose::about(0, std::f64::consts::PI),
    }
}

/// A name within an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
