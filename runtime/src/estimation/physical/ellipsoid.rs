//! Bodies within ellipsoids (Wensing, Kim and Slotine 2018, section IV).
//!
//! A body with pseudo-inertia P whose density is nowhere negative and zero outside of the ellipsoid has tr(P Q) >= 0, with
//! Q = [[-S⁻¹, S⁻¹c], [cᵀS⁻¹, 1 - cᵀS⁻¹c]]: tr(P Q) is the integral of ρ (1 - (p - c)ᵀ S⁻¹ (p - c)). With P positive definite
//! the condition is also enough: there is a density within the ellipsoid that has P.

use dynid_description::Ellipsoid;
use nalgebra::{DVector, Matrix3, Matrix4, Vector3};

use super::pseudo_inertia::{pseudo_inertia, unit_inertia};

/// Shape as a matrix and its inverse; `None` where it is no ellipsoid.
fn shape(ellipsoid: &Ellipsoid) -> Option<(Matrix3<f64>, Matrix3<f64>)> {
    let shape = Matrix3::from_fn(|i, j| ellipsoid.shape[i][j]);
    let is_finite =
        ellipsoid.centre.iter().all(|x| x.is_finite()) && (shape - shape.transpose()).amax() == 0.0;
    let inverse = nalgebra::Cholesky::new(shape)?.inverse();
    (is_finite && inverse.iter().all(|x| x.is_finite())).then_some((shape, inverse))
}

/// Q; `None` where it is no ellipsoid.
fn dual(ellipsoid: &Ellipsoid) -> Option<Matrix4<f64>> {
    let (_, inverse) = shape(ellipsoid)?;
    let centre = Vector3::from(ellipsoid.centre);
    let pulled = inverse * centre;
    let mut q = Matrix4::zeros();
    q.fixed_view_mut::<3, 3>(0, 0).copy_from(&-inverse);
    q.fixed_view_mut::<3, 1>(0, 3).copy_from(&pulled);
    q.fixed_view_mut::<1, 3>(3, 0).copy_from(&pulled.transpose());
    q[(3, 3)] = 1.0 - centre.dot(&pulled);
    Some(q)
}

/// tr(P Q) of a unit of each of XX XY XZ YY YZ ZZ MX MY MZ M; `None` where it is no ellipsoid.
pub(super) fn coefficients(ellipsoid: &Ellipsoid) -> Option<[f64; 10]> {
    let q = dual(ellipsoid)?;
    Some(std::array::from_fn(|place| unit_inertia(place).dot(&q)))
}

/// How far within an ellipsoid a body XX XY XZ YY YZ ZZ MX MY MZ M lies: tr(P Q) over its mass, 1 for a point at the centre, 0.4
/// for one that fills it evenly, 0 where all mass is on its surface, negative for what cannot be within. `None` without mass or
/// for a shape that is not positive definite.
///
/// ```
/// use dynid_runtime::estimation::{ellipsoid_margin, uniform_body};
/// use dynid_runtime::model::Ellipsoid;
///
/// let arm = Ellipsoid { centre: [0.2, 0.0, 0.0], shape: [[0.09, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]] };
/// let full = uniform_body(&arm, 4.0).expect("an ellipsoid");
/// assert!((ellipsoid_margin(&arm, &full).expect("a mass") - 0.4).abs() < 1e-12);
/// ```
pub fn ellipsoid_margin(ellipsoid: &Ellipsoid, body: &[f64; 10]) -> Option<f64> {
    let coefficients = coefficients(ellipsoid)?;
    let trace: f64 = coefficients.iter().zip(body).map(|(a, x)| a * x).sum();
    (body[9] > 0.0).then(|| trace / body[9])
}

/// XX XY XZ YY YZ ZZ MX MY MZ M of a body of this mass, kg, that fills an ellipsoid evenly: its covariance is shape/5. `None`
/// for a shape that is not positive definite.
pub fn uniform_body(ellipsoid: &Ellipsoid, mass: f64) -> Option<[f64; 10]> {
    let (shape, _) = shape(ellipsoid)?;
    let c = Vector3::from(ellipsoid.centre);
    let second = (shape / 5.0 + c * c.transpose()) * mass;
    let inertia = Matrix3::from_diagonal_element(second.trace()) - second;
    let i = |a: usize, b: usize| inertia[(a, b)];
    let first = c * mass;
    Some([i(0, 0), i(0, 1), i(0, 2), i(1, 1), i(1, 2), i(2, 2), first.x, first.y, first.z, mass])
}

/// Pseudo-inertia of ten numbers.
pub(super) fn pseudo_of(body: &[f64; 10]) -> Matrix4<f64> {
    pseudo_inertia(&std::array::from_fn(|k| k), &DVector::from_column_slice(body))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_have_a_margin_and_points_without_have_none() {
        // Axes of 0.3, 0.2 and 0.1 m, turned by 30 degrees about z.
        let turn = nalgebra::Rotation3::from_euler_angles(0.0, 0.0, std::f64::consts::FRAC_PI_6);
        let shape = turn * Matrix3::from_diagonal(&Vector3::new(0.09, 0.04, 0.01)) * turn.transpose();
        let shape = (shape + shape.transpose()) * 0.5;
        let centre = Vector3::new(0.5, -0.2, 0.1);
        let ellipsoid = Ellipsoid {
            centre: centre.into(),
            shape: std::array::from_fn(|i| std::array::from_fn(|j| shape[(i, j)])),
        };
        let point = |p: Vector3<f64>| {
            let i = Matrix3::from_diagonal_element(p.dot(&p)) - p * p.transpose();
            [i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)], p.x, p.y, p.z, 1.0]
                .map(|x| 2.0 * x)
        };
        for (share, wanted) in [(0.0, 1.0), (0.5, 0.75), (1.0, 0.0), (2.0, -3.0)] {
            let at = point(centre + turn * Vector3::new(0.3 * share, 0.0, 0.0));
            assert!((ellipsoid_margin(&ellipsoid, &at).unwrap_or(9.0) - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn what_has_no_volume_is_no_ellipsoid() {
        let flat = Ellipsoid { centre: [0.0; 3], shape: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]] };
        assert_eq!(uniform_body(&flat, 1.0), None);
        let nan = Ellipsoid {
            centre: [f64::NAN, 0.0, 0.0],
            shape: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        assert_eq!(ellipsoid_margin(&nan, &[1.0; 10]), None);
    }
}
