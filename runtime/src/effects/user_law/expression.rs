//! The expression of a law as a tree, and what it comes to at an instant.

use dynid_description::formula::{Algebra, FormulaError, joint_variable, parse};

/// What a law may look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Quantity {
    Position,
    Speed,
    Acceleration,
    Load,
    Time,
}

/// Prefixes of the variables of a joint; the longer ones first.
const PREFIXES: [(&str, Quantity); 4] = [
    ("ddq", Quantity::Acceleration),
    ("dq", Quantity::Speed),
    ("load", Quantity::Load),
    ("q", Quantity::Position),
];

/// A variable of a law: what, and the number j of its joint in the table, 0 for the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Input {
    pub quantity: Quantity,
    pub number: usize,
}

impl Input {
    pub fn of_name(name: &str) -> Option<Self> {
        if name == "t" {
            return Some(Self { quantity: Quantity::Time, number: 0 });
        }
        PREFIXES
            .into_iter()
            .find_map(|(prefix, quantity)| Some(Self { quantity, number: joint_variable(name, prefix)? }))
    }

    pub fn name(self) -> String {
        match PREFIXES.into_iter().find(|(_, quantity)| *quantity == self.quantity) {
            Some((prefix, _)) => format!("{prefix}{}", self.number),
            None => "t".to_owned(),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Tanh,
    Exp,
    Ln,
    Abs,
    Sign,
    Sqrt,
}

const FUNCTIONS: [(&str, Function); 9] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("tanh", Function::Tanh),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("abs", Function::Abs),
    ("sign", Function::Sign),
    ("sqrt", Function::Sqrt),
];

/// An expression. Variables, shapes and constants are counted.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Number(f64),
    Input(usize),
    Shape(usize),
    /// One of the constants, and where it stands in the text.
    Constant(usize, usize),
    Negative(Box<Node>),
    Combined(char, Box<[Node; 2]>),
    Call(Function, Box<Node>),
}

/// What an expression without constants is evaluated at.
pub(super) struct At<'a> {
    pub inputs: &'a [f64],
    pub shape: &'a [f64],
    /// The variable whose sign is given, and its sign.
    pub direction: Option<(usize, f64)>,
}

impl Node {
    /// What it comes to; a constant counts as 1.
    pub fn value(&self, at: &At<'_>) -> f64 {
        match self {
            Self::Number(x) => *x,
            Self::Input(k) => at.inputs[*k],
            Self::Shape(k) => at.shape[*k],
            Self::Constant(..) => 1.0,
            Self::Negative(a) => -a.value(at),
            Self::Combined(operator, both) => {
                let [a, b] = [both[0].value(at), both[1].value(at)];
                match operator {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a.powf(b),
                }
            }
            Self::Call(Function::Sign, a) => match (a.as_ref(), at.direction) {
                (Self::Input(k), Some((given, sign))) if *k == given => sign,
                _ => sign(a.value(at)),
            },
            Self::Call(function, a) => function.of(a.value(at)),
        }
    }

    /// Whether it holds the sign of a variable.
    pub fn has_sign_of(&self, input: usize) -> bool {
        match self {
            Self::Call(Function::Sign, a) if **a == Self::Input(input) => true,
            Self::Negative(a) | Self::Call(_, a) => a.has_sign_of(input),
            Self::Combined(_, both) => both.iter().any(|a| a.has_sign_of(input)),
            _ => false,
        }
    }

    /// Whether it is a pure number whatever the units of the variables are: functions of anything, and what is made of
    /// them.
    pub fn is_pure(&self) -> bool {
        match self {
            Self::Number(_) => true,
            Self::Input(_) | Self::Shape(_) | Self::Constant(..) => false,
            Self::Call(Function::Abs | Function::Sqrt, a) | Self::Negative(a) => a.is_pure(),
            Self::Call(..) => true,
            Self::Combined(_, both) => both.iter().all(Self::is_pure),
        }
    }
}

/// -1, 0 or 1.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

