//! Every mistake in a robot's YAML is reported at its place, all of them at once.

use dynid_codegen::read_all;
use dynid_codegen::robot::{RobotTable, parse, parse_with_warnings};
use dynid_description::JointKind;
use proptest::prelude::*;

/// The mistakes of a text as `line:column: message`.
fn mistakes(text: impl AsRef<[u8]>) -> Vec<String> {
    match parse("arm.yaml", text.as_ref()) {
        Ok(robot) => panic!("no mistake found in {robot:?}"),
        Err(found) => found
            .iter()
            .map(|m| m.to_string().strip_prefix("arm.yaml:").expect("names the file").to_owned())
            .collect(),
    }
}

/// That the text has exactly one mistake, at this place, with these words in its message.
#[track_caller]
fn one_mistake(text: &str, place: &str, words: &[&str]) {
    let found = mistakes(text);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].starts_with(&format!("{place}: ")), "{found:#?}");
    for word in words {
        assert!(found[0].contains(word), "no '{word}' in {found:#?}");
    }
}

fn read(text: &str) -> RobotTable {
    parse("arm.yaml", text.as_bytes()).unwrap_or_else(|m| panic!("{}", m[0]))
}

/// A robot of two revolute joints with one line replaced or added.
fn arm(rest: &str) -> String {
    format!(
        "name: arm\nframes:\n  - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  \
         - {{j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}}\n{rest}\n"
    )
}

/// A robot whose second row is given.
fn arm_with_row(row: &str) -> String {
    format!(
        "name: arm\nconstants: {{d2: 0.5, zero: 0}}\nframes:\n  \
         - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  - {{{row}}}\n"
    )
}

#[test]
fn an_empty_file_says_what_a_robot_has() {
    one_mistake("", "1:1", &["empty", "name", "frames"]);
    one_mistake("# only a comment\n", "1:1", &["empty"]);
    one_mistake("---\n", "1:1", &["empty"]);
}

#[test]
fn bytes_that_are_not_utf_8_are_pointed_at() {
    let found = mistakes(b"name: arm\nframes: caf\xe9\n");
    assert_eq!(found.len(), 1);
    assert!(found[0].starts_with("2:12: ") && found[0].contains("UTF-8"), "{found:?}");
}

#[test]
fn yaml_that_is_not_yaml_is_pointed_at() {
    one_mistake("name: arm\nframes: [1, 2\n", "3:1", &["not YAML"]);
    one_mistake("name: arm\n\tframes: 1\n", "2:1", &["not YAML", "tab"]);
    one_mistake("a list\n", "1:1", &["expected a robot", "name"]);
    one_mistake("name: a\n---\nname: b\n", "2:1", &["second document"]);
    one_mistake("name: &x arm\nframes: *x\n", "2:9", &["alias"]);
    one_mistake("name: !!str arm\n", "1:7", &["tag"]);
}

#[test]
fn an_unknown_key_names_the_nearest_known_one() {
    one_mistake(
        &arm("gravitiy: [0, 0, -9.81]"),
        "5:1",
        &["unknown key 'gravitiy'", "did you mean 'gravity'"],
    );
    one_mistake(
        &arm_with_row("j: 2, sigma: 0, alfa: 0, alpha: 0, d: 0, theta: q2, r: 0"),
        "5:22",
        &["did you mean 'alpha'"],
    );
    one_mistake(&arm("drive: {gears: [1, 2]}"), "5:9", &["'gear'"]);
    one_mistake(&arm("nominal: {noise: {velocity: 1}}"), "5:19", &["velocity", "position"]);
    one_mistake(&arm("nominal: {parameters: {ZZ3: 1}}"), "5:24", &["ZZ3", "standard parameter"]);
}

/// The warnings of a text without mistakes, as `line:column: message`.
fn warnings(text: &str) -> Vec<String> {
    let (_, warnings) =
        parse_with_warnings("arm.yaml", text.as_bytes()).unwrap_or_else(|m| panic!("{}", m[0]));
    warnings
        .iter()
        .map(|d| d.to_string().strip_prefix("arm.yaml:").expect("names the file").to_owned())
        .collect()
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
    let row = |j: usize| format!("  - {{j: {j}, sigma: 0, alpha: 0, d: 0.1, theta: q{j}, r: 0}}\n");
    let table = |rows: usize| format!("name: arm\nframes:\n{}", (1..=rows).map(row).collect::<String>());
    assert_eq!(read(&table(16)).frames.len(), 16);
    one_mistake(&table(17), "19:5", &["17 rows", "at most 16"]);
}

