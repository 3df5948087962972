//! A simulated robot: forward dynamics with friction that holds at rest.

use super::drive::{DriveFriction, rotor_matrix};
use super::extra::{ExtraTorque, Instant};
use super::rest::{self, Decision, RestScratch};
use super::{SimulationError, cholesky};
use crate::model::{Model, ParameterKind};

/// Compliance and play between motor and link of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticJoint {
    /// 0-based joint.
    pub joint: usize,
    /// N.m/rad or N/m.
    pub stiffness: f64,
    /// N.m.s/rad or N.s/m.
    pub damping: f64,
    /// Total play, rad or m; 0 for none.
    pub play: f64,
}

/// Whether a place of dry friction holds or slips.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// At rest, held by friction.
    Sticking,
    /// Slip velocity positive.
    Forward,
    /// Slip velocity negative.
    Backward,
}

/// Where the robot is. The first n coordinates are the joints; then one per elastic joint, its motor side.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// s.
    pub time: f64,
    /// rad or m.
    pub q: Vec<f64>,
    /// rad/s or m/s.
    pub dq: Vec<f64>,
    /// One per place of dry friction.
    pub hold: Vec<Hold>,
}

impl State {
    /// Takes over another state of the same plant, without allocating.
    pub fn copy_from(&mut self, other: &State) {
        self.time = other.time;
        self.q.copy_from_slice(&other.q);
        self.dq.copy_from_slice(&other.dq);
        self.hold.copy_from_slice(&other.hold);
    }
}

/// A robot that can be driven by joint torques.
pub struct Plant<'m> {
    pub(super) model: &'m dyn Model,
    chi: Vec<f64>,
    joints: usize,
    pub(super) freedom: usize,
    pub(super) friction: DriveFriction,
    elastic: Vec<ElasticJoint>,
    /// Coordinate of the motor side of each joint.
    motor: Vec<usize>,
    /// Rotor inertias where they are not part of chi (with elastic joints), n x n; else empty.
    rotor: Vec<f64>,
    pub(super) effects: Vec<Box<dyn ExtraTorque + 'm>>,
    pub(super) work: Work,
}

/// Memory of one evaluation, allocated once.
#[derive(Debug, Clone)]
pub(super) struct Work {
    link_mass: Vec<f64>,
    link_bias: Vec<f64>,
    mass: Vec<f64>,
    /// M⁻¹·Gᵀ, one row per friction element.
    response: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    limits: Vec<[f64; 2]>,
    chosen: Vec<usize>,
    decisions: Vec<Decision>,
    rest: RestScratch,
    extra: Vec<f64>,
    joint_levels: Vec<[f64; 2]>,
    levels: Vec<[f64; 2]>,
    motor_q: Vec<f64>,
    motor_dq: Vec<f64>,
    pub(super) load: Vec<f64>,
    pub(super) slopes: [Vec<f64>; 4],
    pub(super) stage_q: Vec<f64>,
    pub(super) stage_dq: Vec<f64>,
    pub(super) next_q: Vec<f64>,
    pub(super) next_dq: Vec<f64>,
}

impl<'m> Plant<'m> {
    /// A rigid robot from base parameters chi (friction and offsets included, payload regrouped in it).
    ///
    /// # Errors
    /// Wrong length, a number that is not finite, a negative friction coefficient.
    pub fn new(model: &'m dyn Model, chi: &[f64]) -> Result<Self, SimulationError> {
        Self::build(model, chi.to_vec(), Vec::new(), None, Vec::new())
    }

    /// [`Plant::new`] with torques of effects.
    ///
    /// # Errors
    /// As [`Plant::new`].
    pub fn with_torques(
        model: &'m dyn Model,
        chi: &[f64],
        effects: Vec<Box<dyn ExtraTorque + 'm>>,
    ) -> Result<Self, SimulationError> {
        Self::build(model, chi.to_vec(), Vec::new(), None, effects)
    }

    /// A robot from standard parameters chi_st, with elastic joints and effects. Rotors and friction of an
    /// elastic joint are on its motor side.
    ///
    /// # Errors
    /// As [`Plant::new`]; an elastic joint without rotor inertia or with a negative constant. Physical
    /// consistency is checked by [`super::check_standard`], not here.
    pub fn with_effects(
        model: &'m dyn Model,
        standard: &[f64],
        elastic: &[ElasticJoint],
        effects: Vec<Box<dyn ExtraTorque + 'm>>,
    ) -> Result<Self, SimulationError> {
        let robot = model.robot();
        if standard.len() != robot.standard.len() {
            return Err(SimulationError::Length {
                what: "standard parameters",
                expected: robot.standard.len(),
                found: standard.len(),
            });
        }
        if elastic.is_empty() {
            return Self::build(model, robot.base_from_standard(standard), Vec::new(), None, effects);
        }
        let joint_of = robot.joint_of_frame();
        let mut links = standard.to_vec();
        let mut inertia = vec![0.0; robot.joints()];
        for (parameter, value) in robot.standard.iter().zip(&mut links) {
            if let (ParameterKind::Ia, Some(j)) = (parameter.kind, joint_of[parameter.frame]) {
                inertia[j] = std::mem::take(value);
            }
        }
        for joint in elastic {
            check_elastic(joint, &inertia)?;
        }
        let rotor = rotor_matrix(robot, &inertia);
        Self::build(model, robot.base_from_standard(&links), elastic.to_vec(), Some(rotor), effects)
    }

