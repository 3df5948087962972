//! What a `<collision>` of a link is.
//!
//! Dynamics do not need it: what cannot be read here is no mistake of the file, only no geometry.

use roxmltree::Node;

use crate::attributes::first;
use crate::mistake::shown;
use crate::pose::Pose;

/// Largest length, m: what is larger is no part of a robot.
const LARGEST: f64 = 1e3;

/// A part of a link's geometry, in the link's frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Collision {
    pub pose: Pose,
    /// Or why it is not known.
    pub shape: Result<Shape, String>,
}

/// Lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    Box { size: [f64; 3] },
    Cylinder { radius: f64, length: f64 },
    Sphere { radius: f64 },
    Mesh { file: String, scale: [f64; 3] },
}

/// A <collision>.
pub(crate) fn read_collision(node: Node<'_, '_>) -> Collision {
    let pose = match first(node, "origin") {
        None => Some(Pose::identity()),
        Some(origin) => {
            let triple = |name: &str| match origin.attribute(name) {
                None => Some([0.0; 3]),
                Some(text) => numbers(text),
            };
            triple("xyz").zip(triple("rpy")).map(|(xyz, rpy)| Pose::from_xyz_rpy(xyz, rpy))
        }
    };
    let geometry = first(node, "geometry").and_then(|geometry| geometry.first_element_child());
    match pose {
        None => Collision {
            pose: Pose::identity(),
            shape: Err("the origin of a <collision> is no pose".to_owned()),
        },
        Some(pose) => Collision {
            pose,
            shape: geometry.map_or_else(|| Err("a <collision> is empty".to_owned()), shape),
        },
    }
}

fn shape(node: Node<'_, '_>) -> Result<Shape, String> {
    let name = node.tag_name().name();
    let length = |attribute: &str| {
        let [value] = numbers(node.attribute(attribute)?)?;
        (value > 0.0).then_some(value)
    };
    let whole = match name {
        "box" => node
            .attribute("size")
            .and_then(numbers)
            .filter(|size: &[f64; 3]| size.iter().all(|x| *x > 0.0))
            .map(|size| Shape::Box { size }),
        "cylinder" => {
            length("radius").zip(length("length")).map(|(radius, length)| Shape::Cylinder { radius, length })
        }
        "sphere" => length("radius").map(|radius| Shape::Sphere { radius }),
        "mesh" => {
            let scale = node.attribute("scale").map_or(Some([1.0; 3]), numbers);
            node.attribute("filename")
                .zip(scale)
                .map(|(file, scale)| Shape::Mesh { file: file.trim().to_owned(), scale })
        }
        _ => {
            return Err(format!(
                "a <collision> is a <{}>: box, cylinder, sphere and mesh are read",
                shown(name)
            ));
        }
    };
    whole.ok_or_else(|| format!("the sizes of a <{name}> are no lengths"))
}

/// Exactly so many finite numbers of a robot's size.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let number = |word: &str| word.parse::<f64>().ok().filter(|x| x.abs() <= LARGEST);
    let all: Vec<f64> = text.split_whitespace().map(number).collect::<Option<_>>()?;
    all.try_into().ok()
}