#[test]
fn a_gear_matrix_couples_no_more_joints_than_can_be_computed() {
    let row = |j: usize| format!("  - {{j: {j}, sigma: 0, alpha: 0, d: 0.1, theta: q{j}, r: 0}}\n");
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
fn a_name_that_would_break_the_generated_module_is_refused_where_modules_are_made() {
    let named = |name: &str| arm("").replace("name: arm", &format!("name: {name}")).into_bytes();
    for name in ["Model", "Operations", "registry", "dynid_runtime", "Option", "std", "core", "f64", "UR10e"]
    {
        let found = read_all(&[("robots/x.yaml".to_owned(), named(name))]).expect_err(name);
        assert_eq!(found.len(), 1);
        let words = found[0].to_string();
        assert!(words.starts_with("robots/x.yaml:1:1: ") && words.contains(name), "{words}");
        // Read at run time, a name is no more than a label.
        assert_eq!(parse("x.yaml", &named(name)).expect("a robot").name, name);
    }
    assert!(read_all(&[("x.yaml".to_owned(), named("arm_2"))]).is_ok());
}

#[test]
fn a_duplicate_key_is_reported_where_it_stands_the_second_time() {
    one_mistake(&arm("name: again"), "5:1", &["'name'", "twice", "line 1"]);
    one_mistake(&arm("constants: {a: 1, a: 2}"), "5:19", &["'a'", "twice", "line 5"]);
    one_mistake(
        &arm_with_row("j: 2, sigma: 0, alpha: 0, d: 0, d: 1, theta: q2, r: 0"),
        "5:38",
        &["'d'", "twice"],
    );
    one_mistake(&arm("nominal: {parameters: {M1: 1, M1: 2}}"), "5:31", &["M1", "twice"]);
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

#[test]
fn sigma_is_0_1_or_2() {
    for sigma in ["3", "-1", "revolute", "0.0"] {
        let row = format!("j: 2, sigma: {sigma}, alpha: 0, d: 0, theta: q2, r: 0");
        one_mistake(&arm_with_row(&row), "5:19", &["sigma", "0 (revolute), 1 (prismatic) or 2 (fixed)"]);
    }
}

#[test]
fn the_joint_variable_stands_where_sigma_says() {
    let rows = [
        ("sigma: 0, alpha: 0, d: 0, theta: 0.3, r: 0", "theta of frame 2 does not match sigma 0"),
        ("sigma: 0, alpha: 0, d: 0, theta: q2 - q2, r: 0", "q2 cancels in theta of frame 2"),
        (
            "sigma: 0, alpha: 0, d: 0, theta: q2/2, r: 0",
            "q2 has the coefficient 0.5; an angle needs whole numbers",
        ),
        ("sigma: 0, alpha: 0, d: 0, theta: 17*q2, r: 0", "expected at most 16 in an angle"),
        ("sigma: 0, alpha: 0, d: 0, theta: q2*q1, r: 0", "needs a numerical solver"),
        ("sigma: 0, alpha: 0, d: 0, theta: 1/q2, r: 0", "may only be added, or multiplied by a number"),
        (
            "sigma: 0, alpha: 0, d: 0, theta: q2 + q7, r: 0",
            "there is no frame 7; joint variables of this table: q1, q2",
        ),
        ("sigma: 0, alpha: 0, d: 0, theta: q1 + q3, r: 0", "there is no frame 3"),
        ("sigma: 1, alpha: 0, d: 0, theta: 0, r: 1e6*q2", "q2 has the coefficient 1000000"),
        ("sigma: 0, alpha: 0, d: 0, theta: q2, r: q2", "r of frame 2 does not match sigma 0"),
        ("sigma: 1, alpha: 0, d: 0, theta: q2, r: q2", "theta of frame 2 does not match sigma 1"),
        ("sigma: 1, alpha: 0, d: 0, theta: 0, r: 0.1", "r of frame 2 does not match sigma 1"),
        ("sigma: 2, alpha: 0, d: 0, theta: q2, r: 0", "theta of frame 2 does not match sigma 2"),
        ("sigma: 0, alpha: q2, d: 0, theta: q2, r: 0", "alpha must not depend on q2"),
    ];
    for (row, words) in rows {
        let found = mistakes(arm_with_row(&format!("j: 2, {row}")));
        assert!(
            found.len() == 1 && found[0].starts_with("5:") && found[0].contains(words),
            "{row}: {found:?}"
        );
    }
}

#[test]
fn a_mistake_of_a_variable_is_told_at_its_character() {
    let row = |theta: &str| arm_with_row(&format!("j: 2, sigma: 0, alpha: 0, d: 0, theta: {theta}, r: 0"));
    // theta starts in column 45.
    one_mistake(&row("q2 + 0.3*q1"), "5:54", &["q1 has the coefficient 0.3", "drive: gear"]);
    one_mistake(&row("q2 - 2*(q9 + d2)"), "5:53", &["there is no frame 9"]);
    one_mistake(&row("atan2(q1)"), "5:45", &["'atan2' is a function", "numerical solver"]);
}

#[test]
fn rows_may_move_with_variables_of_others() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: -q1 + pi/2, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0, d: 0.1, theta: 2*(q3 - q1)/2, r: 0}\n  \
                - {j: 3, sigma: 0, alpha: 0, d: 0.1, theta: q3 - q1, r: 0}\n  \
                - {j: 4, sigma: 1, alpha: 0, d: 0.1, theta: 0, r: 0.05*q1 - 0.2}\n";
    let robot = read(&format!("name: arm\nframes:\n{rows}"));
    assert_eq!(robot.joint_frames(), [0, 2]);
    let terms: Vec<Vec<(usize, f64)>> = robot.motions().into_iter().map(|m| m.terms).collect();
    let expected = [vec![(0, -1.0)], vec![(0, -1.0), (1, 1.0)], vec![(0, -1.0), (1, 1.0)], vec![(0, 0.05)]];
    assert_eq!(terms, expected);
    assert_eq!(robot.frames[3].kind, JointKind::Fixed);
    assert_eq!(robot.motions()[3].kind, JointKind::Prismatic);
    let mixed = rows.replace("r: 0.05*q1 - 0.2", "r: q4").replace("q3 - q1, r", "q3 + q4, r");
    let found = mistakes(format!("name: arm\nframes:\n{mixed}"));
    assert!(found.len() == 1 && found[0].contains("q4 is a length"), "{found:?}");
    let without = rows.replace("theta: q3 - q1, r", "theta: 2*q1, r");
    let found = mistakes(format!("name: arm\nframes:\n{without}"));
    assert!(found.len() == 1 && found[0].contains("frame 3 has no q3 in its own row"), "{found:?}");
}