    fn build(
        model: &'m dyn Model,
        chi: Vec<f64>,
        elastic: Vec<ElasticJoint>,
        rotor: Option<Vec<f64>>,
        effects: Vec<Box<dyn ExtraTorque + 'm>>,
    ) -> Result<Self, SimulationError> {
        let robot = model.robot();
        if chi.len() != robot.base.len() {
            return Err(SimulationError::Length {
                what: "base parameters",
                expected: robot.base.len(),
                found: chi.len(),
            });
        }
        if let Some(k) = chi.iter().position(|x| !x.is_finite()) {
            return Err(SimulationError::NotFinite { name: robot.base[k].name.to_string() });
        }
        let n = robot.joints();
        let mut motor: Vec<usize> = (0..n).collect();
        for (k, joint) in elastic.iter().enumerate() {
            motor[joint.joint] = n + k;
        }
        let freedom = n + elastic.len();
        let kept = robot.base.iter().zip(&chi).map(|(p, &value)| {
            let standard = &robot.standard[p.standard];
            (&*p.name, standard.kind, standard.frame, value)
        });
        let every_joint = effects.iter().any(|e| e.has_dry_friction());
        let friction = DriveFriction::new(robot, kept, &motor, every_joint)?;
        let elements = friction.elements.len();
        let work = Work {
            link_mass: vec![0.0; n * n],
            link_bias: vec![0.0; n],
            mass: vec![0.0; freedom * freedom],
            response: vec![0.0; elements * freedom],
            a: vec![0.0; elements * elements],
            b: vec![0.0; elements],
            limits: vec![[0.0; 2]; elements],
            chosen: Vec::with_capacity(elements),
            decisions: vec![Decision::Stick; elements],
            rest: RestScratch::new(elements),
            extra: vec![0.0; n],
            joint_levels: vec![[0.0; 2]; n],
            levels: friction.elements.iter().map(|e| [e.level; 2]).collect(),
            motor_q: vec![0.0; n],
            motor_dq: vec![0.0; n],
            load: vec![0.0; n],
            slopes: std::array::from_fn(|_| vec![0.0; freedom]),
            stage_q: vec![0.0; freedom],
            stage_dq: vec![0.0; freedom],
            next_q: vec![0.0; freedom],
            next_dq: vec![0.0; freedom],
        };
        let rotor = rotor.unwrap_or_default();
        Ok(Self { model, chi, joints: n, freedom, friction, elastic, motor, rotor, effects, work })
    }

    /// Number of joints n.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// The base parameters of the links (rotor inertias included where no joint is elastic).
    pub fn chi(&self) -> &[f64] {
        &self.chi
    }

