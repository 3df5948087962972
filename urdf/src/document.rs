//! A URDF as its XML says: links, joints, and where in the file they stand.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use nalgebra::Vector3;
use roxmltree::{Document, Node};

use crate::angles::{rounding, snapped};
use crate::attributes::Reader;
use crate::body::Body;
use crate::mistake::{Mistake, Place, START, shown};
use crate::pose::Pose;
use crate::text::plain;

/// Longest file that is read, bytes: meshes lie in files of their own.
const MAX_BYTES: usize = 1 << 24;
/// Most elements that are read.
const MAX_NODES: u32 = 1 << 20;
/// An axis whose length is further from 1 than this is warned of.
const UNIT: f64 = 1e-3;

/// A URDF that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Urdf {
    /// Name of the robot.
    pub name: String,
    pub(crate) links: Vec<Link>,
    pub(crate) joints: Vec<Joint>,
    /// The link that is nobody's child.
    pub(crate) root: usize,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Mistake>,
    /// The coarsest rounding of a right angle that was taken as it stands, rad.
    pub coarsest_rounding: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub name: String,
    pub place: Place,
    /// Its bytes in the file.
    pub range: Range<usize>,
    pub inertial: Option<Inertial>,
    /// Joints that it is the parent of, in the order of the file.
    pub children: Vec<usize>,
    /// The joint that it is the child of.
    pub joint: Option<usize>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Inertial {
    pub range: Range<usize>,
    /// About the origin of the link's frame.
    pub body: Body,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointType {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Floating,
    Planar,
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

/// Reads a URDF from its bytes. `snap` (rad) is how far an angle may be from a multiple of pi/4 to be taken for one.
///
/// # Errors
/// Every mistake of the file, in its order; just one where it is no XML.
pub fn read(bytes: &[u8], snap: f64) -> Result<Urdf, Vec<Mistake>> {
    let text = utf8(bytes).map_err(|mistake| vec![mistake])?;
    let options =
        roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..Default::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        let place = Place { line: at.row.max(1) as usize, column: at.col.max(1) as usize };
        // The library's words end with the place.
        let words = error.to_string();
        let words = words.rsplit_once(" at ").map_or(words.as_str(), |(before, _)| before);
        let hint = if words.contains("xacro") { ": xacro has to be expanded first" } else { "" };
        vec![Mistake::new(place, format!("not XML: {}{hint}", shown(words)))]
    })?;
    let mut reader = Reader::new(&document);
    let urdf = read_robot(&mut reader, document.root_element(), snap);
    let (mut mistakes, warnings) = (reader.mistakes, reader.warnings);
    mistakes.sort_by_key(|m| m.place);
    match urdf {
        Some(urdf) if mistakes.is_empty() => Ok(Urdf { warnings, ..urdf }),
        _ if mistakes.is_empty() => Err(vec![Mistake::new(START, "no robot in it")]),
        _ => Err(mistakes),
    }
}

/// The text of a file that is not too long. A byte order mark stays: bytes are counted from the file's beginning.
pub(crate) fn utf8(bytes: &[u8]) -> Result<&str, Mistake> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file has {} bytes; a robot has at most {MAX_BYTES}", bytes.len());
        return Err(Mistake::new(START, message));
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]).into_owned();
        let place = Place {
            line: good.matches('\n').count() + 1,
            column: good.chars().rev().take_while(|&c| c != '\n').count() + 1,
        };
        let byte = bytes[error.valid_up_to()];
        Mistake::new(place, format!("the file is not UTF-8 text (byte 0x{byte:02x} here)"))
    })
}

fn elements<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

fn first<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    elements(node, name).next()
}

