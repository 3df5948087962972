//! One step of a plant with fixed stick and slip states, by several schemes. `docs/simulation.md` compares them.

use super::SimulationError;
use super::plant::{Plant, State};

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scheme {
    /// Euler's, order 1.
    ExplicitEuler,
    /// Velocities first, then positions with the new ones (symplectic Euler), order 1.
    SemiImplicitEuler,
    /// Heun's (1900), order 2.
    Heun,
    /// The classical one of four stages (Kutta 1901), order 4.
    #[default]
    RungeKutta4,
    /// ROS2 (Verwer, Spee, Blom and Hundsdorfer 1999), order 2 and L-stable: for drives so stiff that the other
    /// schemes need steps far below the control period. Its Jacobian is taken by differences.
    Rosenbrock2,
}

impl Scheme {
    /// All of them.
    pub const ALL: [Scheme; 5] = [
        Scheme::ExplicitEuler,
        Scheme::SemiImplicitEuler,
        Scheme::Heun,
        Scheme::RungeKutta4,
        Scheme::Rosenbrock2,
    ];

    /// For a person.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::ExplicitEuler => "explicit Euler",
            Scheme::SemiImplicitEuler => "semi-implicit Euler",
            Scheme::Heun => "Heun (RK2)",
            Scheme::RungeKutta4 => "Runge-Kutta 4",
            Scheme::Rosenbrock2 => "Rosenbrock 2 (stiff-safe)",
        }
    }
}

/// Memory of a [`Scheme::Rosenbrock2`] step: derivatives of the accelerations, row-major with one row a coordinate,
/// and the factored matrix of the step.
#[derive(Debug, Clone, Default)]
pub(super) struct Stiff {
    by_position: Vec<f64>,
    by_velocity: Vec<f64>,
    matrix: Vec<f64>,
    pivots: Vec<usize>,
    shifted: Vec<f64>,
}

impl Stiff {
    pub fn new(freedom: usize) -> Self {
        let square = || vec![0.0; freedom * freedom];
        Self {
            by_position: square(),
            by_velocity: square(),
            matrix: square(),
            pivots: vec![0; freedom],
            shifted: vec![0.0; freedom],
        }
    }
}

