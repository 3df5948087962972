//! Where the mass of links can be.

use super::document::Node;
use super::known::Known;
use super::magnitudes::within;
use super::reader::Reader;
use dynid_description::bounds::{LONGEST, WIDEST};
use dynid_description::{Ellipsoid, ParameterKind, StandardParameter};

const KEYS: [&str; 4] = ["frame", "centre", "radii", "rpy"];
/// Least radius, m: what is thinner is no body's.
const THINNEST: f64 = 1e-6;

/// Reads `ellipsoids`: of each its frame, and in that frame its centre, its radii and how its axes are turned. Ascending by
/// index of the frame.
pub(super) fn read_ellipsoids(
    reader: &mut Reader,
    node: &Node,
    known: (&[StandardParameter], &Known),
    constants: &[(String, f64)],
) -> Vec<(usize, Ellipsoid)> {
    let what = "ellipsoids as a list ([{frame: 2, centre: [0.2, 0, 0], radii: [0.3, 0.1, 0.1]}])";
    let mut all: Vec<(usize, Ellipsoid)> = Vec::new();
    for item in reader.list(node, what).unwrap_or(&[]) {
        let Some((frame, ellipsoid)) = read_one(reader, item, known, constants) else { continue };
        if all.iter().any(|(other, _)| *other == frame) {
            reader.report(item.place, format!("frame {} has an ellipsoid already", frame + 1));
        } else {
            all.push((frame, ellipsoid));
        }
    }
    all.sort_by_key(|(frame, _)| *frame);
    all
}

fn read_one(
    reader: &mut Reader,
    node: &Node,
    (standard, known): (&[StandardParameter], &Known),
    constants: &[(String, f64)],
) -> Option<(usize, Ellipsoid)> {
    let fields = reader.fields(node, "an ellipsoid", &KEYS)?;
    let at = reader.required(&fields, "frame");
    let frame = at.and_then(|at| {
        let j = reader.integer(at, "the number j of a frame")?;
        let frames = standard.iter().map(|p| p.frame + 1).max().unwrap_or(0);
        if !(1..=frames).contains(&j) {
            reader.report(at.place, format!("there is no frame {j}: the table has frames 1 to {frames}"));
            return None;
        }
        let mass = standard.iter().position(|p| p.frame + 1 == j && p.kind == ParameterKind::M);
        if mass.is_some_and(|mass| known.zero.contains(&mass)) {
            reader
                .report(at.place, format!("frame {j} is known to have no mass that an ellipsoid could hold"));
            return None;
        }
        Some(j - 1)
    });
    let mut three = |key: &str, least: f64, most: f64| {
        let node = fields.get(key)?;
        let values = reader.numbers(node, key, 3, constants)?;
        if let Some(wrong) = values.iter().find(|x| least > 0.0 && **x <= 0.0) {
            reader.report(node.place, format!("{key} has {wrong}: expected numbers above 0, m"));
            return None;
        }
        values.iter().for_each(|&x| within(reader, node, key, x, [least, most]));
        Some([values[0], values[1], values[2]])
    };
    let centre = three("centre", 0.0, LONGEST);
    let radii = three("radii", THINNEST, LONGEST);
    let turned = three("rpy", 0.0, WIDEST);
    let centre = if fields.get("centre").is_some() { centre? } else { [0.0; 3] };
    let turned = if fields.get("rpy").is_some() { turned? } else { [0.0; 3] };
    reader.required(&fields, "radii")?;
    Some((frame?, Ellipsoid::with_axes(centre, radii?, turned)))
}
