//! A robot as MJCF, the format of MuJoCo.

use std::fmt::Write as _;

use crate::skeleton::{Mimic, Segment, Skeleton};
use crate::text::plain;
use crate::write_urdf::escaped;
use dynid_description::JointKind;

/// The MJCF of a robot: bodies with `fullinertia`, joints with `armature`, `damping` and `frictionloss`. Gravity is that of
/// the table, in the frame of the base, which is the world's. What moves with another joint is an `equality` of joints, with
/// several one of a fixed tendon; where a joint with a variable of its own moves with others too, one more stands in its body,
/// which follows those. Friction between links and springs are fixed tendons, springs between points spatial ones.
pub fn write_mjcf(skeleton: &Skeleton) -> String {
    let mut text = String::new();
    let g = skeleton.gravity;
    // Writing to a String cannot fail.
    let _ = writeln!(text, "<mujoco model=\"{}\">", escaped(&skeleton.name));
    text.push_str("  <compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\"/>\n");
    let _ = writeln!(text, "  <option gravity=\"{} {} {}\"/>", plain(g.x), plain(g.y), plain(g.z));
    text.push_str("  <worldbody>\n");
    sites(&mut text, skeleton, None, 2);
    for k in (0..skeleton.segments.len()).filter(|&k| skeleton.segments[k].parent.is_none()) {
        body(&mut text, skeleton, k, 2);
    }
    text.push_str("  </worldbody>\n");
    equalities(&mut text, skeleton);
    tendons(&mut text, skeleton);
    text + "</mujoco>\n"
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
    if let (Some((name, _)), None) = (dependent(segment), segment.mimic) {
        further(text, segment, &name, &indent);
    }
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
    sites(text, skeleton, Some(k), depth + 1);
    for child in (0..skeleton.segments.len()).filter(|&child| skeleton.segments[child].parent == Some(k)) {
        body(text, skeleton, child, depth + 1);
    }
    let _ = writeln!(text, "{indent}</body>");
}

/// The joint of a segment that has no variable of its own, and what it follows: the segment's where that has none, else one
/// more about the same axis, behind it. `None` where there is no such joint.
fn dependent(segment: &Segment) -> Option<(String, Vec<Mimic>)> {
    match segment.mimic {
        Some(first) => Some((segment.joint.clone(), [&[first], segment.further.as_slice()].concat())),
        None if segment.further.is_empty() => None,
        None => Some((format!("{}_further", segment.joint), segment.further.clone())),
    }
}

/// The points of springs on a segment, or on the base.
fn sites(text: &mut String, skeleton: &Skeleton, segment: Option<usize>, depth: usize) {
    let indent = "  ".repeat(depth);
    for spring in &skeleton.between {
        for (end, (_, p)) in spring.ends.iter().enumerate().filter(|(_, (on, _))| *on == segment) {
            let [x, y, z] = [p.x, p.y, p.z].map(plain);
            let name = escaped(&spring.name);
            let _ = writeln!(text, "{indent}<site name=\"{name}_{end}\" pos=\"{x} {y} {z}\"/>");
        }
    }
}

/// One more joint about the axis of a segment.
fn further(text: &mut String, segment: &Segment, name: &str, indent: &str) {
    let kind = if segment.kind == JointKind::Prismatic { "slide" } else { "hinge" };
    let [x, y, z] = [segment.axis.x, segment.axis.y, segment.axis.z].map(plain);
    let _ =
        writeln!(text, "{indent}  <joint name=\"{}\" type=\"{kind}\" axis=\"{x} {y} {z}\"/>", escaped(name));
}

/// Which joints follow others.
fn equalities(text: &mut String, skeleton: &Skeleton) {
    let mut lines = String::new();
    for (name, terms) in skeleton.segments.iter().filter_map(dependent) {
        let name = escaped(&name);
        let _ = match terms.as_slice() {
            [mimic] => writeln!(
                lines,
                "    <joint joint1=\"{name}\" joint2=\"{}\" polycoef=\"0 {} 0 0 0\"/>",
                escaped(&skeleton.segments[mimic.segment].joint),
                plain(mimic.multiplier)
            ),
            _ => writeln!(lines, "    <tendon tendon1=\"{name}_follows\" polycoef=\"0 0 0 0 0\"/>"),
        };
    }
    if !lines.is_empty() {
        let _ = writeln!(text, "  <equality>\n{lines}  </equality>");
    }
}

/// Sums that joints follow, friction between links and springs.
fn tendons(text: &mut String, skeleton: &Skeleton) {
    let mut lines = String::new();
    let add = |lines: &mut String, joint: &str, coefficient: f64| {
        let joint = escaped(joint);
        let _ = writeln!(lines, "      <joint joint=\"{joint}\" coef=\"{}\"/>", plain(coefficient));
    };
    let named = |segment: usize| skeleton.segments[segment].joint.as_str();
    for (name, terms) in skeleton.segments.iter().filter_map(dependent).filter(|(_, terms)| terms.len() > 1) {
        let _ = writeln!(lines, "    <fixed name=\"{}_follows\">", escaped(&name));
        add(&mut lines, &name, 1.0);
        terms.iter().for_each(|mimic| add(&mut lines, named(mimic.segment), -mimic.multiplier));
        lines.push_str("    </fixed>\n");
    }
    for tendon in &skeleton.tendons {
        let _ = writeln!(
            lines,
            "    <fixed name=\"{}\" damping=\"{}\" frictionloss=\"{}\" stiffness=\"{}\" springlength=\"{}\">",
            escaped(&tendon.name),
            plain(tendon.damping),
            plain(tendon.friction),
            plain(tendon.stiffness),
            plain(tendon.rest)
        );
        tendon.terms.iter().for_each(|&(segment, coefficient)| add(&mut lines, named(segment), coefficient));
        lines.push_str("    </fixed>\n");
    }
    for spring in &skeleton.between {
        let name = escaped(&spring.name);
        let (stiffness, rest) = (plain(spring.stiffness), plain(spring.rest));
        let _ = writeln!(
            lines,
            "    <spatial name=\"{name}\" stiffness=\"{stiffness}\" springlength=\"{rest}\">\n      <site site=\"{name}_0\"/>\n      \
             <site site=\"{name}_1\"/>\n    </spatial>"
        );
    }
    if !lines.is_empty() {
        let _ = writeln!(text, "  <tendon>\n{lines}  </tendon>");
    }
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
