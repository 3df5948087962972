//! Rotations and translations, with right angles that stay exact.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

/// Pose of a frame in another: p = rotation p' + translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Axes of the frame as columns.
    pub rotation: Matrix3<f64>,
    /// Its origin, m.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The frame itself.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// From the `xyz` and `rpy` of a URDF: Rot(z, yaw) Rot(y, pitch) Rot(x, roll).
    pub fn from_xyz_rpy(xyz: [f64; 3], rpy: [f64; 3]) -> Self {
        let [roll, pitch, yaw] = rpy;
        let rotation = about(2, yaw) * about(1, pitch) * about(0, roll);
        Self { rotation, translation: Vector3::from(xyz) }
    }

    /// `other`, a pose in this frame, in the frame that this one is given in.
    pub fn then(&self, other: &Pose) -> Self {
        Self {
            rotation: self.rotation * other.rotation,
            translation: self.rotation * other.translation + self.translation,
        }
    }

    /// The pose of the other frame in this one.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// Roll, pitch and yaw, rad, with pitch within a quarter turn.
    pub fn rpy(&self) -> [f64; 3] {
        let r = &self.rotation;
        let flat = r[(0, 0)].hypot(r[(1, 0)]);
        let pitch = (-r[(2, 0)]).atan2(flat);
        if flat < 1e-9 {
            // Roll and yaw turn about the same axis: yaw stays 0.
            return [(-r[(1, 2)]).atan2(r[(1, 1)]), pitch, 0.0];
        }
        [r[(2, 1)].atan2(r[(2, 2)]), pitch, r[(1, 0)].atan2(r[(0, 0)])]
    }

    /// The rotation as a unit quaternion w x y z, w not negative.
    pub fn quaternion(&self) -> [f64; 4] {
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(self.rotation);
        let q = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        [q.w, q.i, q.j, q.k].map(|x| sign * x)
    }
}

/// Sine and cosine; those of multiples of pi/4 that a double can hold are exact.
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    let eighths = (angle / FRAC_PI_4).round();
    if eighths.abs() < 64.0 && (angle - eighths * FRAC_PI_4).abs() <= 4.0 * f64::EPSILON * angle.abs() {
        const SIN: [f64; 8] =
            [0.0, FRAC_1_SQRT_2, 1.0, FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2, -1.0, -FRAC_1_SQRT_2];
        let k = (eighths as i64).rem_euclid(8) as usize;
        return (SIN[k], SIN[(k + 2) % 8]);
    }
    angle.sin_cos()
}

/// The rotation about a coordinate axis (0 x, 1 y, 2 z).
pub(crate) fn about(axis: usize, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = sin_cos(angle);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut rotation = Matrix3::identity();
    rotation[(i, i)] = cos;
    rotation[(j, j)] = cos;
    rotation[(j, i)] = sin;
    rotation[(i, j)] = -sin;
    rotation
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_have_exact_rotations() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let turned = Pose::from_xyz_rpy([0.0; 3], [quarter, -quarter, 2.0 * quarter]).rotation;
        assert!(turned.iter().all(|x| [0.0, 1.0, -1.0].contains(x)), "{turned}");
    }

    #[test]
    fn angles_and_quaternion_give_the_rotation_back() {
        for rpy in [[0.3, -1.2, 2.5], [-3.0, 1.5, 0.1], [0.4, std::f64::consts::FRAC_PI_2, 0.9]] {
            let pose = Pose::from_xyz_rpy([1.0, 2.0, 3.0], rpy);
            let again = Pose::from_xyz_rpy([1.0, 2.0, 3.0], pose.rpy());
            assert!((again.rotation - pose.rotation).norm() < 1e-14);
            let [w, x, y, z] = pose.quaternion();
            let q = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            assert!((q.to_rotation_matrix().matrix() - pose.rotation).norm() < 1e-14);
            let back = pose.then(&pose.inverse());
            assert!((back.rotation - Matrix3::identity()).norm() + back.translation.norm() < 1e-14);
        }
    }
}
