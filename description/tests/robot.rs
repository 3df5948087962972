//! Joints are counted the same way from both sides, and nothing is lost in JSON.
#![allow(clippy::unwrap_used)]

use JointKind::{Fixed, Prismatic, Revolute};
use dynid_description::{
    CouplingLaw, Drive, Frame, JointIndex, JointKind, JointNumber, Limits, Nominal, ParameterKind, Robot,
};

/// A serial robot with these joints; numbers without a short decimal form.
fn robot(kinds: &[JointKind]) -> Robot {
    let frames = kinds
        .iter()
        .enumerate()
        .map(|(k, &kind)| {
            let x = 1.0 / (3.0 + k as f64);
            let parent = k.checked_sub(1);
            Frame { parent, kind, gamma: 0.0, b: -0.0, alpha: x.sin(), d: x, theta: -x.cos(), r: x.exp() }
        })
        .collect();
    let n = kinds.iter().filter(|&&kind| kind != Fixed).count();
    let gear = (0..n * n).map(|k| if k % (n + 1) == 0 { 100.0 / 3.0 } else { 0.0 }).collect();
    let drive = Drive { gear, coupled_friction: vec![n - 1].into() };
    let limits = Limits { position: vec![[-0.1, 0.1 + 0.2]; n].into(), ..Limits::default() };
    Robot::with_standard_as_base("test", [0.0, 0.0, -9.81], frames, drive, limits)
}

#[test]
fn numbers_and_indices_agree_where_a_fixed_frame_stands_in_mid_chain() {
    let robot = robot(&[Revolute, Fixed, Prismatic, Fixed, Fixed, Revolute, Fixed]);
    assert_eq!(robot.joints(), 3);
    let numbers: Vec<_> = (0..3).map(|j| robot.joint_number(JointIndex(j)).0).collect();
    assert_eq!(numbers, [1, 3, 6]);
    assert_eq!(robot.joint_kinds(), [Revolute, Prismatic, Revolute]);
    for number in 0..9 {
        let index = robot.joint_index(JointNumber(number));
        assert_eq!(index.is_some(), numbers.contains(&number), "{number}");
        if let Some(index) = index {
            assert_eq!(robot.joint_number(index), JointNumber(number));
        }
    }
    let of_frame = robot.joint_of_frame();
    assert_eq!(of_frame, [Some(0), None, Some(1), None, None, Some(2), None]);
}

#[test]
fn an_index_past_the_last_joint_has_a_number_that_no_joint_has() {
    let robot = robot(&[Revolute, Fixed, Revolute, Fixed]);
    for past in [2, 3, 100, usize::MAX] {
        let number = robot.joint_number(JointIndex(past));
        assert!(number.0 > robot.frames.len(), "{past} gives {number}");
        assert_eq!(robot.joint_index(number), None);
    }
}

#[test]
fn parameters_are_named_after_the_number_of_their_frame() {
    let robot = robot(&[Revolute, Fixed, Prismatic]);
    let names: Vec<&str> = robot.standard.iter().map(|p| p.name.as_ref()).collect();
    assert!(names.contains(&"Ia3") && names.contains(&"off1") && names.contains(&"M2"));
    assert!(!names.contains(&"Ia2"), "a fixed frame has no rotor");
    // The coupled motor is motor 1 of 2, whose joint is frame 3.
    let coupled: Vec<&str> =
        robot.standard.iter().filter(|p| p.kind >= ParameterKind::Fvm).map(|p| p.name.as_ref()).collect();
    assert_eq!(coupled, ["Fvm3", "Fcm3"]);
    let friction = robot.base.iter().find(|p| p.name == "Fv3").unwrap();
    assert_eq!(friction.unit, "N.s/m");
}

#[test]
fn a_robot_comes_back_from_json_bit_for_bit() {
    let mut robot = robot(&[Revolute, Fixed, Prismatic]);
    let standard = (0..robot.standard.len()).map(|k| (k as f64 + 0.1).sqrt()).collect();
    let gains = || vec![1e-300, f64::MIN_POSITIVE].into();
    robot.nominal = Some(Nominal {
        standard,
        kp: gains(),
        kd: gains(),
        ki: gains(),
        position_noise: vec![1.0 / 3.0e6, 5e-324].into(),
        torque_noise: vec![].into(),
    });
    let text = serde_json::to_string(&robot).unwrap();
    let back: Robot = serde_json::from_str(&text).unwrap();
    assert_eq!(back, robot);
    // Equal is not the same bits for zeros, and a parser may be off in the last digit.
    assert_eq!(format!("{back:?}"), format!("{robot:?}"));
    assert!(back.frames[0].b.is_sign_negative());
}

#[test]
fn json_says_kinds_as_the_table_does() {
    let text = serde_json::to_string(&[Revolute, Prismatic, Fixed]).unwrap();
    assert_eq!(text, r#"["revolute","prismatic","fixed"]"#);
    let of_couplings = [CouplingLaw::Friction, CouplingLaw::Spring].map(CouplingLaw::parameters).concat();
    let kinds = ParameterKind::INERTIAL.into_iter().chain(ParameterKind::JOINT).chain(ParameterKind::MOTOR);
    for kind in kinds.chain(of_couplings) {
        assert_eq!(serde_json::to_string(&kind).unwrap(), format!("\"{}\"", kind.symbol()));
    }
    assert_eq!(serde_json::to_string(&JointNumber(4)).unwrap(), "4");
}
