//! Attributes of XML elements as numbers, with their places.

use std::cell::Cell;

use crate::mistake::{Mistake, Place, shown};
use roxmltree::{Attribute, Document, Node};

/// Largest number of a URDF, SI: what is larger is a mistake, and its square would be no robot's.
const LARGEST: f64 = 1e9;

/// A document and what was found wrong in it.
pub(crate) struct Reader<'a> {
    document: &'a Document<'a>,
    lines: Vec<usize>,
    /// Start of a line, a byte of it, and the characters between them: a file of one line is counted once.
    counted: Cell<(usize, usize, usize)>,
    pub mistakes: Vec<Mistake>,
    pub warnings: Vec<Mistake>,
}

impl<'a> Reader<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        let text = document.input_text();
        let starts = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at + 1);
        let lines = std::iter::once(0).chain(starts).collect();
        Self { document, lines, counted: Cell::new((0, 0, 0)), mistakes: Vec::new(), warnings: Vec::new() }
    }

    /// Line and column of a byte.
    pub fn place(&self, byte: usize) -> Place {
        let line = self.lines.partition_point(|&start| start <= byte).max(1);
        let start = self.lines[line - 1];
        let (known, at, count) = self.counted.get();
        let (at, count) = if known == start && at <= byte { (at, count) } else { (start, 0) };
        let count = count + self.document.input_text().get(at..byte).unwrap_or_default().chars().count();
        self.counted.set((start, byte, count));
        Place { line, column: count + 1 }
    }

    pub fn place_of(&self, node: Node<'_, '_>) -> Place {
        self.place(node.range().start)
    }

    pub fn report(&mut self, place: Place, message: impl Into<String>) {
        self.mistakes.push(Mistake::new(place, message));
    }

    pub fn warn(&mut self, place: Place, message: impl Into<String>) {
        self.warnings.push(Mistake::new(place, message));
    }

    /// An attribute that must be there and not be empty.
    pub fn required<'n>(&mut self, node: Node<'n, '_>, name: &str) -> Option<&'n str> {
        let value = node.attribute(name).map(str::trim).filter(|text| !text.is_empty());
        if value.is_none() {
            let place = self.place_of(node);
            self.report(place, format!("<{}> has no '{name}'", node.tag_name().name()));
        }
        value
    }

    /// A number; `None` where it is absent or wrong.
    pub fn number(&mut self, node: Node<'_, '_>, name: &str) -> Option<f64> {
        let attribute = node.attribute_node(name)?;
        let [value] = self.numbers(attribute, 1)?[..] else { return None };
        Some(value.1)
    }

    /// A number that must be there.
    pub fn required_number(&mut self, node: Node<'_, '_>, name: &str) -> Option<f64> {
        self.required(node, name)?;
        self.number(node, name)
    }

    /// Three numbers as they are written and what they are, with the place; `None` where absent or wrong.
    pub fn triple<'n>(&mut self, node: Node<'n, '_>, name: &str) -> Option<([(&'n str, f64); 3], Place)> {
        let attribute = node.attribute_node(name)?;
        let place = self.place(attribute.range_value().start);
        let values = <[(&'n str, f64); 3]>::try_from(self.numbers(attribute, 3)?).ok()?;
        Some((values, place))
    }

    fn numbers<'n>(&mut self, attribute: Attribute<'n, '_>, count: usize) -> Option<Vec<(&'n str, f64)>> {
        let place = self.place(attribute.range_value().start);
        let words: Vec<&str> = attribute.value().split_whitespace().collect();
        if words.len() != count {
            let expected = if count == 1 { "one number".to_owned() } else { format!("{count} numbers") };
            let found = shown(attribute.value());
            self.report(place, format!("'{}': expected {expected}, found '{found}'", attribute.name()));
            return None;
        }
        let mut values = Vec::new();
        for word in words {
            match word.parse::<f64>() {
                Ok(value) if value.abs() <= LARGEST => values.push((word, value)),
                Ok(value) if value.is_finite() => {
                    let name = attribute.name();
                    self.report(place, format!("'{name}' is {value:e}: expected at most {LARGEST:e}"));
                }
                _ => {
                    let (name, found) = (attribute.name(), shown(word));
                    let hint =
                        if word.contains("${") { " (an expression of xacro: expand it first)" } else { "" };
                    self.report(place, format!("'{name}': '{found}' is not a finite number{hint}"));
                }
            }
        }
        (values.len() == count).then_some(values)
    }
}

/// The children of this name.
pub(crate) fn elements<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The first child of this name.
pub(crate) fn first<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    elements(node, name).next()
}
