//! Numbers that no robot has, and numbers that are probably not meant.

use super::{arm, arm_with_row, mistakes, one_mistake, read, without_file};
use dynid_codegen::robot::parse_with_warnings;

/// The warnings of a text without mistakes, as `line:column: message`.
fn warnings(text: &str) -> Vec<String> {
    let (_, warnings) =
        parse_with_warnings("arm.yaml", text.as_bytes()).unwrap_or_else(|m| panic!("{}", m[0]));
    without_file(&warnings)
}

/// Row j of a table of revolute joints.
fn row(j: usize) -> String {
    format!("  - {{j: {j}, sigma: 0, alpha: 0, d: 0.1, theta: q{j}, r: 0}}\n")
}

#[test]
fn an_angle_that_is_a_rounded_multiple_of_45_degrees_gets_a_warning_at_its_place() {
    for (row, place, meant) in [
        ("j: 2, sigma: 0, alpha: 1.5708, d: 0.5, theta: q2, r: 0", "5:29", "pi/2"),
        ("j: 2, sigma: 0, alpha: -1.57, d: 0.5, theta: q2, r: 0", "5:29", "pi/2"),
        ("j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2 - 3.1416, r: 0", "5:47", "write pi "),
        ("j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2 + 2.35619, r: 0", "5:47", "3*pi/4"),
        ("j: 2, sigma: 0, gamma: 0.785, b: 0, alpha: 0, d: 0.5, theta: q2, r: 0", "5:29", "pi/4"),
        ("j: 2, sigma: 0, alpha: 90*3.14159/180, d: 0.5, theta: q2, r: 0", "5:29", "pi/2"),
        ("j: 2, sigma: 2, alpha: 0, d: 0.5, theta: 6.2832, r: 0", "5:47", "2*pi"),
    ] {
        let found = warnings(&arm_with_row(row));
        assert_eq!(found.len(), 1, "{row}: {found:?}");
        assert!(found[0].starts_with(&format!("{place}: ")) && found[0].contains(meant), "{found:?}");
    }
}

#[test]
fn exact_and_general_angles_and_lengths_get_no_warning() {
    for row in [
        "j: 2, sigma: 0, alpha: -pi/2, d: 1.5708, theta: q2 + 3*pi/4, r: 0.785",
        "j: 2, sigma: 0, alpha: 1.5712, d: 0.5, theta: q2 - 0.3, r: 0",
        "j: 2, sigma: 0, alpha: 0.79, d: 0.5, theta: q2 + 0.5, r: 0",
        "j: 2, sigma: 0, alpha: 0.00005, d: 0.5, theta: q2 + pi - 2*pi, r: 0",
        "j: 2, sigma: 0, alpha: 1.5707963267948966, d: 0.5, theta: q2, r: 0",
    ] {
        assert_eq!(warnings(&arm_with_row(row)), Vec::<String>::new(), "{row}");
    }
}

#[test]
fn sizes_that_no_robot_has_are_mistakes() {
    for (row, place, words) in [
        ("j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: -1e308", "5:54", ["r is -1e308 m", "10000 m"]),
        ("j: 2, sigma: 0, alpha: 0, d: 1e200, theta: q2, r: 0", "5:35", ["d is 1e200 m", "10000 m"]),
        ("j: 2, sigma: 0, alpha: 1e5, d: 0, theta: q2, r: 0", "5:29", ["alpha is 1e5 rad", "10000 rad"]),
    ] {
        one_mistake(&arm_with_row(row), place, &words);
    }
    for (rest, place, words) in [
        ("gravity: [0, 0, -1e300]", "5:10", ["gravity is -1e300", "at most 1e4"]),
        ("drive: {gear: [50, 1e300]}", "5:15", ["a ratio of gear", "at most 1e6"]),
        ("drive: {gear: [50, 1e-300]}", "5:15", ["a ratio of gear", "at least"]),
        ("limits: {velocity: 1e-300}", "5:20", ["limit of velocity is 1e-300", "at least"]),
        ("limits: {velocity: [3, 1e300]}", "5:24", ["limit of velocity is 1e300", "at most 1e9"]),
        ("limits: {position: [1, [0.5, 0.5000000000001]]}", "5:24", ["width", "at least"]),
        ("nominal: {parameters: {ZZ1: 1e200}}", "5:29", ["ZZ1 is 1e200", "at most 1e9"]),
        ("nominal: {noise: {torque: 1e200}}", "5:27", ["1e200", "at most 1e9"]),
    ] {
        one_mistake(&arm(rest), place, &words);
    }
}

#[test]
fn sizes_that_are_probably_not_meant_get_a_warning() {
    for (row, place, words) in [
        ("j: 2, sigma: 0, alpha: 90, d: 0.5, theta: q2, r: 0", "5:29", "90 rad, more than a turn"),
        ("j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2 - 45, r: 0", "5:47", "Write -45*pi/180"),
        ("j: 2, sigma: 0, alpha: 1e-9, d: 0.5, theta: q2, r: 0", "5:29", "alpha is 1e-9 rad"),
        ("j: 2, sigma: 0, alpha: 0, d: -1e-300, theta: q2, r: 0", "5:35", "d is -1e-300 m"),
    ] {
        let found = warnings(&arm_with_row(row));
        assert!(found.iter().any(|w| w.starts_with(&format!("{place}: ")) && w.contains(words)), "{found:?}");
    }
}

#[test]
fn a_table_is_no_longer_than_what_computes_with_it_and_the_first_row_too_many_is_pointed_at() {
    let table = |rows: usize| format!("name: arm\nframes:\n{}", (1..=rows).map(row).collect::<String>());
    assert_eq!(read(&table(16)).frames.len(), 16);
    one_mistake(&table(17), "19:5", &["17 rows", "at most 16"]);
}

#[test]
fn a_gear_matrix_couples_no_more_joints_than_can_be_computed() {
    let table = |n: usize, coupled: usize| {
        let entry = |m: usize, k: usize| {
            if m == k {
                "9"
            } else if m < coupled && k < coupled {
                "1"
            } else {
                "0"
            }
        };
        let line = |m: usize| format!("[{}]", (0..n).map(|k| entry(m, k)).collect::<Vec<_>>().join(", "));
        let gear = (0..n).map(line).collect::<Vec<_>>().join(", ");
        format!("name: arm\nframes:\n{}drive: {{gear: [{gear}]}}\n", (1..=n).map(row).collect::<String>())
    };
    assert_eq!(read(&table(10, 8)).drive.gear[0][7], 1.0);
    one_mistake(&table(10, 9), "13:15", &["couples 9 joints", "at most 8"]);
}

#[test]
fn a_number_that_is_not_finite_is_refused_wherever_it_stands() {
    for number in [".nan", ".inf", "-.inf", "1e999", "nan", "1e308*10"] {
        one_mistake(&arm(&format!("gravity: [0, {number}, 0]")), &place_of(number), &["finite"]);
        let row = format!("j: 2, sigma: 0, alpha: 0, d: {number}, theta: q2, r: 0");
        assert!(mistakes(arm_with_row(&row))[0].contains("finite"), "{number}");
        assert!(mistakes(arm(&format!("constants: {{a: {number}}}")))[0].contains("finite"), "{number}");
        assert!(mistakes(arm(&format!("nominal: {{parameters: {{M1: {number}}}}}")))[0].contains("finite"));
    }
}

/// Column of the part of the number that is wrong, in `gravity: [0, NUMBER`.
fn place_of(number: &str) -> String {
    if number == "-.inf" { "5:15".to_owned() } else { "5:14".to_owned() }
}
