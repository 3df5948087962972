#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use super::*;
use crate::diagnosis::Errors;
use crate::effects::{EffectKind, EffectTerm, Place, TermScale};
use crate::model::{Coupling, CouplingLaw, Drive, Frame, JointKind, Limits, Robot};
use serde_json::{Value, json};

/// Revolute, fixed, prismatic.
fn robot() -> Robot {
    let row = |parent, kind, d| Frame { parent, kind, gamma: 0.0, b: 0.0, alpha: 0.3, d, theta: 0.1, r: 0.2 };
    let frames = vec![
        row(None, JointKind::Revolute, 0.0),
        row(Some(0), JointKind::Fixed, 0.5),
        row(Some(1), JointKind::Prismatic, 0.25),
    ];
    let drive = Drive { gear: vec![50.0, 0.0, 0.0, 80.0].into(), coupled_friction: vec![1].into() };
    Robot::with_standard_as_base("crane", [0.0, 0.0, -9.81], frames, drive, Limits::default())
}

fn term(effect: EffectKind, place: Place, shape: &[f64], amplitude: &[f64]) -> EffectTerm {
    EffectTerm {
        effect,
        place,
        joints: vec![1],
        shape: shape.to_vec(),
        amplitude: amplitude.to_vec(),
        sigma: vec![0.1; amplitude.len()],
        scale: Some(TermScale::UNIT),
        wrenches: Vec::new(),
    }
}

fn model() -> Identified {
    let robot = robot();
    let named = |name: &str| NamedParameter {
        name: name.to_owned(),
        value: 1.5,
        sigma: Some(0.1),
        relative_sigma_percent: None,
        sigma_white: None,
        correction: None,
        doubt: None,
        sigma_blocks: None,
        unit: String::new(),
    };
    let rows = EvaluatedRows {
        samples: 100,
        rows_left_out: None,
        equations: Vec::new(),
        band: 25.0,
        errors: Errors { relative_error: Some(0.1), per_joint: vec![Some(0.1), None] },
        noise: None,
    };
    let parameters = robot.base.iter().map(|b| named(&b.name)).collect();
    Identified {
        delay: 1e-3,
        standstill: Some(vec![0.1; 2]),
        effects: vec![
            term(EffectKind::Stribeck, Place::Joint(0), &[0.1], &[2.0]),
            term(EffectKind::FrictionDrift, Place::Joint(0), &[2.0, 4.0], &[1.0, 1.0]),
            term(EffectKind::PositionOffset, Place::Variant(0), &[], &[0.01]),
            term(EffectKind::JointElasticity, Place::Joint(0), &[8.0, 0.1, 0.2, 0.0], &[1e4, 2.0, 0.1, 0.0]),
            term(EffectKind::CoupledTransmission, Place::Pair(0, 1), &[0.5], &[1.0, 1.0, 1.0]),
            term(EffectKind::Payload, Place::Link(2), &[], &[0.0; 10]),
            term(EffectKind::TorqueCrosstalk, Place::Hears(1, 0), &[], &[0.1]),
            term(EffectKind::TorqueConstantDrift, Place::Robot, &[3.0, 9.0], &[0.1]),
            // Two waves are one law.
            term(EffectKind::TorqueRipple, Place::Joint(1), &[404.0, 202.0], &[0.1, 0.2, 0.3, 0.4]),
        ],
        ..Identified::with_parameters(&robot, "crane", "diagnosis", rows, parameters)
    }
}

fn text_of(model: &Identified) -> String {
    serde_json::to_string(model).unwrap()
}

#[test]
fn what_is_written_is_read_again() {
    let model = model();
    assert_eq!(read(&text_of(&model)).unwrap(), model);
    assert_eq!(model.table.as_ref().unwrap(), &robot());
    assert_eq!(model.condition_number, None);
}

#[test]
fn frames_that_move_with_joints_that_are_not_there_are_not_believed() {
    let mut good: Value = serde_json::to_value(model()).unwrap();
    let frame =
        |frame: usize, kind: &str, terms: Value| json!([{"frame": frame, "kind": kind, "terms": terms}]);
    for (dependent, expected) in [
        (frame(9, "revolute", json!([[0, 1.0]])), "table.dependent[0].frame"),
        (frame(1, "fixed", json!([[0, 1.0]])), "table.dependent[0].kind"),
        (frame(0, "prismatic", json!([[0, 1.0]])), "table.dependent[0].kind"),
        (frame(1, "revolute", json!([[2, 1.0]])), "table.dependent[0].terms"),
        (frame(1, "revolute", json!([[0, 0.5]])), "table.dependent[0].terms"),
        (frame(1, "prismatic", json!([[1, 1.0], [0, 1.0]])), "table.dependent[0].terms"),
        (frame(1, "prismatic", json!([])), "table.dependent[0].terms"),
        (frame(1, "prismatic", json!([[1, 0.5]])), "fingerprint"),
    ] {
        good["table"]["dependent"] = dependent.clone();
        let error = read(&good.to_string()).expect_err(expected).to_string();
        assert!(error.contains(expected), "{dependent}: {error}");
    }
    good["table"]["dependent"] = json!([]);
    good["table"]["known"] = json!([999]);
    let error = read(&good.to_string()).expect_err("no such parameter").to_string();
    assert!(error.contains("table.known[0]"), "{error}");
}

