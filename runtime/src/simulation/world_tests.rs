//! Effects in a simulated robot.

use super::World;
use super::extra::Instant;
use super::testing::{arm, pendulum};
use crate::effects::{EffectKind, EffectTerm, Place, TermScale};
use crate::model::Model;

fn term(effect: EffectKind, place: Place, shape: &[f64], amplitude: &[f64]) -> EffectTerm {
    let scale = TermScale::UNIT;
    EffectTerm {
        effect,
        place,
        joints: vec![1],
        shape: shape.to_vec(),
        amplitude: amplitude.to_vec(),
        sigma: vec![0.0; amplitude.len()],
        scale: Some(scale),
        wrenches: Vec::new(),
    }
}

#[test]
fn stribeck_friction_raises_the_level_of_both_directions_and_fades_with_speed() {
    let (model, chi) = pendulum(0.0, 1.0, 1.0, 0.0);
    let terms = [term(EffectKind::Stribeck, Place::Joint(0), &[0.1], &[2.0])];
    let world = World::from_base(&model, &chi).with(&terms);
    let torques = world.torques(&chi, "");
    let level = |dq: f64| {
        let at = Instant {
            time: 0.0,
            q: &[0.3],
            dq: &[dq],
            ddq: &[0.0],
            load: &[0.0],
            link: &[0.0],
            gravity: &[0.0],
            effects: &[0.0],
        };
        let mut levels = [[0.0; 2]];
        torques[0].dry_friction(&at, &mut levels);
        levels[0]
    };
    assert_eq!(level(0.0), [2.0, 2.0]);
    assert!((level(0.1)[1] - 2.0 * (-1.0_f64).exp()).abs() < 1e-15);
    assert!(torques[0].has_dry_friction());
}

#[test]
fn friction_that_bends_upwards_or_takes_off_does_not_hold_a_joint_at_rest() {
    let (model, chi) = pendulum(0.0, 1.0, 1.0, 0.0);
    let both = |power: f64, f: f64| {
        let terms = [term(EffectKind::NonlinearViscous, Place::Joint(0), &[power], &[f])];
        let world = World::from_base(&model, &chi).with(&terms);
        let torques = world.torques(&chi, "");
        let at = Instant {
            time: 0.0,
            q: &[0.3],
            dq: &[-0.5],
            ddq: &[0.0],
            load: &[0.0],
            link: &[0.0],
            gravity: &[0.0],
            effects: &[0.0],
        };
        let (mut torque, mut levels) = ([0.0], [[0.0; 2]]);
        torques[0].torque(&at, &mut torque);
        torques[0].dry_friction(&at, &mut levels);
        (torque[0], levels[0])
    };
    assert_eq!(both(2.0, 3.0), (-0.75, [0.0; 2]));
    assert_eq!(both(2.0, -3.0), (0.75, [0.0; 2]));
    let (torque, levels) = both(0.5, 3.0);
    assert_eq!(torque, 0.0);
    assert!((levels[0] - 3.0 * 0.5_f64.sqrt()).abs() < 1e-15 && levels[0] == levels[1]);
}

#[test]
fn a_body_on_a_link_becomes_part_of_chi() {
    let (model, chi) = pendulum(0.0, 1.0, 0.0, 0.0);
    let mut inertial = [0.0; 10];
    inertial[5] = 0.25;
    let terms = [term(EffectKind::Payload, Place::Link(0), &[], &inertial)];
    let world = World::from_base(&model, &chi).with(&terms);
    let robot = model.robot();
    let zz = robot.base.iter().position(|b| b.name.starts_with("ZZ1")).expect("ZZ1 is a base parameter");
    assert!((world.chi()[zz] - chi[zz] - 0.25).abs() < 1e-15);
}

#[test]
fn a_joint_that_hears_another_has_a_part_of_its_torque() {
    let (model, chi) = arm();
    let n = model.robot().joints();
    let terms = [term(EffectKind::TorqueCrosstalk, Place::Hears(0, 1), &[], &[0.1])];
    let world = World::from_base(&model, &chi).with(&terms);
    let torques = world.torques(&chi, "");
    let (still, mut load) = (vec![0.0; n], vec![0.0; n]);
    let mut torque = |of_second: f64| {
        load[1] = of_second;
        let at = Instant {
            time: 0.0,
            q: &still,
            dq: &still,
            ddq: &still,
            load: &load,
            link: &load,
            gravity: &still,
            effects: &still,
        };
        let mut out = vec![0.0; n];
        torques[0].torque(&at, &mut out);
        out
    };
    let difference: Vec<f64> = torque(20.0).iter().zip(torque(0.0)).map(|(a, b)| a - b).collect();
    assert!((difference[0] - 2.0).abs() < 1e-12);
    assert!(difference[1..].iter().all(|x| *x == 0.0));
}

#[test]
fn a_law_of_all_joints_is_in_each_of_them() {
    let (model, chi) = arm();
    let common = [term(EffectKind::TorqueConstantDrift, Place::Robot, &[3.0, 9.0], &[0.1])];
    let world = World::from_base(&model, &chi).with(&common);
    assert_eq!(world.torques(&chi, "").len(), model.robot().joints());
    let alone = [term(EffectKind::Stribeck, Place::Robot, &[0.1], &[2.0])];
    assert_eq!(World::from_base(&model, &chi).with(&alone).left_out(), [EffectKind::Stribeck]);
}

#[test]
fn what_a_rigid_plant_does_not_have_is_named() {
    let (model, chi) = pendulum(0.0, 1.0, 0.0, 0.0);
    let terms = [term(EffectKind::TimeDelay, Place::Robot, &[], &[0.001])];
    assert_eq!(World::from_base(&model, &chi).with(&terms).left_out(), [EffectKind::TimeDelay]);
}
