//! Laws that look at the torque of a drive: it holds the other laws of that drive.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot, planar, term};
use dynid_runtime::diagnosis::{Settings, Silent, diagnose, term_torques};
use dynid_runtime::effects::{EffectKind, EffectTerm, Place};
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::Motion;

/// A spring on the second joint, 5 N.m/rad, at rest at 0.2 rad.
fn spring() -> EffectTerm {
    term(EffectKind::Spring, Place::Joint(1), &[], &[5.0, -1.0])
}

/// The first joint hears a tenth of the second.
fn heard() -> EffectTerm {
    term(EffectKind::TorqueCrosstalk, Place::Hears(0, 1), &[], &[0.1])
}

/// The torques of laws on the joints of the planar arm at one instant.
fn torques(robot: &SimulatedRobot, terms: &[EffectTerm]) -> [f64; 2] {
    let chi = robot.model.robot().base_from_standard(&robot.standard);
    let at = |x: [f64; 2]| x.map(|x| vec![x; 4]).to_vec();
    let motion = Motion {
        name: String::new(),
        rate: 100.0,
        start: 0.0,
        q: at([0.3, 0.8]),
        dq: at([0.5, -0.4]),
        ddq: at([0.0, 0.0]),
        torque: at([0.0, 0.0]),
        edge_samples: 0,
        fixed: Vec::new(),
    };
    let torques = term_torques(&robot.model, &chi, terms, &motion).unwrap();
    [torques[0][1], torques[1][1]]
}

#[test]
fn a_channel_hears_the_laws_of_the_other_joint_wherever_they_stand_in_the_model() {
    let robot = planar();
    let (alone, of_spring) = (torques(&robot, &[heard()]), torques(&robot, &[spring()]));
    assert!(of_spring[0] == 0.0 && of_spring[1].abs() > 1.0);
    for both in [torques(&robot, &[heard(), spring()]), torques(&robot, &[spring(), heard()])] {
        assert!((both[0] - alone[0] - 0.1 * of_spring[1]).abs() < 1e-12, "{both:?}");
        assert_eq!(both[1], of_spring[1]);
    }
}

#[test]
fn a_factor_on_a_torque_is_one_on_all_laws_of_the_joint() {
    let robot = planar();
    let factor = term(EffectKind::TorqueConstantError, Place::Joint(1), &[], &[0.2]);
    let [_, alone] = torques(&robot, std::slice::from_ref(&factor));
    let [_, of_spring] = torques(&robot, &[spring()]);
    let [_, both] = torques(&robot, &[factor, spring()]);
    assert!((both - alone - 1.2 * of_spring).abs() < 1e-12);
}

#[test]
fn what_is_heard_does_not_hear_itself() {
    let robot = planar();
    let back = term(EffectKind::TorqueCrosstalk, Place::Hears(1, 0), &[], &[0.1]);
    let (one, other) = (torques(&robot, &[heard()]), torques(&robot, std::slice::from_ref(&back)));
    assert_eq!(torques(&robot, &[heard(), back]), [one[0] + other[0], one[1] + other[1]]);
}

#[test]
fn friction_of_the_joint_that_is_heard_is_named_beside_the_crosstalk() {
    let robot = planar();
    let friction = term(EffectKind::Stribeck, Place::Joint(1), &[0.3], &[4.0]);
    let hidden = Hidden {
        put: Box::new(move |world| world.put(&friction)),
        distort: |motion: &mut Trajectory| {
            let heard = motion.torque[1].clone();
            motion.torque[0].iter_mut().zip(heard).for_each(|(own, heard)| *own += 0.2 * heard);
        },
    };
    let recorded = robot.record(&robot.motions(3, 6.0, 21), &hidden, 22);
    let diagnosis = diagnose(&robot.model, &recorded, &[], &Settings::default(), &Silent).unwrap();
    let mut found: Vec<_> =
        diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.clone())).collect();
    found.sort();
    assert_eq!(found, [("stribeck", vec![2]), ("torque_crosstalk", vec![1])]);
    let heard = &diagnosis.findings.iter().find(|f| f.effect == "torque_crosstalk").unwrap().parameters["k"];
    assert!((heard.value - 0.2).abs() < 3.0 * heard.sigma + 1e-3, "{heard:?}");
}