#[test]
fn ellipsoids_hold_links_and_are_refused_where_nothing_can_be_within() {
    let robot = read(&arm(
        "ellipsoids:\n  - {frame: 2, radii: [0.3, 0.1, 0.2], rpy: [0, 0, pi/2]}\n  - {frame: 1, centre: [0.1, 0, 0], radii: [1, 1, 1]}",
    ));
    let frames: Vec<usize> = robot.ellipsoids.iter().map(|(frame, _)| *frame).collect();
    assert_eq!(frames, [0, 1]);
    assert_eq!(robot.ellipsoids[0].1.centre, [0.1, 0.0, 0.0]);
    // Turned by a right angle about z: y has the first radius.
    let shape = robot.ellipsoids[1].1.shape;
    for (k, wanted) in [(0, 0.01), (1, 0.09), (2, 0.04)] {
        assert!((shape[k][k] - wanted).abs() < 1e-15, "{shape:?}");
    }
    let one = |text: &str| arm(&format!("ellipsoids: [{{{text}}}]"));
    one_mistake(&arm("ellipsoids: {2: 1}"), "5:13", &["ellipsoids as a list"]);
    one_mistake(&one("frame: 3, radii: [1, 1, 1]"), "5:22", &["no frame 3", "1 to 2"]);
    one_mistake(&one("radii: [1, 1, 1]"), "5:14", &["an ellipsoid has no 'frame'"]);
    one_mistake(&one("frame: 2"), "5:14", &["an ellipsoid has no 'radii'"]);
    one_mistake(&one("frame: 2, radii: [1, 1]"), "5:32", &["radii has 2 entries, expected 3"]);
    one_mistake(&one("frame: 2, radii: [1, 0, 1]"), "5:32", &["radii has 0", "above 0"]);
    one_mistake(&one("frame: 2, radii: [1, -2, 1]"), "5:32", &["radii has -2"]);
    one_mistake(&one("frame: 2, radii: [1, 1, 1e300]"), "5:32", &["radii is 1e300", "at most"]);
    one_mistake(&one("frame: 2, radii: [1, 1, 1], centre: q1"), "5:51", &["centre"]);
    one_mistake(&one("frame: 2, radii: [1, 1, 1], shape: 1"), "5:43", &["unknown key 'shape'"]);
    one_mistake(
        &arm("massless: [2]\nellipsoids: [{frame: 2, radii: [1, 1, 1]}]"),
        "6:22",
        &["frame 2", "no mass"],
    );
    let twice = "ellipsoids: [{frame: 2, radii: [1, 1, 1]}, {frame: 2, radii: [2, 1, 1]}]";
    one_mistake(&arm(twice), "5:44", &["frame 2 has an ellipsoid already"]);
}

