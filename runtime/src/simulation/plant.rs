//! A simulated robot: its parameters, its friction and its elastic joints.

use super::SimulationError;
use super::drive::{DriveFriction, rotor_matrix};
use super::elastic::{ElasticJoint, check_elastic};
use super::extra::ExtraTorque;
use super::scheme::Scheme;
use super::state::{Hold, State};
use super::work::Work;
use crate::model::{JointIndex, Model, ParameterKind};

/// A robot that can be driven by joint torques.
pub struct Plant<'m> {
    pub(super) model: &'m dyn Model,
    pub(super) chi: Vec<f64>,
    pub(super) joints: usize,
    pub(super) freedom: usize,
    pub(super) friction: DriveFriction,
    pub(super) elastic: Vec<ElasticJoint>,
    /// Coordinate of the motor side of each joint.
    pub(super) motor: Vec<usize>,
    /// Rotor inertias where they are not part of chi (with elastic joints), n x n; else empty.
    pub(super) rotor: Vec<f64>,
    /// What the rotors whose inertias are parameters of their own add to the mass matrix of chi, n x n.
    pub(super) rotor_in_chi: Vec<f64>,
    pub(super) effects: Vec<Box<dyn ExtraTorque + 'm>>,
    /// How far each joint is from where its encoder sees it.
    pub(super) beyond_encoder: Vec<f64>,
    /// So many times its real torque is what each drive is told and records.
    pub(super) recorded_larger: Vec<f64>,
    pub(super) scheme: Scheme,
    pub(super) work: Work,
}

impl<'m> Plant<'m> {
    /// A rigid robot from base parameters chi (friction and offsets included, payload regrouped in it).
    ///
    /// # Errors
    /// Wrong length, a number that is not finite, a negative friction coefficient.
    pub fn new(model: &'m dyn Model, chi: &[f64]) -> Result<Self, SimulationError> {
        Self::with_torques(model, chi, Vec::new())
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
        for (k, joint) in elastic.iter().enumerate() {
            check_elastic(joint, &inertia)?;
            if elastic[..k].iter().any(|other| other.joint == joint.joint) {
                let number = robot.joint_number(JointIndex(joint.joint));
                let (what, found) = ("each elastic joint", number.0 as f64);
                return Err(SimulationError::Setting { what, expected: "another joint", found });
            }
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
            (&*p.name, standard, value)
        });
        let every_joint = effects.iter().any(|e| e.has_dry_friction());
        let friction = DriveFriction::new(robot, kept, &motor, every_joint)?;
        let work = Work::new(n, freedom, &friction.elements);
        let rotor = rotor.unwrap_or_default();
        let joint_of = robot.joint_of_frame();
        let mut inertia = vec![0.0; n];
        for (parameter, value) in robot.base.iter().zip(&chi) {
            let standard = &robot.standard[parameter.standard];
            if let (ParameterKind::Ia, Some(j)) = (standard.kind, joint_of[standard.frame]) {
                inertia[j] = *value;
            }
        }
        let rotor_in_chi = rotor_matrix(robot, &inertia);
        Ok(Self {
            model,
            chi,
            joints: n,
            freedom,
            friction,
            elastic,
            motor,
            rotor,
            rotor_in_chi,
            effects,
            beyond_encoder: vec![0.0; n],
            recorded_larger: vec![1.0; n],
            scheme: Scheme::default(),
            work,
        })
    }

    /// With encoders whose zeros are off: each joint is so much beyond where its encoder sees it, rad or m.
    ///
    /// # Errors
    /// Another number of joints, a number that is not finite.
    pub fn with_encoders_off(mut self, beyond: &[f64]) -> Result<Self, SimulationError> {
        let (expected, found) = (self.joints, beyond.len());
        if expected != found {
            return Err(SimulationError::Length { what: "encoder zeros", expected, found });
        }
        if let Some(&found) = beyond.iter().find(|x| !x.is_finite()) {
            return Err(SimulationError::Setting { what: "encoder zero", expected: "finite", found });
        }
        self.beyond_encoder = beyond.to_vec();
        Ok(self)
    }

    /// With drives whose torque constants are off: what each is told to do, and records, is so many times its real torque.
    ///
    /// # Errors
    /// Another number of joints, a factor that is not positive.
    pub fn with_drives_off(mut self, larger: &[f64]) -> Result<Self, SimulationError> {
        let (expected, found) = (self.joints, larger.len());
        if expected != found {
            return Err(SimulationError::Length { what: "torque constants", expected, found });
        }
        if let Some(&found) = larger.iter().find(|x| !(x.is_finite() && **x > 0.0)) {
            let what = "torque constant in multiples of the real one";
            return Err(SimulationError::Setting { what, expected: "positive", found });
        }
        self.recorded_larger = larger.to_vec();
        Ok(self)
    }

    /// The real torques, N.m or N, of drives that record these.
    pub fn real_torques(&self, recorded: &[f64], real: &mut [f64]) {
        for ((real, recorded), larger) in real.iter_mut().zip(recorded).zip(&self.recorded_larger) {
            *real = recorded / larger;
        }
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

    /// What the encoder of joint j sees in `state`, in units of the joint.
    #[inline]
    pub fn encoder(&self, state: &State, j: usize) -> f64 {
        self.motor_position(state, j) - self.beyond_encoder[j]
    }

    /// The robot where its encoders see it at positions `q` (n), with joint velocities `dq` (n).
    pub fn state_seen_at(&self, q: &[f64], dq: &[f64]) -> State {
        let there: Vec<f64> = q.iter().zip(&self.beyond_encoder).map(|(q, beyond)| q + beyond).collect();
        self.state(&there, dq)
    }

    /// Motor-side position of joint j in `state`, in units of the joint.
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
}
