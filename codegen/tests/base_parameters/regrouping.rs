//! How parameters are regrouped, on small tables: the closed forms, gravity, equal lengths, rotors, friction of motors.

use crate::{names, relation, table_of};
use dynid_codegen::base::base_set;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

/// The closed form for a revolute joint (Gautier and Khalil 1990, Khalil and Dombre 2002): YY, MZ and M of link j go
/// into link j and, through alpha, d and r, into link j - 1.
#[test]
fn a_revolute_link_regroups_by_the_closed_form_rule() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0.3, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0.8, d: 0.1, theta: q2, r: 0.7}\n  \
                - {j: 3, sigma: 0, alpha: a3, d: d3, theta: q3, r: r3}\n";
    let set = base_set(&table_of(rows, "constants: {a3: 0.4, d3: 0.2, r3: 0.5}"));
    let rule = [
        ("XX2R", "XX2 - YY2 + sin(a3)^2*YY3 + 2*r3*sin(a3)^2*MZ3 + (r3^2*sin(a3)^2 - d3^2)*M3"),
        ("XY2R", "XY2 + d3*sin(a3)*MZ3 + d3*r3*sin(a3)*M3"),
        ("XZ2R", "XZ2 - d3*cos(a3)*MZ3 - d3*r3*cos(a3)*M3"),
        ("YZ2R", "YZ2 + cos(a3)*sin(a3)*YY3 + 2*r3*cos(a3)*sin(a3)*MZ3 + r3^2*cos(a3)*sin(a3)*M3"),
        ("ZZ2R", "ZZ2 + sin(a3)^2*YY3 + 2*r3*sin(a3)^2*MZ3 + (r3^2*sin(a3)^2 + d3^2)*M3"),
        ("MX2R", "MX2 + d3*M3"),
        ("MY2R", "MY2 - sin(a3)*MZ3 - r3*sin(a3)*M3"),
        ("XX3R", "XX3 - YY3"),
    ];
    for (name, expected) in rule {
        assert_eq!(relation(&set, name), expected);
    }
}

#[test]
fn a_prismatic_link_leaves_its_inertias_to_its_parent() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0.3, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0.8, d: 0.1, theta: q2, r: 0.7}\n  \
                - {j: 3, sigma: 1, alpha: pi/2, d: 0.2, theta: 0, r: q3}\n";
    let set = base_set(&table_of(rows, ""));
    assert_eq!(relation(&set, "XX2R"), "XX2 - YY2 + XX3 - ZZ3");
    assert_eq!(relation(&set, "ZZ2R"), "ZZ2 + YY3");
    assert_eq!(relation(&set, "XY2R"), "XY2 - XZ3");
    for name in ["MX3", "MY3", "MZ3", "M3", "Ia3"] {
        assert_eq!(relation(&set, name), name);
    }
}

#[test]
fn gravity_along_an_axis_hides_what_gravity_across_it_shows() {
    let row = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n";
    assert_eq!(names(&base_set(&table_of(row, "gravity: [0, 0, -9.81]"))), ["ZZ1R", "Fv1", "Fc1", "off1"]);
    assert_eq!(
        names(&base_set(&table_of(row, "gravity: [0, -9.81, 0]"))),
        ["ZZ1R", "MX1", "MY1", "Fv1", "Fc1", "off1"]
    );
    let tilted = names(&base_set(&table_of(row, "gravity: [0, 0.001, -9.81]"))).len();
    assert_eq!(tilted, 6);
}