#[test]
fn what_is_known_is_no_base_parameter_or_one_with_a_value() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0, d: 0.1, theta: q2, r: 0}\n";
    let arm = |rest: &str| format!("name: arm\ngravity: [0, -9.81, 0]\nframes:\n{rows}{rest}");
    let robot = read(&arm("massless: [2]\nknown: {Ia1: 0, off1: 1 - 1}\n"));
    let set = dynid_codegen::base::base_set(&robot);
    let names: Vec<&str> = set.base.iter().map(|p| p.relation.as_ref()).collect();
    assert_eq!(names, ["ZZ1", "MX1", "MY1", "Fv1", "Fc1", "Ia2", "Fv2", "Fc2", "off2"]);
    one_mistake(&arm("massless: [2]\nknown: {M2: 0.3}\n"), "7:9", &["M2 is known already", "massless"]);
    one_mistake(&arm("known: {M2: 1e300}\n"), "6:13", &["M2", "at most"]);
    one_mistake(&arm("known: {M9: 0}\n"), "6:9", &["'M9' is not a standard parameter"]);
    one_mistake(&arm("massless: [3]\n"), "6:12", &["massless names 3", "1 to 2"]);
    let nominal = "massless: [2]\nnominal: {parameters: {M2: 1}}\n";
    one_mistake(&arm(nominal), "7:10", &["nominal has M2: 1, which is known to be 0"]);
    let nominal = "known: {M2: 2}\nnominal: {parameters: {M2: 1}}\n";
    one_mistake(&arm(nominal), "7:10", &["nominal has M2: 1, which is known to be 2"]);
    // What torques can tell keeps a column of its own; what is part of others is regrouped as ever.
    let robot = read(&arm("known: {Ia2: 0.3, M2: 2, Fv1: 4}\nnominal: {parameters: {Fc1: 1}}\n"));
    let robot = dynid_codegen::numeric_robot(&robot, &dynid_codegen::base::base_set(&robot));
    let fixed: Vec<(&str, f64)> =
        robot.fixed_base().into_iter().map(|(k, value)| (&*robot.base[k].name, value)).collect();
    assert_eq!(fixed, [("Fv1", 4.0), ("Ia2", 0.3)]);
    assert!(robot.base.iter().any(|p| p.relation.starts_with("ZZ1 + Ia1 + 0.01*M2")), "{:?}", robot.base);
    let nominal = robot.nominal.as_ref().expect("the table has nominal values");
    assert_eq!(robot.base_from_standard(&nominal.standard)[robot.fixed_base()[0].0], 4.0);
}

