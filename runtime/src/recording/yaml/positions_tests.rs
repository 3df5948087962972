use super::*;

fn read(text: &str) -> Node {
    read_positions(text.as_bytes()).expect("valid").expect("not empty")
}

fn mistake(text: &str) -> (usize, usize, String) {
    let Mistake { place, message } = read_positions(text.as_bytes()).expect_err("a mistake");
    (place.line, place.column, message)
}

fn at(node: &Node, keys: &[&str]) -> (usize, usize) {
    let place = node.place_of(keys);
    (place.line, place.column)
}

#[test]
fn keys_are_found_by_their_path_and_not_by_their_text() {
    let node = read("title: \"torque: none\"\nx: {torque: 1}\ntorque: {unit: A,\n  gain: [1, 2]}\n");
    assert_eq!(at(&node, &["torque"]), (3, 1));
    assert_eq!(at(&node, &["torque", "gain"]), (4, 3));
    assert_eq!(at(&node, &["torque", "gain", "1"]), (4, 13));
    assert_eq!(at(&node, &["x", "torque"]), (2, 5));
}

#[test]
fn what_is_not_there_is_told_at_what_would_hold_it() {
    let node = read("# first\nrobot: a\nlist:\n  - {x: 1}\n  - {x: 2}\n");
    assert_eq!(at(&node, &["nowhere"]), (2, 1));
    assert_eq!(at(&node, &["robot", "columns"]), (2, 1));
    assert_eq!(at(&node, &["list", "1", "x"]), (5, 6));
    assert_eq!(at(&node, &["list", "1", "y"]), (5, 5));
    assert_eq!(at(&node, &["list", "7"]), (3, 1));
}

#[test]
fn a_repeated_key_is_told_at_its_own_place() {
    assert_eq!(
        mistake("robot: a\ntitle: b\nrobot: c\n"),
        (3, 1, "key 'robot' is there twice; first at line 1".into())
    );
    assert_eq!(mistake("a: 1\ntime: {rate: 5,\n  unit: s, rate: 6}\n").0, 3);
    assert_eq!(mistake("- {x: 1}\n- {x: 1, y: [x, x], 'x': 2}\n").1, 21);
}

#[test]
fn the_same_key_in_several_mappings_and_the_same_value_are_no_mistake() {
    for text in
        ["a: {file: x}\nb: {file: a}\nc: [a, a, {a: a}]\nd: {}\n", "? [a, b]\n: 1\na: 2\n? {c: 1}\n: c\n"]
    {
        read(text);
    }
}

#[test]
fn tabs_and_text_that_is_no_yaml_are_told_where_they_stand() {
    let (line, column, message) = mistake("robot: a\ntime:\n\trate: 5\n");
    assert_eq!((line, column), (3, 1));
    assert!(message.contains("tab") && message.contains("spaces"), "{message}");
    let (line, _, message) = mistake("robot: a\nside: [\n");
    assert!(line >= 2 && message.starts_with("not YAML"), "{line}: {message}");
    assert_eq!(mistake("a: 1\n---\nb: 2\n").0, 2);
}

#[test]
fn a_byte_order_mark_moves_nothing() {
    let node = read("\u{feff}robot: a\ntorque: b\n");
    assert_eq!(at(&node, &["robot"]), (1, 1));
    assert_eq!(at(&node, &["torque"]), (2, 1));
}

#[test]
fn nesting_and_length_have_limits_that_are_found_fast() {
    let start = std::time::Instant::now();
    for bracket in ["[", "{", "- ", "? "] {
        let (line, _, message) = mistake(&bracket.repeat(200_000));
        assert!(line == 1 && message.contains("deeper than 16"), "{message}");
    }
    let (.., message) = mistake(&"# ".repeat(MAX_BYTES));
    assert!(message.contains("1048576 bytes"), "{message}");
    // A file of the largest size with one key a line, all of them different.
    let mut many = String::new();
    for k in 0..100_000 {
        many.push_str(&format!("k{k}: 1\n"));
    }
    assert_eq!(at(&read(&many), &["k99999"]), (100_000, 1));
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn nothing_is_nothing() {
    for text in ["", "\n\n", "# only a comment\n", "---\n", "\u{feff}"] {
        assert_eq!(read_positions(text.as_bytes()), Ok(None), "{text:?}");
    }
    let bad = read_positions(b"a: 1\nb: \xff").expect_err("not UTF-8");
    assert_eq!((bad.place.line, bad.place.column), (2, 4));
}
