//! Motion of a plant over one control interval: steps that end where friction changes direction.
//!
//! Between two control samples the torques are held, and with fixed stick and slip states the robot is a smooth
//! system without fast modes: the controller is sampled, so its gains are no stiffness of the equations. The
//! classical fourth-order scheme at 5 kHz keeps the energy of a frictionless arm to better than 1e-8 over ten
//! seconds; `docs/simulation.md` sets the schemes beside each other. A slip velocity that would pass through zero ends the step there (located by the cubic through
//! values and slopes, then Newton), the stick-slip decision is taken exactly, and the rest of the interval goes
//! on with it. Friction never chatters, and nothing at rest creeps.

use super::SimulationError;
use super::plant::Plant;
use super::state::{Hold, State};

/// Slip velocities below this are rest where a step ends at a reversal, rad/s or m/s.
const REST: f64 = 1e-9;

/// Reversals in one step after which elements close to rest are simply held until its end.
const MANY_REVERSALS: usize = 24;

impl Plant<'_> {
    /// Moves the robot on by `step` seconds under held motor torques `torque` (n, joint side, N.m or N).
    ///
    /// # Errors
    /// A mass matrix that is not positive definite; a state that is no longer finite.
    pub fn advance(&mut self, state: &mut State, torque: &[f64], step: f64) -> Result<(), SimulationError> {
        let end = state.time + step;
        let mut left = step;
        for reversal in 0.. {
            self.decide(state, torque)?;
            self.trial_step(state, torque, left)?;
            let crossing = self.earliest_reversal(state, left);
            let Some(mut part) = crossing.filter(|_| reversal < MANY_REVERSALS) else {
                if crossing.is_some() {
                    self.hold_what_reversed(state);
                    self.trial_step(state, torque, left)?;
                }
                break;
            };
            if part <= 1e-9 * step {
                // It has only just been released and falls back at once: it holds.
                self.hold_what_reversed(state);
                continue;
            }
            for _ in 0..4 {
                self.trial_step(state, torque, part)?;
                let Some(correction) = self.newton_correction(state) else { break };
                part = (part + correction).clamp(0.0, left);
            }
            self.accept(state, part)?;
            self.stop_at_reversal(state);
            left -= part;
            if left <= 1e-12 * step {
                left = 0.0;
                break;
            }
        }
        if left > 0.0 {
            self.accept(state, left)?;
            self.follow_slip(state);
        }
        state.time = end;
        Ok(())
    }

    /// After a step that was not cut at every reversal in it: elements that slip the other way do so from now on.
    fn follow_slip(&mut self, state: &mut State) {
        for (element, hold) in self.friction.elements.iter().zip(&mut state.hold) {
            let slip = element.slip(&state.dq);
            match *hold {
                Hold::Forward if slip < -REST => *hold = Hold::Backward,
                Hold::Backward if slip > REST => *hold = Hold::Forward,
                _ => {}
            }
        }
    }

    /// Time into the step of `h` at which the first slipping element comes to rest; `None` where none does.
    fn earliest_reversal(&self, state: &State, h: f64) -> Option<f64> {
        let mut earliest: Option<f64> = None;
        for (element, hold) in self.friction.elements.iter().zip(&state.hold) {
            let (before, after) = (element.slip(&state.dq), element.slip(&self.work.next_dq));
            let reversed = match hold {
                Hold::Sticking => false,
                Hold::Forward => after < 0.0,
                Hold::Backward => after > 0.0,
            };
            if !reversed {
                continue;
            }
            let [start, .., end] = &self.work.stages.slopes;
            let when = h * cubic_root(before, after, h * element.slip(start), h * element.slip(end));
            earliest = Some(earliest.map_or(when, |t: f64| t.min(when)));
        }
        earliest
    }

    /// Newton step of the time at which the element nearest past rest is exactly at rest; `None` once it is.
    fn newton_correction(&self, state: &State) -> Option<f64> {
        let mut worst: Option<(f64, f64)> = None;
        for (element, hold) in self.friction.elements.iter().zip(&state.hold) {
            let along = match hold {
                Hold::Sticking => continue,
                Hold::Forward => 1.0,
                Hold::Backward => -1.0,
            };
            let slip = along * element.slip(&self.work.next_dq);
            let rate = along * element.slip(&self.work.stages.slopes[3]);
            if worst.is_none_or(|(least, _)| slip < least) {
                worst = Some((slip, rate));
            }
        }
        let (slip, rate) = worst?;
        (slip.abs() > REST && rate < 0.0).then(|| -slip / rate)
    }

    /// Holds, from the start of the step, every element that is at rest there and that the trial step carried
    /// the wrong way.
    fn hold_what_reversed(&mut self, state: &mut State) {
        for (element, hold) in self.friction.elements.iter().zip(&mut state.hold) {
            let (before, after) = (element.slip(&state.dq), element.slip(&self.work.next_dq));
            let reversed =
                (*hold == Hold::Forward && after < 0.0) || (*hold == Hold::Backward && after > 0.0);
            if reversed && before.abs() <= REST {
                *hold = Hold::Sticking;
            }
        }
        self.stop_sticking(state);
    }

    /// After a step that ends at a reversal: elements at rest are marked, and their velocity is exactly zero.
    fn stop_at_reversal(&mut self, state: &mut State) {
        for (element, hold) in self.friction.elements.iter().zip(&mut state.hold) {
            let slip = element.slip(&state.dq);
            if (*hold == Hold::Forward && slip <= REST) || (*hold == Hold::Backward && slip >= -REST) {
                *hold = Hold::Sticking;
            }
        }
        self.stop_sticking(state);
    }

    /// Takes the last rounding errors of velocity from elements that stick.
    fn stop_sticking(&self, state: &mut State) {
        for (element, hold) in self.friction.elements.iter().zip(&state.hold) {
            if *hold != Hold::Sticking {
                continue;
            }
            if let [(coordinate, _)] = element.direction[..] {
                state.dq[coordinate] = 0.0;
            }
        }
    }

    fn accept(&mut self, state: &mut State, step: f64) -> Result<(), SimulationError> {
        state.q.copy_from_slice(&self.work.next_q);
        state.dq.copy_from_slice(&self.work.next_dq);
        state.time += step;
        if !state.q.iter().chain(&state.dq).all(|x| x.is_finite() && x.abs() < 1e9) {
            return Err(SimulationError::Diverged { time: state.time });
        }
        if !self.effects.is_empty() {
            let last = std::mem::take(&mut self.work.stages.slopes[3]);
            self.note_load(state, &last);
            self.work.stages.slopes[3] = last;
            self.advance_effects(state, step);
        }
        Ok(())
    }
}

/// First zero in [0, 1] of the cubic with values `before`, `after` and slopes `d0`, `d1` at 0 and 1, where the
/// values differ in sign (or `before` is zero, and then the zero after leaving it).
fn cubic_root(before: f64, after: f64, d0: f64, d1: f64) -> f64 {
    let value = |s: f64| {
        let (r, rr, ss) = (1.0 - s, (1.0 - s) * (1.0 - s), s * s);
        before * (1.0 + 2.0 * s) * rr + d0 * s * rr + after * ss * (3.0 - 2.0 * s) - d1 * ss * r
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if value(middle) * after > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
        if high - low < 1e-15 {
            break;
        }
    }
    high
}
