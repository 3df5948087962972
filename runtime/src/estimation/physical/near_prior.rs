//! The standard parameters nearest to a prior that have identified base parameters within their uncertainty.
//!
//! Torques determine base parameters; of the standard ones behind them a recording leaves a whole space. Here that one is
//! taken whose bodies are nearest to those of a prior (a URDF, a CAD model) in the entropic divergence
//! D(P | P0) = tr(P0⁻¹ P) - ln det(P0⁻¹ P) - 4 of pseudo-inertias (Lee, Wensing and Park 2020): it does not depend on the
//! choice of frames or units, and is infinite where a body stops being one, so that every body of the solution has a density
//! that is nowhere negative.
//!
//! min over x of ½ (K x - chi)ᵀ Λ (K x - chi) + γ R(x), with Λ the information of chi, is convex and smooth; Newton's method
//! with backtracking finds it for any γ. γ is the largest with which the base parameters stay as near as their uncertainty
//! allows: (K x - chi)ᵀ Λ (K x - chi) at most the number of them beyond the least that bodies can have (Morozov's
//! discrepancy principle). A prior that agrees with the data is not left; what the data leave open is the prior's.

use nalgebra::{DMatrix, DVector, Matrix4};

use super::interior_point::factored;
use super::problem::{Combination, parameter, rotors};
use super::pseudo_inertia::{pseudo_inertia, unit_inertia};
use crate::model::{ParameterKind, Robot};

/// Uncertainty of a base parameter, relative to its size, below which it is as good as exact: what is written with fewer
/// digits is no better known, and the normal equations keep their rank.
const EXACT: f64 = 1e-6;
/// Weight of a rotor inertia without a prior beside a body: it takes what the data show beyond the bodies of the prior.
const UNKNOWN_ROTOR: f64 = 1e-2;
/// Scale of what has no prior, SI.
const UNKNOWN: f64 = 1e3;
/// The first weight of the prior, with which the data hardly count, and the factor from one to the next.
const FIRST: f64 = 1e12;
const NEXT: f64 = 0.1;
/// The last weight, and the change of the distance over a decade, relative to it and to one parameter, that ends the way
/// earlier.
const LAST: f64 = 1e-8;
const SETTLED: f64 = 1e-3;
/// Newton's decrement at which a minimum is found, relative to the objective, and at which rounding may end the search.
const PRECISION: f64 = 1e-12;
const ROUNDING: f64 = 1e-6;
/// Newton steps for one weight; some ten are usual.
const MOST_STEPS: usize = 200;
/// Bisections of the logarithm of the weight between two of a decade.
const BISECTIONS: usize = 20;

/// What is known of a robot's bodies before any recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Each frame's body, XX XY XZ YY YZ ZZ MX MY MZ M at its origin; its pseudo-inertia must be positive definite.
    /// `None` for a frame that carries nothing: its parameters are 0.
    pub bodies: Vec<Option<[f64; 10]>>,
    /// What of each frame's link is known and fixed on it (a tool), not counted in `bodies`.
    pub attached: Vec<[f64; 10]>,
    /// Rotor inertia of each joint, where it is known.
    pub rotors: Vec<Option<f64>>,
}