impl Plant<'_> {
    /// Chooses how steps are taken; [`Scheme::RungeKutta4`] unless told otherwise.
    pub fn set_scheme(&mut self, scheme: Scheme) {
        self.scheme = scheme;
    }

    /// One step of `h` seconds with the present stick and slip states, into `next_q` and `next_dq`. Of the slopes,
    /// the first is the acceleration at the start and the last the one nearest the end.
    pub(super) fn trial_step(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
    ) -> Result<(), SimulationError> {
        let mut slopes = std::mem::take(&mut self.work.slopes);
        let mut q = std::mem::take(&mut self.work.stage_q);
        let mut dq = std::mem::take(&mut self.work.stage_dq);
        let outcome = match self.scheme {
            Scheme::ExplicitEuler => self.euler(state, torque, h, 0.0, &mut slopes),
            Scheme::SemiImplicitEuler => self.euler(state, torque, h, h, &mut slopes),
            Scheme::Heun => self.heun(state, torque, h, &mut slopes, &mut q, &mut dq),
            Scheme::RungeKutta4 => self.runge_kutta(state, torque, h, &mut slopes, &mut q, &mut dq),
            Scheme::Rosenbrock2 => self.rosenbrock(state, torque, h, &mut slopes, &mut q, &mut dq),
        };
        self.work.slopes = slopes;
        self.work.stage_q = q;
        self.work.stage_dq = dq;
        outcome
    }

    /// Euler's step; positions go with the velocities at the start plus `lead` times the acceleration.
    fn euler(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
        lead: f64,
        slopes: &mut [Vec<f64>; 4],
    ) -> Result<(), SimulationError> {
        let [start, .., end] = slopes;
        self.accelerate(state.time, &state.q, &state.dq, &state.hold, torque, start)?;
        end.copy_from_slice(start);
        for i in 0..self.freedom {
            self.work.next_q[i] = state.q[i] + h * (state.dq[i] + lead * start[i]);
            self.work.next_dq[i] = state.dq[i] + h * start[i];
        }
        Ok(())
    }

    fn heun(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
        slopes: &mut [Vec<f64>; 4],
        stage_q: &mut [f64],
        stage_dq: &mut [f64],
    ) -> Result<(), SimulationError> {
        let [start, .., end] = slopes;
        self.accelerate(state.time, &state.q, &state.dq, &state.hold, torque, start)?;
        for i in 0..self.freedom {
            stage_q[i] = state.q[i] + h * state.dq[i];
            stage_dq[i] = state.dq[i] + h * start[i];
        }
        self.accelerate(state.time + h, stage_q, stage_dq, &state.hold, torque, end)?;
        for i in 0..self.freedom {
            self.work.next_q[i] = state.q[i] + 0.5 * h * (state.dq[i] + stage_dq[i]);
            self.work.next_dq[i] = state.dq[i] + 0.5 * h * (start[i] + end[i]);
        }
        Ok(())
    }

    fn runge_kutta(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
        slopes: &mut [Vec<f64>; 4],
        stage_q: &mut [f64],
        stage_dq: &mut [f64],
    ) -> Result<(), SimulationError> {
        let d = self.freedom;
        let [k1, k2, k3, k4] = slopes;
        let (half, t) = (0.5 * h, state.time);
        self.accelerate(t, &state.q, &state.dq, &state.hold, torque, k1)?;
        for i in 0..d {
            stage_q[i] = state.q[i] + half * state.dq[i];
            stage_dq[i] = state.dq[i] + half * k1[i];
        }
        self.accelerate(t + half, stage_q, stage_dq, &state.hold, torque, k2)?;
        for i in 0..d {
            stage_q[i] = state.q[i] + half * (state.dq[i] + half * k1[i]);
            stage_dq[i] = state.dq[i] + half * k2[i];
        }
        self.accelerate(t + half, stage_q, stage_dq, &state.hold, torque, k3)?;
        for i in 0..d {
            stage_q[i] = state.q[i] + h * (state.dq[i] + half * k2[i]);
            stage_dq[i] = state.dq[i] + h * k3[i];
        }
        self.accelerate(t + h, stage_q, stage_dq, &state.hold, torque, k4)?;
        for i in 0..d {
            let sum = k1[i] + k2[i] + k3[i];
            self.work.next_q[i] = state.q[i] + h * (state.dq[i] + h / 6.0 * sum);
            self.work.next_dq[i] = state.dq[i] + h / 6.0 * (sum + k2[i] + k3[i] + k4[i]);
        }
        Ok(())
    }

    /// With y = (q, dq), f = (dq, ddq) and J = df/dy: (E - g·h·J)·k1 = f(y), (E - g·h·J)·k2 = f(y + h·k1) - 2·k1,
    /// and the step is h·(3·k1 + k2)/2. The upper half of E - g·h·J is solved by hand.
    fn rosenbrock(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
        slopes: &mut [Vec<f64>; 4],
        stage_q: &mut [f64],
        stage_dq: &mut [f64],
    ) -> Result<(), SimulationError> {
        let d = self.freedom;
        let [start, first, second, end] = slopes;
        self.accelerate(state.time, &state.q, &state.dq, &state.hold, torque, start)?;
        let mut stiff = std::mem::take(&mut self.work.stiff);
        let factored = self.factor_step(state, torque, GAMMA * h, start, end, &mut stiff);
        let outcome = factored.and_then(|()| {
            stiff.solve(GAMMA * h, &state.dq, start, first);
            for i in 0..d {
                // The rate of the position in the first stage.
                let rate = state.dq[i] + GAMMA * h * first[i];
                stage_q[i] = state.q[i] + h * rate;
                stage_dq[i] = state.dq[i] + h * first[i];
            }
            self.accelerate(state.time + h, stage_q, stage_dq, &state.hold, torque, end)?;
            for i in 0..d {
                let rate = (stage_q[i] - state.q[i]) / h;
                stage_q[i] = stage_dq[i] - 2.0 * rate;
                stage_dq[i] = end[i] - 2.0 * first[i];
            }
            stiff.solve(GAMMA * h, stage_q, stage_dq, second);
            for i in 0..d {
                let rates = [state.dq[i] + GAMMA * h * first[i], stage_q[i] + GAMMA * h * second[i]];
                self.work.next_q[i] = state.q[i] + h * (1.5 * rates[0] + 0.5 * rates[1]);
                self.work.next_dq[i] = state.dq[i] + h * (1.5 * first[i] + 0.5 * second[i]);
            }
            Ok(())
        });
        self.work.stiff = stiff;
        outcome
    }

    /// Derivatives of the accelerations about `state` by differences from `ddq`, and the factors of
    /// E - s·dA/d(dq) - s²·dA/dq.
    fn factor_step(
        &mut self,
        state: &State,
        torque: &[f64],
        s: f64,
        ddq: &[f64],
        scratch: &mut [f64],
        stiff: &mut Stiff,
    ) -> Result<(), SimulationError> {
        let d = self.freedom;
        for of_velocity in [false, true] {
            for c in 0..d {
                let from = if of_velocity { &state.dq } else { &state.q };
                let step = 1.5e-8 * from[c].abs().max(1.0);
                stiff.shifted.copy_from_slice(from);
                stiff.shifted[c] += step;
                let (q, dq) =
                    if of_velocity { (&state.q, &stiff.shifted) } else { (&stiff.shifted, &state.dq) };
                self.accelerate(state.time, q, dq, &state.hold, torque, scratch)?;
                let into = if of_velocity { &mut stiff.by_velocity } else { &mut stiff.by_position };
                for r in 0..d {
                    into[r * d + c] = (scratch[r] - ddq[r]) / step;
                }
            }
        }
        for (k, entry) in stiff.matrix.iter_mut().enumerate() {
            let unit = if k / d == k % d { 1.0 } else { 0.0 };
            *entry = unit - s * (stiff.by_velocity[k] + s * stiff.by_position[k]);
        }
        if lu_factor(d, &mut stiff.matrix, &mut stiff.pivots) {
            Ok(())
        } else {
            Err(SimulationError::Diverged { time: state.time })
        }
    }
}