fn read_robot(reader: &mut Reader<'_>, root: Node<'_, '_>, snap: f64) -> Option<Urdf> {
    let place = reader.place_of(root);
    if root.tag_name().name() != "robot" {
        let found = shown(root.tag_name().name());
        reader.report(place, format!("expected <robot>, found <{found}>"));
        return None;
    }
    if let Some(macros) =
        root.descendants().find(|n| n.tag_name().namespace().is_some_and(|s| s.contains("xacro")))
    {
        let place = reader.place_of(macros);
        reader.report(place, "xacro that is not expanded: run `xacro FILE.xacro > FILE.urdf` first");
        return None;
    }
    let name = root.attribute("name").unwrap_or("robot").to_owned();
    let mut rounded = None;
    let mut links = Vec::new();
    let mut by_name = HashMap::new();
    for node in elements(root, "link") {
        let Some(link) = read_link(reader, node, snap, &mut rounded) else { continue };
        if by_name.contains_key(&link.name) {
            reader.report(link.place, format!("link '{}' is there twice", shown(&link.name)));
            continue;
        }
        by_name.insert(link.name.clone(), links.len());
        links.push(link);
    }
    let mut joints: Vec<Joint> = Vec::new();
    let mut names = HashSet::new();
    for node in elements(root, "joint") {
        let Some(joint) = read_joint(reader, node, snap, &by_name, &mut rounded) else { continue };
        if !names.insert(joint.name.clone()) {
            reader.report(joint.place, format!("joint '{}' is there twice", shown(&joint.name)));
            continue;
        }
        joints.push(joint);
    }
    for node in elements(root, "transmission") {
        read_transmission(reader, node, &mut joints);
    }
    check_mimics(reader, &joints);
    let root = connect(reader, place, &mut links, &joints)?;
    if let Some(off) = rounded.filter(|off| *off > snap) {
        let words = format!(
            "angles such as 1.5708 are taken as they stand, up to {off:.1e} rad from a multiple of pi/4: base parameters \
             appear that no motion shows; where right angles are meant, --snap {} takes them so",
            plain(10_f64.powi(off.log10().ceil() as i32))
        );
        reader.warn(place, words);
    }
    Some(Urdf { name, links, joints, root, warnings: Vec::new(), coarsest_rounding: rounded })
}

/// `xyz` and `rpy` of an <origin>, with what is meant to be a right angle as one.
fn read_origin(reader: &mut Reader<'_>, node: Node<'_, '_>, snap: f64, rounded: &mut Option<f64>) -> Pose {
    let Some(origin) = first(node, "origin") else { return Pose::identity() };
    let xyz = reader.triple(origin, "xyz").map_or([0.0; 3], |(xyz, _)| xyz.map(|(_, x)| x));
    let rpy = reader.triple(origin, "rpy").map_or([0.0; 3], |(rpy, _)| {
        rpy.map(|(text, angle)| {
            let taken = snapped(angle, snap);
            if taken == angle
                && let Some(off) = rounding(text, angle).filter(|off| *off > snap)
            {
                *rounded = Some(rounded.map_or(off, |known: f64| known.max(off)));
            }
            taken
        })
    });
    Pose::from_xyz_rpy(xyz, rpy)
}

fn read_link(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    snap: f64,
    rounded: &mut Option<f64>,
) -> Option<Link> {
    let name = reader.required(node, "name")?.to_owned();
    let place = reader.place_of(node);
    let inertial = first(node, "inertial").and_then(|node| read_inertial(reader, node, &name, snap, rounded));
    Some(Link { name, place, range: node.range(), inertial, children: Vec::new(), joint: None })
}

fn read_inertial(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    link: &str,
    snap: f64,
    rounded: &mut Option<f64>,
) -> Option<Inertial> {
    let place = reader.place_of(node);
    let mut ignored = None;
    let origin = read_origin(reader, node, snap, &mut ignored);
    *rounded = rounded.map_or(ignored, |known| Some(ignored.map_or(known, |more: f64| known.max(more))));
    let mut part = |name: &'static str| {
        let found = first(node, name);
        if found.is_none() {
            reader.report(place, format!("<inertial> of link '{}' has no <{name}>", shown(link)));
        }
        found
    };
    let (mass, inertia) = (part("mass"), part("inertia"));
    let mass = mass.and_then(|node| reader.required_number(node, "value"));
    let inertia = inertia.map(|node| {
        ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(|name| match name {
            "ixy" | "ixz" | "iyz" if node.attribute(name).is_none() => {
                let place = reader.place_of(node);
                reader.warn(
                    place,
                    format!(
                        "no '{name}': taken as 0, while some readers then leave out the whole <inertial>"
                    ),
                );
                Some(0.0)
            }
            _ => reader.required_number(node, name),
        })
    });
    let (mass, [xx, xy, xz, yy, yz, zz]) = (mass?, inertia?);
    let moments = [xx?, xy?, xz?, yy?, yz?, zz?];
    if mass < 0.0 {
        reader
            .report(place, format!("the mass of link '{}' is {mass} kg: expected none below 0", shown(link)));
        return None;
    }
    let at_centre = Body::at_centre(mass, moments);
    if mass > 0.0 && !at_centre.is_possible() {
        let words = "no body has this inertia (its principal moments are negative or one is larger than the others together)";
        reader.warn(place, format!("link '{}': {words}", shown(link)));
    }
    Some(Inertial { range: node.range(), body: at_centre.seen_from(&origin) })
}

