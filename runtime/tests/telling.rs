//! Motions that tell laws of a joint apart: each of two laws is simulated on the motion that was made for them, and
//! diagnosed.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, EffectTerm};
use dynid_runtime::model::Model;
use dynid_runtime::simulation::excitation::{ExcitingMotion, TellPlan, TellSettings, tell};

fn plan(robot: &SimulatedRobot, effects: [EffectKind; 2], joint: usize) -> TellPlan {
    let chi = robot.model.robot().base_from_standard(&robot.standard);
    let settings = TellSettings { effects: effects.to_vec(), joint, share: 0.8, reach: 1.0, seed: 3 };
    tell(&robot.model, Some(&chi), &settings).unwrap()
}

/// What a diagnosis says of one motion of the robot with this law.
fn told(robot: &SimulatedRobot, motion: &ExcitingMotion, law: &EffectTerm, seed: u64) -> Option<Diagnosis> {
    let law = law.clone();
    let hidden = Hidden::in_robot(move |world| world.put(&law));
    let recording = robot.record(std::slice::from_ref(motion), &hidden, seed);
    let mut settings = Settings::default();
    settings.threads = 2;
    diagnose(&robot.model, &recording, &[], &settings, &Silent).ok()
}

/// What a diagnosis says is there: these laws are smaller than the noise, so that it may call them small.
fn there(diagnosis: &Option<Diagnosis>) -> Vec<&str> {
    let findings = diagnosis.iter().flat_map(|d| &d.findings).map(|f| f.effect.as_str());
    findings.chain(diagnosis.iter().flat_map(|d| &d.small).map(|s| s.effect.as_str())).collect()
}

/// Simulates each of two laws, as small as an ordinary motion puts them `apart` times the noise apart at most, on the
/// motion that was made for them, where it must be told and nothing else, and on the ordinary one, where not both are.
fn assert_told(effects: [EffectKind; 2], joint: usize, apart: f64) {
    let robot = common::planar();
    let plan = plan(&robot, effects, joint);
    let best = &plan.candidates[0];
    assert!(best.distances.least() > 2.0 * plan.ordinary.distances.least());
    let mut on_ordinary = 0;
    for (a, law) in plan.laws.iter().enumerate() {
        let usual = plan.ordinary.distances.apart[a].iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let scale = (apart / usual).min(1.0);
        let amplitude = law.amplitude.iter().map(|x| x * scale).collect();
        let law = EffectTerm { amplitude, ..law.clone() };
        let id = law.effect.id();
        assert_eq!(there(&told(&robot, &best.motion, &law, 1)), [id], "on {}", best.what);
        on_ordinary += usize::from(there(&told(&robot, &plan.ordinary.motion, &law, 1)) == [id]);
    }
    assert!(on_ordinary < plan.laws.len(), "an ordinary motion tells {effects:?} as well");
}

#[test]
fn friction_that_falls_from_rest_is_told_from_friction_that_builds_up() {
    assert_told([EffectKind::Stribeck, EffectKind::PreslidingHysteresis], 0, 5.0);
}

#[test]
fn a_bent_torque_is_told_from_a_spring() {
    assert_told([EffectKind::PositionDependentTorque, EffectKind::Spring], 0, 8.0);
}

#[test]
fn a_law_that_contains_another_is_no_rival_of_it() {
    let plan = plan(&common::planar(), [EffectKind::PositionDependentTorque, EffectKind::Spring], 1);
    for told in plan.candidates.iter().chain([&plan.ordinary]) {
        assert!(told.distances.apart[1][0].is_none() && told.distances.apart[0][1].is_some());
    }
}
