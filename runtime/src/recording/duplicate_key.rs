//! A key that stands twice in a mapping of a YAML, which serde reports without its place.

use saphyr_parser::{Event, Parser, Span};

/// A repeated key and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DuplicateKey {
    pub key: String,
    /// Line and column of the repetition, from 1.
    pub line: usize,
    pub column: usize,
    /// Line of the first.
    pub first: usize,
}

/// What is open around the parser.
enum Open {
    Sequence,
    /// Keys and their lines so far, and whether the next node is a key.
    Mapping(Vec<(String, usize)>, bool),
}

/// The first key of a document that is repeated in its mapping. A text that is no YAML has none: another reader says
/// what is wrong with it.
pub(super) fn duplicate_key(text: &str) -> Option<DuplicateKey> {
    let mut open: Vec<Open> = Vec::new();
    for event in Parser::new_from_str(text.strip_prefix('\u{feff}').unwrap_or(text)) {
        let (event, span) = event.ok()?;
        match event {
            Event::Scalar(value, ..) => {
                if let Some(duplicate) = note(&mut open, &value, &span) {
                    return Some(duplicate);
                }
                turn(&mut open);
            }
            Event::Alias(_) => turn(&mut open),
            Event::SequenceStart(..) => open.push(Open::Sequence),
            Event::MappingStart(..) => open.push(Open::Mapping(Vec::new(), true)),
            Event::SequenceEnd | Event::MappingEnd => {
                open.pop();
                turn(&mut open);
            }
            _ => {}
        }
    }
    None
}

/// Notes a scalar that is a key.
fn note(open: &mut [Open], value: &str, span: &Span) -> Option<DuplicateKey> {
    let Some(Open::Mapping(keys, true)) = open.last_mut() else { return None };
    let line = span.start.line().max(1);
    if let Some((key, first)) = keys.iter().find(|(key, _)| key == value) {
        return Some(DuplicateKey { key: key.clone(), line, column: span.start.col() + 1, first: *first });
    }
    keys.push((value.to_owned(), line));
    None
}

/// A node is complete: after a key comes its value, after a value the next key.
fn turn(open: &mut [Open]) {
    if let Some(Open::Mapping(_, key)) = open.last_mut() {
        *key = !*key;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Option<(String, usize, usize, usize)> {
        duplicate_key(text).map(|d| (d.key, d.line, d.column, d.first))
    }

    #[test]
    fn a_repeated_key_is_found_at_its_own_place() {
        assert_eq!(found("robot: a\ntitle: b\nrobot: c\n"), Some(("robot".to_owned(), 3, 1, 1)));
        assert_eq!(
            found("a: 1\ntime: {rate: 5,\n  unit: s, rate: 6}\n"),
            Some(("rate".to_owned(), 3, 12, 2))
        );
        assert_eq!(found("- {x: 1}\n- {x: 1, y: [x, x], 'x': 2}\n"), Some(("x".to_owned(), 2, 21, 2)));
    }

    #[test]
    fn the_same_key_in_several_mappings_and_the_same_value_are_no_mistake() {
        assert_eq!(found("a: {file: x}\nb: {file: a}\nc: [a, a, {a: a}]\nd: {}\n"), None);
        assert_eq!(found("? [a, b]\n: 1\na: 2\n"), None);
        assert_eq!(found("a: *b\nb: [unclosed\n"), None);
        assert_eq!(found(""), None);
    }
}