#[test]
fn lengths_and_angles_that_only_rounding_keeps_apart_are_the_same() {
    // 0.1 + 0.2 and 0.3 differ in floating point; 0.3 - 0.2 - 0.1 rad does too.
    let rows = |d: &str, alpha: &str| {
        format!(
            "  - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  \
             - {{j: 2, sigma: 2, alpha: 0.2, d: {d}, theta: 0, r: 0}}\n  \
             - {{j: 3, sigma: 2, alpha: 0.1, d: 0, theta: 0, r: 0}}\n  \
             - {{j: 4, sigma: 0, alpha: {alpha}, d: -0.3, theta: q4, r: 0}}\n"
        )
    };
    let count = |d: &str, alpha: &str| base_set(&table_of(&rows(d, alpha), "")).base.len();
    // Two joints about one vertical axis: ZZ1, ZZ4, Ia4 less one, and friction.
    assert_eq!(count("0.1 + 0.2", "-0.3"), count("0.3", "-0.3"));
    assert!(count("0.1 + 0.2", "-0.3") < count("0.31", "-0.3"));
    assert!(count("0.3", "-0.3") < count("0.3", "-0.31"));
}

#[test]
fn friction_of_a_motor_that_turns_with_its_own_joint_is_that_joints_friction() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}\n";
    let set = base_set(&table_of(rows, "drive: {gear: [10, 10], coupled_friction: [2]}"));
    assert_eq!((relation(&set, "Fv2R"), relation(&set, "Fc2R")), ("Fv2 + Fvm2", "Fc2 + Fcm2"));
    let set = base_set(&table_of(rows, "drive: {gear: [[10, 0], [5, 10]], coupled_friction: [2]}"));
    assert_eq!(
        (relation(&set, "Fv2"), relation(&set, "Fvm2"), relation(&set, "Fcm2")),
        ("Fv2", "Fvm2", "Fcm2")
    );
    // Of a differential's two motors the viscous frictions add up to those of the joints.
    let set = base_set(&table_of(rows, "drive: {gear: [[10, 10], [10, -10]], coupled_friction: [1, 2]}"));
    assert_eq!((relation(&set, "Fv1R"), relation(&set, "Fvm1R")), ("Fv1 + 2*Fvm2", "Fvm1 - Fvm2"));
}

/// Khalil and Dombre 2002: the first prismatic joint has the mass that it moves, and its rotor goes into that.
#[test]
fn a_gantry_keeps_the_mass_of_its_first_axis_and_the_rotors_of_the_others() {
    let rows = "  - {j: 1, sigma: 1, alpha: pi/2, d: 0, theta: 0, r: q1}\n  \
                - {j: 2, sigma: 1, alpha: pi/2, d: 0, theta: pi/2, r: q2}\n  \
                - {j: 3, sigma: 1, alpha: pi/2, d: 0, theta: pi/2, r: q3}\n";
    let set = base_set(&table_of(rows, ""));
    let moved: Vec<&str> = set.base.iter().map(|b| b.relation.as_ref()).filter(|r| r.contains('M')).collect();
    assert_eq!(
        moved,
        ["M1 + Ia1 + M2 + M3", "Ia2 + M2 + M3", "off2 - 9.81*(M2 + M3)", "Ia3 + M3"],
        "the second axis is vertical"
    );
}

#[test]
fn calibrated_tables_with_general_angles_everywhere_are_no_harder() {
    let mut random = Pcg64::seed_from_u64(5);
    let mut rows = String::new();
    for j in 1..=8 {
        let mut draw = |middle: f64, spread: f64| middle + random.random_range(-spread..spread);
        let (alpha, d, theta, r) = (draw(PI / 2.0, 1e-3), draw(0.2, 0.1), draw(0.0, 1e-3), draw(0.1, 0.1));
        let (theta, r, sigma) = if j == 5 {
            (format!("{theta}"), format!("{r}"), 2)
        } else {
            (format!("q{j} + {theta}"), format!("{r}"), 0)
        };
        rows.push_str(&format!(
            "  - {{j: {j}, sigma: {sigma}, alpha: {alpha}, d: {d}, theta: {theta}, r: {r}}}\n"
        ));
    }
    let robot = table_of(&rows, "");
    let start = std::time::Instant::now();
    let count = base_set(&robot).base.len();
    assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    // Seven links: gravity is along no axis, so the first keeps ZZ, MX, MY, the others seven each; Ia2 .. Ia7; friction.
    assert_eq!(count, 3 + 6 * 7 + 6 + 3 * 7);
}
