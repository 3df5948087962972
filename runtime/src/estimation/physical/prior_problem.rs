//! The convex problem of [`near_prior`](super::near_prior): distance to the identified base parameters and divergence from
//! the prior, and its minimum by Newton's method with backtracking.

use nalgebra::{DMatrix, DVector, Matrix4};

use super::constraint::Constraint;
use super::ellipsoid::{coefficients, ellipsoid_margin, pseudo_of, uniform_body};
use super::interior_point::factored;
use super::newton_step::Step;
use super::prior::{NearPriorError, Prior};
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
/// Newton's decrement at which a minimum is found, relative to the objective, and at which rounding may end the search.
const PRECISION: f64 = 1e-12;
const ROUNDING: f64 = 1e-6;
/// Newton steps for one weight; some ten are usual.
const MOST_STEPS: usize = 200;

/// The convex problem over the standard parameters that are not fixed.
pub(super) struct Search {
    /// Rows: determined base parameters in units in which their information is 1.
    g: DMatrix<f64>,
    y: DVector<f64>,
    pub(super) normal: DMatrix<f64>,
    pub(super) bodies: Vec<Known>,
    /// Rotor inertias at the motors: combination, weight, scale.
    rotors: Vec<(Combination, f64, f64)>,
    /// Parameters that stay as they start: of frames that carry nothing, and friction that the data do not show.
    fixed: Vec<usize>,
    /// Ellipsoids that bodies lie in: tr(P Q) in units of the prior's mass as a function of x, without what is attached.
    ellipsoids: Vec<Combination>,
    /// What a released body or rotor is held by instead, weakly: parameter, where it is, scale.
    loose: Vec<(usize, f64, f64)>,
    pub(super) start: DVector<f64>,
    pub(super) determined: usize,
}

/// A body with a prior.
pub(super) struct Known {
    pub(super) frame: usize,
    pub(super) link: [usize; 10],
    attached: Matrix4<f64>,
    /// Its place among the ellipsoids.
    pub(super) ellipsoid: Option<usize>,
    /// tr(P Q) of what is attached, in the same units.
    beyond: f64,
    /// Inverse of the prior's pseudo-inertia, and its logarithmic determinant.
    inverse: Matrix4<f64>,
    log_determinant: f64,
}