/// Standard parameters that bodies can have.
#[derive(Debug, Clone, PartialEq)]
pub struct NearPrior {
    /// In the order of the robot's standard parameters, `attached` counted in.
    pub standard: Vec<f64>,
    /// Their base parameters.
    pub chi: Vec<f64>,
    /// Of each standard parameter the part that the data decided, 0 to 1; the rest is the prior's.
    pub from_data: Vec<f64>,
    /// (K x - chi)ᵀ Λ (K x - chi) over the determined base parameters.
    pub distance: f64,
    /// The least that bodies can have of it: near 0 where the identified values are possible.
    pub least: f64,
    /// Number of base parameters that the data determine.
    pub determined: usize,
    /// Weight of the prior that was chosen.
    pub gamma: f64,
    /// Divergence of each frame's body from its prior; 0 where there is none.
    pub divergence: Vec<f64>,
}

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NearPriorError {
    /// Arguments of other lengths than the robot has parameters, frames or joints.
    #[error("prior, parameters and covariance are not those of one robot")]
    Shape,
    /// A prior body with a density that is negative or vanishes.
    #[error("the prior of frame {} is no body", .0 + 1)]
    Prior(usize),
    /// A link or rotor of which parameters are known to be 0, but not all ten of a link.
    #[error(
        "frame {}: some of its parameters are known to be 0, which no body and no rotor has: all ten of a link are (massless), or none",
        .0 + 1
    )]
    Known(usize),
    /// No parameter has an uncertainty.
    #[error("no base parameter has an uncertainty: nothing says how near they must be")]
    NoInformation,
    /// Newton's method did not arrive.
    #[error("the search for bodies did not converge")]
    NotConverged,
}

/// Standard parameters nearest to `prior` that have the base parameters `chi` within their `covariance` (rows of zeros or
/// what is not finite: not determined).
///
/// Friction and offsets are taken as identified. Rotor inertias at the motors are positive.
///
/// # Errors
/// See [`NearPriorError`].
pub fn near_prior(
    robot: &Robot,
    chi: &[f64],
    covariance: &DMatrix<f64>,
    prior: &Prior,
) -> Result<NearPrior, NearPriorError> {
    let n = robot.base.len();
    let shapes = chi.len() == n
        && covariance.shape() == (n, n)
        && prior.bodies.len() == robot.frames.len()
        && prior.attached.len() == robot.frames.len()
        && prior.rotors.len() == robot.joints();
    if !shapes {
        return Err(NearPriorError::Shape);
    }
    for frame in 0..robot.frames.len() {
        let zero = |of: &dyn Fn(ParameterKind) -> bool| {
            robot.known.iter().map(|&k| &robot.standard[k]).filter(|p| p.frame == frame && of(p.kind)).count()
        };
        let body = zero(&|kind| ParameterKind::INERTIAL.contains(&kind));
        if zero(&|kind| kind == ParameterKind::Ia) > 0
            || body > 0 && (body < 10 || prior.bodies[frame].is_some())
        {
            return Err(NearPriorError::Known(frame));
        }
    }
    let search = Search::new(robot, chi, covariance, prior)?;
    let mut path = vec![(FIRST, search.minimum(FIRST, search.start.clone())?)];
    while let Some((gamma, x)) = path.last()
        && *gamma > LAST
    {
        let next = gamma * NEXT;
        // Where rounding takes over, the way is at its end.
        let Ok(found) = search.minimum(next, x.clone()) else { break };
        let [before, after] = [x, &found].map(|x| search.distance(x));
        let settled = next < 1.0 && before - after < SETTLED * (1.0 + after);
        path.push((next, found));
        if settled {
            break;
        }
    }
    let distances: Vec<f64> = path.iter().map(|(_, x)| search.distance(x)).collect();
    let least = distances.last().copied().unwrap_or_default();
    let allowed = least + search.determined as f64;
    let first = distances.iter().position(|d| *d <= allowed).unwrap_or(path.len() - 1);
    let (mut gamma, mut x) = path.swap_remove(first);
    if first > 0 {
        let mut above = gamma / NEXT;
        for _ in 0..BISECTIONS {
            let middle = (gamma * above).sqrt();
            let found = search.minimum(middle, x.clone())?;
            if search.distance(&found) <= allowed {
                (gamma, x) = (middle, found);
            } else {
                above = middle;
            }
        }
    }
    Ok(search.outcome(robot, gamma, &x, least))
}