fn read_joint(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    snap: f64,
    links: &HashMap<String, usize>,
    rounded: &mut Option<f64>,
) -> Option<Joint> {
    let place = reader.place_of(node);
    let name = reader.required(node, "name")?.to_owned();
    let kind = read_type(reader, node, &name)?;
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
    let origin = read_origin(reader, node, snap, rounded);
    let axis =
        if kind == JointType::Fixed { Some(Vector3::x()) } else { read_axis(reader, node, &name, snap) };
    let [damping, friction] = ["damping", "friction"].map(|what| read_friction(reader, node, what));
    let mimic = first(node, "mimic").and_then(|node| {
        Some(Mimic {
            place: reader.place_of(node),
            of: reader.required(node, "joint")?.to_owned(),
            multiplier: reader.number(node, "multiplier").unwrap_or(1.0),
            offset: reader.number(node, "offset").unwrap_or(0.0),
        })
    });
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

fn read_type(reader: &mut Reader<'_>, node: Node<'_, '_>, joint: &str) -> Option<JointType> {
    Some(match reader.required(node, "type")? {
        "fixed" => JointType::Fixed,
        "revolute" => JointType::Revolute,
        "continuous" => JointType::Continuous,
        "prismatic" => JointType::Prismatic,
        "floating" => JointType::Floating,
        "planar" => JointType::Planar,
        other => {
            let (place, joint, found) = (reader.place_of(node), shown(joint), shown(other));
            reader.report(
                place,
                format!(
                    "joint '{joint}' has type '{found}': expected revolute, continuous, prismatic or fixed"
                ),
            );
            return None;
        }
    })
}

/// A number of a joint's `<dynamics>`.
fn read_friction(reader: &mut Reader<'_>, node: Node<'_, '_>, what: &str) -> Option<f64> {
    let node = first(node, "dynamics")?;
    let value = reader.number(node, what)?;
    if value < 0.0 {
        let place = reader.place_of(node);
        reader.warn(place, format!("{what} {value} is below 0"));
    }
    Some(value)
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

fn read_transmission(reader: &mut Reader<'_>, node: Node<'_, '_>, joints: &mut [Joint]) {
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

fn check_mimics(reader: &mut Reader<'_>, joints: &[Joint]) {
    let names: HashSet<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    for joint in joints {
        let Some(mimic) = &joint.mimic else { continue };
        if !names.contains(mimic.of.as_str()) {
            let (name, of) = (shown(&joint.name), shown(&mimic.of));
            reader.report(
                mimic.place,
                format!("joint '{name}' mimics '{of}', which is not a joint of the file"),
            );
        }
    }
}

/// Gives links their joints and finds the root; reports loops and what hangs together with nothing.
fn connect(reader: &mut Reader<'_>, place: Place, links: &mut [Link], joints: &[Joint]) -> Option<usize> {
    for (k, joint) in joints.iter().enumerate() {
        if let Some(other) = links[joint.child].joint {
            let (link, first, second) = (&links[joint.child].name, &joints[other].name, &joint.name);
            reader.report(
                joint.place,
                format!(
                    "link '{}' is the child of joint '{}' already: '{}' closes a loop, and dynid takes trees; a parallelogram \
                     is a tree whose bars mimic its joints, any other loop needs a numerical solver, which dynid has not",
                    shown(link),
                    shown(first),
                    shown(second)
                ),
            );
            return None;
        }
        links[joint.child].joint = Some(k);
        links[joint.parent].children.push(k);
    }
    let roots: Vec<usize> = (0..links.len()).filter(|&k| links[k].joint.is_none()).collect();
    match roots[..] {
        [] if links.is_empty() => reader.report(place, "there is no <link> in it"),
        [] => reader.report(place, "every link is the child of a joint: the joints go in a circle"),
        [_, second, ..] => {
            let (first, second) = (&links[roots[0]], &links[second]);
            reader.report(
                second.place,
                format!(
                    "link '{}' hangs together with nothing: the root is '{}'",
                    shown(&second.name),
                    shown(&first.name)
                ),
            );
        }
        [root] => {
            // With one root and one parent a link, what is not reached goes in a circle.
            let mut reached = vec![false; links.len()];
            let mut open = vec![root];
            while let Some(k) = open.pop() {
                reached[k] = true;
                open.extend(links[k].children.iter().map(|&j| joints[j].child));
            }
            match reached.iter().position(|seen| !seen) {
                None => return Some(root),
                Some(k) => {
                    let name = shown(&links[k].name);
                    reader.report(links[k].place, format!("link '{name}' is in a circle of joints"));
                }
            }
        }
    }
    None
}