impl Search {
    pub(super) fn new(
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
            ellipsoids: Vec::new(),
            rotors: Vec::new(),
            loose: Vec::new(),
            fixed: Vec::new(),
            start: DVector::zeros(standard),
            determined: 0,
        };
        for frame in 0..robot.frames.len() {
            search.add_body(robot, prior, frame)?;
        }
        search.add_rotors(robot, prior);
        search.add_data(robot, chi, covariance)?;
        // Friction, offsets and springs have no prior: where no data show them there is nothing to say, and of what is part of
        // one base parameter all is said by the one that it is named after.
        for (k, p) in robot.standard.iter().enumerate() {
            let is_loose = !ParameterKind::INERTIAL.contains(&p.kind) && p.kind != ParameterKind::Ia;
            let is_base = robot.base.iter().any(|b| b.standard == k);
            let is_known = robot.fixed.iter().any(|&(known, _)| known == k);
            if is_loose && !is_known && (!is_base || search.normal[(k, k)] == 0.0) {
                search.fixed.push(k);
            }
        }
        Ok(search)
    }

    fn add_body(&mut self, robot: &Robot, prior: &Prior, frame: usize) -> Result<(), NearPriorError> {
        let own = ParameterKind::INERTIAL.map(|kind| parameter(robot, frame, kind));
        let known: Vec<usize> = own.into_iter().flatten().collect();
        let link = <[usize; 10]>::try_from(known).map_err(|_| NearPriorError::Shape)?;
        let attached = pseudo_of(&prior.attached[frame]);
        let Some(body) = &prior.bodies[frame] else {
            self.fixed.extend(link);
            link.iter().zip(prior.attached[frame]).for_each(|(&k, value)| self.start[k] = value);
            return Ok(());
        };
        let factor = nalgebra::Cholesky::new(pseudo_of(body)).ok_or(NearPriorError::Prior(frame))?;
        let log_determinant = 2.0 * (0..4).map(|i| factor.l_dirty()[(i, i)].ln()).sum::<f64>();
        if !log_determinant.is_finite() {
            return Err(NearPriorError::Prior(frame));
        }
        let (mut begin, mut ellipsoid, mut beyond) = (*body, None, 0.0);
        if let Some(own) = &prior.ellipsoids[frame] {
            let wrong = NearPriorError::Ellipsoid(frame);
            let row = coefficients(own).ok_or(wrong)?.map(|a| a / body[9]);
            beyond = row.iter().zip(&prior.attached[frame]).map(|(a, x)| a * x).sum();
            ellipsoid = Some(self.ellipsoids.len());
            self.ellipsoids.push(link.iter().copied().zip(row).collect());
            if ellipsoid_margin(own, body).is_none_or(|margin| margin <= 0.0) {
                begin = uniform_body(own, body[9]).ok_or(wrong)?;
            }
        }
        for (place, &k) in link.iter().enumerate() {
            self.start[k] = begin[place] + prior.attached[frame][place];
        }
        let inverse = factor.inverse();
        self.bodies.push(Known { frame, link, attached, ellipsoid, beyond, inverse, log_determinant });
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
        self.add_fixed(robot);
        self.normal = self.g.tr_mul(&self.g);
        Ok(())
    }

    /// What the table knows of standard parameters is as good as exact.
    fn add_fixed(&mut self, robot: &Robot) {
        let free = robot.fixed.iter().filter(|(k, _)| !self.fixed.contains(k));
        for &(k, value) in free {
            let sigma = EXACT * value.abs().max(EXACT);
            let at = self.y.len();
            self.g = std::mem::take(&mut self.g).insert_row(at, 0.0);
            self.g[(at, k)] = 1.0 / sigma;
            self.y = std::mem::take(&mut self.y).push(value / sigma);
        }
    }

    /// Takes away what keeps a body one, or a rotor's inertia positive. `false` where there is no such.
    pub(super) fn release(&mut self, what: Constraint) -> bool {
        match what {
            Constraint::Body(frame) => {
                let Some(at) = self.bodies.iter().position(|body| body.frame == frame) else { return false };
                let body = self.bodies.remove(at);
                if let Some(place) = body.ellipsoid {
                    self.ellipsoids.remove(place);
                    let later = self.bodies.iter_mut().filter_map(|body| body.ellipsoid.as_mut());
                    later.filter(|other| **other > place).for_each(|other| *other -= 1);
                }
                // Numbers of one unit have one scale.
                for part in [&body.link[..6], &body.link[6..9], &body.link[9..]] {
                    let largest = part.iter().map(|&k| self.start[k].abs()).fold(EXACT, f64::max);
                    self.loose.extend(part.iter().map(|&k| (k, self.start[k], largest)));
                }
            }
            Constraint::Rotor(motor) => {
                if motor >= self.rotors.len() {
                    return false;
                }
                let (combination, ..) = self.rotors.remove(motor);
                self.loose.extend(combination.iter().map(|&(k, _)| (k, self.start[k], UNKNOWN)));
            }
        }
        true
    }

    /// tr(P Q) of each ellipsoid's body in units of its prior's mass. What rounding takes below zero is at the surface.
    fn margins(&self, x: &DVector<f64>) -> DVector<f64> {
        let bounded = self.bodies.iter().filter_map(|body| Some((body.ellipsoid?, body.beyond)));
        let value = |(k, beyond): (usize, f64)| (at(&self.ellipsoids[k], x) - beyond).max(0.0);
        DVector::from_iterator(self.ellipsoids.len(), bounded.map(value))
    }

    /// Newton's step from x for half the distance and `gamma` R, both over `gamma`, and the gradient there.
    pub(super) fn newton(&self, gamma: f64, x: &DVector<f64>) -> Option<(Step, DVector<f64>)> {
        let (mut gradient, mut hessian) = self.curvature(x)?;
        gradient += self.g.tr_mul(&(&self.g * x - &self.y)) / gamma;
        hessian += &self.normal / gamma;
        Some((Step::new(hessian, &gradient, &self.ellipsoids, &self.margins(x))?, gradient))
    }

    pub(super) fn distance(&self, x: &DVector<f64>) -> f64 {
        (&self.g * x - &self.y).norm_squared()
    }

    /// D of one body; `None` where it is none.
    pub(super) fn divergence(&self, body: &Known, x: &DVector<f64>) -> Option<f64> {
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
        sum += self.loose.iter().map(|&(k, at, scale)| 0.5 * ((x[k] - at) / scale).powi(2)).sum::<f64>();
        sum.is_finite().then_some(sum)
    }

    /// Gradient and curvature of R.
    pub(super) fn curvature(&self, x: &DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
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
        for &(k, at, scale) in &self.loose {
            gradient[k] += (x[k] - at) / (scale * scale);
            hessian[(k, k)] += 1.0 / (scale * scale);
        }
        self.fixed.iter().for_each(|&k| hessian[(k, k)] = 1.0);
        Some((gradient, hessian))
    }

    /// Half the distance and `gamma` R, both over `gamma`; `None` outside of what is possible.
    pub(super) fn objective(&self, gamma: f64, x: &DVector<f64>) -> Option<f64> {
        Some(0.5 * self.distance(x) / gamma + self.regulariser(x)?)
    }

    /// The minimum of [`Self::objective`].
    pub(super) fn minimum(&self, gamma: f64, mut x: DVector<f64>) -> Result<DVector<f64>, NearPriorError> {
        let value = |x: &DVector<f64>| self.objective(gamma, x);
        for _ in 0..MOST_STEPS {
            let (found, gradient) = self.newton(gamma, &x).ok_or(NearPriorError::NotConverged)?;
            let step = found.step;
            let decrement = -gradient.dot(&step);
            if !decrement.is_finite() {
                return Err(NearPriorError::NotConverged);
            }
            let before = value(&x).ok_or(NearPriorError::NotConverged)?;
            if decrement < PRECISION * (1.0 + before.abs()) {
                return Ok(x);
            }
            let mut share = 1.0;
            let next = loop {
                let next = &x + &step * share;
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
}

fn at(combination: &Combination, x: &DVector<f64>) -> f64 {
    combination.iter().map(|&(k, coefficient)| coefficient * x[k]).sum()
}
