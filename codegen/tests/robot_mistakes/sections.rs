//! Sections beside the table: names, drive, limits, nominal values, and what is known of links.

use super::{arm, arm_with_row, one_mistake, read};
use dynid_codegen::read_all;
use dynid_codegen::robot::parse;

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