/// g of [`Scheme::Rosenbrock2`]: 1 - 1/sqrt(2), the L-stable value with the smaller error.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

impl Stiff {
    /// The accelerations' part of (E - s·J)⁻¹·(`upper`, `lower`); that of the positions is upper + s times it.
    fn solve(&self, s: f64, upper: &[f64], lower: &[f64], out: &mut [f64]) {
        let d = out.len();
        for r in 0..d {
            let row = &self.by_position[r * d..][..d];
            out[r] = lower[r] + s * row.iter().zip(upper).map(|(a, x)| a * x).sum::<f64>();
        }
        lu_solve(d, &self.matrix, &self.pivots, out);
    }
}

/// Factors with row exchanges in place; false where a pivot vanishes.
fn lu_factor(n: usize, a: &mut [f64], pivots: &mut [usize]) -> bool {
    for c in 0..n {
        let largest = |&x: &usize, &y: &usize| a[x * n + c].abs().total_cmp(&a[y * n + c].abs());
        let pivot = (c..n).max_by(largest).unwrap_or(c);
        pivots[c] = pivot;
        if !(a[pivot * n + c].abs() > 0.0 && a[pivot * n + c].is_finite()) {
            return false;
        }
        if pivot != c {
            for k in 0..n {
                a.swap(pivot * n + k, c * n + k);
            }
        }
        for r in c + 1..n {
            a[r * n + c] /= a[c * n + c];
            for k in c + 1..n {
                a[r * n + k] -= a[r * n + c] * a[c * n + k];
            }
        }
    }
    true
}

