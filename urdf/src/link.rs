//! Links as the file says, and their bodies.

use std::ops::Range;

use roxmltree::Node;

use crate::attributes::{Reader, elements, first};
use crate::body::Body;
use crate::geometry::{Collision, read_collision};
use crate::mistake::{Place, shown};
use crate::origin::{Rounding, read_origin};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub name: String,
    pub place: Place,
    /// Its bytes in the file.
    pub range: Range<usize>,
    pub inertial: Option<Inertial>,
    /// Its geometry, in its own frame.
    pub collisions: Vec<Collision>,
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

/// A <link>; `None` where it has no name.
pub(crate) fn read_link(reader: &mut Reader<'_>, node: Node<'_, '_>, angles: &mut Rounding) -> Option<Link> {
    let name = reader.required(node, "name")?.to_owned();
    let place = reader.place_of(node);
    let inertial = first(node, "inertial").and_then(|node| read_inertial(reader, node, &name, angles));
    let collisions = elements(node, "collision").map(read_collision).collect();
    Some(Link { name, place, range: node.range(), inertial, collisions, children: Vec::new(), joint: None })
}

fn read_inertial(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    link: &str,
    angles: &mut Rounding,
) -> Option<Inertial> {
    let place = reader.place_of(node);
    let origin = read_origin(reader, node, angles);
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