/// The convex problem over the standard parameters that are not fixed.
struct Search {
    /// Rows: determined base parameters in units in which their information is 1.
    g: DMatrix<f64>,
    y: DVector<f64>,
    normal: DMatrix<f64>,
    bodies: Vec<Known>,
    /// Rotor inertias at the motors: combination, weight, scale.
    rotors: Vec<(Combination, f64, f64)>,
    /// Parameters that stay as they start: of frames that carry nothing, and friction that the data do not show.
    fixed: Vec<usize>,
    start: DVector<f64>,
    determined: usize,
}

/// A body with a prior.
struct Known {
    frame: usize,
    link: [usize; 10],
    attached: Matrix4<f64>,
    /// Inverse of the prior's pseudo-inertia, and its logarithmic determinant.
    inverse: Matrix4<f64>,
    log_determinant: f64,
}

impl Search {
    fn new(
        robot: &Robot,
        chi: &[f64],
        covariance: &DMatrix<f64>,
        prior: &Prior,
    ) -> Result<Search, NearPriorError> {
        let standard = robot.standard.len();
        let mut search = Search {
            g: DMatrix::zeros(0, standard),
            y: DVector::zeros(0),
            normal: DMatrix::zeros(standard, standard),
            bodies: Vec::new(),
            rotors: Vec::new(),
            fixed: Vec::new(),
            start: DVector::zeros(standard),
            determined: 0,
        };
        for frame in 0..robot.frames.len() {
            search.add_body(robot, prior, frame)?;
        }
        search.add_rotors(robot, prior);
        search.add_data(robot, chi, covariance)?;
        // Friction and offsets have no prior: where no data show them there is nothing to say.
        for (k, p) in robot.standard.iter().enumerate() {
            let is_loose = !ParameterKind::INERTIAL.contains(&p.kind) && p.kind != ParameterKind::Ia;
            if is_loose && search.normal[(k, k)] == 0.0 {
                search.fixed.push(k);
            }
        }
        Ok(search)
    }

    fn add_body(&mut self, robot: &Robot, prior: &Prior, frame: usize) -> Result<(), NearPriorError> {
        let own = ParameterKind::INERTIAL.map(|kind| parameter(robot, frame, kind));
        let known: Vec<usize> = own.into_iter().flatten().collect();
        let link = <[usize; 10]>::try_from(known).map_err(|_| NearPriorError::Shape)?;
        let numbers = |body: &[f64; 10]| DVector::from_column_slice(body);
        let own: [usize; 10] = std::array::from_fn(|k| k);
        let attached = pseudo_inertia(&own, &numbers(&prior.attached[frame]));
        let Some(body) = &prior.bodies[frame] else {
            self.fixed.extend(link);
            link.iter().zip(prior.attached[frame]).for_each(|(&k, value)| self.start[k] = value);
            return Ok(());
        };
        let pseudo = pseudo_inertia(&own, &numbers(body));
        let factor = nalgebra::Cholesky::new(pseudo).ok_or(NearPriorError::Prior(frame))?;
        let log_determinant = 2.0 * (0..4).map(|i| factor.l_dirty()[(i, i)].ln()).sum::<f64>();
        if !log_determinant.is_finite() {
            return Err(NearPriorError::Prior(frame));
        }
        for (place, &k) in link.iter().enumerate() {
            self.start[k] = body[place] + prior.attached[frame][place];
        }
        self.bodies.push(Known { frame, link, attached, inverse: factor.inverse(), log_determinant });
        Ok(())
    }

    fn add_rotors(&mut self, robot: &Robot, prior: &Prior) {
        let known = |motor: usize| prior.rotors.get(motor).copied().flatten().filter(|ia| *ia > 0.0);
        let (combinations, start) = rotors(robot, |motor| known(motor).unwrap_or(0.1));
        for (k, value) in start {
            self.start[k] = value;
        }
        for (motor, combination) in combinations.into_iter().enumerate() {
            let (weight, scale) = known(motor).map_or((UNKNOWN_ROTOR, UNKNOWN), |ia| (1.0, ia));
            self.rotors.push((combination, weight, scale));
        }
    }

