//! The text: what is no YAML, keys, what is given twice, bounds of size.

use super::{arm, arm_with_row, mistakes, one_mistake, read};
use dynid_codegen::robot::parse;
use proptest::prelude::*;

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
