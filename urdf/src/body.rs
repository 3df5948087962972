//! The ten inertial parameters of a body, and what they are seen from another frame.

use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::pose::Pose;

/// How far below zero, relative to the largest, a moment may be by rounding.
const ROUNDING: f64 = 1e-6;

/// A rigid body about the origin of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// kg.
    pub mass: f64,
    /// Mass times the centre of mass, kg.m.
    pub first: Vector3<f64>,
    /// Moments of inertia about the frame's origin, kg.m2.
    pub inertia: Matrix3<f64>,
}

impl Body {
    /// Nothing.
    pub fn none() -> Self {
        Self { mass: 0.0, first: Vector3::zeros(), inertia: Matrix3::zeros() }
    }

    /// A body whose centre of mass is the frame's origin; moments in the order xx xy xz yy yz zz.
    pub fn at_centre(mass: f64, moments: [f64; 6]) -> Self {
        Self { mass, first: Vector3::zeros(), inertia: symmetric(moments) }
    }

    /// From XX XY XZ YY YZ ZZ MX MY MZ M at the frame's origin.
    pub fn from_parameters(p: &[f64; 10]) -> Self {
        let moments = [p[0], p[1], p[2], p[3], p[4], p[5]];
        Self { mass: p[9], first: Vector3::new(p[6], p[7], p[8]), inertia: symmetric(moments) }
    }

    /// XX XY XZ YY YZ ZZ MX MY MZ M at the frame's origin.
    pub fn parameters(&self) -> [f64; 10] {
        let i = &self.inertia;
        let f = &self.first;
        [i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)], f.x, f.y, f.z, self.mass]
    }

    /// The same body seen from the frame in which its own frame has this pose.
    pub fn seen_from(&self, pose: &Pose) -> Self {
        let (rotation, p) = (pose.rotation, pose.translation);
        let first = rotation * self.first;
        let inertia = rotation * self.inertia * rotation.transpose();
        // J' = J - [p][f] - [f][p] - M [p][p], with [a][b] = b aT - (a.b) E.
        let product =
            |a: &Vector3<f64>, b: &Vector3<f64>| b * a.transpose() - Matrix3::from_diagonal_element(a.dot(b));
        let moved = inertia - product(&p, &first) - product(&first, &p) - product(&p, &p) * self.mass;
        Self { mass: self.mass, first: first + p * self.mass, inertia: (moved + moved.transpose()) * 0.5 }
    }

    /// Both together, about the same origin.
    pub fn with(&self, other: &Body) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            inertia: self.inertia + other.inertia,
        }
    }

    /// What is left without the other.
    pub fn without(&self, other: &Body) -> Self {
        Self {
            mass: self.mass - other.mass,
            first: self.first - other.first,
            inertia: self.inertia - other.inertia,
        }
    }

    /// Mass, centre of mass and the moments about it, axes as the frame's; `None` where there is no mass.
    pub fn centred(&self) -> Option<(f64, Vector3<f64>, Matrix3<f64>)> {
        (self.mass > 0.0).then(|| {
            let centre = self.first / self.mass;
            let spread = Matrix3::from_diagonal_element(centre.dot(&centre)) - centre * centre.transpose();
            (self.mass, centre, self.inertia - spread * self.mass)
        })
    }

    /// The pseudo-inertia [[S, f], [fT, M]] with S = tr(J)/2 E - J (Wensing, Kim and Slotine 2018).
    pub fn pseudo_inertia(&self) -> Matrix4<f64> {
        let second = Matrix3::from_diagonal_element(0.5 * self.inertia.trace()) - self.inertia;
        let mut pseudo = Matrix4::zeros();
        pseudo.fixed_view_mut::<3, 3>(0, 0).copy_from(&second);
        for i in 0..3 {
            pseudo[(i, 3)] = self.first[i];
            pseudo[(3, i)] = self.first[i];
        }
        pseudo[(3, 3)] = self.mass;
        pseudo
    }

    /// Whether a body can have these numbers: its density is nowhere negative, to rounding.
    pub fn is_possible(&self) -> bool {
        let values = self.pseudo_inertia().symmetric_eigenvalues();
        values.min() >= -ROUNDING * values.amax()
    }
}

fn symmetric([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_mass_has_the_moments_of_its_place() {
        let pose = Pose::from_xyz_rpy([0.1, -0.2, 0.3], [0.4, 0.5, 0.6]);
        let point = Body::at_centre(2.0, [0.0; 6]).seen_from(&pose);
        let expected = [0.26, 0.04, -0.06, 0.2, 0.12, 0.1, 0.2, -0.4, 0.6, 2.0];
        for (a, b) in point.parameters().iter().zip(expected) {
            assert!((a - b).abs() < 1e-15, "{:?}", point.parameters());
        }
    }

    #[test]
    fn there_and_back_is_the_same_body() {
        let body = Body::at_centre(3.0, [0.2, 0.01, -0.02, 0.3, 0.03, 0.25]);
        assert!(body.is_possible());
        let pose = Pose::from_xyz_rpy([1.0, 2.0, -0.5], [0.3, -1.0, 2.0]);
        let there = body.seen_from(&pose);
        assert!(there.is_possible());
        let back = there.seen_from(&pose.inverse());
        for (a, b) in back.parameters().iter().zip(body.parameters()) {
            assert!((a - b).abs() < 1e-13);
        }
        let (mass, centre, moments) = there.centred().expect("a mass");
        assert!((mass - 3.0).abs() < 1e-15 && (centre - pose.translation).norm() < 1e-15);
        let turned = pose.rotation * body.inertia * pose.rotation.transpose();
        assert!((moments - turned).norm() < 1e-13);
    }
}