    fn add_data(
        &mut self,
        robot: &Robot,
        chi: &[f64],
        covariance: &DMatrix<f64>,
    ) -> Result<(), NearPriorError> {
        let is_known =
            |k: &usize| covariance[(*k, *k)] > 0.0 && covariance.row(*k).iter().all(|x| x.is_finite());
        let known: Vec<usize> = (0..chi.len()).filter(is_known).collect();
        if known.is_empty() {
            return Err(NearPriorError::NoInformation);
        }
        self.determined = known.len();
        let before = robot.base_from_standard(self.start.as_slice());
        let floor = |k: usize| EXACT * chi[k].abs().max(before[k].abs()).max(EXACT);
        let sigma: Vec<f64> = known.iter().map(|&k| (covariance[(k, k)] + floor(k).powi(2)).sqrt()).collect();
        let scaled = DMatrix::from_fn(known.len(), known.len(), |i, j| {
            let value = if i == j { sigma[i] * sigma[i] } else { covariance[(known[i], known[j])] };
            value / (sigma[i] * sigma[j])
        });
        let factor = factored(scaled).ok_or(NearPriorError::NoInformation)?;
        let mut rows = DMatrix::zeros(known.len(), robot.standard.len());
        for (i, &b) in known.iter().enumerate() {
            for &(k, coefficient) in robot.base[b].combination.iter() {
                rows[(i, k)] += coefficient / sigma[i];
            }
        }
        let mut y = DVector::from_fn(known.len(), |i, _| chi[known[i]] / sigma[i]);
        for &k in &self.fixed {
            y -= rows.column(k) * self.start[k];
            rows.column_mut(k).fill(0.0);
        }
        let l = factor.l();
        self.g = l.solve_lower_triangular(&rows).ok_or(NearPriorError::NoInformation)?;
        self.y = l.solve_lower_triangular(&y).ok_or(NearPriorError::NoInformation)?;
        self.normal = self.g.tr_mul(&self.g);
        Ok(())
    }

    fn distance(&self, x: &DVector<f64>) -> f64 {
        (&self.g * x - &self.y).norm_squared()
    }

    /// D of one body; `None` where it is none.
    fn divergence(&self, body: &Known, x: &DVector<f64>) -> Option<f64> {
        let pseudo = pseudo_inertia(&body.link, x) - body.attached;
        let factor = nalgebra::Cholesky::new(pseudo)?;
        let log_determinant = 2.0 * (0..4).map(|i| factor.l_dirty()[(i, i)].ln()).sum::<f64>();
        let value = body.inverse.dot(&pseudo) - log_determinant + body.log_determinant - 4.0;
        value.is_finite().then_some(value)
    }

    /// R; `None` outside of what is possible.
    fn regulariser(&self, x: &DVector<f64>) -> Option<f64> {
        let mut sum = 0.0;
        for body in &self.bodies {
            sum += self.divergence(body, x)?;
        }
        for (combination, weight, scale) in &self.rotors {
            let value = at(combination, x);
            if value <= 0.0 {
                return None;
            }
            sum += weight * (value / scale - (value / scale).ln() - 1.0);
        }
        sum.is_finite().then_some(sum)
    }

    /// Gradient and curvature of R.
    fn curvature(&self, x: &DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let mut gradient = DVector::zeros(x.len());
        let mut hessian = DMatrix::zeros(x.len(), x.len());
        let basis: [Matrix4<f64>; 10] = std::array::from_fn(unit_inertia);
        for body in &self.bodies {
            let inverse = (pseudo_inertia(&body.link, x) - body.attached).try_inverse()?;
            let slope = body.inverse - inverse;
            let products = basis.map(|b| inverse * b);
            for (place, &i) in body.link.iter().enumerate() {
                gradient[i] += slope.dot(&basis[place]);
                for (other, &j) in products.iter().zip(&body.link) {
                    hessian[(i, j)] += products[place].dot(&other.transpose());
                }
            }
        }
        for (combination, weight, scale) in &self.rotors {
            let value = at(combination, x);
            for &(i, a) in combination {
                gradient[i] += weight * a * (1.0 / scale - 1.0 / value);
                for &(j, b) in combination {
                    hessian[(i, j)] += weight * a * b / (value * value);
                }
            }
        }
        self.fixed.iter().for_each(|&k| hessian[(k, k)] = 1.0);
        Some((gradient, hessian))
    }