/// Every mutation ends in an error that names its field.
#[test]
fn no_field_that_cannot_be_is_believed() {
    let good: Value = serde_json::to_value(model()).unwrap();
    let mutations: [(&str, Value, &str); 38] = [
        ("/effects/0/shape", json!([]), "effects[0].shape"),
        ("/effects/0/shape", json!([0.0]), "effects[0].shape"),
        ("/effects/0/shape", json!([0.1, 1.0, 0.2]), "effects[0].shape"),
        ("/effects/0/place", json!({"joint": 9}), "effects[0].place.joint"),
        ("/effects/0/place", json!("robot"), "effects[0].place"),
        ("/effects/0/joints", json!([2]), "effects[0].joints[0]"),
        ("/effects/0/amplitude", json!([]), "effects[0].amplitude"),
        ("/effects/0/scale/speed", json!(0.0), "effects[0].scale.speed"),
        ("/effects/0/sigma", json!([]), "written"),
        ("/effects/1/amplitude", json!([1.0]), "effects[1].amplitude"),
        ("/effects/2/place", json!({"variant": 9}), "effects[2].place.variant"),
        ("/effects/3/shape", json!([1.0]), "effects[3].shape"),
        ("/effects/3/amplitude", json!([-1.0, 0.0, 0.0, 0.0]), "effects[3].amplitude"),
        ("/effects/4/place", json!({"pair": [1, 1]}), "effects[4].place.pair"),
        ("/effects/4/shape", json!([]), "effects[4].shape"),
        ("/effects/5/place", json!({"link": 3}), "effects[5].place.link"),
        ("/effects/6/place", json!({"hears": [1, 1]}), "effects[6].place.hears"),
        ("/effects/6/place", json!({"joint": 0}), "effects[6].place"),
        ("/effects/7/shape", json!([0.0, 9.0]), "effects[7].shape"),
        ("/effects/8/shape", json!([404.0]), "effects[8].amplitude"),
        ("/effects/8/shape", json!([]), "effects[8].shape"),
        ("/effects/0/effect", json!("gremlins"), "gremlins"),
        ("/band", json!(0.0), "band"),
        ("/band", json!("wide"), "wide"),
        ("/standstill", json!([0.1]), "standstill"),
        ("/standstill", json!([0.1, -0.1]), "standstill[1]"),
        ("/delay", json!(null), "not a saved model"),
        ("/per_joint", json!([0.1]), "per_joint"),
        ("/schema_version", json!(99), "schema_version"),
        ("/fingerprint", json!("0"), "fingerprint"),
        ("/table/gravity", json!([0.0, 0.0, -1.62]), "fingerprint"),
        ("/table/frames/1/parent", json!(7), "table"),
        ("/table/drive/gear", json!([50.0]), "table"),
        ("/table/drive/coupled_friction", json!([5]), "table.drive.coupled_friction[0]"),
        ("/table/base/0/standard", json!(500), "table.base[0].standard"),
        ("/table/frames", json!([]), "table"),
        ("/base_parameters/0/name", json!("nobody"), "base_parameters"),
        ("/base_parameters/1/sigma", json!(-1.0), "base_parameters[1].sigma"),
    ];
    for (path, value, expected) in mutations {
        let mut bad = good.clone();
        *bad.pointer_mut(path).unwrap_or_else(|| panic!("{path}")) = value.clone();
        let outcome = read(&bad.to_string());
        if expected == "written" {
            // Not knowing how well an amplitude is known is no mistake.
            assert!(outcome.is_ok(), "{path} = {value}");
            continue;
        }
        let error = outcome.expect_err(path).to_string();
        assert!(error.contains(expected), "{path} = {value}: {error}");
    }
}

