//! The best parameters that a real robot can have: what a recording says where the fit is held to physics.
//!
//! Least squares is free to give a link a negative inertia or a joint a friction that drives it. A robot that fits its
//! recording does so by little; a recording that another robot made, or whose axes, signs or units are mixed up, needs
//! such parameters. The best physically possible fit therefore tells whether the recording can be this robot's.

use nalgebra::{Cholesky, DMatrix, DVector, Matrix4};

use super::observe::Observation;
use super::weights::stack;
use super::{Estimate, Factor, per_equation, relative_error};
use crate::model::{ParameterKind, Robot};

/// Newton steps of the whole solution; one takes some thirty to eighty.
const MOST_STEPS: usize = 400;
/// Factor on the weight of the equations from one centre to the next.
const NEXT: f64 = 20.0;
/// The fit is this close to the best possible one, as a share of its squared error.
const GAP: f64 = 0.01;
/// Scale, SI, of the quadratic prior on every standard parameter: weak beside any data, it bounds what the recording
/// does not identify.
const PRIOR_SCALE: f64 = 1e3;

/// The best fit whose parameters belong to real bodies and whose friction dissipates.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalFit {
    /// Base parameters.
    pub chi: Vec<f64>,
    /// ||Y - W chi|| / ||Y|| over all equations.
    pub relative_error: f64,
    /// The same per joint.
    pub per_equation: Vec<f64>,
    /// Mean square of its weighted errors over that of the free fit, each freedom counted: 1 where physics costs
    /// nothing.
    pub strain: f64,
}

/// Fits an observation of torques with parameters that a robot can have, in the weights of a free estimate.
///
/// Physically possible is (Sousa and Cortesao 2014; Wensing, Kim and Slotine 2018): the pseudo-inertia of every link is
/// positive semidefinite; rotor inertias at the motors are not negative; the line Fc + Fv v does not lie below zero at
/// the mean speed |v| of its rows, nor at that weighted by |v|. The least-squares line of any friction that
/// dissipates obeys the latter, Stribeck's with its falling branch as well, so that no law of friction is demanded.
///
/// The problem is convex. It is solved with a logarithmic barrier and Newton's method, the distance to the optimum
/// being the number of constraints over the weight of the equations (Boyd and Vandenberghe 2004, chapter 11). `None`
/// where that distance was not reached, or where the observation is not one of torques by this robot.
pub fn physical_fit(robot: &Robot, observation: &Observation, estimate: &Estimate) -> Option<PhysicalFit> {
    if observation.unknowns.len() != robot.base.len() {
        return None;
    }
    let sigma = sigmas(observation, estimate)?;
    let stacked = stack(observation, &sigma);
    let free = stacked.residual_norm(&estimate.chi()).powi(2);
    if !(free.is_finite() && free > 0.0) {
        return None;
    }
    let unweighted = stack(observation, &vec![1.0; observation.groups.len()]);
    let problem = Problem::new(robot, &stacked, &unweighted, free);
    let standard = problem.solve()?;
    let chi = robot.base_from_standard(standard.as_slice());
    let freedom = estimate.degrees_of_freedom.max(1) as f64 / stacked.rows() as f64;
    let strain = freedom * stacked.residual_norm(&chi).powi(2) / free;
    Some(PhysicalFit {
        relative_error: relative_error(observation, &chi),
        per_equation: per_equation(observation, &chi),
        chi,
        strain,
    })
}

/// The standard deviation of each group's errors; `None` where an equation has none.
fn sigmas(observation: &Observation, estimate: &Estimate) -> Option<Vec<f64>> {
    let of = |trajectory, equation| {
        let found =
            estimate.errors.iter().find(|e| e.trajectory == trajectory && e.equation == equation)?.sigma;
        (found > 0.0).then_some(found)
    };
    let sigma = |g: &super::observe::EquationFactor| match g.factor.rows() {
        0 => Some(1.0),
        _ => of(g.trajectory, g.equation),
    };
    observation.groups.iter().map(sigma).collect()
}

/// A linear combination of standard parameters.
type Combination = Vec<(usize, f64)>;

/// min ||G x - y||^2 over standard parameters x that are possible.
struct Problem {
    g: DMatrix<f64>,
    y: DVector<f64>,
    /// GT G
    normal: DMatrix<f64>,
    /// The ten inertial parameters of each link.
    links: Vec<[usize; 10]>,
    /// Combinations that must be positive.
    positive: Vec<Combination>,
    start: DVector<f64>,
    free: f64,
}

const INERTIAL: [ParameterKind; 10] = {
    use ParameterKind::{M, MX, MY, MZ, XX, XY, XZ, YY, YZ, ZZ};
    [XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ, M]
};