fn lu_solve(n: usize, a: &[f64], pivots: &[usize], x: &mut [f64]) {
    for c in 0..n {
        x.swap(c, pivots[c]);
    }
    for r in 0..n {
        for k in 0..r {
            x[r] -= a[r * n + k] * x[k];
        }
    }
    for r in (0..n).rev() {
        for k in r + 1..n {
            x[r] -= a[r * n + k] * x[k];
        }
        x[r] /= a[r * n + r];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Model, ParameterKind};
    use crate::simulation::ElasticJoint;
    use crate::simulation::testing::{arm, pendulum};
    use rand::{RngExt, SeedableRng};

    /// Positions of the arm without dry friction after 0.1 s in `steps` steps.
    fn after(scheme: Scheme, steps: usize) -> Vec<f64> {
        let (model, mut chi) = arm();
        for (x, p) in chi.iter_mut().zip(model.robot().standard.iter()) {
            if matches!(p.kind, ParameterKind::Fc | ParameterKind::Fcm) {
                *x = 0.0;
            }
        }
        let n = model.robot().joints();
        let mut plant = Plant::new(&model, &chi).expect("the arm can be simulated");
        plant.set_scheme(scheme);
        let mut state = plant.state(&vec![0.3; n], &vec![2.5; n]);
        for _ in 0..steps {
            plant.advance(&mut state, &vec![0.0; n], 0.1 / steps as f64).expect("it moves smoothly");
        }
        state.q
    }

    #[test]
    fn every_scheme_has_its_order() {
        let exact = after(Scheme::RungeKutta4, 1600);
        let error = |scheme, steps| -> f64 {
            let found = after(scheme, steps);
            found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        for (scheme, order) in Scheme::ALL.into_iter().zip([1.0, 1.0, 2.0, 4.0, 2.0]) {
            let found = (error(scheme, 20) / error(scheme, 40)).log2();
            assert!((found - order).abs() < 0.3, "{}: order {found}", scheme.name());
        }
    }

    /// A rotor on a spring that swings at 2.8 kHz, in steps of 0.5 ms: what is explicit leaves all bounds.
    #[test]
    fn the_stiff_safe_scheme_takes_steps_that_explicit_ones_cannot() {
        let (model, mut chi) = pendulum(0.5, 2.0, 0.0, 0.1);
        for (x, p) in chi.iter_mut().zip(model.robot().standard.iter()) {
            if p.kind == ParameterKind::Ia {
                *x = 0.2;
            }
        }
        let joint = ElasticJoint { joint: 0, stiffness: 6e7, damping: 0.0, play: 0.0 };
        let run = |scheme| {
            let mut plant = Plant::with_effects(&model, &chi, &[joint], Vec::new()).expect("a pendulum");
            plant.set_scheme(scheme);
            let mut state = plant.state(&[0.5], &[0.0]);
            (0..2000).try_for_each(|_| plant.advance(&mut state, &[0.1], 5e-4)).map(|()| state.q)
        };
        let moved = run(Scheme::Rosenbrock2).expect("it stays in bounds");
        assert!(moved.iter().all(|q| q.abs() < 1.0), "{moved:?}");
        for scheme in [Scheme::ExplicitEuler, Scheme::SemiImplicitEuler, Scheme::Heun, Scheme::RungeKutta4] {
            assert!(run(scheme).is_err(), "{}", scheme.name());
        }
    }

    #[test]
    fn a_factored_matrix_solves_its_system() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(2);
        for n in 1..=9 {
            let a: Vec<f64> = (0..n * n).map(|_| random.random_range(-1.0..1.0)).collect();
            let x: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut b: Vec<f64> = (0..n).map(|r| (0..n).map(|c| a[r * n + c] * x[c]).sum()).collect();
            let (mut lu, mut pivots) = (a.clone(), vec![0; n]);
            assert!(lu_factor(n, &mut lu, &mut pivots));
            lu_solve(n, &lu, &pivots, &mut b);
            assert!(b.iter().zip(&x).all(|(b, x)| (b - x).abs() < 1e-9), "{n}: {b:?} {x:?}");
        }
        assert!(!lu_factor(2, &mut [1.0, 2.0, 2.0, 4.0], &mut [0, 0]));
    }
}
