//! A step of [`super::Scheme::Rosenbrock2`].

use super::SimulationError;
use super::driven::Driven;
use super::lu::lu_factor;
use super::plant::Plant;
use super::state::State;
use super::stiff::Stiff;
use super::work::Stages;

/// g of [`super::Scheme::Rosenbrock2`]: 1 - 1/sqrt(2), the L-stable value with the smaller error.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

impl Plant<'_> {
    /// With y = (q, dq), f = (dq, ddq) and J = df/dy: (E - g·h·J)·k1 = f(y), (E - g·h·J)·k2 = f(y + h·k1) - 2·k1,
    /// and the step is h·(3·k1 + k2)/2. The upper half of E - g·h·J is solved by hand.
    pub(super) fn rosenbrock(
        &mut self,
        state: &State,
        torque: &[f64],
        h: f64,
        stages: &mut Stages,
    ) -> Result<(), SimulationError> {
        let d = self.freedom;
        let Stages { slopes: [start, first, second, end], q: stage_q, dq: stage_dq } = stages;
        self.accelerate(&Driven::by(state, torque), start)?;
        let mut stiff = std::mem::take(&mut self.work.stiff);
        let factored = self.factor_step(state, torque, GAMMA * h, [start, end], &mut stiff);
        let outcome = factored.and_then(|()| {
            stiff.solve(GAMMA * h, &state.dq, start, first);
            for i in 0..d {
                // The rate of the position in the first stage.
                let rate = state.dq[i] + GAMMA * h * first[i];
                stage_q[i] = state.q[i] + h * rate;
                stage_dq[i] = state.dq[i] + h * first[i];
            }
            self.accelerate(
                &Driven { time: state.time + h, q: stage_q, dq: stage_dq, hold: &state.hold, torque },
                end,
            )?;
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
        [ddq, scratch]: [&mut [f64]; 2],
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
                self.accelerate(&Driven { time: state.time, q, dq, hold: &state.hold, torque }, scratch)?;
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
