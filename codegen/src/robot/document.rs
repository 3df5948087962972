//! YAML text to a tree of values that know their line and column.

use super::Diagnostic;
use saphyr_parser::{Event, Marker, Parser, ScalarStyle};

/// Deepest nesting that is read; a robot needs four levels.
const MAX_DEPTH: usize = 16;
/// Longest file that is read, bytes; a robot of 64 frames needs a few thousand.
const MAX_BYTES: usize = 1 << 20;

/// Line and column, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub line: usize,
    pub column: usize,
}

impl Place {
    fn of(marker: Marker) -> Place {
        Place { line: marker.line().max(1), column: marker.col() + 1 }
    }
}

/// A value of the file and where it starts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub place: Place,
    pub value: Value,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Scalar {
        text: String,
        /// Not quoted and not a block: text and file run in step.
        plain: bool,
    },
    Sequence(Vec<Node>),
    Mapping(Vec<(Node, Node)>),
}

impl Node {
    /// How a person would call it.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Scalar { text, plain: true } if text.is_empty() => "nothing".to_owned(),
            Value::Scalar { text, .. } => format!("'{}'", shortened(text)),
            Value::Sequence(items) => format!("a list of {}", items.len()),
            Value::Mapping(_) => "a group of keys".to_owned(),
        }
    }
}

/// A text for a message: one line, not too long.
pub(super) fn shortened(text: &str) -> String {
    let one_line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(41).collect();
    if one_line.chars().count() > 40 {
        one_line.chars().take(40).chain("...".chars()).collect()
    } else {
        one_line
    }
}

/// A tab at the start of this line or the next: the usual cause of an error that the scanner puts elsewhere.
fn indenting_tab(text: &str, line: usize) -> Option<Place> {
    text.lines().enumerate().skip(line - 1).take(2).find_map(|(k, text)| {
        let indent = text.chars().take_while(|c| c.is_whitespace());
        let column = indent.enumerate().find(|&(_, c)| c == '\t').map(|(column, _)| column + 1)?;
        Some(Place { line: k + 1, column })
    })
}

/// Reads the one document of a YAML file.
pub(super) fn read_document(path: &str, bytes: &[u8]) -> Result<Node, Diagnostic> {
    let fail = |place: Place, message: String| Diagnostic {
        path: path.to_owned(),
        line: place.line,
        column: place.column,
        message,
    };
    let start = Place { line: 1, column: 1 };
    if bytes.len() > MAX_BYTES {
        return Err(fail(
            start,
            format!("the file has {} bytes; a robot has at most {MAX_BYTES}", bytes.len()),
        ));
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let good = String::from_utf8_lossy(&bytes[..e.valid_up_to()]).into_owned();
        let line = good.matches('\n').count() + 1;
        let column = good.chars().rev().take_while(|&c| c != '\n').count() + 1;
        let byte = bytes[e.valid_up_to()];
        fail(Place { line, column }, format!("the file is not UTF-8 text (byte 0x{byte:02x} here)"))
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let empty = || fail(start, "the file is empty; expected a robot: name, frames, ...".to_owned());

    let mut root: Option<Node> = None;
    let mut open: Vec<(Node, Option<Node>)> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| {
            let place = Place::of(*e.marker());
            match indenting_tab(text, place.line) {
                Some(tab) => fail(tab, "not YAML: indented with a tab; expected spaces".to_owned()),
                None => fail(place, format!("not YAML: {}", e.info())),
            }
        })?;
        let place = Place::of(span.start);
        let tagged = matches!(
            &event,
            Event::Scalar(_, _, _, Some(_))
                | Event::SequenceStart(_, Some(_))
                | Event::MappingStart(_, Some(_))
        );
        if tagged {
            return Err(fail(
                place,
                "a tag (!...) has no meaning in a robot; expected a plain value".to_owned(),
            ));
        }
        let finished = match event {
            Event::Scalar(text, style, ..) => Node {
                place,
                value: Value::Scalar { text: text.into_owned(), plain: style == ScalarStyle::Plain },
            },
            Event::SequenceStart(..) | Event::MappingStart(..) => {
                if open.len() == MAX_DEPTH {
                    return Err(fail(
                        place,
                        format!("nested deeper than {MAX_DEPTH} levels; a robot needs four"),
                    ));
                }
                let is_list = matches!(event, Event::SequenceStart(..));
                let value = if is_list { Value::Sequence(Vec::new()) } else { Value::Mapping(Vec::new()) };
                open.push((Node { place, value }, None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some((node, _)) => node,
                None => continue,
            },
            Event::Alias(_) => {
                return Err(fail(
                    place,
                    "an alias (*...) is not read in a robot; write the value out".to_owned(),
                ));
            }
            Event::DocumentStart(_) if root.is_some() => {
                return Err(fail(place, "a second document; expected one robot a file".to_owned()));
            }
            _ => continue,
        };
        match open.last_mut() {
            None => root = Some(finished),
            Some((Node { value: Value::Sequence(items), .. }, _)) => items.push(finished),
            Some((Node { value: Value::Mapping(pairs), .. }, key)) => match key.take() {
                None => *key = Some(finished),
                Some(key) => pairs.push((key, finished)),
            },
            // Only sequences and mappings are ever opened.
            Some(_) => {}
        }
    }
    match root {
        Some(Node { value: Value::Scalar { ref text, plain: true }, .. }) if text.is_empty() => Err(empty()),
        Some(node) => Ok(node),
        None => Err(empty()),
    }
}
