//! Where the values of a YAML file stand, from the events of its parser.

use std::collections::HashMap;

use saphyr_parser::{Event, Marker, Parser, ScalarStyle, Span};

/// Longest file that is read, bytes; a recording of a thousand windows needs less than a tenth of it.
pub const MAX_BYTES: usize = 1 << 20;
/// Deepest nesting that is read; a recording needs four levels.
const MAX_DEPTH: usize = 16;

/// Line and column in characters, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

impl Place {
    /// The beginning of a file.
    pub const START: Place = Place { line: 1, column: 1 };

    fn of(marker: Marker) -> Place {
        Place { line: marker.line().max(1), column: marker.col() + 1 }
    }
}

/// What is wrong with a file, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// Where it stands.
    pub place: Place,
    /// What was found and what was expected.
    pub message: String,
}

/// A value and where it starts.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where it starts.
    pub place: Place,
    /// What is inside.
    pub content: Content,
}

/// What is inside of a value.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A scalar or an alias.
    Single {
        /// Nothing stands there.
        empty: bool,
        /// Columns from its place to its first character; `None` where characters of the text stand elsewhere: escapes,
        /// several lines, an alias.
        first: Option<usize>,
    },
    /// The items of a list.
    Sequence(Vec<Node>),
    /// Keys in the order of the file, each with its place.
    Mapping(Vec<(String, Place, Node)>),
}

impl Node {
    /// Whether it has keys.
    pub fn is_mapping(&self) -> bool {
        matches!(self.content, Content::Mapping(_))
    }

    /// Whether a mapping has this key.
    pub fn has(&self, key: &str) -> bool {
        self.entry(key).is_some()
    }

    /// The place of a character of a value's text, as far as it is known.
    pub fn place_of_text(&self, offset: usize) -> Place {
        match self.content {
            Content::Single { first: Some(first), .. } => {
                Place { line: self.place.line, column: self.place.column + first + offset }
            }
            _ => self.place,
        }
    }

    /// The value of a key, or an item of a list.
    pub fn value_of(&self, key: &str) -> Option<&Node> {
        self.find(key)
    }

    /// The items of a list.
    pub fn items(&self) -> Option<&[Node]> {
        if let Content::Sequence(items) = &self.content { Some(items) } else { None }
    }

    /// The place of `keys[0]`, of `keys[1]` in its value, and so on, as far as they are there. A number stands for an
    /// item of a list, from 0.
    pub fn place_of(&self, keys: &[&str]) -> Place {
        let Some((key, rest)) = keys.split_first() else { return self.place };
        match &self.content {
            Content::Mapping(_) => self.entry(key).map_or(self.place, |(place, value)| match rest {
                [] => place,
                // Where the value has no such key, the key that holds it is what was meant.
                _ if value.find(rest[0]).is_none() => place,
                _ => value.place_of(rest),
            }),
            Content::Sequence(_) => self.find(key).map_or(self.place, |item| item.place_of(rest)),
            Content::Single { .. } => self.place,
        }
    }

    fn entry(&self, key: &str) -> Option<(Place, &Node)> {
        let Content::Mapping(entries) = &self.content else { return None };
        entries.iter().find(|(name, ..)| name == key).map(|(_, place, value)| (*place, value))
    }

    fn find(&self, key: &str) -> Option<&Node> {
        match &self.content {
            Content::Sequence(items) => items.get(key.parse::<usize>().ok()?),
            _ => self.entry(key).map(|(_, value)| value),
        }
    }
}

/// A sequence or mapping whose end has not come yet.
struct Open {
    node: Node,
    /// The key whose value comes next.
    key: Option<(String, Place)>,
    /// Line of each key so far.
    lines: HashMap<String, usize>,
}

/// Reads the places of all values of the one document of a file; `None` where it holds nothing.
///
/// Time and memory grow linearly with the file, which has at most [`MAX_BYTES`] bytes.
///
/// # Errors
/// Text that is too long, not UTF-8 or not YAML, a tab that indents, nesting that is too deep, a key that is there
/// twice, a second document.
pub fn read_positions(bytes: &[u8]) -> Result<Option<Node>, Mistake> {
    read_positions_of(bytes, "recording")
}

