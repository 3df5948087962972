//! A law as a sum of terms, each linear in one constant.

use super::expression::{Node, Read};
use dynid_description::formula::FormulaError;

/// What stands before each constant, and what has none.
#[derive(Default)]
struct Terms {
    /// The part without a constant.
    free: Option<Node>,
    /// Constants with their coefficients, each constant once.
    of: Vec<(usize, Node)>,
}

/// The coefficient of each constant, in the order of the constants.
///
/// # Errors
/// A constant that does not enter linearly, and a term that has none.
pub(super) fn coefficients(read: &Read) -> Result<Vec<Node>, FormulaError> {
    let terms = terms(&read.tree, &read.constants)?;
    if read.constants.is_empty() {
        let what = "a law has at least one constant whose size is fitted: write k*(...)";
        return Err(FormulaError::new(0, what));
    }
    if terms.free.is_some() {
        let what = "a term has no constant whose size is fitted: write k*(...) for it, or put it into a term";
        return Err(FormulaError::new(0, what));
    }
    let mut of = terms.of;
    of.sort_by_key(|(constant, _)| *constant);
    Ok(of.into_iter().map(|(_, coefficient)| coefficient).collect())
}

fn combined(operator: char, a: Node, b: Node) -> Node {
    Node::Combined(operator, Box::new([a, b]))
}

fn terms(node: &Node, names: &[String]) -> Result<Terms, FormulaError> {
    let constant = first_constant(node);
    let Some(constant) = constant else {
        return Ok(Terms { free: Some(node.clone()), of: Vec::new() });
    };
    match node {
        Node::Constant(k, _) => Ok(Terms { free: None, of: vec![(*k, Node::Number(1.0))] }),
        Node::Negative(a) => Ok(map(terms(a, names)?, |part| Node::Negative(Box::new(part)))),
        Node::Combined(operator @ ('+' | '-'), both) => {
            let (left, right) = (terms(&both[0], names)?, terms(&both[1], names)?);
            Ok(added(left, right, *operator))
        }
        Node::Combined('*', both) => match both.each_ref().map(first_constant) {
            [Some(_), None] => Ok(map(terms(&both[0], names)?, |part| combined('*', part, both[1].clone()))),
            [None, _] => Ok(map(terms(&both[1], names)?, |part| combined('*', both[0].clone(), part))),
            [Some(_), Some(second)] => not_linear(second, names),
        },
        Node::Combined('/', both) => match first_constant(&both[1]) {
            None => Ok(map(terms(&both[0], names)?, |part| combined('/', part, both[1].clone()))),
            Some(below) => not_linear(below, names),
        },
        // The exponent before the base: `k*x^p` is linear in k once p is declared.
        Node::Combined(_, both) => not_linear(first_constant(&both[1]).unwrap_or(constant), names),
        Node::Number(_) | Node::Input(_) | Node::Shape(_) | Node::Call(..) => not_linear(constant, names),
    }
}

/// A constant that does not enter linearly.
fn not_linear<T>((k, offset): (usize, usize), names: &[String]) -> Result<T, FormulaError> {
    let name = names.get(k).map_or("", String::as_str);
    let what = format!(
        "'{name}' does not enter linearly: a constant that is fitted stands before a term. Declare the range it is searched in, as shapes: {{{name}: [0.1, 10]}}"
    );
    Err(FormulaError::new(offset, what))
}

/// The first constant of an expression and where it stands.
fn first_constant(node: &Node) -> Option<(usize, usize)> {
    match node {
        Node::Constant(k, offset) => Some((*k, *offset)),
        Node::Number(_) | Node::Input(_) | Node::Shape(_) => None,
        Node::Negative(a) | Node::Call(_, a) => first_constant(a),
        Node::Combined(_, both) => both.iter().find_map(first_constant),
    }
}

fn map(terms: Terms, each: impl Fn(Node) -> Node) -> Terms {
    Terms { free: terms.free.map(&each), of: terms.of.into_iter().map(|(k, part)| (k, each(part))).collect() }
}

fn added(left: Terms, right: Terms, operator: char) -> Terms {
    let signed = |part: Node| if operator == '-' { Node::Negative(Box::new(part)) } else { part };
    let free = match (left.free, right.free.map(signed)) {
        (Some(a), Some(b)) => Some(combined('+', a, b)),
        (a, b) => a.or(b),
    };
    let mut of = left.of;
    for (k, part) in right.of {
        let part = signed(part);
        match of.iter().position(|(known, _)| *known == k) {
            Some(at) => {
                let (_, before) = of.remove(at);
                of.push((k, combined('+', before, part)));
            }
            None => of.push((k, part)),
        }
    }
    Terms { free, of }
}