#[test]
fn friction_between_links_is_named_by_its_joints_and_refused_where_it_is_there_already() {
    let robot = read(&arm("friction: [{joints: {q1: 1, q2: -0.5}}, {joints: {q2: 1, q1: 1}, name: belt}]"));
    let names: Vec<String> = robot.standard_parameters()[28..].iter().map(|p| p.name.to_string()).collect();
    assert_eq!(names, ["Fvc1_2", "Fcc1_2", "Fvc_belt", "Fcc_belt"]);
    assert_eq!(*robot.couplings[1].terms, [(0, 1.0), (1, 1.0)]);
    let one = |entries: &str, place: &str, words: &[&str]| {
        one_mistake(&arm(&format!("friction: [{entries}]")), place, words);
    };
    one("{joints: {q2: 1}}", "5:12", &["joint 2 alone", "Fv2 and Fc2"]);
    one("{joints: {q3: 1}}", "5:22", &["'q3' is no joint", "q1, q2"]);
    one("{joints: {q1: 1, q2: 0}}", "5:33", &["coefficient of q2 is 0"]);
    one("{joints: {q1: 1, q2: 1e9}}", "5:33", &["coefficient of q2", "at most"]);
    one("{joints: q1 - q2}", "5:21", &["joints with their coefficients"]);
    one("{name: belt}", "5:12", &["has no 'joints'"]);
    one("{joints: {q1: 1, q2: 1}, name: 7}", "5:43", &["name '7'", "not a Rust identifier"]);
    one("{joints: {q1: 1, q2: 1}}, {joints: {q1: -2, q2: -2}}", "5:38", &["Fvc1_2 and Fcc1_2"]);
    one("{joints: {q1: 1, q2: 1}}, {joints: {q1: 1, q2: -1}}", "5:38", &["'1_2' already", "`name`"]);
    let motor =
        "drive: {gear: [[10, 0], [5, 10]], coupled_friction: [2]}\nfriction: [{joints: {q1: 1, q2: 2}}]";
    one_mistake(&arm(motor), "6:12", &["speed of motor 2", "Fvm2 and Fcm2"]);
}

#[test]
fn springs_are_of_one_joint_or_several_and_refused_where_torques_cannot_tell_them_apart() {
    let robot =
        read(&arm("springs: [{joint: 2}, {joints: {q1: 1, q2: 1}, rest: pi/2, name: hose, law: linear}]"));
    let names: Vec<String> = robot.standard_parameters()[28..].iter().map(|p| p.name.to_string()).collect();
    assert_eq!(names, ["K2", "KR2", "K_hose"]);
    let set = dynid_codegen::base::base_set(&robot);
    assert!(set.base.iter().any(|p| p.relation == "off2 - KR2"), "{:?}", set.base);
    // Where the offset is known, the rest of the spring shows.
    let without = read(&arm("springs: [{joint: 2}]\nknown: {off2: 0}"));
    let set = dynid_codegen::base::base_set(&without);
    assert!(set.base.iter().any(|p| p.name == "KR2"), "{:?}", set.base);
    let one = |entries: &str, place: &str, words: &[&str]| {
        one_mistake(&arm(&format!("springs: [{entries}]")), place, words);
    };
    one("{joint: 3}", "5:19", &["no joint 3", "[1, 2]"]);
    one("{}", "5:11", &["joint: 2"]);
    one("{joint: 1, joints: {q1: 1}}", "5:11", &["expected a spring on one joint"]);
    one("{joint: 1, law: gas}", "5:27", &["the law is linear", "'gas'"]);
    one("{joint: 1, rest: q2}", "5:28", &["rest must not depend on q2"]);
    one("{joint: 1}, {joints: {q1: 3}, name: b}", "5:23", &["'_b' cannot be told"]);
    let both = "{joint: 1}, {joint: 2}, {joints: {q1: 1, q2: 1}}, {joints: {q1: 1, q2: -1}, name: b}";
    one(both, "5:61", &["'_b' cannot be told"]);
}

#[test]
fn theta_is_the_joint_variable_plus_a_constant_in_any_order() {
    let expected = 0.5 - std::f64::consts::PI / 2.0;
    for theta in [
        "q2 - pi/2 + d2",
        "d2 - pi/2 + q2",
        "-(pi/2 - q2) + d2",
        "(q2) + (d2 - 2*pi/4)",
        "\"q2 - pi/2 + d2\"",
    ] {
        let robot = read(&arm_with_row(&format!("j: 2, sigma: 0, alpha: 0, d: d2, theta: {theta}, r: 0")));
        assert_eq!(robot.frames[1].kind, JointKind::Revolute);
        assert!((robot.frames[1].theta.value() - expected).abs() < 1e-15, "{theta}");
    }
    assert_eq!(read(&arm("")).frames[1].theta.value(), 0.0);
}

