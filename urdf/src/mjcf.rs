//! A robot as MJCF, the format of MuJoCo.

use std::fmt::Write as _;

use crate::skeleton::{Segment, Skeleton};
use crate::text::plain;
use crate::write_urdf::escaped;
use dynid_description::JointKind;

/// The MJCF of a robot: bodies with `fullinertia`, joints with `armature`, `damping` and `frictionloss`. Gravity is that of
/// the table, in the frame of the base, which is the world's.
pub fn write_mjcf(skeleton: &Skeleton) -> String {
    let mut text = String::new();
    let g = skeleton.gravity;
    // Writing to a String cannot fail.
    let _ = writeln!(text, "<mujoco model=\"{}\">", escaped(&skeleton.name));
    text.push_str("  <compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\"/>\n");
    let _ = writeln!(text, "  <option gravity=\"{} {} {}\"/>", plain(g.x), plain(g.y), plain(g.z));
    text.push_str("  <worldbody>\n");
    for k in (0..skeleton.segments.len()).filter(|&k| skeleton.segments[k].parent.is_none()) {
        body(&mut text, skeleton, k, 2);
    }
    text + "  </worldbody>\n</mujoco>\n"
}

/// One body and what it carries. A table has few frames, so the depth is small; that of a URDF was walked without recursion
/// and is bounded by the frames of a table.
fn body(text: &mut String, skeleton: &Skeleton, k: usize, depth: usize) {
    let segment = &skeleton.segments[k];
    let indent = "  ".repeat(depth);
    let p = segment.origin.translation;
    let [w, x, y, z] = segment.origin.quaternion().map(plain);
    let _ = writeln!(
        text,
        "{indent}<body name=\"{}\" pos=\"{} {} {}\" quat=\"{w} {x} {y} {z}\">",
        escaped(&segment.link),
        plain(p.x),
        plain(p.y),
        plain(p.z)
    );
    joint(text, segment, &indent);
    if let Some((mass, c, i)) = segment.body.centred() {
        let moments = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| plain(i[at])).join(" ");
        let _ = writeln!(
            text,
            "{indent}  <inertial pos=\"{} {} {}\" mass=\"{}\" fullinertia=\"{moments}\"/>",
            plain(c.x),
            plain(c.y),
            plain(c.z),
            plain(mass)
        );
    }
    for child in (0..skeleton.segments.len()).filter(|&child| skeleton.segments[child].parent == Some(k)) {
        body(text, skeleton, child, depth + 1);
    }
    let _ = writeln!(text, "{indent}</body>");
}

fn joint(text: &mut String, segment: &Segment, indent: &str) {
    let kind = if segment.kind == JointKind::Prismatic { "slide" } else { "hinge" };
    let axis = segment.axis;
    let range = segment
        .position
        .map_or_else(String::new, |[low, high]| format!(" range=\"{} {}\"", plain(low), plain(high)));
    let _ = writeln!(
        text,
        "{indent}  <joint name=\"{}\" type=\"{kind}\" axis=\"{} {} {}\"{range} armature=\"{}\" damping=\"{}\" \
         frictionloss=\"{}\"/>",
        escaped(&segment.joint),
        plain(axis.x),
        plain(axis.y),
        plain(axis.z),
        plain(segment.armature),
        plain(segment.damping),
        plain(segment.friction)
    );
}
