//! The ellipsoid of least volume around points (Khachiyan 1996; with the steps of Todd and Yildirim 2007).

use dynid_description::Ellipsoid;
use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

/// How much larger than the least one, in the squares of its radii, it may be before it is widened to hold every point.
const TOLERANCE: f64 = 1e-3;
/// Steps of the search; some hundred are usual.
const MOST_STEPS: usize = 20_000;
/// Half thickness, m, that is given to points that lie in a plane, on a line or in one place: a link has some.
const THINNEST: f64 = 1e-3;
/// Directions in which points are farthest that decide the shape: so many turns and tilts.
const TURNS: usize = 24;
const TILTS: usize = 12;
/// How often the shape is found again with directions that suit it.
const PASSES: usize = 3;

/// An ellipsoid that holds all points, m, with as little volume as can be, to about a thousandth; `None` for no points, or for
/// some that are not finite.
pub(crate) fn enclosing(points: &[Vector3<f64>]) -> Option<Ellipsoid> {
    if points.is_empty() || points.iter().any(|p| p.iter().any(|x| !x.is_finite())) {
        return None;
    }
    let middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let thickness = (0..6).map(|k| {
        middle + Vector3::ith(k / 2, THINNEST * if usize::is_multiple_of(k, 2) { 1.0 } else { -1.0 })
    });
    let thickness: Vec<Vector3<f64>> = thickness.collect();
    // Where the points are seen as a ball, directions all around miss none that matter.
    let mut seen = Matrix3::identity();
    let (mut centre, mut shape) = (middle, seen);
    for _ in 0..PASSES {
        let mut outer = outermost(points, &seen);
        outer.extend_from_slice(&thickness);
        (centre, shape) = least_volume(&outer)?;
        seen = nalgebra::Cholesky::new(shape)?.l().try_inverse()?;
    }
    // Widened so that no point is left out, those that did not decide the shape among them.
    let inverse = shape.try_inverse()?;
    let far = |p: &Vector3<f64>| (p - centre).dot(&(inverse * (p - centre)));
    let shape = shape * points.iter().map(far).fold(1.0, f64::max) * (1.0 + 1e-12);
    Some(Ellipsoid {
        centre: centre.into(),
        shape: std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (shape[(i, j)] + shape[(j, i)]))),
    })
}

/// The points that are farthest in directions all around, seen through a linear map.
fn outermost(points: &[Vector3<f64>], seen: &Matrix3<f64>) -> Vec<Vector3<f64>> {
    let along = |d: Vector3<f64>| {
        let d = seen.tr_mul(&d);
        (0..points.len()).max_by(|&a, &b| points[a].dot(&d).total_cmp(&points[b].dot(&d)))
    };
    let mut chosen: Vec<usize> = directions(TURNS, TILTS).filter_map(along).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen.into_iter().map(|k| points[k]).collect()
}

/// Unit vectors on circles of latitude, the poles among them.
pub(crate) fn directions(turns: usize, tilts: usize) -> impl Iterator<Item = Vector3<f64>> {
    use std::f64::consts::PI;
    (0..=tilts).flat_map(move |tilt| {
        let polar = PI * tilt as f64 / tilts as f64;
        (0..turns).map(move |turn| {
            let (sin, cos) = (2.0 * PI * turn as f64 / turns as f64).sin_cos();
            Vector3::new(polar.sin() * cos, polar.sin() * sin, polar.cos())
        })
    })
}

