//! The body nearest to ten numbers that were fitted as if they were one.

use nalgebra::{DMatrix, DVector};

use super::problem::Problem;

/// Squared error of a row that no parameter changes, for each number: the distance to the best body is found to a hundredth
/// of a standard deviation squared where the numbers are a body already.
const FLOOR: f64 = 1.0;
/// What the information matrix has added on its diagonal, relative to its largest entry there, so that it has a root.
const RIDGE: f64 = 1e-14;

/// Cost, in standard deviations, of the least mass that a body with the first and second moments can have: so little that it
/// decides only where the mass does not show.
const LIGHTER: f64 = 0.1;

/// Least mass of a body within reach that has these first moments, or moments of inertia, kg.
fn lightest(numbers: &DVector<f64>, reach: f64) -> f64 {
    let first = numbers.rows(6, 3).norm() / reach;
    [0, 3, 5].into_iter().fold(first, |most, k| most.max(numbers[k] / (reach * reach)))
}

/// A body and what it costs.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestBody {
    /// XX XY XZ YY YZ ZZ MX MY MZ M at the origin of the frame.
    pub parameters: [f64; 10],
    /// Squared distance of the numbers from it, in the metric of their information.
    pub cost: f64,
}

/// The body nearest to ten inertial parameters XX XY XZ YY YZ ZZ MX MY MZ M, in the metric of their information (inverse
/// covariance); where that is singular, what is not determined is free.
///
/// A body has a positive semidefinite pseudo-inertia (Wensing, Kim and Slotine 2018), and where `reach` (m) is given it
/// lies within that distance of the frame's origin, so that its squared distances weighted by mass are at most reach² M.
/// `None` where the numbers are none, or the best body is not found.
pub fn nearest_body(
    information: &DMatrix<f64>,
    numbers: &DVector<f64>,
    reach: Option<f64>,
) -> Option<NearestBody> {
    let largest = information.diagonal().max();
    let is_positive = largest > 0.0 && largest.is_finite();
    if information.nrows() != 10 || numbers.len() != 10 || !is_positive {
        return None;
    }
    // Equations with this information: a root of it, of unit diagonal because units differ by orders of magnitude.
    let scale = information.diagonal().map(|d| if d > 0.0 { d.sqrt() } else { 0.0 });
    let unit = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
    let scaled = DMatrix::from_fn(10, 10, |i, k| information[(i, k)] * unit(scale[i]) * unit(scale[k]));
    let eigen = scaled.symmetric_eigen();
    let mut g = DMatrix::<f64>::zeros(12, 10);
    for (i, &value) in eigen.eigenvalues.iter().enumerate() {
        let root = value.max(RIDGE).sqrt();
        for k in 0..10 {
            g[(i, k)] = root * eigen.eigenvectors[(k, i)] * scale[k];
        }
    }
    let mut y = &g * numbers;
    y[10] = (10.0 * FLOOR).sqrt();
    // Of bodies that do as well the lighter one.
    let lightest = lightest(numbers, reach.unwrap_or(1.0));
    if lightest > 0.0 {
        (g[(11, 9)], y[11]) = (LIGHTER / lightest, 0.0);
    }
    let mut start = DVector::zeros(10);
    let near = reach.map_or(1.0, |r| r * r);
    for (place, value) in [(0, 0.1 * near), (3, 0.1 * near), (5, 0.1 * near), (9, 1.0)] {
        start[place] = value;
    }
    // tr Σ = (XX + YY + ZZ) / 2
    let within = |r: f64| vec![(9, 1.0), (0, -0.5 / (r * r)), (3, -0.5 / (r * r)), (5, -0.5 / (r * r))];
    let problem = Problem {
        normal: g.tr_mul(&g),
        g,
        y,
        links: vec![std::array::from_fn(|k| k)],
        positive: reach.map(within).into_iter().collect(),
        start,
        free: 10.0 * FLOOR,
    };
    let body = problem.solve()?;
    let off = &body - numbers;
    let parameters = std::array::from_fn(|k| body[k]);
    Some(NearestBody { parameters, cost: off.dot(&(information * &off)).max(0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 kg at (0.1, -0.2, 0.3) m with principal moments of 0.01, 0.02 and 0.025 kg.m².
    fn a_box() -> DVector<f64> {
        let (m, c, i) = (2.0, [0.1, -0.2, 0.3], [0.01, 0.02, 0.025]);
        DVector::from_vec(vec![
            i[0] + m * (c[1] * c[1] + c[2] * c[2]),
            -m * c[0] * c[1],
            -m * c[0] * c[2],
            i[1] + m * (c[0] * c[0] + c[2] * c[2]),
            -m * c[1] * c[2],
            i[2] + m * (c[0] * c[0] + c[1] * c[1]),
            m * c[0],
            m * c[1],
            m * c[2],
            m,
        ])
    }

    #[test]
    fn a_body_costs_nothing_and_stays_what_it_is() {
        let information = DMatrix::identity(10, 10) * 1e6;
        let found = nearest_body(&information, &a_box(), Some(1.0)).expect("a box is a body");
        assert!(found.cost < 0.5, "{found:?}");
        assert!((found.parameters[9] - 2.0).abs() < 0.01);
    }

    #[test]
    fn what_no_body_has_costs_its_distance() {
        let information = DMatrix::identity(10, 10) * 1e6;
        // No body has a negative mass: nothing is left of it.
        let found = nearest_body(&information, &-a_box(), None).expect("there is a nearest one");
        assert!(found.cost > 1e6 && found.parameters[9] < 0.01, "{found:?}");
        // Nor a first moment without mass, nor one at a hundred metres from a small robot.
        let mut far = DVector::zeros(10);
        (far[6], far[9]) = (1.0, 0.01);
        let found = nearest_body(&information, &far, Some(0.8)).expect("there is a nearest one");
        assert!(found.cost > 1e5, "{found:?}");
    }

    #[test]
    fn of_what_is_not_determined_the_body_may_have_anything() {
        // A first moment alone, as a joint about a horizontal axis shows it at rest.
        let mut information = DMatrix::zeros(10, 10);
        (information[(6, 6)], information[(7, 7)]) = (1e6, 1e6);
        let mut numbers = DVector::zeros(10);
        (numbers[6], numbers[7]) = (0.3, -0.1);
        let found = nearest_body(&information, &numbers, Some(0.8)).expect("there are many");
        assert!(found.cost < 0.5 && found.parameters[9] > 0.3, "{found:?}");
        // The mass is not made up: it is about the least that such a body has.
        assert!(found.parameters[9] < 5.0, "{found:?}");
    }
}