#[test]
fn an_expression_says_what_is_wrong_at_its_character() {
    let row = |d: &str| arm_with_row(&format!("j: 2, sigma: 0, alpha: 0, d: {d}, theta: q2, r: 0"));
    // d starts in column 35.
    one_mistake(&row("d2 + d3"), "5:40", &["unknown constant 'd3'", "d2", "pi"]);
    one_mistake(&row("1/(d2 - 0.5)"), "5:37", &["division by zero"]);
    one_mistake(&row("1/zero"), "5:37", &["division by zero"]);
    one_mistake(&row("2 3"), "5:37", &["operator"]);
    one_mistake(&row("(2 + 1"), "5:41", &["')'"]);
    one_mistake(&row("2 + 1)"), "5:40", &["without its '('"]);
    one_mistake(&row("2 +"), "5:38", &["ends where"]);
    one_mistake(&row("2^2"), "5:36", &["'^'"]);
    one_mistake(&row("1.2.3"), "5:35", &["not a number"]);
    one_mistake(&row("[1]"), "5:35", &["expected d", "a list of 1"]);
    one_mistake(&row(""), "5:33", &["expected d", "nothing"]);
}

#[test]
fn constants_use_those_above_and_hide_nothing() {
    let robot = read(&arm("constants: {a: 0.5, b: 2*a + pi}"));
    assert_eq!(robot.constants[1], ("b".to_owned(), 1.0 + std::f64::consts::PI));
    one_mistake(&arm("constants: {a: b, b: 1}"), "5:16", &["unknown constant 'b'"]);
    one_mistake(&arm("constants: {pi: 3}"), "5:13", &["'pi'", "hide"]);
    one_mistake(&arm("constants: {q1: 3}"), "5:13", &["'q1'", "hide"]);
    one_mistake(&arm("constants: {2a: 3}"), "5:13", &["identifier"]);
    one_mistake(&arm("constants: {fn: 3}"), "5:13", &["keyword"]);
}

#[test]
fn a_name_is_a_rust_identifier_and_no_keyword() {
    for (name, why) in [
        ("my-arm", "identifier"),
        ("2r", "identifier"),
        ("b\u{e9}ta", "identifier"),
        ("_", "identifier"),
        ("struct", "keyword"),
        ("self", "keyword"),
        ("gen", "keyword"),
    ] {
        one_mistake(&arm("").replace("name: arm", &format!("name: {name}")), "1:7", &[why]);
    }
    assert_eq!(read(&arm("").replace("name: arm", "name: Arm_2")).name, "Arm_2");
    one_mistake(&arm("").replace("name: arm\n", "\n"), "2:1", &["no 'name'"]);
}

#[test]
fn j_counts_from_1_without_a_gap() {
    one_mistake(
        &arm_with_row("j: 3, sigma: 0, alpha: 0, d: 0, theta: q2, r: 0"),
        "5:9",
        &["j is 3", "expected 2"],
    );
    one_mistake(&arm_with_row("j: two, sigma: 0, alpha: 0, d: 0, theta: q2, r: 0"), "5:9", &["whole number"]);
    one_mistake(&arm_with_row("sigma: 0, alpha: 0, d: 0, theta: q2, r: 0"), "5:5", &["no 'j'"]);
}

#[test]
fn a_parent_comes_earlier() {
    let rows = |parents: [usize; 3]| {
        let row = |(k, p): (usize, usize)| {
            let j = k + 1;
            format!("  - {{j: {j}, parent: {p}, sigma: 0, alpha: 0, d: 0, theta: q{j}, r: 0}}\n")
        };
        format!("name: arm\nframes:\n{}", parents.into_iter().enumerate().map(row).collect::<String>())
    };
    assert_eq!(read(&rows([0, 0, 1])).frames[2].parent, 1);
    one_mistake(&rows([0, 3, 1]), "4:20", &["parent 3 of frame 2 comes later", "0 to 1"]);
    one_mistake(&rows([0, 2, 1]), "4:20", &["its own parent"]);
    one_mistake(&rows([0, 3, 2]), "4:20", &["circle", "2 -> 3 -> 2"]);
    one_mistake(&rows([0, 9, 1]), "4:20", &["3 frames"]);
}