#[test]
fn a_text_that_is_no_model_is_refused_with_its_line_and_column() {
    assert_eq!(read("robot: arm").unwrap_err().place, "1:1");
    let error = read("{\n  \"robot\": 7\n}").unwrap_err();
    assert!(error.place.starts_with("2:") && error.what.contains("not a saved model"), "{error}");
    let without_table = {
        let mut value: Value = serde_json::to_value(model()).unwrap();
        value.as_object_mut().unwrap().remove("table");
        value.to_string()
    };
    assert_eq!(read(&without_table).unwrap_err().place, "table");
}

#[test]
fn a_file_from_before_there_were_schemas_is_read_without_its_invented_zeros() {
    let mut value: Value = serde_json::to_value(model()).unwrap();
    let fields = value.as_object_mut().unwrap();
    for field in ["schema_version", "dynid_version", "table", "fingerprint", "delay"] {
        fields.remove(field);
    }
    fields.insert("condition_number".into(), json!(0.0));
    let old = read(&value.to_string()).unwrap();
    assert_eq!((old.schema_version, old.condition_number, old.delay), (0, None, 0.0));
    assert_eq!(old.table, None);
}

#[test]
fn the_fingerprint_is_the_same_everywhere_and_follows_what_torques_depend_on() {
    // Written down: a change of this value makes every saved model one of another robot.
    assert_eq!(fingerprint(&robot()), FINGERPRINT);
    let mut other = robot();
    other.name = "another".into();
    other.limits.torque = vec![[-1.0, 1.0]; 2].into();
    assert_eq!(fingerprint(&other), FINGERPRINT);
    assert_eq!(difference(&robot(), &other), None);
    other.frames.to_mut()[1].d = 0.6;
    assert_eq!(difference(&robot(), &other).unwrap(), "d of frame 2 was 0.5, now 0.6");
    let mut geared = robot();
    geared.drive.gear.to_mut()[0] = 51.0;
    assert_eq!(difference(&robot(), &geared).unwrap(), "its drive has changed");
}

const FINGERPRINT: &str = "5aeb02c20489fcb0";

#[test]
fn friction_between_links_and_springs_of_a_table_are_read_back_and_checked() {
    let coupling =
        |name: &'static str, law| Coupling { name: name.into(), terms: vec![(0, 1.0)].into(), law };
    let couplings = vec![
        Coupling { terms: vec![(0, 0.5), (1, -1.0)].into(), ..coupling("1_3", CouplingLaw::Friction) },
        coupling("1", CouplingLaw::Spring),
        coupling("_hose", CouplingLaw::SpringAt(0.2)),
    ];
    let mut robot = robot().with_couplings(couplings);
    robot.fixed = vec![(9, 2.5)].into();
    let rows = EvaluatedRows {
        samples: 100,
        rows_left_out: None,
        equations: Vec::new(),
        band: 25.0,
        errors: Errors { relative_error: None, per_joint: vec![None; 2] },
        noise: None,
    };
    let parameters = model().base_parameters;
    let mut all: Vec<NamedParameter> = robot
        .base
        .iter()
        .map(|b| NamedParameter { name: b.name.to_string(), ..parameters[0].clone() })
        .collect();
    all.iter_mut().for_each(|p| p.value = 1.0);
    let saved = Identified::with_parameters(&robot, "crane", "diagnosis", rows, all);
    let good: Value = serde_json::to_value(&saved).unwrap();
    let back = read(&good.to_string()).unwrap();
    assert_eq!(back.table.as_ref().unwrap().couplings, robot.couplings);
    assert_eq!(back.table.as_ref().unwrap().fixed, robot.fixed);
    let standard = robot.standard.len();
    for (path, value, expected) in [
        ("/table/couplings/0/terms".to_owned(), json!([[1, 1.0], [0, 1.0]]), "table.couplings[0].terms"),
        ("/table/couplings/0/terms".to_owned(), json!([[5, 1.0]]), "table.couplings[0].terms"),
        ("/table/couplings/1/terms".to_owned(), json!([]), "table.couplings[1].terms"),
        ("/table/couplings/0/name".to_owned(), json!("a}\n"), "table.couplings[0].name"),
        ("/table/couplings/2/law".to_owned(), json!({"spring_at": 1e300}), "table.couplings[2].law"),
        ("/table/couplings".to_owned(), json!([]), "coupling"),
        (format!("/table/standard/{}/coupling", standard - 1), json!(7), "coupling"),
        (format!("/table/standard/{}/kind", standard - 1), json!("Fc"), "coupling"),
        ("/table/fixed/0".to_owned(), json!([900, 1.0]), "table.fixed[0]"),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(&path).unwrap_or_else(|| panic!("{path}")) = value.clone();
        let error = read(&bad.to_string()).expect_err(&path).to_string();
        assert!(error.contains(expected), "{path} = {value}: {error}");
    }
}
