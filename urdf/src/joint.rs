//! Joints as the file says.

use std::collections::HashMap;
use std::ops::Range;

use nalgebra::Vector3;
use roxmltree::Node;

use crate::attributes::{Reader, elements, first};
use crate::mistake::{Place, shown};
use crate::origin::{Rounding, read_origin};
use crate::pose::Pose;

/// An axis whose length is further from 1 than this is warned of.
const UNIT: f64 = 1e-3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointType {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Floating,
    Planar,
}

impl JointType {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "fixed" => Self::Fixed,
            "revolute" => Self::Revolute,
            "continuous" => Self::Continuous,
            "prismatic" => Self::Prismatic,
            "floating" => Self::Floating,
            "planar" => Self::Planar,
            _ => return None,
        })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Joint {
    pub name: String,
    pub place: Place,
    pub range: Range<usize>,
    pub kind: JointType,
    pub parent: usize,
    pub child: usize,
    /// The child's frame in the parent's where the joint is at 0.
    pub origin: Pose,
    /// Unit vector in the child's frame.
    pub axis: Vector3<f64>,
    pub limit: Limit,
    pub damping: Option<f64>,
    pub friction: Option<f64>,
    pub mimic: Option<Mimic>,
    /// Motor turns a joint turn, where a transmission says so.
    pub gear: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mimic {
    pub place: Place,
    pub of: String,
    pub multiplier: f64,
    /// rad or m.
    pub offset: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Limit {
    pub position: Option<[f64; 2]>,
    pub velocity: Option<f64>,
    pub effort: Option<f64>,
}

/// A <joint>; `None` where something is wrong with it that was reported.
pub(crate) fn read_joint(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    links: &HashMap<String, usize>,
    angles: &mut Rounding,
) -> Option<Joint> {
    let place = reader.place_of(node);
    let name = reader.required(node, "name")?.to_owned();
    let kind = reader.required(node, "type")?;
    let Some(kind) = JointType::of(kind) else {
        let (name, found) = (shown(&name), shown(kind));
        let expected = "expected revolute, continuous, prismatic or fixed";
        reader.report(place, format!("joint '{name}' has type '{found}': {expected}"));
        return None;
    };
    let mut end = |tag: &'static str| {
        let Some(node) = first(node, tag) else {
            reader.report(place, format!("joint '{}' has no <{tag}>", shown(&name)));
            return None;
        };
        let link = reader.required(node, "link")?;
        let found = links.get(link).copied();
        if found.is_none() {
            let place = reader.place_of(node);
            reader.report(place, format!("there is no link '{}'", shown(link)));
        }
        found
    };
    let (parent, child) = (end("parent"), end("child"));
    let origin = read_origin(reader, node, angles);
    let axis = if kind == JointType::Fixed {
        Some(Vector3::x())
    } else {
        read_axis(reader, node, &name, angles.snap)
    };
    let dynamics = first(node, "dynamics");
    let mut friction = |name: &str| {
        let node = dynamics?;
        let value = reader.number(node, name)?;
        if value < 0.0 {
            let place = reader.place_of(node);
            reader.warn(place, format!("{name} {value} is below 0"));
        }
        Some(value)
    };
    let (damping, friction) = (friction("damping"), friction("friction"));
    let mimic = first(node, "mimic").and_then(|node| read_mimic(reader, node));
    let limit = read_limit(reader, node, kind);
    let (parent, child, axis) = (parent?, child?, axis?);
    let range = node.range();
    Some(Joint {
        name,
        place,
        range,
        kind,
        parent,
        child,
        origin,
        axis,
        limit,
        damping,
        friction,
        mimic,
        gear: None,
    })
}

fn read_mimic(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Option<Mimic> {
    Some(Mimic {
        place: reader.place_of(node),
        of: reader.required(node, "joint")?.to_owned(),
        multiplier: reader.number(node, "multiplier").unwrap_or(1.0),
        offset: reader.number(node, "offset").unwrap_or(0.0),
    })
}

fn read_axis(reader: &mut Reader<'_>, node: Node<'_, '_>, joint: &str, snap: f64) -> Option<Vector3<f64>> {
    let Some(axis) = first(node, "axis") else { return Some(Vector3::x()) };
    reader.required(axis, "xyz")?;
    let (xyz, place) = reader.triple(axis, "xyz")?;
    let vector = Vector3::from(xyz.map(|(_, x)| x));
    let length = vector.norm();
    if length < 1e-9 {
        reader.report(place, format!("the axis of joint '{}' is zero: expected a unit vector", shown(joint)));
        return None;
    }
    if (length - 1.0).abs() > UNIT {
        reader.warn(
            place,
            format!("the axis of joint '{}' has length {length:.4}: taken as a direction", shown(joint)),
        );
    }
    let unit = vector / length;
    // What is along a coordinate axis stays exactly there.
    let nearest = unit.map(|x| if x.abs() > 0.5 { x.signum() } else { 0.0 });
    Some(if (unit - nearest).norm() <= snap.max(4.0 * f64::EPSILON) { nearest } else { unit })
}

/// Limits; what is not there, 0, or no range, is not given.
fn read_limit(reader: &mut Reader<'_>, node: Node<'_, '_>, kind: JointType) -> Limit {
    let Some(limit) = first(node, "limit") else { return Limit::default() };
    let ends = [reader.number(limit, "lower").unwrap_or(0.0), reader.number(limit, "upper").unwrap_or(0.0)];
    let mut positive = |name: &str| reader.number(limit, name).filter(|x| *x > 0.0);
    let (velocity, effort) = (positive("velocity"), positive("effort"));
    let position = (kind != JointType::Continuous && ends[0] < ends[1]).then_some(ends);
    if kind != JointType::Continuous && ends[0] > ends[1] {
        let place = reader.place_of(limit);
        reader.warn(place, format!("limits from {} to {}: not taken", ends[0], ends[1]));
    }
    Limit { position, velocity, effort }
}

/// The gear ratio of a <transmission> of one joint.
pub(crate) fn read_transmission(reader: &mut Reader<'_>, node: Node<'_, '_>, joints: &mut [Joint]) {
    let of: Vec<&str> = elements(node, "joint").filter_map(|joint| joint.attribute("name")).collect();
    // A transmission of several joints couples them in a way that the file does not tell.
    let [of] = of[..] else { return };
    let ratio = node.descendants().find(|n| n.tag_name().name() == "mechanicalReduction");
    let Some((ratio, text)) = ratio.and_then(|node| Some((node, node.text()?.trim()))) else { return };
    let place = reader.place_of(ratio);
    match text.parse::<f64>() {
        Ok(ratio) if ratio != 0.0 && ratio.is_finite() => {
            joints.iter_mut().filter(|joint| joint.name == of).for_each(|joint| joint.gear = Some(ratio));
        }
        _ => reader.report(place, format!("mechanicalReduction '{}' is no ratio", shown(text))),
    }
}
