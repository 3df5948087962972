//! One step of a plant with fixed stick and slip states.

use super::SimulationError;
use super::driven::Driven;
use super::plant::Plant;
use super::scheme::Scheme;
use super::state::State;
use super::work::Stages;

impl Plant<'_> {
    /// Chooses how steps are taken; [`Scheme::RungeKutta4`] unless told otherwise.
    pub fn set_scheme(&mut self, scheme: Scheme) {
        self.scheme = scheme;
    }

    /// One step of `h` seconds with the present stick and slip states, into `next_q` and `next_dq`. Of the slopes
    /// of the stages the first is the acceleration at the start and the last the one nearest the end.
    pub(super) fn trial_step(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
    ) -> Result<(), SimulationError> {
        let mut stages = std::mem::take(&mut self.work.stages);
        let outcome = match self.scheme {
            Scheme::ExplicitEuler => self.euler(state, torque, h, 0.0, &mut stages),
            Scheme::SemiImplicitEuler => self.euler(state, torque, h, h, &mut stages),
            Scheme::Heun => self.heun(state, torque, h, &mut stages),
            Scheme::RungeKutta4 => self.runge_kutta(state, torque, h, &mut stages),
            Scheme::Rosenbrock2 => self.rosenbrock(state, torque, h, &mut stages),
        };
        self.work.stages = stages;
        outcome
    }

    /// Euler's step; positions go with the velocities at the start plus `lead` times the acceleration.
    fn euler(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
        lead: f64,
        stages: &mut Stages,
    ) -> Result<(), SimulationError> {
        let [start, .., end] = &mut stages.slopes;
        self.accelerate(&Driven::by(state, torque), start)?;
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
        stages: &mut Stages,
    ) -> Result<(), SimulationError> {
        let Stages { slopes: [start, .., end], q: stage_q, dq: stage_dq } = stages;
        self.accelerate(&Driven::by(state, torque), start)?;
        for i in 0..self.freedom {
            stage_q[i] = state.q[i] + h * state.dq[i];
            stage_dq[i] = state.dq[i] + h * start[i];
        }
        self.accelerate(
            &Driven { time: state.time + h, q: stage_q, dq: stage_dq, hold: &state.hold, torque },
            end,
        )?;
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
        stages: &mut Stages,
    ) -> Result<(), SimulationError> {
        let d = self.freedom;
        let Stages { slopes: [k1, k2, k3, k4], q: stage_q, dq: stage_dq } = stages;
        let (half, t) = (0.5 * h, state.time);
        self.accelerate(&Driven { time: t, q: &state.q, dq: &state.dq, hold: &state.hold, torque }, k1)?;
        for i in 0..d {
            stage_q[i] = state.q[i] + half * state.dq[i];
            stage_dq[i] = state.dq[i] + half * k1[i];
        }
        self.accelerate(&Driven { time: t + half, q: stage_q, dq: stage_dq, hold: &state.hold, torque }, k2)?;
        for i in 0..d {
            stage_q[i] = state.q[i] + half * (state.dq[i] + half * k1[i]);
            stage_dq[i] = state.dq[i] + half * k2[i];
        }
        self.accelerate(&Driven { time: t + half, q: stage_q, dq: stage_dq, hold: &state.hold, torque }, k3)?;
        for i in 0..d {
            stage_q[i] = state.q[i] + h * (state.dq[i] + half * k2[i]);
            stage_dq[i] = state.dq[i] + h * k3[i];
        }
        self.accelerate(&Driven { time: t + h, q: stage_q, dq: stage_dq, hold: &state.hold, torque }, k4)?;
        for i in 0..d {
            let sum = k1[i] + k2[i] + k3[i];
            self.work.next_q[i] = state.q[i] + h * (state.dq[i] + h / 6.0 * sum);
            self.work.next_dq[i] = state.dq[i] + h / 6.0 * (sum + k2[i] + k3[i] + k4[i]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Model, ParameterKind};
    use crate::simulation::ElasticJoint;
    use crate::simulation::testing::{arm, pendulum};

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
}
