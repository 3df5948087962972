//! The base parameters of shipped robots: their number, names and relations.

use crate::shipped::{robots, workspace};
use crate::{names, relation, robot};
use dynid_codegen::base::base_set;
use dynid_description::{BaseParameter, ParameterKind};
use std::io::Write as _;

#[test]
fn inertial_counts_are_those_of_the_independent_reference() {
    let path = workspace().join("../shared/reference/regressors.json");
    let Ok(text) = std::fs::read(&path) else {
        let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
        return;
    };
    let reference: serde_json::Value = serde_json::from_slice(&text).unwrap();
    for robot in robots().iter().filter(|robot| reference.get(&robot.name).is_some()) {
        let (name, set) = (&robot.name, base_set(robot));
        // The reference has no rotors: one that the mass of its link was regrouped into stands for that mass.
        let kind = |k: usize| set.standard[k].kind;
        let inertial = |p: &&BaseParameter| {
            let has_mass = p.combination.iter().any(|&(k, _)| kind(k) <= ParameterKind::M);
            kind(p.standard) <= ParameterKind::M || kind(p.standard) == ParameterKind::Ia && has_mass
        };
        let expected = reference[name]["inertial_base_count"].as_u64().unwrap() as usize;
        assert_eq!(set.base.iter().filter(inertial).count(), expected, "{name}");
    }
}

#[test]
fn the_tx40_has_the_sixty_base_parameters_of_table_ii() {
    let mut with_payload = robot("tx40");
    let set = base_set(&with_payload);
    assert_eq!(set.base.len(), 60);
    with_payload.frames.pop();
    let without_payload = base_set(&with_payload);
    let expected = "ZZ1R Fv1 Fc1 off1 XX2R XY2 XZ2R YZ2 ZZ2R MX2R MY2 Fv2 Fc2 off2 XX3R XY3 XZ3 YZ3 ZZ3R MX3 MY3R Ia3 \
                    Fv3 Fc3 off3 XX4R XY4 XZ4 YZ4 ZZ4R MX4 MY4R Ia4 Fv4 Fc4 off4 XX5R XY5 XZ5 YZ5 ZZ5R MX5 MY5R Ia5 Fv5 \
                    Fc5 off5 XX6R XY6 XZ6 YZ6 ZZ6 MX6 MY6 Ia6 Fv6 Fc6 off6 Fvm6 Fcm6";
    assert_eq!(names(&without_payload).join(" "), expected);
    // The payload stands on link 6, so that it is regrouped into all of that link.
    let payload = ["XY6R", "XZ6R", "YZ6R", "ZZ6R", "MX6R", "MY6R"];
    let expected = expected.split(' ').map(str::to_owned).collect::<Vec<_>>();
    for (name, own) in names(&set).into_iter().zip(expected) {
        assert!(name == own || payload.contains(&name) && name == format!("{own}R"), "{name} {own}");
    }
    assert_eq!(
        relation(&without_payload, "ZZ1R"),
        "ZZ1 + Ia1 + YY2 + YY3 + 2*rl3*MZ3 + (rl3^2 + d3^2)*(M3 + M4 + M5 + M6)"
    );
    assert_eq!(relation(&without_payload, "ZZ2R"), "ZZ2 + Ia2 + d3^2*(M3 + M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "MX2R"), "MX2 + d3*(M3 + M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "XZ2R"), "XZ2 - d3*MZ3 - d3*rl3*(M3 + M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "MY3R"), "MY3 - MZ4 - rl4*(M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "XX6R"), "XX6 - YY6");
    let held =
        |k: usize| without_payload.base.iter().any(|b| b.combination.iter().any(|&(column, _)| column == k));
    let without: Vec<&str> = (0..without_payload.standard.len())
        .filter(|&k| !held(k))
        .map(|k| without_payload.standard[k].name.as_ref())
        .collect();
    assert_eq!(without.join(" "), "XX1 XY1 XZ1 YY1 YZ1 MX1 MY1 MZ1 M1 MZ2 M2");
}

#[test]
fn on_a_vertical_axis_a_rotor_cannot_be_told_from_mass_and_offset() {
    let set = base_set(&robot("scara4"));
    assert_eq!(relation(&set, "Ia3R"), "Ia3 + M3 + M4");
    assert_eq!(relation(&set, "off3R"), "off3 + 9.81*(M3 + M4)");
    assert_eq!(relation(&set, "ZZ1R"), "ZZ1 + Ia1 + d2^2*(M2 + M3 + M4)");
    assert_eq!(relation(&set, "MX2R"), "MX2 + MX3 + d3*(M3 + M4)");
}

#[test]
fn the_same_table_gives_the_same_base_every_time() {
    for (robot, again) in robots().iter().zip(&robots()) {
        assert_eq!(base_set(robot), base_set(again));
    }
}
