//! A simulated robot with everything that is in it: the one place that puts effects into a plant.

use super::SimulationError;
use super::coupled_friction::CoupledFriction;
use super::effect::EffectTorque;
use super::elastic::ElasticJoint;
use super::extra::ExtraTorque;
use super::free::FreeTorque;
use super::less_friction::LessFriction;
use super::plant::Plant;
use super::push::Push;
use super::uncovered::UncoveredTorque;
use super::user::UserTorque;
use crate::effects::{
    ContactForce, Corrected, EffectKind, EffectTerm, Form, FreeLaw, JointLaw, Place, Sensitivity, numbers_at,
};
use crate::model::{Model, ParameterKind, RecursiveModel, RecursiveModelError, Robot};

/// What is known of the robot's numbers.
#[derive(Debug, Clone, PartialEq)]
enum Parameters {
    /// Base parameters chi, as an identification gives them.
    Base(Vec<f64>),
    /// Standard parameters chi_st.
    Standard(Vec<f64>),
}

/// A robot and what is in it.
///
/// ```
/// use dynid_runtime::effects::{EffectKind, EffectTerm, Place, TermScale};
/// use dynid_runtime::model::Model;
/// use dynid_runtime::simulation::World;
///
/// fn with_stribeck(model: &dyn Model, chi: &[f64]) -> Result<(), Box<dyn std::error::Error>> {
///     let mut world = World::from_base(model, chi);
///     world.put(&EffectTerm {
///         effect: EffectKind::Stribeck,
///         place: Place::Joint(0),
///         joints: vec![1],
///         shape: vec![0.1],
///         amplitude: vec![2.0],
///         sigma: vec![0.0],
///         scale: Some(TermScale::UNIT),
///         wrenches: Vec::new(),
///     });
///     assert!(world.left_out().is_empty());
///     let plant = world.plant("motion 1")?;
///     Ok(())
/// }
/// ```
pub struct World<'m> {
    nominal: &'m dyn Model,
    /// The robot with another table or another gravity.
    table: Option<RecursiveModel>,
    /// How far each joint is from where its encoder sees it, rad or m.
    beyond_encoder: Vec<f64>,
    /// So many times its real torque is what each drive records.
    recorded_larger: Vec<f64>,
    /// What an error of the table uncovers: amplitudes of columns beyond its numbers.
    uncovered: Vec<(&'static dyn Sensitivity, Vec<f64>)>,
    parameters: Parameters,
    /// Laws of a joint: the joint that each is a torque of, and the one whose state it is made from.
    laws: Vec<(&'static dyn JointLaw, [usize; 2], EffectTerm)>,
    /// Laws over any variables, with their joints.
    free: Vec<(usize, EffectTerm)>,
    /// Laws that a user wrote down.
    of_user: Vec<EffectTerm>,
    /// Elastic joints; the inertia of the rotor where base parameters do not tell it apart.
    elastic: Vec<(ElasticJoint, Option<f64>)>,
    coupled: Vec<CoupledFriction>,
    pushes: Vec<ContactForce>,
    less_friction: bool,
    left_out: Vec<EffectKind>,
    left_out_ids: Vec<&'static str>,
}

impl<'m> World<'m> {
    /// A robot from base parameters.
    pub fn from_base(model: &'m dyn Model, chi: &[f64]) -> Self {
        Self::new(model, Parameters::Base(chi.to_vec()))
    }

    /// A robot from standard parameters.
    pub fn from_standard(model: &'m dyn Model, standard: &[f64]) -> Self {
        Self::new(model, Parameters::Standard(standard.to_vec()))
    }

    fn new(nominal: &'m dyn Model, parameters: Parameters) -> Self {
        Self {
            nominal,
            table: None,
            beyond_encoder: vec![0.0; nominal.robot().joints()],
            recorded_larger: vec![1.0; nominal.robot().joints()],
            uncovered: Vec::new(),
            parameters,
            laws: Vec::new(),
            free: Vec::new(),
            of_user: Vec::new(),
            elastic: Vec::new(),
            coupled: Vec::new(),
            pushes: Vec::new(),
            less_friction: false,
            left_out: Vec::new(),
            left_out_ids: Vec::new(),
        }
    }

    /// Takes friction parameters below zero as they are. Beside a law that was found they are part of a friction that
    /// is positive all the same; by themselves no plant takes them.
    #[must_use]
    pub fn with_friction_as_identified(mut self) -> Self {
        self.less_friction = true;
        self
    }

    /// Puts effects in; see [`World::put`].
    #[must_use]
    pub fn with(mut self, terms: &[EffectTerm]) -> Self {
        terms.iter().for_each(|term| self.put(term));
        self
    }

    /// Puts an effect in. Bodies become part of the parameters, laws of a joint torques; transmissions become elastic
    /// joints, errors of the table another table, encoders see joints elsewhere, and drives record other torques than they
    /// give. What a plant does not have (skews and rates of a recording, the inertia of a coupled rotor, contacts, which
    /// belong to the recording they were seen in, laws of a user over accelerations) or what does not fit the robot is left
    /// out and named.
    pub fn put(&mut self, term: &EffectTerm) {
        let n = self.nominal.robot().joints();
        let is_in = match term.effect.form() {
            Form::Joint(law) if term.place == Place::Robot => {
                let known = law.may_be_common() && term.scale.is_some();
                self.laws.extend((0..n).filter(|_| known).map(|j| (law, [j, j], term.clone())));
                known
            }
            Form::Joint(_) if term.effect == EffectKind::TorqueConstantError => self.put_factor(term),
            Form::Joint(law) => self.put_law(law, term.place.joint().map(|j| [j, j]), term),
            Form::Heard(law) => self.put_law(law, term.place.hears(), term),
            Form::Body(_) => term.place.link().is_some_and(|frame| self.put_body(frame, &term.amplitude)),
            Form::Compliance(_) => match term.transmission() {
                Some((joint, t)) if joint < n && t.rotor > 0.0 => {
                    let joint =
                        ElasticJoint { joint, stiffness: t.stiffness, damping: t.damping, play: t.play };
                    self.elastic.push((joint, Some(t.rotor)));
                    true
                }
                _ => false,
            },
            Form::Coupled => match (term.place.pair(), term.shape.as_slice(), term.amplitude.as_slice()) {
                (Some(joints), &[ratio], &[viscous, coulomb, 0.0]) if joints.iter().all(|j| *j < n) => {
                    self.coupled.push(CoupledFriction { joints, ratio, viscous, coulomb });
                    true
                }
                _ => false,
            },
            Form::Free => match term.place.joint().filter(|j| *j < n) {
                Some(j) if FreeLaw::from_shape(&term.shape, n).is_some() => {
                    self.free.push((j, term.clone()));
                    true
                }
                _ => false,
            },
            Form::User => {
                let sound = UserTorque::new(self.nominal.robot(), term).is_some();
                self.of_user.extend(sound.then(|| term.clone()));
                sound
            }
            Form::Sensitivity(law) => self.put_error(law, term),
            Form::Window => false,
        };
        if !is_in {
            self.left_out.push(term.effect);
            self.left_out_ids.push(term.id());
        }
    }

    /// Adds a law of a joint: of these two, the first has the torque, and the second the state that it is made from.
    fn put_law(&mut self, law: &'static dyn JointLaw, joints: Option<[usize; 2]>, term: &EffectTerm) -> bool {
        let n = self.nominal.robot().joints();
        let joints = joints.filter(|both| both.iter().all(|j| *j < n) && term.scale.is_some());
        self.laws.extend(joints.map(|joints| (law, joints, term.clone())));
        joints.is_some()
    }

    /// Puts a wrong torque constant in: the drive is told, and records, another torque than it gives.
    fn put_factor(&mut self, term: &EffectTerm) -> bool {
        let factor = 1.0 + term.amplitude.iter().sum::<f64>();
        let own = term.place.joint().and_then(|j| self.recorded_larger.get_mut(j));
        own.filter(|_| factor > 0.0 && factor.is_finite()).map(|own| *own *= factor).is_some()
    }

    /// Puts an error of the robot's own numbers in.
    fn put_error(&mut self, law: &'static dyn Sensitivity, term: &EffectTerm) -> bool {
        let robot = self.model().robot();
        let Some(Corrected { robot: changed, beyond_encoder }) = term.corrected(robot) else { return false };
        let same_table = changed.gravity == robot.gravity && changed.frames == robot.frames;
        let changed = if same_table {
            Ok(())
        } else if let Parameters::Base(_) = self.parameters {
            // What was fitted beside the error are parameters of the regrouped table.
            RecursiveModel::new(changed).map(|table| self.table = Some(table))
        } else {
            self.change_table(|robot| (robot.gravity, robot.frames) = (changed.gravity, changed.frames))
        };
        let numbers = term.place.variant().map_or(0, |v| numbers_at(law, self.nominal.robot(), v).len());
        if changed.is_ok() {
            self.beyond_encoder.iter_mut().zip(beyond_encoder).for_each(|(all, more)| *all += more);
            let more = term.amplitude.get(numbers..).unwrap_or_default();
            self.uncovered.extend((!more.is_empty()).then(|| (law, more.to_vec())));
        }
        changed.is_ok()
    }

    /// Adds a joint's spring; its rotor is the one of the parameters.
    pub fn put_spring(&mut self, joint: ElasticJoint) {
        self.elastic.push((joint, None));
    }

    /// Adds a push from outside in the motion that it names: `force` is the largest, in the middle of the window.
    /// Without a force, the largest torques of its joints act.
    pub fn put_push(&mut self, force: ContactForce) {
        self.pushes.push(force);
    }

    /// Changes the table or gravity. Parameters keep their meaning where the world was made from standard ones; the
    /// regrouping of the table as it was does not hold for another one, so that every standard parameter stands by
    /// itself in the changed robot.
    ///
    /// # Errors
    /// A table that no model can be made from.
    pub fn change_table(&mut self, change: impl FnOnce(&mut Robot)) -> Result<(), RecursiveModelError> {
        let mut changed = self.model().robot().clone();
        change(&mut changed);
        let every = Robot::with_standard_as_base(
            &changed.name,
            changed.gravity,
            changed.frames.to_vec(),
            changed.drive.clone(),
            changed.limits.clone(),
        );
        changed.base = every.base;
        changed.standard = every.standard;
        self.table = Some(RecursiveModel::new(changed)?);
        Ok(())
    }

    /// Changes viscous and Coulomb friction of a joint by a factor, where the world was made from standard parameters.
    pub fn scale_friction(&mut self, joint: usize, factor: f64) {
        let robot = self.nominal.robot();
        let Parameters::Standard(standard) = &mut self.parameters else { return };
        for kind in [ParameterKind::Fv, ParameterKind::Fc] {
            if let Some(k) = standard_of_joint(robot, kind, joint) {
                standard[k] *= factor;
            }
        }
    }

    /// The model that moves.
    pub fn model(&self) -> &dyn Model {
        self.table.as_ref().map_or(self.nominal, |table| table as &dyn Model)
    }

    /// Its base parameters, bodies that were put on it included.
    pub fn chi(&self) -> Vec<f64> {
        match &self.parameters {
            Parameters::Base(chi) => chi.clone(),
            Parameters::Standard(standard) => self.model().robot().base_from_standard(standard),
        }
    }

    /// Whether a joint has a spring between motor and link.
    pub fn has_elastic_joints(&self) -> bool {
        !self.elastic.is_empty()
    }

    /// Effects that the plant does not have.
    pub fn left_out(&self) -> &[EffectKind] {
        &self.left_out
    }

    /// Their names in the JSON: those of a user's laws are the user's.
    pub fn left_out_ids(&self) -> &[&'static str] {
        &self.left_out_ids
    }

    /// The robot for a motion: pushes act in the motion that they name.
    ///
    /// # Errors
    /// As [`Plant::new`] and [`Plant::with_effects`].
    pub fn plant(&self, motion: &str) -> Result<Plant<'_>, SimulationError> {
        let model = self.model();
        let robot = model.robot();
        let mut chi = self.chi();
        let mut torques = self.torques(&chi, motion);
        if self.less_friction {
            torques.push(Box::new(LessFriction::taken_from(robot, &mut chi)));
        }
        let joints: Vec<ElasticJoint> = self.elastic.iter().map(|(joint, _)| *joint).collect();
        let plant = match &self.parameters {
            _ if joints.is_empty() => Plant::with_torques(model, &chi, torques),
            Parameters::Standard(standard) => Plant::with_effects(model, standard, &joints, torques),
            Parameters::Base(_) => {
                Plant::with_effects(model, &self.with_rotors_apart(robot, &chi), &joints, torques)
            }
        };
        plant?.with_encoders_off(&self.beyond_encoder)?.with_drives_off(&self.recorded_larger)
    }

    /// Torques of what is in the robot, in a motion.
    pub(super) fn torques(&self, chi: &[f64], motion: &str) -> Vec<Box<dyn ExtraTorque + '_>> {
        let robot = self.model().robot();
        let mut torques: Vec<Box<dyn ExtraTorque + '_>> = Vec::new();
        for (law, joints, term) in &self.laws {
            if let Some(torque) = EffectTorque::new(robot, chi, *law, *joints, term) {
                torques.push(Box::new(torque));
            }
        }
        for (joint, term) in &self.free {
            if let Some(torque) = FreeTorque::new(robot, chi, *joint, term) {
                torques.push(Box::new(torque));
            }
        }
        for torque in self.of_user.iter().filter_map(|term| UserTorque::new(robot, term)) {
            torques.push(Box::new(torque));
        }
        for coupled in &self.coupled {
            torques.push(Box::new(*coupled));
        }
        for (law, amplitude) in &self.uncovered {
            torques.push(Box::new(UncoveredTorque { law: *law, robot: self.nominal.robot(), amplitude }));
        }
        for force in self.pushes.iter().filter(|p| p.motion == motion) {
            if let Some(push) = Push::new(robot, force) {
                torques.push(Box::new(push));
            }
        }
        torques
    }

    /// Adds the ten inertial parameters of a body on a frame.
    fn put_body(&mut self, frame: usize, inertial: &[f64]) -> bool {
        let robot = self.nominal.robot();
        let body = robot.standard_of_body(frame, inertial);
        let (parameters, more) = match &mut self.parameters {
            Parameters::Base(chi) => (chi, robot.base_from_standard(&body)),
            Parameters::Standard(standard) => (standard, body),
        };
        parameters.iter_mut().zip(more).for_each(|(x, more)| *x += more);
        frame < robot.frames.len()
    }

    /// Standard parameters that have these base parameters, with the rotors of the elastic joints apart.
    fn with_rotors_apart(&self, robot: &Robot, chi: &[f64]) -> Vec<f64> {
        let mut standard = vec![0.0; robot.standard.len()];
        for (joint, rotor) in &self.elastic {
            if let (Some(k), Some(rotor)) = (standard_of_joint(robot, ParameterKind::Ia, joint.joint), rotor)
            {
                standard[k] = *rotor;
            }
        }
        let apart = robot.base_from_standard(&standard);
        for ((base, value), apart) in robot.base.iter().zip(chi).zip(apart) {
            // A rotor that is a base parameter of its own is known from the motion.
            standard[base.standard] += value - apart;
        }
        standard
    }
}

/// A joint's own parameter in chi_st.
fn standard_of_joint(robot: &Robot, kind: ParameterKind, joint: usize) -> Option<usize> {
    let joint_of = robot.joint_of_frame();
    robot.standard.iter().position(|p| p.kind == kind && joint_of[p.frame] == Some(joint))
}