impl Function {
    fn of(self, x: f64) -> f64 {
        match self {
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Tanh => x.tanh(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Abs => x.abs(),
            Self::Sign => sign(x),
            Self::Sqrt => x.sqrt(),
        }
    }
}

/// An expression with the names that it has.
pub(super) struct Read {
    pub tree: Node,
    pub inputs: Vec<Input>,
    /// Constants that are no shapes, in the order of the text.
    pub constants: Vec<String>,
    /// Whether each shape is there.
    pub used: Vec<bool>,
}

/// Reads an expression; `shapes` are the names of its shapes.
pub(super) fn read(text: &str, shapes: &[&str]) -> Result<Read, FormulaError> {
    let used = vec![false; shapes.len()];
    let mut names = Names { shapes, inputs: Vec::new(), constants: Vec::new(), used };
    let tree = parse(text, &mut names)?;
    let Names { inputs, constants, used, .. } = names;
    Ok(Read { tree, inputs, constants, used })
}

/// Longest name of a constant.
const LONGEST: usize = 40;

/// Why a word cannot be the name of a constant; `None` where it can.
pub(super) fn no_constant(name: &str) -> Option<String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if name.starts_with(|c: char| c.is_ascii_digit()) || !name.chars().all(plain) || name.is_empty() {
        return Some(format!("'{name}' is no name: expected letters, digits and underscores"));
    }
    if name.len() > LONGEST {
        return Some(format!("a name of more than {LONGEST} characters"));
    }
    if name == "pi" || Input::of_name(name).is_some() {
        return Some(format!("'{name}' is a variable or a number already; choose another name"));
    }
    if FUNCTIONS.iter().any(|(function, _)| *function == name) {
        return Some(format!("'{name}' is a function: write {name}(...)"));
    }
    let without_number =
        |prefix: &str| name.strip_prefix(prefix).is_some_and(|rest| rest.chars().all(|c| c.is_ascii_digit()));
    PREFIXES.into_iter().find(|(prefix, _)| without_number(prefix)).map(|(prefix, _)| {
        format!("'{name}' is no variable: write {prefix}<j> with the number j of a joint, from 1")
    })
}

struct Names<'a> {
    shapes: &'a [&'a str],
    inputs: Vec<Input>,
    constants: Vec<String>,
    used: Vec<bool>,
}

/// The place of an item in a list, to which it is added where it is new.
fn counted<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    list.iter().position(|known| *known == item).unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
}

impl Algebra for Names<'_> {
    type Value = Node;
    const OPERATORS: &'static str = "+-*/^";
    const PARTS: &'static str =
        "numbers, pi, q<j>, dq<j>, ddq<j>, load<j>, t, constants, functions, + - * / ^ and parentheses";
    const HAS_FUNCTIONS: bool = true;

    fn number(&mut self, value: f64) -> Node {
        Node::Number(value)
    }

    fn name(&mut self, name: &str, offset: usize) -> Result<Node, FormulaError> {
        if name == "pi" {
            return Ok(Node::Number(std::f64::consts::PI));
        }
        if let Some(input) = Input::of_name(name) {
            return Ok(Node::Input(counted(&mut self.inputs, input)));
        }
        if let Some(k) = self.shapes.iter().position(|shape| *shape == name) {
            self.used[k] = true;
            return Ok(Node::Shape(k));
        }
        match no_constant(name) {
            Some(why) => Err(FormulaError::new(offset, why)),
            None => Ok(Node::Constant(counted(&mut self.constants, name.to_owned()), offset)),
        }
    }

    fn call(&mut self, function: &str, offset: usize, argument: Node) -> Result<Node, FormulaError> {
        match FUNCTIONS.iter().find(|(name, _)| *name == function) {
            Some((_, known)) => Ok(Node::Call(*known, Box::new(argument))),
            None => {
                let names: Vec<&str> = FUNCTIONS.iter().map(|(name, _)| *name).collect();
                let names = names.join(", ");
                let what = format!(
                    "'{function}' is no function; there are {names}. A product is written {function}*(...)"
                );
                Err(FormulaError::new(offset, what))
            }
        }
    }

    fn negative(&mut self, operand: Node) -> Node {
        Node::Negative(Box::new(operand))
    }

    fn combined(&mut self, operator: char, both: [Node; 2], _: usize) -> Result<Node, FormulaError> {
        Ok(Node::Combined(operator, Box::new(both)))
    }
}
