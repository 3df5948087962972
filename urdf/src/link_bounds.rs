//! Ellipsoids that hold the links of a template, in frames of the table.

use nalgebra::Vector3;

use crate::document::Urdf;
use crate::enclosing::{directions, enclosing};
use crate::geometry::{Collision, Shape};
use crate::mistake::shown;
use crate::pose::Pose;
use crate::template::Template;
use dynid_description::Ellipsoid;

/// Corners of the polygon that stands for a circle.
const CORNERS: usize = 32;
/// Circles of the polyhedron that stands for a ball.
const TILTS: usize = 16;
/// Largest coordinate of a mesh, m: also of one in millimetres without a scale.
const FARTHEST: f64 = 1e4;

/// What is known of where a link's mass can be.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkBound {
    /// Frame of the table, 0-based.
    pub frame: usize,
    /// Name of the link whose inertial parameters are identified.
    pub link: String,
    /// What holds its geometry and that of all links fixed to it, in the frame of the table; or why that is not known.
    pub ellipsoid: Result<Ellipsoid, String>,
}

/// Reads the vertices of a mesh by the name that the URDF has for its file, or says why it cannot.
pub type Meshes<'a> = dyn Fn(&str) -> Result<Vec<[f64; 3]>, String> + 'a;

impl Template<'_> {
    /// For each moving body an ellipsoid that holds the `<collision>` of its link and of what is fixed to it, the smallest to
    /// about a hundredth. `meshes` reads the vertices of a mesh file.
    pub fn bounds(&self, meshes: &Meshes<'_>) -> Vec<LinkBound> {
        let bound = |(k, body): (usize, usize)| {
            let known = self.body(k, self.frames[body]);
            let links = &self.tree.bodies[k].links;
            let ellipsoid = ellipsoid_of(self.urdf, links, &self.in_link[k], Some(&known.link), meshes);
            LinkBound { frame: known.frame, link: known.link, ellipsoid }
        };
        self.carriers().map(bound).collect()
    }

    /// Whether any link that moves has a `<collision>`.
    pub fn has_geometry(&self) -> bool {
        let links = self.tree.bodies.iter().flat_map(|body| &body.links);
        links.into_iter().any(|(link, _)| !self.urdf.links[*link].collisions.is_empty())
    }
}

/// The ellipsoid around the geometry of links that one joint moves, in the frame of the table, whose pose in the link of the
/// joint is `in_link`. `target` is the link whose mass is asked for, all that have some where it is not given: these must have
/// geometry.
pub(crate) fn ellipsoid_of(
    urdf: &Urdf,
    links: &[(usize, Pose)],
    in_link: &Pose,
    target: Option<&str>,
    meshes: &Meshes<'_>,
) -> Result<Ellipsoid, String> {
    let to_table = in_link.inverse();
    let mut points = Vec::new();
    for (link, pose) in links {
        let link = &urdf.links[*link];
        let name = shown(&link.name);
        let is_target = target == Some(link.name.as_str());
        if is_target && link.collisions.is_empty() {
            return Err("it has no <collision>".to_owned());
        }
        if target.is_none() && link.inertial.is_some() && link.collisions.is_empty() {
            return Err(format!("'{name}' has an <inertial> and no <collision>"));
        }
        for collision in &link.collisions {
            let own = points_of(collision, meshes).map_err(|why| match target {
                None => format!("of '{name}' {why}"),
                Some(_) if is_target => why,
                Some(_) => format!("of '{name}', which is fixed to it, {why}"),
            })?;
            let seen = to_table.then(pose).then(&collision.pose);
            points.extend(own.iter().map(|p| seen.rotation * p + seen.translation));
        }
    }
    if points.is_empty() {
        return Err("it has no <collision>".to_owned());
    }
    enclosing(&points).ok_or_else(|| "nothing encloses its geometry".to_owned())
}

/// Points whose convex hull holds a part of a link, in the frame of that part.
fn points_of(collision: &Collision, meshes: &Meshes<'_>) -> Result<Vec<Vector3<f64>>, String> {
    use std::f64::consts::PI;
    match collision.shape.as_ref().map_err(Clone::clone)? {
        Shape::Box { size } => {
            let corner =
                |k: usize| Vector3::from_fn(|i, _| if k >> i & 1 == 0 { 0.5 } else { -0.5 } * size[i]);
            Ok((0..8).map(corner).collect())
        }
        Shape::Cylinder { radius, length } => {
            // The polygon is around the circle.
            let outer = radius / (PI / CORNERS as f64).cos();
            let corner = |k: usize| {
                let (sin, cos) = (2.0 * PI * (k / 2) as f64 / CORNERS as f64).sin_cos();
                Vector3::new(outer * cos, outer * sin, if k.is_multiple_of(2) { 0.5 } else { -0.5 } * length)
            };
            Ok((0..2 * CORNERS).map(corner).collect())
        }
        Shape::Sphere { radius } => {
            // No direction is farther from one of them than half the diagonal of a cell: the hull of these holds the ball.
            let outer = radius / (PI / TILTS as f64 * std::f64::consts::FRAC_1_SQRT_2).cos();
            Ok(directions(2 * TILTS, TILTS).map(|d| d * outer).collect())
        }
        Shape::Mesh { file, scale } => {
            let vertices = meshes(file).map_err(|why| format!("the mesh {}: {why}", shown(file)))?;
            let points: Vec<Vector3<f64>> =
                vertices.iter().map(|v| Vector3::from_fn(|i, _| v[i] * scale[i])).collect();
            match points.iter().all(|p| p.amax() <= FARTHEST) {
                true => Ok(points),
                false => Err(format!("the mesh {}: it is larger than any robot", shown(file))),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]
    use super::*;
    use nalgebra::Matrix3;
    use rand::{RngExt, SeedableRng};

    fn collision(shape: Shape) -> Collision {
        Collision { pose: Pose::identity(), shape: Ok(shape) }
    }

    fn around(shape: Shape) -> (Vector3<f64>, Matrix3<f64>) {
        let points = points_of(&collision(shape), &|_| Err("no mesh".to_owned())).unwrap();
        let found = enclosing(&points).unwrap();
        (Vector3::from(found.centre), Matrix3::from_fn(|i, j| found.shape[i][j]))
    }

    #[test]
    fn every_point_of_a_ball_and_of_a_cylinder_is_within_and_little_else() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(8);
        let ball = around(Shape::Sphere { radius: 0.2 });
        let can = around(Shape::Cylinder { radius: 0.1, length: 0.6 });
        let far = |(c, s): &(Vector3<f64>, Matrix3<f64>), p: Vector3<f64>| {
            (p - c).dot(&(s.try_inverse().unwrap() * (p - c)))
        };
        for _ in 0..2000 {
            let v = Vector3::from_fn(|_, _| random.random::<f64>() - 0.5).normalize();
            assert!(far(&ball, v * 0.2) <= 1.0);
            let rim = Vector3::new(v.x, v.y, 0.0).normalize() * 0.1;
            assert!(far(&can, rim + Vector3::z() * 0.3 * v.z.signum()) <= 1.0);
        }
        assert!(ball.1.symmetric_eigenvalues().max().sqrt() < 0.2 * 1.02);
        // The ellipsoid of least volume around a cylinder: radii r sqrt(3/2) and sqrt(3) l/2.
        let wanted = Vector3::new(0.015, 0.015, 0.27);
        assert!((0..3).all(|k| (can.1[(k, k)] / wanted[k] - 1.0).abs() < 0.03), "{}", can.1);
    }
}
