//! Mass, centre and inertia about the centre of a body, with standard deviations, from its ten inertial parameters.

use nalgebra::{DMatrix, DVector};

/// Step of the differences, relative to a standard deviation.
const STEP: f64 = 1e-3;

/// A number with its standard deviation; `None` where the data do not determine it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// SI.
    pub value: f64,
    /// Standard deviation; 0 where it was known beforehand.
    pub sigma: Option<f64>,
}

/// A payload in the numbers that a person knows, in the last frame of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadBody {
    /// XX XY XZ YY YZ ZZ MX MY MZ M at the origin of the frame.
    pub parameters: [Quantity; 10],
    /// kg.
    pub mass: Quantity,
    /// Centre of mass, m.
    pub centre: [Quantity; 3],
    /// XX XY XZ YY YZ ZZ about the centre of mass, kg.m²; XY is -∫xy dm.
    pub inertia: [Quantity; 6],
}

impl PayloadBody {
    /// From ten parameters, their covariance, and which of them the data determine; first-order propagation.
    pub(in crate::estimation) fn new(
        parameters: &DVector<f64>,
        covariance: &DMatrix<f64>,
        determined: &[bool],
    ) -> Self {
        let about = about_centre(parameters);
        let gradient = |out: usize, k: usize| {
            let step = STEP * covariance[(k, k)].max(0.0).sqrt();
            if step == 0.0 {
                return 0.0;
            }
            let at = |by: f64| {
                let mut moved = parameters.clone();
                moved[k] += by;
                about_centre(&moved)[out]
            };
            (at(step) - at(-step)) / (2.0 * step)
        };
        let quantity = |out: usize, needs: &[usize]| {
            let known = needs.iter().all(|&k| determined[k]) && about[out].is_finite();
            let g = DVector::from_fn(10, |k, _| gradient(out, k));
            let variance = (g.transpose() * covariance * &g)[0];
            Quantity { value: about[out], sigma: known.then(|| variance.max(0.0).sqrt()) }
        };
        let own = |k: usize| Quantity {
            value: parameters[k],
            sigma: determined[k].then(|| covariance[(k, k)].max(0.0).sqrt()),
        };
        let needs: [&[usize]; 6] =
            [&[0, 7, 8, 9], &[1, 6, 7, 9], &[2, 6, 8, 9], &[3, 6, 8, 9], &[4, 7, 8, 9], &[5, 6, 7, 9]];
        Self {
            parameters: std::array::from_fn(own),
            mass: own(9),
            centre: std::array::from_fn(|i| quantity(i, &[6 + i, 9])),
            inertia: std::array::from_fn(|i| quantity(3 + i, needs[i])),
        }
    }
}

/// Centre of mass, then the inertia about it.
fn about_centre(p: &DVector<f64>) -> [f64; 9] {
    let m = p[9];
    let [x, y, z] = [p[6] / m, p[7] / m, p[8] / m];
    let steiner = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
    let inertia: [f64; 6] = std::array::from_fn(|k| p[k] - m * steiner[k]);
    let [a, b, c, d, e, f] = inertia;
    [x, y, z, a, b, c, d, e, f]
}
