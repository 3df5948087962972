//! Forward dynamics of a plant: which friction holds, and the accelerations that follow.

use super::SimulationError;
use super::driven::Driven;
use super::extra::ExtraTorque;
use super::plant::Plant;
use super::state::{Hold, State};
use super::stiction::{self, Decision};
use super::work::Work;
use crate::model::cholesky;

impl Plant<'_> {
    /// Accelerations of all coordinates under the motor torques `torque` (n, joint side), with every place of dry
    /// friction as `state.hold` says. Elements at rest are decided first.
    ///
    /// # Errors
    /// A mass matrix that is not positive definite.
    pub fn acceleration(
        &mut self,
        state: &mut State,
        torque: &[f64],
        ddq: &mut [f64],
    ) -> Result<(), SimulationError> {
        self.decide(state, torque)?;
        self.accelerate(&Driven::by(state, torque), ddq)
    }

    /// Mass matrix (factored in place) and the torques that accelerate it, all friction of slipping elements
    /// included, that of sticking ones not.
    fn assemble(&mut self, at: &Driven<'_>, right: &mut [f64]) -> Result<(), SimulationError> {
        let &Driven { time, q, dq, hold, torque } = at;
        let (n, d) = (self.joints, self.freedom);
        let work = &mut self.work;
        self.model.mass_and_bias(&self.chi, &q[..n], &dq[..n], &mut work.link_mass, &mut work.link_bias);
        if d == n {
            work.mass.copy_from_slice(&work.link_mass);
        } else {
            work.mass.fill(0.0);
            for a in 0..n {
                for b in 0..n {
                    work.mass[a * d + b] += work.link_mass[a * n + b];
                    work.mass[self.motor[a] * d + self.motor[b]] += self.rotor[a * n + b];
                }
            }
        }
        right.fill(0.0);
        for j in 0..n {
            right[j] -= work.link_bias[j];
            right[self.motor[j]] += torque[j];
        }
        for &(coordinate, offset) in &self.friction.offset {
            right[coordinate] -= offset;
        }
        for &(row, column, coefficient) in &self.friction.viscous {
            right[row] -= coefficient * dq[column];
        }
        for joint in &self.elastic {
            let (link, motor) = (joint.joint, self.motor[joint.joint]);
            let twist = q[motor] - q[link];
            let stretch = twist - twist.clamp(-0.5 * joint.play, 0.5 * joint.play);
            if stretch != 0.0 || joint.play == 0.0 {
                let through = joint.stiffness * stretch + joint.damping * (dq[motor] - dq[link]);
                right[link] += through;
                right[motor] -= through;
            }
        }
        if !self.effects.is_empty() {
            self.add_effects(at, right);
        }
        let work = &mut self.work;
        for ((element, hold), level) in self.friction.elements.iter().zip(hold).zip(&work.levels) {
            match hold {
                Hold::Sticking => {}
                Hold::Forward => element.add(-level[1], right),
                Hold::Backward => element.add(level[0], right),
            }
        }
        if cholesky::factor(d, &mut work.mass) { Ok(()) } else { Err(SimulationError::MassMatrix { time }) }
    }

    /// Torques of the effects, and the levels of dry friction with theirs.
    fn add_effects(&mut self, at: &Driven<'_>, right: &mut [f64]) {
        let n = self.joints;
        self.work.extra.fill(0.0);
        self.work.joint_levels.fill([0.0; 2]);
        self.work.seen.effects.fill(0.0);
        self.sum_effects(at, |effect| !effect.looks_at_effects());
        if self.effects.iter().any(|effect| effect.looks_at_effects()) {
            let Work { seen, extra, joint_levels, .. } = &mut self.work;
            for (j, sum) in seen.effects.iter_mut().enumerate() {
                let [backward, forward] = joint_levels[j];
                *sum = extra[j] + if seen.dq[j] < 0.0 { -backward } else { forward };
            }
            self.sum_effects(at, |effect| effect.looks_at_effects());
        }
        let work = &mut self.work;
        for j in 0..n {
            right[self.motor[j]] -= work.extra[j];
        }
        for (level, element) in work.levels.iter_mut().zip(&self.friction.elements) {
            let more = element.joint.map_or([0.0; 2], |j| work.joint_levels[j]);
            *level = more.map(|x| (element.level + x).max(0.0));
        }
    }

    /// Adds what some of the effects make to the sums of all.
    fn sum_effects(&mut self, at: &Driven<'_>, of: impl Fn(&dyn ExtraTorque) -> bool) {
        let &Driven { time, q, dq, hold, .. } = at;
        let work = &mut self.work;
        for j in 0..self.joints {
            work.seen.q[j] = q[self.motor[j]];
            work.seen.dq[j] = dq[self.motor[j]];
        }
        let these = || self.effects.iter().filter(|effect| of(effect.as_ref()));
        let seen = work.seen.at(time);
        these().for_each(|effect| effect.torque(&seen, &mut work.extra));
        // Where a step passes a reversal before it is cut there, friction of a direction is that of rest: a level that
        // grows with the speed would push on, the further the more.
        for (element, hold) in self.friction.elements.iter().zip(hold) {
            if let Some(j) = element.joint {
                let dq = &mut work.seen.dq[j];
                *dq = match hold {
                    Hold::Sticking => *dq,
                    Hold::Forward => dq.max(0.0),
                    Hold::Backward => dq.min(0.0),
                };
            }
        }
        let seen = work.seen.at(time);
        these().for_each(|effect| effect.dry_friction(&seen, &mut work.joint_levels));
    }

    /// Fills `response` = M⁻¹·Gᵀ, A and b for the elements in `chosen`, for accelerations `free` without them.
    fn condense(&mut self, free: &[f64]) {
        let d = self.freedom;
        let Work { mass, response, a, b, chosen, .. } = &mut self.work;
        let count = chosen.len();
        for (row, &k) in chosen.iter().enumerate() {
            let column = &mut response[row * d..][..d];
            column.fill(0.0);
            self.friction.elements[k].add(1.0, column);
            cholesky::solve(d, mass, column);
        }
        for (row, &k) in chosen.iter().enumerate() {
            let element = &self.friction.elements[k];
            b[row] = element.slip(free);
            for column in 0..count {
                a[row * count + column] = element.slip(&response[column * d..][..d]);
            }
        }
    }

    /// Decides for every element at rest whether it holds or starts to slip.
    pub(super) fn decide(&mut self, state: &mut State, torque: &[f64]) -> Result<(), SimulationError> {
        if state.hold.iter().all(|&hold| hold != Hold::Sticking) {
            return Ok(());
        }
        let mut free = std::mem::take(&mut self.work.stages.slopes[0]);
        let assembled = self.assemble(&Driven::by(state, torque), &mut free);
        if assembled.is_ok() {
            cholesky::solve(self.freedom, &self.work.mass, &mut free);
            self.choose_sticking(&state.hold);
            self.condense(&free);
            let Work { a, b, limits, levels, chosen, decisions, stiction: memory, .. } = &mut self.work;
            for (limit, &k) in limits.iter_mut().zip(chosen.iter()) {
                *limit = [-levels[k][0], levels[k][1]];
            }
            stiction::decide(chosen.len(), a, b, limits, memory, decisions);
            for (&k, decision) in chosen.iter().zip(decisions.iter()) {
                state.hold[k] = match decision {
                    Decision::Stick => Hold::Sticking,
                    Decision::Forward => Hold::Forward,
                    Decision::Backward => Hold::Backward,
                };
            }
        }
        self.work.stages.slopes[0] = free;
        assembled
    }

    fn choose_sticking(&mut self, hold: &[Hold]) {
        self.work.chosen.clear();
        self.work.chosen.extend((0..hold.len()).filter(|&k| hold[k] == Hold::Sticking));
    }

    /// Accelerations with every element held or slipping as `at.hold` says.
    pub(super) fn accelerate(&mut self, at: &Driven<'_>, ddq: &mut [f64]) -> Result<(), SimulationError> {
        self.assemble(at, ddq)?;
        let d = self.freedom;
        cholesky::solve(d, &self.work.mass, ddq);
        self.choose_sticking(at.hold);
        if self.work.chosen.is_empty() {
            return Ok(());
        }
        self.condense(ddq);
        let Work { response, a, b, chosen, .. } = &mut self.work;
        let count = hold_at_rest(chosen, a, b);
        for (row, column) in response.chunks_exact(d).enumerate().take(count) {
            for (x, &r) in ddq.iter_mut().zip(column) {
                *x -= b[row] * r;
            }
        }
        for &k in chosen.iter() {
            if let [(coordinate, _)] = self.friction.elements[k].direction[..] {
                ddq[coordinate] = 0.0;
            }
        }
        Ok(())
    }

    /// Records the torque that each joint transmits, for effects that depend on the load.
    pub(super) fn note_load(&mut self, state: &State, ddq: &[f64]) {
        if self.effects.is_empty() {
            return;
        }
        let n = self.joints;
        let work = &mut self.work;
        self.model.mass_and_bias(
            &self.chi,
            &state.q[..n],
            &state.dq[..n],
            &mut work.link_mass,
            &mut work.link_bias,
        );
        work.seen.ddq.copy_from_slice(&ddq[..n]);
        for j in 0..n {
            let inertial: f64 = (0..n).map(|s| work.link_mass[j * n + s] * ddq[s]).sum();
            work.seen.load[j] = work.link_bias[j] + inertial;
            let rotors: f64 = (0..n).map(|s| self.rotor_in_chi[j * n + s] * ddq[s]).sum();
            work.seen.link[j] = work.seen.load[j] - rotors;
        }
        if self.effects.iter().any(|effect| effect.needs_gravity()) {
            work.extra.fill(0.0);
            let (rest, mass) = (&work.extra, &mut work.link_mass);
            self.model.mass_and_bias(&self.chi, &state.q[..n], rest, mass, &mut work.seen.gravity);
        }
    }

    /// Lets the effects update their inner states.
    pub(super) fn advance_effects(&mut self, state: &State, step: f64) {
        if self.effects.is_empty() {
            return;
        }
        let work = &mut self.work;
        for j in 0..self.joints {
            work.seen.q[j] = state.q[self.motor[j]];
            work.seen.dq[j] = state.dq[self.motor[j]];
        }
        let at = work.seen.at(state.time);
        for effect in &mut self.effects {
            effect.advance(&at, step);
        }
    }
}

/// Solves A·f = b for the elements that hold, in place of b; returns their number. An element that the ones
/// before it already hold (its pivot vanishes) gets no torque of its own.
fn hold_at_rest(chosen: &[usize], a: &mut [f64], b: &mut [f64]) -> usize {
    let count = chosen.len();
    for i in 0..count {
        let scale = a[i * count + i];
        for j in 0..i {
            let mut sum = a[i * count + j];
            for k in 0..j {
                sum -= a[i * count + k] * a[j * count + k];
            }
            a[i * count + j] = sum * a[j * count + j];
        }
        let mut pivot = scale;
        for k in 0..i {
            pivot -= a[i * count + k] * a[i * count + k];
        }
        a[i * count + i] = if pivot > 1e-10 * scale { 1.0 / pivot.sqrt() } else { 0.0 };
    }
    cholesky::solve(count, a, b);
    count
}
