//! A pose as the row of a modified-DH table: Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r).
//!
//! Six numbers, and the decomposition of any pose into them is that of a rotation into z-x-z angles, with the distances
//! along the same axes (Khalil and Kleinfinger 1986 for trees).

use nalgebra::Vector3;

use crate::pose::Pose;

/// Lines closer to parallel than this, rad, are parallel; lengths below it, m, are zero.
pub(crate) const EXACT: f64 = 1e-12;
/// Where the common normal meets the axes, as a multiple of how far the frames are apart: beyond it the lines are so close
/// to parallel that numbers of the row are large only because of that.
const FARTHEST: f64 = 30.0;
/// The distance that counts where the frames are closer, m.
const NEAREST: f64 = 0.1;

/// The numbers of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Screw {
    pub gamma: f64,
    pub b: f64,
    pub alpha: f64,
    pub d: f64,
    pub theta: f64,
    pub r: f64,
}

/// The common normal of the z axis of a frame and a line, seen from the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Normal {
    /// The same line.
    Same,
    /// Parallel lines: from the z axis to the line, square to both.
    Parallel(Vector3<f64>),
    /// Unit vector along the normal, and the heights of its ends: on the z axis, and on the line from its point.
    Skew { along: Vector3<f64>, on_axis: f64, on_line: f64 },
}

/// The common normal of the z axis and the line through `point` along the unit vector `axis`; `None` where the lines are so
/// close to parallel without being it that the normal is far away.
pub(crate) fn normal(point: &Vector3<f64>, axis: &Vector3<f64>) -> Option<Normal> {
    let across = Vector3::new(-axis.y, axis.x, 0.0);
    let sine = across.norm();
    if sine <= EXACT {
        let apart = Vector3::new(point.x, point.y, 0.0) - axis * (axis.x * point.x + axis.y * point.y);
        return Some(if apart.norm() <= EXACT { Normal::Same } else { Normal::Parallel(apart) });
    }
    // b ez + d along = point + s axis, solved along ez and axis.
    let (pz, pa, c) = (point.z, point.dot(axis), axis.z);
    let determinant = sine * sine;
    let on_axis = (pz - c * pa) / determinant;
    let on_line = (c * pz - pa) / determinant;
    let farthest = FARTHEST * point.norm().max(NEAREST);
    let near = on_axis.abs() <= farthest && on_line.abs() <= farthest;
    near.then(|| Normal::Skew { along: across / sine, on_axis, on_line })
}

impl Screw {
    /// The row of a pose; `None` where the z axes are so close to parallel that their normal is far away.
    ///
    /// Of the two directions of the normal the one is taken that keeps gamma within a quarter turn. Where the axes are
    /// parallel, b is 0; where they are the same, gamma and d are 0 too.
    pub fn of(pose: &Pose) -> Option<Screw> {
        let axis: Vector3<f64> = pose.rotation.column(2).into();
        let p = pose.translation;
        let (x, b) = match normal(&p, &axis)? {
            Normal::Same => (Vector3::x(), 0.0),
            Normal::Parallel(apart) => (forward(apart / apart.norm()), 0.0),
            Normal::Skew { along, on_axis, .. } => (forward(along), on_axis),
        };
        let gamma = x.y.atan2(x.x);
        let y = Vector3::new(-x.y, x.x, 0.0);
        let alpha = (-axis.dot(&y)).atan2(axis.z);
        // x of the frame in the axes (x, axis cross x) that theta turns.
        let side = axis.cross(&x);
        let turned: Vector3<f64> = pose.rotation.column(0).into();
        let theta = turned.dot(&side).atan2(turned.dot(&x));
        let rest = p - Vector3::new(0.0, 0.0, b);
        Some(Screw { gamma, b, alpha, d: rest.dot(&x), theta, r: rest.dot(&axis) })
    }

    /// The pose of a row.
    pub fn pose(&self) -> Pose {
        use crate::pose::about;
        let turn = |axis, angle| Pose { rotation: about(axis, angle), translation: Vector3::zeros() };
        let shift = |x, z| Pose { translation: Vector3::new(x, 0.0, z), ..Pose::identity() };
        [
            turn(2, self.gamma),
            shift(0.0, self.b),
            turn(0, self.alpha),
            shift(self.d, 0.0),
            turn(2, self.theta),
            shift(0.0, self.r),
        ]
        .iter()
        .fold(Pose::identity(), |sum, next| sum.then(next))
    }
}

/// The vector or its opposite: the one within a quarter turn of x; at a quarter turn the one along y.
fn forward(x: Vector3<f64>) -> Vector3<f64> {
    let back = x.x < -EXACT || (x.x.abs() <= EXACT && x.y < 0.0);
    if back { -x } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;
    use proptest::prelude::*;

    fn apart(a: &Pose, b: &Pose) -> f64 {
        (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm()
    }

    proptest! {
        #[test]
        fn any_pose_is_a_row(rpy in [-3.1..3.1, -3.1..3.1, -3.1..3.1], xyz in [-1.0..1.0, -1.0..1.0, -1.0..1.0]) {
            let pose = Pose::from_xyz_rpy(xyz, rpy);
            if let Some(screw) = Screw::of(&pose) {
                prop_assert!(apart(&screw.pose(), &pose) < 1e-12, "{screw:?}");
                prop_assert!(screw.gamma.abs() <= std::f64::consts::FRAC_PI_2 + 1e-12);
            }
        }

        #[test]
        fn right_angles_and_parallel_axes_are_rows(k in [0..4_i32, 0..4, 0..4], xyz in [0..3_i32, 0..3, 0..3]) {
            let quarter = std::f64::consts::FRAC_PI_2;
            let pose = Pose::from_xyz_rpy(xyz.map(|x| f64::from(x - 1) * 0.3), k.map(|k| f64::from(k) * quarter));
            let screw = Screw::of(&pose).expect("no normal is far away");
            prop_assert!(apart(&screw.pose(), &pose) < 1e-14, "{screw:?}");
        }
    }

    #[test]
    fn axes_that_are_nearly_parallel_have_no_row() {
        let pose = Pose::from_xyz_rpy([0.2, 0.3, 0.1], [1e-5, 0.0, 0.0]);
        assert_eq!(Screw::of(&pose), None);
        let meeting = Pose { translation: Vector3::zeros(), rotation: Matrix3::identity() };
        assert!(Screw::of(&meeting).is_some_and(
            |screw| screw == Screw { gamma: 0.0, b: 0.0, alpha: 0.0, d: 0.0, theta: 0.0, r: 0.0 }
        ));
    }
}
