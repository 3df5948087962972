//! Ellipsoids around the geometry of links, in the YAML of a robot.

use std::fmt::Write as _;

use nalgebra::{Matrix3, Vector3};

use crate::document::Urdf;
use crate::frames::Frames;
use crate::link_bounds::{Meshes, ellipsoid_of};
use crate::pose::Pose;
use crate::tree::{Moving, Tree};
use dynid_description::Ellipsoid;

/// What is added to radii, m and as a part of the largest: more than rounding to a micrometre and a microradian takes away.
const ROUNDED: f64 = 3e-6;

/// Ellipsoids around the `<collision>` of what moves, and which frame has none for what reason; empty where nothing has
/// geometry. `between` are bodies that are none.
pub(crate) fn ellipsoids(
    urdf: &Urdf,
    tree: &Tree,
    frames: &Frames,
    between: &[usize],
    meshes: &Meshes<'_>,
) -> String {
    let bodies = || tree.bodies.iter().enumerate().filter(|(k, _)| !between.contains(k));
    let has_some = |m: &Moving| m.links.iter().any(|(link, _)| !urdf.links[*link].collisions.is_empty());
    if !bodies().any(|(_, m)| has_some(m)) {
        return String::new();
    }
    let (mut entries, mut none) = (String::new(), String::new());
    for (k, moving) in bodies() {
        let j = frames.number[k];
        // Writing to a String cannot fail.
        match ellipsoid_of(urdf, &moving.links, &frames.in_link[k], None, meshes) {
            Ok(found) => {
                let _ = writeln!(entries, "  - {}", entry(j, &found));
            }
            Err(why) => {
                let _ = writeln!(none, "  # none of frame {j}: {why}");
            }
        }
    }
    let head = if entries.is_empty() { "# ellipsoids:" } else { "ellipsoids:" };
    format!("{head:34}# around the <collision> of the links, m, rad: their mass is within\n{entries}{none}")
}

/// An ellipsoid by its radii and the turn of its axes.
fn entry(j: usize, ellipsoid: &Ellipsoid) -> String {
    let shape = Matrix3::from_fn(|i, k| ellipsoid.shape[i][k]);
    let eigen = shape.symmetric_eigen();
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let turned = Pose { rotation: axes, translation: Vector3::zeros() }.rpy();
    // To a micrometre and a microradian; no -0.
    let list = |values: [f64; 3]| values.map(|x| ((x * 1e6).round() / 1e6 + 0.0).to_string()).join(", ");
    let largest = eigen.eigenvalues.max().max(0.0).sqrt();
    let radii = [0, 1, 2].map(|k| eigen.eigenvalues[k].max(0.0).sqrt() + ROUNDED * (1.0 + largest));
    let (centre, radii, turned) = (list(ellipsoid.centre), list(radii), list(turned));
    format!("{{frame: {j}, centre: [{centre}], radii: [{radii}], rpy: [{turned}]}}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_read_as_an_ellipsoid_that_is_as_large_and_no_smaller() {
        let turned = Ellipsoid::with_axes([0.1, -0.2, 0.3], [0.4, 0.1, 0.05], [0.3, -0.7, 2.1]);
        let text = entry(3, &turned);
        let numbers = |key: &str| -> [f64; 3] {
            let (_, rest) = text.split_once(&format!("{key}: [")).unwrap_or_default();
            let list = rest.split(']').next().unwrap_or_default();
            let all: Vec<f64> = list.split(", ").filter_map(|x| x.parse().ok()).collect();
            [all[0], all[1], all[2]]
        };
        let again = Ellipsoid::with_axes(numbers("centre"), numbers("radii"), numbers("rpy"));
        let matrix = |e: &Ellipsoid| Matrix3::from_fn(|i, k| e.shape[i][k]);
        let more = (matrix(&again) - matrix(&turned)).symmetric_eigenvalues();
        assert!(more.min() >= 0.0 && more.max() < 1e-5, "{more} {text}");
        assert!(text.starts_with("{frame: 3, ") && numbers("centre") == turned.centre, "{text}");
    }
}