    /// The minimum of half the distance and `gamma` R, both over `gamma`.
    fn minimum(&self, gamma: f64, mut x: DVector<f64>) -> Result<DVector<f64>, NearPriorError> {
        let value = |x: &DVector<f64>| Some(0.5 * self.distance(x) / gamma + self.regulariser(x)?);
        for _ in 0..MOST_STEPS {
            let (mut gradient, mut hessian) = self.curvature(&x).ok_or(NearPriorError::NotConverged)?;
            gradient += self.g.tr_mul(&(&self.g * &x - &self.y)) / gamma;
            hessian += &self.normal / gamma;
            let step = scaled_solution(hessian, &gradient).ok_or(NearPriorError::NotConverged)?;
            let decrement = gradient.dot(&step);
            if !decrement.is_finite() {
                return Err(NearPriorError::NotConverged);
            }
            let before = value(&x).ok_or(NearPriorError::NotConverged)?;
            if decrement < PRECISION * (1.0 + before.abs()) {
                return Ok(x);
            }
            let mut share = 1.0;
            let next = loop {
                let next = &x - &step * share;
                if value(&next).is_some_and(|after| after <= before - 0.1 * share * decrement) {
                    break Some(next);
                }
                share *= 0.5;
                if share < 1e-10 {
                    break None;
                }
            };
            match next {
                Some(next) => x = next,
                // What is left to gain is below the rounding of the objective.
                None if decrement < ROUNDING * (1.0 + before.abs()) => return Ok(x),
                None => return Err(NearPriorError::NotConverged),
            }
        }
        Err(NearPriorError::NotConverged)
    }

    fn outcome(&self, robot: &Robot, gamma: f64, x: &DVector<f64>, least: f64) -> NearPrior {
        let mut divergence = vec![0.0; robot.frames.len()];
        for body in &self.bodies {
            divergence[body.frame] = self.divergence(body, x).unwrap_or_default();
        }
        let from_data = self.curvature(x).and_then(|(_, mut hessian)| {
            let own = &self.normal / gamma;
            hessian += &own;
            let scale = hessian.diagonal().map(|d| 1.0 / d.sqrt());
            let both = |m: DMatrix<f64>| {
                DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * scale[i] * scale[j])
            };
            let part = factored(both(hessian))?.solve(&both(own));
            Some(part.diagonal().iter().map(|x| x.clamp(0.0, 1.0)).collect())
        });
        NearPrior {
            chi: robot.base_from_standard(x.as_slice()),
            from_data: from_data.unwrap_or_else(|| vec![0.0; x.len()]),
            standard: x.as_slice().to_vec(),
            distance: self.distance(x),
            least,
            determined: self.determined,
            gamma,
            divergence,
        }
    }
}

/// The solution of a symmetric system whose unknowns have units of different size.
fn scaled_solution(mut matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let scale = matrix.diagonal().map(|d| 1.0 / d.sqrt());
    for i in 0..scale.len() {
        for j in 0..scale.len() {
            matrix[(i, j)] *= scale[i] * scale[j];
        }
    }
    Some(factored(matrix)?.solve(&right.component_mul(&scale)).component_mul(&scale))
}

fn at(combination: &Combination, x: &DVector<f64>) -> f64 {
    combination.iter().map(|&(k, coefficient)| coefficient * x[k]).sum()
}

#[cfg(test)]
#[path = "near_prior_tests.rs"]
mod tests;