/// The same of a file that is no recording but `what`.
///
/// # Errors
/// As [`read_positions`].
pub fn read_positions_of(bytes: &[u8], what: &str) -> Result<Option<Node>, Mistake> {
    let text = text_of(bytes, what)?;
    let mut root = None;
    let mut open: Vec<Open> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| not_yaml(text, Place::of(*e.marker()), e.info(), what))?;
        let place = Place::of(span.start);
        let finished = match event {
            Event::Scalar(value, style, ..) => {
                if let Some(mapping) = open.last_mut()
                    && mapping.waits_for_key()
                {
                    mapping.take_key(value.into_owned(), place)?;
                    continue;
                }
                Node {
                    place,
                    content: Content::Single { empty: value.is_empty(), first: first(&value, style, &span) },
                }
            }
            Event::Alias(_) => Node { place, content: Content::Single { empty: false, first: None } },
            Event::SequenceStart(..) | Event::MappingStart(..) => {
                if open.len() == MAX_DEPTH {
                    return Err(too_deep(place, what));
                }
                let content = match event {
                    Event::SequenceStart(..) => Content::Sequence(Vec::new()),
                    _ => Content::Mapping(Vec::new()),
                };
                open.push(Open { node: Node { place, content }, key: None, lines: HashMap::new() });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(open) => open.node,
                None => continue,
            },
            Event::DocumentStart(_) if root.is_some() => {
                let message = format!("a second document; expected one {what} a file");
                return Err(Mistake { place, message });
            }
            _ => continue,
        };
        match open.last_mut() {
            Some(open) => open.take(finished),
            None => root = Some(finished),
        }
    }
    Ok(root.filter(|node| !matches!(node.content, Content::Single { empty: true, .. })))
}

/// Columns from the start of a scalar to its first character: none, or the quote.
fn first(value: &str, style: ScalarStyle, span: &Span) -> Option<usize> {
    let quote = match style {
        ScalarStyle::Plain => 0,
        ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted => 1,
        ScalarStyle::Literal | ScalarStyle::Folded => return None,
    };
    let written = span.end.index().checked_sub(span.start.index())?;
    (written == value.chars().count() + 2 * quote).then_some(quote)
}

impl Open {
    fn waits_for_key(&self) -> bool {
        self.key.is_none() && self.node.is_mapping()
    }

    fn take_key(&mut self, key: String, place: Place) -> Result<(), Mistake> {
        if let Some(first) = self.lines.insert(key.clone(), place.line) {
            let message = format!("key '{}' is there twice; first at line {first}", shortened(&key));
            return Err(Mistake { place, message });
        }
        self.key = Some((key, place));
        Ok(())
    }

    fn take(&mut self, value: Node) {
        match (&mut self.node.content, self.key.take()) {
            (Content::Sequence(items), _) => items.push(value),
            (Content::Mapping(entries), Some((key, place))) => entries.push((key, place, value)),
            // A key that is no scalar: nothing is asked for by it, but its value must not be taken for a key.
            (Content::Mapping(_), None) => self.key = Some((String::new(), value.place)),
            (Content::Single { .. }, _) => {}
        }
    }
}

/// The text of a file without a byte-order mark.
fn text_of<'a>(bytes: &'a [u8], what: &str) -> Result<&'a str, Mistake> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file is longer than {MAX_BYTES} bytes, the most that a {what} YAML has");
        return Err(Mistake { place: Place::START, message });
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let good = String::from_utf8_lossy(&bytes[..e.valid_up_to()]).into_owned();
        let line = good.matches('\n').count() + 1;
        let column = good.chars().rev().take_while(|&c| c != '\n').count() + 1;
        let byte = bytes[e.valid_up_to()];
        let message = format!("the file is not UTF-8 text (byte 0x{byte:02x} here)");
        Mistake { place: Place { line, column }, message }
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

fn too_deep(place: Place, what: &str) -> Mistake {
    Mistake { place, message: format!("nested deeper than {MAX_DEPTH} levels; a {what} needs four") }
}

/// What the parser said, or the tab that it stumbled over: the usual cause, which it tells elsewhere.
fn not_yaml(text: &str, place: Place, info: &str, what: &str) -> Mistake {
    let tab = text.lines().enumerate().skip(place.line - 1).take(2).find_map(|(k, line)| {
        let mut indent = line.chars().take_while(|c| c.is_whitespace());
        Some(Place { line: k + 1, column: indent.position(|c| c == '\t')? + 1 })
    });
    match tab {
        Some(place) => {
            Mistake { place, message: "not YAML: indented with a tab; expected spaces".to_owned() }
        }
        // The parser has a limit of its own and reads ahead.
        None if info.contains("recursion limit") => too_deep(place, what),
        None => Mistake { place, message: format!("not YAML: {info}") },
    }
}

/// A text for a message: one line, not too long.
fn shortened(text: &str) -> String {
    const MOST: usize = 40;
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(MOST).collect();
    if text.chars().nth(MOST).is_some() { format!("{line}...") } else { line }
}

#[cfg(test)]
#[path = "positions_tests.rs"]
mod tests;
