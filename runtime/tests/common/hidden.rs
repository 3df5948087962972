//! What a recording hides.

use dynid_runtime::effects::{EffectKind, EffectTerm, Place, TermScale};
use dynid_runtime::model::{Model, RecursiveModel, Robot};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::ElasticJoint;

use super::SimulatedRobot;

/// Physics that is in the robot or in its recording, but not in the standard model. Empty: nothing is hidden.
#[derive(Default, Clone)]
pub struct Hidden {
    /// Laws of joints.
    pub laws: Vec<EffectTerm>,
    /// Compliant joints.
    pub elastic: Vec<ElasticJoint>,
    /// Standard parameters by name, and how much is added to them.
    pub added: Vec<(&'static str, f64)>,
    /// Angles by which gravity is turned about x and y of frame 0, rad; gravity is along z.
    pub tilt: Option<[f64; 2]>,
    /// What the recording says wrongly.
    pub distortion: Option<fn(&mut Trajectory)>,
}

impl Hidden {
    /// A law of a joint (0-based) with its shape and amplitudes in SI, as its effect defines them.
    pub fn law(effect: EffectKind, joint: usize, shape: &[f64], amplitude: &[f64]) -> Self {
        let term = EffectTerm {
            effect,
            place: Place::Joint(joint),
            joints: vec![joint + 1],
            shape: shape.to_vec(),
            amplitude: amplitude.to_vec(),
            sigma: vec![0.0; amplitude.len()],
            scale: Some(TermScale::UNIT),
            wrenches: Vec::new(),
        };
        Self { laws: vec![term], ..Self::default() }
    }

    /// Standard parameters of the robot with what is added to them.
    pub fn standard(&self, robot: &SimulatedRobot) -> Vec<f64> {
        let mut standard = robot.standard.clone();
        for &(name, more) in &self.added {
            standard[robot.parameter(name)] += more;
        }
        standard
    }

    /// The robot under a turned gravity. Its every standard parameter is a base parameter: what was regrouped counts
    /// on gravity along z.
    pub fn tilted(&self, robot: &SimulatedRobot) -> Option<RecursiveModel> {
        let [about_x, about_y] = self.tilt?;
        let plain = robot.model.robot();
        let [_, _, g] = plain.gravity;
        // Turned about y, then about x.
        let gravity =
            [g * about_y.sin(), -g * about_y.cos() * about_x.sin(), g * about_y.cos() * about_x.cos()];
        let mut tilted = Robot::with_standard_as_base(
            &plain.name,
            gravity,
            plain.frames.to_vec(),
            plain.drive.clone(),
            plain.limits.clone(),
        );
        tilted.nominal = plain.nominal.clone();
        Some(RecursiveModel::new(tilted).expect("the table is right"))
    }
}