#[test]
fn a_gear_is_regular_and_has_the_right_size() {
    assert_eq!(read(&arm("drive: {gear: [32, -48]}")).drive.gear, [[32.0, 0.0], [0.0, -48.0]]);
    assert_eq!(read(&arm("drive: {gear: [[1, 0], [1, 1]]}")).drive.gear, [[1.0, 0.0], [1.0, 1.0]]);
    assert_eq!(read(&arm("")).drive.gear, [[1.0, 0.0], [0.0, 1.0]]);
    one_mistake(&arm("drive: {gear: [[0.1, 0.2], [0.3, 0.6]]}"), "5:15", &["singular"]);
    one_mistake(&arm("drive: {gear: [0, 1]}"), "5:16", &["gear[1][1] is 0"]);
    one_mistake(&arm("drive: {gear: [[0, 1], [1, 1]]}"), "5:17", &["gear[1][1] is 0"]);
    one_mistake(&arm("drive: {gear: [1, 2, 3]}"), "5:15", &["3 entries", "expected 2"]);
    one_mistake(&arm("drive: {gear: [[1, 0], [1]]}"), "5:24", &["1 entry", "expected 2"]);
    one_mistake(&arm("drive: {gear: 5}"), "5:15", &["list"]);
    one_mistake(&arm("drive: {gear: [[0, 1], [1, 0, 0]]}"), "5:24", &["3 entries"]);
}

#[test]
fn coupled_friction_names_joints_by_their_number() {
    assert_eq!(read(&arm("drive: {coupled_friction: [2]}")).drive.coupled_friction, [1]);
    one_mistake(&arm("drive: {coupled_friction: [3]}"), "5:28", &["names 3", "[1, 2]"]);
    one_mistake(&arm("drive: {coupled_friction: [2, 2]}"), "5:31", &["twice"]);
    let fixed =
        arm_with_row("j: 2, sigma: 2, alpha: 0, d: 0, theta: 0, r: 0") + "drive: {coupled_friction: [2]}\n";
    one_mistake(&fixed, "6:28", &["not a joint"]);
}

#[test]
fn limits_are_symmetric_or_low_and_high() {
    let limits = read(&arm("limits: {position: [pi, [-1, 2]], velocity: 3}")).limits;
    assert_eq!(limits.position.as_ref(), [[-std::f64::consts::PI, std::f64::consts::PI], [-1.0, 2.0]]);
    assert_eq!(limits.velocity.as_ref(), [[-3.0, 3.0], [-3.0, 3.0]]);
    assert!(limits.torque.is_empty());
    one_mistake(&arm("limits: {position: [1]}"), "5:20", &["1 entry", "expected 2"]);
    one_mistake(&arm("limits: {position: [1, [2, 1]]}"), "5:24", &["low < high"]);
    one_mistake(&arm("limits: {torque: [1, -2]}"), "5:22", &["above 0"]);
    one_mistake(&arm("limits: {torque: [1, [1, 2, 3]]}"), "5:22", &["3 entries", "expected 2"]);
}

#[test]
fn nominal_values_are_read_by_name() {
    let text = "nominal: {parameters: {ZZ1: 0.3, Ia2: 1}, controller: {kp: 5, kd: [1, 2]}, noise: {torque: [0.1, 0.2]}}";
    let nominal = read(&arm(text)).nominal.expect("it is there");
    assert_eq!(nominal.standard, [("ZZ1".to_owned(), 0.3), ("Ia2".to_owned(), 1.0)]);
    assert_eq!((nominal.kp, nominal.kd, nominal.ki), (vec![5.0, 5.0], vec![1.0, 2.0], vec![]));
    assert_eq!((nominal.position_noise, nominal.torque_noise), (vec![], vec![0.1, 0.2]));
    one_mistake(&arm("nominal: {parameters: {ZZ1: big}}"), "5:29", &["ZZ1", "unknown constant 'big'"]);
    one_mistake(&arm("nominal: {parameters: [1]}"), "5:23", &["by name"]);
    one_mistake(&arm("nominal: {noise: {torque: [0.1, -1]}}"), "5:27", &["-1", "below 0"]);
    one_mistake(&arm("nominal: {parameters: {Fvm1: 1}}"), "5:24", &["Fvm1"]);
}

#[test]
fn a_table_needs_a_joint_and_rows() {
    one_mistake("name: arm\nframes: []\n", "2:9", &["empty"]);
    one_mistake("name: arm\n", "1:1", &["no 'frames'"]);
    let fixed = "name: arm\nframes: [{j: 1, sigma: 2, alpha: 0, d: 0, theta: 0, r: 0}]\n";
    one_mistake(fixed, "2:9", &["at least one joint"]);
    one_mistake(&arm_with_row("j: 2, sigma: 0, alpha: 0, d: 0, theta: q2"), "5:5", &["no 'r'"]);
}