impl Problem {
    fn new(robot: &Robot, stacked: &Factor, unweighted: &Factor, free: f64) -> Problem {
        let (base, standard) = (robot.base.len(), robot.standard.len());
        let mut g = DMatrix::<f64>::zeros(base + 1, standard);
        for (b, parameter) in robot.base.iter().enumerate() {
            for &(k, coefficient) in parameter.combination.iter() {
                (0..=b).for_each(|i| g[(i, k)] += coefficient * stacked.r(i, b));
            }
        }
        let y = DVector::from_fn(base + 1, |i, _| stacked.r(i, base));
        let normal = g.tr_mul(&g);
        let mut problem = Problem {
            normal,
            g,
            y,
            links: Vec::new(),
            positive: Vec::new(),
            start: DVector::zeros(standard),
            free,
        };
        problem.bodies(robot);
        problem.friction(robot, unweighted);
        problem.rotors(robot);
        problem
    }

    fn bodies(&mut self, robot: &Robot) {
        for frame in 0..robot.frames.len() {
            let own = INERTIAL.map(|kind| parameter(robot, frame, kind));
            let known: Vec<usize> = own.into_iter().flatten().collect();
            let Ok(link) = <[usize; 10]>::try_from(known) else { continue };
            for (place, value) in [(0, 0.1), (3, 0.1), (5, 0.1), (9, 1.0)] {
                self.start[link[place]] = value;
            }
            self.links.push(link);
        }
    }

    /// The speeds come from the columns of Fv and Fc, which are v and sign(v) of each row.
    fn friction(&mut self, robot: &Robot, unweighted: &Factor) {
        use ParameterKind::{Fc, Fcm, Fv, Fvm};
        let column = |standard: usize| robot.base.iter().position(|b| b.standard == standard);
        let product = |a: usize, b: usize| -> f64 {
            (0..=a.min(b)).map(|i| unweighted.r(i, a) * unweighted.r(i, b)).sum()
        };
        for frame in 0..robot.frames.len() {
            for (viscous, coulomb) in [(Fv, Fc), (Fvm, Fcm)] {
                let (viscous, coulomb) = (parameter(robot, frame, viscous), parameter(robot, frame, coulomb));
                let known: Vec<usize> = [viscous, coulomb].into_iter().flatten().collect();
                known.iter().for_each(|&k| self.start[k] = 1.0);
                let speeds = match known.as_slice() {
                    &[v, c] => column(v).zip(column(c)).and_then(|(v, c)| {
                        let (vv, vc, cc) = (product(v, v), product(v, c), product(c, c));
                        (cc > 0.0 && vc > 0.0).then(|| [vc / cc, vv / vc])
                    }),
                    _ => None,
                };
                match (speeds, known.as_slice()) {
                    (Some(speeds), &[v, c]) => {
                        self.positive.extend(speeds.map(|speed| vec![(c, 1.0), (v, speed)]));
                    }
                    _ => self.positive.extend(known.iter().map(|&k| vec![(k, 1.0)])),
                }
            }
        }
    }

    /// Ja = ((N∘N)ᵀ)⁻¹ Ia by (26), rows scaled by N_mm²; where there is no inverse, Ia stands for Ja.
    fn rotors(&mut self, robot: &Robot) {
        let n = robot.joints();
        let frames = robot.joint_of_frame();
        let mut inertia = vec![None; n];
        for (frame, joint) in frames.iter().enumerate() {
            if let Some(j) = joint {
                inertia[*j] = parameter(robot, frame, ParameterKind::Ia);
            }
        }
        let Some(inertia) = inertia.into_iter().collect::<Option<Vec<usize>>>() else { return };
        let gear = &robot.drive.gear;
        let squared = DMatrix::from_fn(n, n, |m, j| (gear[m * n + j] / gear[m * n + m]).powi(2)).transpose();
        let start = &squared * DVector::from_element(n, 0.1);
        match squared.try_inverse() {
            Some(inverse) => {
                for m in 0..n {
                    let row = (0..n).filter(|&j| inverse[(m, j)] != 0.0);
                    self.positive.push(row.map(|j| (inertia[j], inverse[(m, j)])).collect());
                    self.start[inertia[m]] = start[m];
                }
            }
            None => {
                for &k in &inertia {
                    self.positive.push(vec![(k, 1.0)]);
                    self.start[k] = 0.1;
                }
            }
        }
    }

    /// Squared error of the equations.
    fn error(&self, x: &DVector<f64>) -> f64 {
        (&self.g * x - &self.y).norm_squared()
    }

    /// Log barrier plus a weak quadratic prior that bounds what the data do not identify; `None` where infeasible.
    fn barrier(&self, x: &DVector<f64>) -> Option<f64> {
        let mut sum = 0.5 * x.norm_squared() / (PRIOR_SCALE * PRIOR_SCALE);
        for combination in &self.positive {
            let value = at(combination, x);
            if value <= 0.0 {
                return None;
            }
            sum -= value.ln();
        }
        for link in &self.links {
            let factor = Cholesky::new(pseudo_inertia(link, x))?;
            sum -= 2.0 * (0..4).map(|i| factor.l_dirty()[(i, i)].ln()).sum::<f64>();
        }
        sum.is_finite().then_some(sum)
    }