/// Centre and shape of the ellipsoid of least volume around points that span space, to the tolerance. Weights u of the points
/// maximise ln det Σ u q qᵀ, q = (p, 1); at the maximum no point has q ᵀ(Σ u q qᵀ)⁻¹ q above 4.
fn least_volume(points: &[Vector3<f64>]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let lifted: Vec<Vector4<f64>> = points.iter().map(|p| p.push(1.0)).collect();
    let dimension = 4.0;
    let mut weights = vec![1.0 / points.len() as f64; points.len()];
    for _ in 0..MOST_STEPS {
        let moment = lifted.iter().zip(&weights).map(|(q, w)| q * q.transpose() * *w).sum::<Matrix4<f64>>();
        let inverse = moment.try_inverse()?;
        let far: Vec<f64> = lifted.iter().map(|q| q.dot(&(inverse * q))).collect();
        let all = || 0..points.len();
        let out = all().max_by(|&a, &b| far[a].total_cmp(&far[b]))?;
        let within = all().filter(|&k| weights[k] > 0.0).min_by(|&a, &b| far[a].total_cmp(&far[b]))?;
        let (above, below) = (far[out] / dimension - 1.0, 1.0 - far[within] / dimension);
        if above < TOLERANCE && below < TOLERANCE {
            break;
        }
        // Towards the point farthest out, or away from the one farthest in.
        let (k, far) = if above >= below { (out, far[out]) } else { (within, far[within]) };
        let full = (far - dimension) / (dimension * (far - 1.0));
        let step = full.max(-weights[k] / (1.0 - weights[k]));
        weights.iter_mut().for_each(|w| *w *= 1.0 - step);
        weights[k] = (weights[k] + step).max(0.0);
    }
    let centre: Vector3<f64> = points.iter().zip(&weights).map(|(p, w)| p * *w).sum();
    let spread = |p: &Vector3<f64>| (p - centre) * (p - centre).transpose();
    let shape: Matrix3<f64> = points.iter().zip(&weights).map(|(p, w)| spread(p) * (3.0 * *w)).sum();
    Some((centre, shape))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn matrix(e: &Ellipsoid) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| e.shape[i][j])
    }

    #[test]
    fn around_a_box_the_radii_are_root_three_times_half_its_sides() {
        let corner = |k: usize| {
            let side = |bit: usize, half: f64| if k >> bit & 1 == 0 { half } else { -half };
            Vector3::new(1.0 + side(0, 0.3), side(1, 0.2), side(2, 0.1))
        };
        let corners: Vec<Vector3<f64>> = (0..8).map(corner).collect();
        let found = enclosing(&corners).unwrap();
        for (k, half) in [0.3_f64, 0.2, 0.1].into_iter().enumerate() {
            assert!((found.shape[k][k] / (3.0 * half * half) - 1.0).abs() < 2e-3, "{found:?}");
        }
        assert!((found.centre[0] - 1.0).abs() < 1e-4);
    }

    #[test]
    fn it_holds_all_points_and_is_no_larger_than_the_ellipsoid_that_they_are_on() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(5);
        for _ in 0..20 {
            let mut number = || random.random::<f64>() - 0.5;
            let turn = nalgebra::Rotation3::from_euler_angles(6.0 * number(), 3.0 * number(), 6.0 * number());
            let radii = Vector3::new(0.3 + 0.2 * number(), 0.1 + 0.1 * number(), 0.06 + 0.1 * number());
            let centre = Vector3::new(number(), number(), number());
            let on = |v: Vector3<f64>| centre + turn * v.normalize().component_mul(&radii);
            let points: Vec<Vector3<f64>> =
                (0..3000).map(|_| on(Vector3::new(number(), number(), number()))).collect();
            let found = enclosing(&points).unwrap();
            let inverse = matrix(&found).try_inverse().unwrap();
            let c = Vector3::from(found.centre);
            assert!(points.iter().all(|p| (p - c).dot(&(inverse * (p - c))) <= 1.0));
            let volume = matrix(&found).determinant().sqrt() / (radii.x * radii.y * radii.z).abs();
            assert!((0.9..1.03).contains(&volume), "{volume}");
        }
    }

    #[test]
    fn points_in_a_plane_or_in_one_place_get_a_thickness() {
        for points in [vec![Vector3::x()], vec![Vector3::x(), Vector3::y(), Vector3::zeros()]] {
            let found = enclosing(&points).unwrap();
            assert!(matrix(&found).symmetric_eigenvalues().min().sqrt() > 0.9 * THINNEST, "{found:?}");
        }
        assert_eq!(enclosing(&[]), None);
        assert_eq!(enclosing(&[Vector3::new(f64::NAN, 0.0, 0.0)]), None);
    }
}
