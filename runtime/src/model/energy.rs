//! The energy of a robot with known parameters. Equation numbers are those of Gautier and Briot.

use super::dynamics::Model;
use super::states::States;
use dynid_description::ParameterKind;

/// Energy of base parameters `chi` at every sample, J: h chi of (10) and the potential off q of every offset.
///
/// Its rate is the power dh chi without friction, and its difference between two states the work of all torques but friction.
/// h chi by itself lacks what a prismatic joint lifts where that was regrouped into the joint's offset (`off3R` of `scara4`).
/// The zero of the potential is that of the base parameters: a link's height where nothing else shows it is not in them.
///
/// `chi` has one value per base parameter, in the model's order; `states.ddq` is not read.
///
/// # Panics
/// Where `chi` or the signals do not have the model's shape: a bug of the caller.
pub fn energies(model: &dyn Model, chi: &[f64], states: States<'_>) -> Vec<f64> {
    let samples = states.samples();
    let mut rows = vec![0.0; chi.len() * samples];
    model.energy_block(states, samples, &mut rows);
    let robot = model.robot();
    let joints = robot.joint_of_frame();
    let mut energy = vec![0.0; samples];
    for (k, (base, &value)) in robot.base.iter().zip(chi).enumerate() {
        let parameter = &robot.standard[base.standard];
        let column = match (parameter.kind, joints[parameter.frame]) {
            (ParameterKind::Off, Some(joint)) => &states.q[joint][..samples],
            _ => &rows[k * samples..][..samples],
        };
        energy.iter_mut().zip(column).for_each(|(sum, x)| *sum += value * x);
    }
    energy
}

/// [`energies`] at one state, J.
///
/// # Panics
/// Where `chi` or the state do not have the model's shape: a bug of the caller.
pub fn energy_at(model: &dyn Model, chi: &[f64], q: &[f64], dq: &[f64]) -> f64 {
    let [q, dq] = [q, dq].map(|state| state.iter().map(std::slice::from_ref).collect::<Vec<_>>());
    energies(model, chi, States { q: &q, dq: &dq, ddq: &dq }).iter().sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::model::{
        BaseParameter, Drive, Frame, JointKind, Limits, RecursiveModel, Robot, StandardParameter,
    };

    /// A vertical slide whose rotor cannot be told from its mass and offset: M1R = M1 + Ia1, off1R = off1 - 9.81 Ia1.
    fn slide() -> RecursiveModel {
        let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
        let frames = vec![Frame::on_base(JointKind::Prismatic)];
        let mut robot =
            Robot::with_standard_as_base("slide", [0.0, 0.0, -9.81], frames, drive, Limits::default());
        let at = |name: &str| robot.standard.iter().position(|p: &StandardParameter| p.name == name);
        let (mass, rotor, offset) = (at("M1").unwrap(), at("Ia1").unwrap(), at("off1").unwrap());
        let base = |standard: usize, combination: Vec<(usize, f64)>| BaseParameter {
            combination: combination.into(),
            ..robot.base[standard].clone()
        };
        robot.base = vec![
            base(mass, vec![(mass, 1.0), (rotor, 1.0)]),
            base(offset, vec![(offset, 1.0), (rotor, -9.81)]),
        ]
        .into();
        RecursiveModel::new(robot).unwrap()
    }

    #[test]
    fn a_slide_stores_the_weight_that_is_in_its_offset() {
        let model = slide();
        let mut standard = vec![0.0; model.robot().standard.len()];
        // 3 kg on the slide, and a rotor that is as slow to turn as 2 kg but weighs nothing on it.
        standard[model.robot().base[0].standard] = 3.0;
        standard[model.robot().standard.iter().position(|p| p.name == "Ia1").unwrap()] = 2.0;
        let chi = model.robot().base_from_standard(&standard);
        let lifted = energy_at(&model, &chi, &[0.4], &[1.5]) - energy_at(&model, &chi, &[0.0], &[0.0]);
        let expected = 0.5 * (3.0 + 2.0) * 1.5 * 1.5 + 3.0 * 9.81 * 0.4;
        assert!((lifted - expected).abs() < 1e-12, "{lifted} {expected}");
    }
}
