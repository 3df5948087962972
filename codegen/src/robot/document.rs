//! YAML text to a tree of values that know their line and column.

use super::diagnostic::Diagnostic;
use saphyr_parser::{Event, Marker, Parser, ScalarStyle};

/// Deepest nesting that is read; a robot needs four levels.
const MAX_DEPTH: usize = 16;
/// Longest file that is read, bytes; a robot of the most frames needs a few thousand.
const MAX_BYTES: usize = 1 << 20;

/// Where a file starts.
pub(super) const START: Place = Place { line: 1, column: 1 };

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
    tree(bytes).map_err(|Fault { place, message }| Diagnostic {
        path: path.to_owned(),
        line: place.line,
        column: place.column,
        message,
    })
}

/// Why there is no tree, and where.
struct Fault {
    place: Place,
    message: String,
}

impl Fault {
    fn new(place: Place, message: impl Into<String>) -> Self {
        Fault { place, message: message.into() }
    }

    fn empty() -> Self {
        Fault::new(START, "the file is empty; expected a robot: name, frames, ...")
    }
}

fn tree(bytes: &[u8]) -> Result<Node, Fault> {
    let text = utf8(bytes)?;
    let mut tree = Tree::default();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| {
            let place = Place::of(*e.marker());
            match indenting_tab(text, place.line) {
                Some(tab) => Fault::new(tab, "not YAML: indented with a tab; expected spaces"),
                // The parser has a limit of its own and reads ahead.
                None if e.info().contains("recursion limit") => too_deep(place),
                None => Fault::new(place, format!("not YAML: {}", e.info())),
            }
        })?;
        tree.take(event, Place::of(span.start))?;
    }
    match tree.root {
        Some(Node { value: Value::Scalar { ref text, plain: true }, .. }) if text.is_empty() => {
            Err(Fault::empty())
        }
        Some(node) => Ok(node),
        None => Err(Fault::empty()),
    }
}

fn too_deep(place: Place) -> Fault {
    Fault::new(place, format!("nested deeper than {MAX_DEPTH} levels; a robot needs four"))
}

/// The text of a file that is not too long, without a byte order mark.
fn utf8(bytes: &[u8]) -> Result<&str, Fault> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file has {} bytes; a robot has at most {MAX_BYTES}", bytes.len());
        return Err(Fault::new(START, message));
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let good = String::from_utf8_lossy(&bytes[..e.valid_up_to()]).into_owned();
        let line = good.matches('\n').count() + 1;
        let column = good.chars().rev().take_while(|&c| c != '\n').count() + 1;
        let byte = bytes[e.valid_up_to()];
        Fault::new(Place { line, column }, format!("the file is not UTF-8 text (byte 0x{byte:02x} here)"))
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// What has been read of the tree.
#[derive(Default)]
struct Tree {
    root: Option<Node>,
    /// Lists and groups that have not ended, outermost first; a group with the key that waits for its value.
    open: Vec<(Node, Option<Node>)>,
}

impl Tree {
    /// Takes in what the parser found next.
    fn take(&mut self, event: Event<'_>, place: Place) -> Result<(), Fault> {
        let tagged = matches!(
            &event,
            Event::Scalar(_, _, _, Some(_))
                | Event::SequenceStart(_, Some(_))
                | Event::MappingStart(_, Some(_))
        );
        if tagged {
            return Err(Fault::new(place, "a tag (!...) has no meaning in a robot; expected a plain value"));
        }
        match event {
            Event::Scalar(text, style, ..) => {
                let value = Value::Scalar { text: text.into_owned(), plain: style == ScalarStyle::Plain };
                self.put(Node { place, value });
            }
            Event::SequenceStart(..) => self.open(place, Value::Sequence(Vec::new()))?,
            Event::MappingStart(..) => self.open(place, Value::Mapping(Vec::new()))?,
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some((node, _)) = self.open.pop() {
                    self.put(node);
                }
            }
            Event::Alias(_) => {
                return Err(Fault::new(place, "an alias (*...) is not read in a robot; write the value out"));
            }
            Event::DocumentStart(_) if self.root.is_some() => {
                return Err(Fault::new(place, "a second document; expected one robot a file"));
            }
            _ => {}
        }
        Ok(())
    }

    /// A list or a group begins.
    fn open(&mut self, place: Place, value: Value) -> Result<(), Fault> {
        if self.open.len() == MAX_DEPTH {
            return Err(too_deep(place));
        }
        self.open.push((Node { place, value }, None));
        Ok(())
    }

    /// Puts a finished value where it belongs.
    fn put(&mut self, finished: Node) {
        match self.open.last_mut() {
            None => self.root = Some(finished),
            Some((Node { value: Value::Sequence(items), .. }, _)) => items.push(finished),
            Some((Node { value: Value::Mapping(pairs), .. }, key)) => match key.take() {
                None => *key = Some(finished),
                Some(key) => pairs.push((key, finished)),
            },
            // Only sequences and mappings are ever opened.
            Some(_) => {}
        }
    }
}
