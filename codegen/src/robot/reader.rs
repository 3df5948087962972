//! Reading values of a YAML tree, with every mistake noted at its place.

use super::diagnostic::{Diagnostic, nearest};
use super::document::{Node, Place, Value, shortened};
use super::expression::Expression;
use super::formula::{Formula, parse_formula};

/// Collects the mistakes of one file.
pub(super) struct Reader {
    path: String,
    pub diagnostics: Vec<Diagnostic>,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Diagnostic>,
}

/// The keys of one mapping, checked against those that are known.
pub(super) struct Fields<'a> {
    pub place: Place,
    what: &'static str,
    pairs: Vec<(&'a str, &'a Node)>,
}

impl<'a> Fields<'a> {
    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.pairs.iter().find(|(k, _)| *k == key).map(|&(_, node)| node)
    }
}

/// The words for a number of values.
fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

impl Reader {
    pub fn new(path: &str) -> Self {
        Reader { path: path.to_owned(), diagnostics: Vec::new(), warnings: Vec::new() }
    }

    pub fn report(&mut self, place: Place, message: impl Into<String>) {
        let Place { line, column } = place;
        self.diagnostics.push(Diagnostic { path: self.path.clone(), line, column, message: message.into() });
    }

    pub fn warn(&mut self, place: Place, message: impl Into<String>) {
        let Place { line, column } = place;
        self.warnings.push(Diagnostic { path: self.path.clone(), line, column, message: message.into() });
    }

    /// The keys of a mapping. Unknown and repeated keys are reported; the first of a repeated key counts.
    pub fn fields<'a>(&mut self, node: &'a Node, what: &'static str, known: &[&str]) -> Option<Fields<'a>> {
        let Value::Mapping(pairs) = &node.value else {
            let found = node.describe();
            self.report(
                node.place,
                format!("expected {what} as keys and values ({}), found {found}", known.join(", ")),
            );
            return None;
        };
        let mut fields = Fields { place: node.place, what, pairs: Vec::new() };
        for (key, value) in pairs {
            let Value::Scalar { text, .. } = &key.value else {
                let found = key.describe();
                self.report(
                    key.place,
                    format!("expected a key of {what} ({}), found {found}", known.join(", ")),
                );
                continue;
            };
            if !known.contains(&text.as_str()) {
                let shown = shortened(text);
                let hint = match nearest(text, known.iter().copied()) {
                    Some(close) => format!("did you mean '{close}'?"),
                    None => format!("expected one of {}", known.join(", ")),
                };
                self.report(key.place, format!("unknown key '{shown}' in {what}; {hint}"));
            } else if let Some(first) = self.first_of(pairs, text, key.place) {
                let line = first.line;
                self.report(
                    key.place,
                    format!("key '{text}' is there twice in {what}; first at line {line}"),
                );
            } else {
                fields.pairs.push((text, value));
            }
        }
        Some(fields)
    }

    /// Where the same key stood before `place`.
    pub fn first_of(&self, pairs: &[(Node, Node)], text: &str, place: Place) -> Option<Place> {
        let same = |key: &&(Node, Node)| matches!(&key.0.value, Value::Scalar { text: t, .. } if t == text);
        pairs.iter().find(same).map(|(key, _)| key.place).filter(|&first| first != place)
    }

    /// A key that must be there.
    pub fn required<'a>(&mut self, fields: &Fields<'a>, key: &str) -> Option<&'a Node> {
        let node = fields.get(key);
        if node.is_none() {
            self.report(fields.place, format!("{} has no '{key}'", fields.what));
        }
        node
    }

    pub fn text<'a>(&mut self, node: &'a Node, what: &str) -> Option<&'a str> {
        match &node.value {
            Value::Scalar { text, plain } if !text.is_empty() || !plain => Some(text),
            _ => {
                let found = node.describe();
                self.report(node.place, format!("expected {what}, found {found}"));
                None
            }
        }
    }

    pub fn list<'a>(&mut self, node: &'a Node, what: &str) -> Option<&'a [Node]> {
        match &node.value {
            Value::Sequence(items) => Some(items),
            _ => {
                let found = node.describe();
                self.report(node.place, format!("expected {what}, found {found}"));
                None
            }
        }
    }

    pub fn integer(&mut self, node: &Node, what: &str) -> Option<usize> {
        let text = self.text(node, what)?;
        let number = text.parse().ok();
        if number.is_none() {
            let found = node.describe();
            self.report(node.place, format!("expected {what}, found {found}"));
        }
        number
    }

    pub fn formula(&mut self, node: &Node, what: &str, constants: &[(String, f64)]) -> Option<Formula> {
        let text = self.text(node, what)?;
        match parse_formula(text, constants) {
            Ok(formula) => Some(formula),
            Err(e) => {
                let place = self.place_in(node, e.offset);
                self.report(place, format!("{what}: {}", e.message));
                None
            }
        }
    }

    /// Where a character of a scalar is: of one in quotes, where it starts.
    pub fn place_in(&self, node: &Node, offset: usize) -> Place {
        let plain = matches!(node.value, Value::Scalar { plain: true, .. });
        let offset = if plain { offset } else { 0 };
        Place { line: node.place.line, column: node.place.column + offset }
    }

    /// An expression without joint variables.
    pub fn constant(&mut self, node: &Node, what: &str, constants: &[(String, f64)]) -> Option<Expression> {
        let formula = self.formula(node, what, constants)?;
        if let Some((j, ..)) = formula.variables.first() {
            self.report(node.place, format!("{what} must not depend on q{j}: expected a constant"));
            return None;
        }
        Some(formula.constant.unwrap_or(Expression::ZERO))
    }

    pub fn number(&mut self, node: &Node, what: &str, constants: &[(String, f64)]) -> Option<f64> {
        self.constant(node, what, constants).map(|e| e.value())
    }

    /// Exactly `n` numbers. Where a list is wrong in several places, each is reported.
    pub fn numbers(
        &mut self,
        node: &Node,
        what: &str,
        n: usize,
        constants: &[(String, f64)],
    ) -> Option<Vec<f64>> {
        let items = self.list(node, &format!("{what} as a list of {}", count(n, "number")))?;
        let values: Vec<_> = items.iter().map(|item| self.number(item, what, constants)).collect();
        self.length(node, what, items.len(), n)?;
        values.into_iter().collect()
    }

    /// Reports a list that does not have `n` entries.
    pub fn length(&mut self, node: &Node, what: &str, found: usize, n: usize) -> Option<()> {
        if found == n {
            return Some(());
        }
        self.report(
            node.place,
            format!("{what} has {}, expected {n}", count(found, "entry").replace("entrys", "entries")),
        );
        None
    }
}