    /// The model that the plant runs on.
    pub fn model(&self) -> &'m dyn Model {
        self.model
    }

    /// The robot at joint positions `q` (n) with joint velocities `dq` (n); motors stand where their links are.
    pub fn state(&self, q: &[f64], dq: &[f64]) -> State {
        let mut state = State {
            time: 0.0,
            q: q.to_vec(),
            dq: dq.to_vec(),
            hold: vec![Hold::Sticking; self.friction.elements.len()],
        };
        for joint in &self.elastic {
            state.q.push(q[joint.joint]);
            state.dq.push(dq[joint.joint]);
        }
        for (hold, element) in state.hold.iter_mut().zip(&self.friction.elements) {
            let slip = element.slip(&state.dq);
            if slip != 0.0 {
                *hold = if slip > 0.0 { Hold::Forward } else { Hold::Backward };
            }
        }
        state
    }

    /// Motor-side position of joint j in `state`: what its encoder sees, in units of the joint.
    #[inline]
    pub fn motor_position(&self, state: &State, j: usize) -> f64 {
        state.q[self.motor[j]]
    }

    /// Motor-side velocity of joint j.
    #[inline]
    pub fn motor_velocity(&self, state: &State, j: usize) -> f64 {
        state.dq[self.motor[j]]
    }

    /// Motor-side acceleration of joint j among the accelerations of all coordinates.
    #[inline]
    pub fn motor_acceleration(&self, ddq: &[f64], j: usize) -> f64 {
        ddq[self.motor[j]]
    }

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
        self.accelerate(state.time, &state.q, &state.dq, &state.hold, torque, ddq)
    }

    /// Mass matrix (factored in place) and the torques that accelerate it, all friction of slipping elements
    /// included, that of sticking ones not.
    fn assemble(
        &mut self,
        time: f64,
        q: &[f64],
        dq: &[f64],
        hold: &[Hold],
        torque: &[f64],
        right: &mut [f64],
    ) -> Result<(), SimulationError> {
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
            for j in 0..n {
                work.motor_q[j] = q[self.motor[j]];
                work.motor_dq[j] = dq[self.motor[j]];
            }
            let at = Instant { time, q: &work.motor_q, dq: &work.motor_dq, load: &work.load };
            work.extra.fill(0.0);
            work.joint_levels.fill([0.0; 2]);
            for effect in &self.effects {
                effect.torque(&at, &mut work.extra);
                effect.dry_friction(&at, &mut work.joint_levels);
            }
            for j in 0..n {
                right[self.motor[j]] -= work.extra[j];
            }
            for (level, element) in work.levels.iter_mut().zip(&self.friction.elements) {
                let more = element.joint.map_or([0.0; 2], |j| work.joint_levels[j]);
                *level = more.map(|x| (element.level + x).max(0.0));
            }
        }
        for ((element, hold), level) in self.friction.elements.iter().zip(hold).zip(&work.levels) {
            match hold {
                Hold::Sticking => {}
                Hold::Forward => element.add(-level[1], right),
                Hold::Backward => element.add(level[0], right),
            }
        }
        if cholesky::factor(d, &mut work.mass) { Ok(()) } else { Err(SimulationError::MassMatrix { time }) }
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
        let mut free = std::mem::take(&mut self.work.slopes[0]);
        let assembled = self.assemble(state.time, &state.q, &state.dq, &state.hold, torque, &mut free);
        if assembled.is_ok() {
            cholesky::solve(self.freedom, &self.work.mass, &mut free);
            self.choose_sticking(&state.hold);
            self.condense(&free);
            let Work { a, b, limits, levels, chosen, decisions, rest, .. } = &mut self.work;
            for (limit, &k) in limits.iter_mut().zip(chosen.iter()) {
                *limit = [-levels[k][0], levels[k][1]];
            }
            rest::decide(chosen.len(), a, b, limits, rest, decisions);
            for (&k, decision) in chosen.iter().zip(decisions.iter()) {
                state.hold[k] = match decision {
                    Decision::Stick => Hold::Sticking,
                    Decision::Forward => Hold::Forward,
                    Decision::Backward => Hold::Backward,
                };
            }
        }
        self.work.slopes[0] = free;
        assembled
    }

    fn choose_sticking(&mut self, hold: &[Hold]) {
        self.work.chosen.clear();
        self.work.chosen.extend((0..hold.len()).filter(|&k| hold[k] == Hold::Sticking));
    }

    /// Accelerations with every element held or slipping as `hold` says.
    pub(super) fn accelerate(
        &mut self,
        time: f64,
        q: &[f64],
        dq: &[f64],
        hold: &[Hold],
        torque: &[f64],
        ddq: &mut [f64],
    ) -> Result<(), SimulationError> {
        self.assemble(time, q, dq, hold, torque, ddq)?;
        let d = self.freedom;
        cholesky::solve(d, &self.work.mass, ddq);
        self.choose_sticking(hold);
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
        for j in 0..n {
            let inertial: f64 = (0..n).map(|s| work.link_mass[j * n + s] * ddq[s]).sum();
            work.load[j] = work.link_bias[j] + inertial;
        }
    }

    /// Lets the effects update their inner states.
    pub(super) fn advance_effects(&mut self, state: &State, step: f64) {
        if self.effects.is_empty() {
            return;
        }
        let work = &mut self.work;
        for j in 0..self.joints {
            work.motor_q[j] = state.q[self.motor[j]];
            work.motor_dq[j] = state.dq[self.motor[j]];
        }
        let at = Instant { time: state.time, q: &work.motor_q, dq: &work.motor_dq, load: &work.load };
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

fn check_elastic(joint: &ElasticJoint, inertia: &[f64]) -> Result<(), SimulationError> {
    let setting = |what, expected, found| Err(SimulationError::Setting { what, expected, found });
    let Some(&rotor) = inertia.get(joint.joint) else {
        return setting("the elastic joint", "a joint of the robot", joint.joint as f64);
    };
    if !(joint.stiffness > 0.0 && joint.stiffness.is_finite()) {
        return setting("the stiffness of an elastic joint", "positive", joint.stiffness);
    }
    if !(joint.damping >= 0.0 && joint.damping.is_finite()) {
        return setting("the damping of an elastic joint", "zero or positive", joint.damping);
    }
    if !(joint.play >= 0.0 && joint.play.is_finite()) {
        return setting("the play of a joint", "zero or positive", joint.play);
    }
    if rotor <= 0.0 {
        return setting("Ia of an elastic joint", "positive", rotor);
    }
    Ok(())
}
