//! Rows of the table: sigma, the joint's variable, expressions, order and parents.

use super::{arm, arm_with_row, mistakes, one_mistake, read};
use dynid_description::JointKind;

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
