//! The pseudo-inertia of a link (Wensing, Kim and Slotine 2018).

use nalgebra::{DVector, Matrix4};

/// [[Σ, MS], [MSᵀ, M]] with Σ = ½ tr(J) E - J, by its ten parameters.
pub(super) fn pseudo_inertia(link: &[usize; 10], x: &DVector<f64>) -> Matrix4<f64> {
    link.iter().enumerate().fold(Matrix4::zeros(), |sum, (place, &k)| sum + unit_inertia(place) * x[k])
}

/// The pseudo-inertia of one unit of an inertial parameter, in the order XX XY XZ YY YZ ZZ MX MY MZ M.
pub(super) fn unit_inertia(place: usize) -> Matrix4<f64> {
    let mut unit = Matrix4::zeros();
    let mut both = |i, j, value| {
        unit[(i, j)] = value;
        unit[(j, i)] = value;
    };
    match place {
        0 | 3 | 5 => {
            let own = place / 2;
            (0..3).for_each(|i| both(i, i, if i == own { -0.5 } else { 0.5 }));
        }
        1 => both(0, 1, -1.0),
        2 => both(0, 2, -1.0),
        4 => both(1, 2, -1.0),
        6..=8 => both(place - 6, 3, 1.0),
        _ => both(3, 3, 1.0),
    }
    unit
}