#[test]
fn all_mistakes_are_reported_at_once_in_the_order_of_the_file() {
    let text = "name: my arm
gravity: [0, 0]
colour: red
constants: {a: .nan, a: 1}
frames:
  - {j: 1, sigma: 5, alpha: x, d: 0, theta: q1, r: 0}
  - {j: 7, sigma: 0, alpha: 0, d: a, theta: 0, r: 1/0, extra: 1}
";
    let places: Vec<String> =
        mistakes(text).iter().map(|m| m.splitn(3, ':').take(2).collect::<Vec<_>>().join(":")).collect();
    assert_eq!(places, ["1:7", "2:10", "3:1", "4:16", "4:22", "6:19", "6:29", "7:9", "7:45", "7:53", "7:56"]);
}

#[test]
fn a_wrong_row_does_not_hide_what_is_wrong_below_the_table() {
    let text = "name: arm
frames:
  - {j: 1, sigma: 0, alpha: none, d: 0, theta: q1, r: 0}
drive: {gear: [0], coupled_friction: [1, 4]}
limits: {speed: 1, position: [1, 2]}
nominal: {parameters: {Fvm1: 1, Fvm2: 1}}
";
    let places: Vec<String> =
        mistakes(text).iter().map(|m| m.splitn(3, ':').take(2).collect::<Vec<_>>().join(":")).collect();
    assert_eq!(places, ["3:29", "4:16", "4:42", "5:10", "6:33"]);
}

#[test]
fn nesting_and_size_have_bounds() {
    let deep = format!("name: {}{}", "[".repeat(5000), "]".repeat(5000));
    assert!(mistakes(&deep)[0].contains("nested deeper than 16"));
    let deep = format!("name: {}", "{a: ".repeat(100));
    assert!(mistakes(&deep)[0].contains("nested deeper"));
    let indented: String = (0..500).map(|k| format!("{}a:\n", " ".repeat(k))).collect();
    assert!(mistakes(&indented)[0].contains("nested deeper"));
    let brackets = arm(&format!("gravity: [0, 0, {}1{}]", "(".repeat(100_000), ")".repeat(100_000)));
    assert!(mistakes(&brackets)[0].contains("expression longer"));
    let sum = arm(&format!("gravity: [0, 0, {}1]", "1+".repeat(100_000)));
    assert!(mistakes(&sum)[0].contains("expression longer"));
    assert!(mistakes(vec![b'a'; 3 << 20])[0].contains("bytes"));
    let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n".repeat(1000);
    assert!(mistakes(format!("name: arm\nframes:\n{rows}"))[0].contains("1000 rows"));
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_do_no_harm() {
    let text = format!("\u{feff}{}", arm("gravity: [0, 0, -9.81]").replace('\n', "\r\n"));
    assert_eq!(read(&text).gravity, [0.0, 0.0, -9.81]);
}

#[test]
fn expressions_print_as_they_are_written() {
    for text in [
        "d2 - pi/2",
        "2*(d2 + 1)",
        "-d2/(2*pi)",
        "d2 - (1 - zero)",
        "-0.6",
        "-(d2 + 1)",
        "d2/(pi/2)",
        "1e-12",
        "1.5e300*1e-300",
    ] {
        let robot = read(&arm_with_row(&format!("j: 2, sigma: 0, alpha: 0, d: {text}, theta: q2, r: 0")));
        assert_eq!(robot.frames[1].d.to_string(), text);
    }
}

proptest! {
    /// Whatever the file holds, the answer is a robot or mistakes with a place.
    #[test]
    fn no_text_makes_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse("arm.yaml", &bytes);
    }

    /// The same for robots with a piece torn out, doubled or replaced.
    #[test]
    fn no_damage_makes_the_reader_panic(
        at in 0usize..400,
        length in 0usize..12,
        piece in "[\\[\\]{}:,q0-9 \n+*/()a-z.-]{0,8}",
    ) {
        let text = arm("constants: {a: 1}\ndrive: {gear: [[32, 0], [1, 2]], coupled_friction: [2]}\nlimits: {position: [1, [0, 2]]}");
        let chars: Vec<char> = text.chars().collect();
        let at = at.min(chars.len());
        let end = (at + length).min(chars.len());
        let damaged: String = chars[..at].iter().copied().chain(piece.chars()).chain(chars[end..].iter().copied()).collect();
        if let Err(found) = parse("arm.yaml", damaged.as_bytes()) {
            prop_assert!(!found.is_empty());
            prop_assert!(found.iter().all(|m| m.line >= 1 && m.column >= 1));
        }
    }
}