    /// Standard parameters within [`GAP`] of the best.
    fn solve(&self) -> Option<DVector<f64>> {
        let constraints = (4 * self.links.len() + self.positive.len()) as f64;
        let mut x = self.start.clone();
        let mut weight = constraints / self.error(&x).max(self.free);
        let mut steps = 0;
        loop {
            // To the centre of this weight.
            loop {
                steps += 1;
                if steps > MOST_STEPS {
                    return None;
                }
                let (step, decrement) = self.newton(&x, weight)?;
                if decrement < 1e-2 {
                    break;
                }
                x = self.descend(&x, &step, decrement, weight)?;
            }
            if constraints / weight < GAP * self.error(&x) {
                return Some(x);
            }
            weight *= NEXT;
        }
    }

    /// Newton's step and the squared decrement.
    fn newton(&self, x: &DVector<f64>, weight: f64) -> Option<(DVector<f64>, f64)> {
        let residual = &self.g * x - &self.y;
        let mut gradient = self.g.tr_mul(&residual) * (2.0 * weight) + x / (PRIOR_SCALE * PRIOR_SCALE);
        let mut hessian = &self.normal * (2.0 * weight);
        (0..x.len()).for_each(|k| hessian[(k, k)] += 1.0 / (PRIOR_SCALE * PRIOR_SCALE));
        for combination in &self.positive {
            let value = at(combination, x);
            for &(i, a) in combination {
                gradient[i] -= a / value;
                for &(j, b) in combination {
                    hessian[(i, j)] += a * b / (value * value);
                }
            }
        }
        let basis: [Matrix4<f64>; 10] = std::array::from_fn(unit_inertia);
        for link in &self.links {
            let inverse = pseudo_inertia(link, x).try_inverse()?;
            let products = basis.map(|b| inverse * b);
            for (a, &i) in products.iter().zip(link) {
                gradient[i] -= a.trace();
                for (b, &j) in products.iter().zip(link) {
                    hessian[(i, j)] += a.dot(&b.transpose());
                }
            }
        }
        // Units differ by orders of magnitude: what is factored has a diagonal of ones.
        let scale = hessian.diagonal().map(|d| 1.0 / d.sqrt());
        for i in 0..scale.len() {
            for j in 0..scale.len() {
                hessian[(i, j)] *= scale[i] * scale[j];
            }
        }
        let step = factored(hessian)?.solve(&gradient.component_mul(&scale)).component_mul(&scale);
        let decrement = gradient.dot(&step);
        decrement.is_finite().then_some((step, decrement))
    }

    /// Backs off along the step until the objective falls.
    fn descend(
        &self,
        x: &DVector<f64>,
        step: &DVector<f64>,
        decrement: f64,
        weight: f64,
    ) -> Option<DVector<f64>> {
        let before = weight * self.error(x) + self.barrier(x)?;
        let mut share = 1.0;
        while share > 1e-10 {
            let next = x - step * share;
            if let Some(barrier) = self.barrier(&next)
                && weight * self.error(&next) + barrier <= before - 0.1 * share * decrement
            {
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }
}

/// The Cholesky factor of a matrix with a diagonal of ones. At the rim of what is possible rounding can take its
/// definiteness; a little on the diagonal gives it back, and the step still descends.
fn factored(matrix: DMatrix<f64>) -> Option<Cholesky<f64, nalgebra::Dyn>> {
    [0.0, 1e-13, 1e-11, 1e-9].into_iter().find_map(|more| {
        let mut lifted = matrix.clone();
        (0..lifted.nrows()).for_each(|k| lifted[(k, k)] += more);
        Cholesky::new(lifted)
    })
}

fn parameter(robot: &Robot, frame: usize, kind: ParameterKind) -> Option<usize> {
    robot.standard.iter().position(|p| p.frame == frame && p.kind == kind)
}

fn at(combination: &Combination, x: &DVector<f64>) -> f64 {
    combination.iter().map(|&(k, coefficient)| coefficient * x[k]).sum()
}

/// [[Σ, MS], [MSᵀ, M]] with Σ = ½ tr(J) E - J, by its ten parameters.
fn pseudo_inertia(link: &[usize; 10], x: &DVector<f64>) -> Matrix4<f64> {
    link.iter().enumerate().fold(Matrix4::zeros(), |sum, (place, &k)| sum + unit_inertia(place) * x[k])
}

/// The pseudo-inertia of one unit of an inertial parameter, in the order XX XY XZ YY YZ ZZ MX MY MZ M.
fn unit_inertia(place: usize) -> Matrix4<f64> {
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

#[cfg(test)]
#[path = "physical_tests.rs"]
mod tests;
