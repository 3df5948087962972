//! A law that a user wrote down: the torque of a joint as a sum of terms, each a constant times a function of the motion.
//!
//! Constants that stand before a term are amplitudes and are fitted; what enters otherwise is a shape and is searched in
//! a range. A law is a value that is copied like the place that it is at: laws are few, and each is kept once for the
//! length of the program.

mod expression;
mod linear;
mod range;
mod saved;

use super::quantity::Parameter;
use super::shape::ShapeSearch;
use super::variable::Variable;
use crate::model::{JointNumber, Robot};
use dynid_description::formula::FormulaError;
use expression::{At, Input, Node, Quantity, read};
use range::{Range, ranges};
use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};
use std::sync::{Mutex, PoisonError};

/// Longest id.
const LONGEST_ID: usize = 40;

/// What is wrong with a law.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {message}")]
pub struct LawError {
    /// `id`, `law` or `shapes`.
    pub field: &'static str,
    /// Characters from the start of the field's text, where it is the law's.
    pub offset: usize,
    /// What was found and what was expected.
    pub message: String,
}

/// Everything that a law is.
struct Definition {
    id: String,
    /// 0-based.
    joint: usize,
    text: String,
    shapes: Vec<Range>,
    inputs: Vec<Input>,
    constants: Vec<String>,
    /// What stands before each constant.
    coefficients: Vec<Node>,
}

/// A law that a user wrote down, on a joint.
///
/// ```
/// use dynid_runtime::effects::UserLaw;
///
/// let shapes = [("p".to_owned(), [0.3, 3.0])].into();
/// let law = UserLaw::new("sag", 1, "k*abs(dq2)^p*sign(dq2)", &shapes)?;
/// assert_eq!(law.constants().collect::<Vec<_>>(), ["k"]);
/// assert!(UserLaw::new("sag", 1, "k*abs(dq2)^p*sign(dq2)", &Default::default()).is_err());
/// # Ok::<(), dynid_runtime::effects::LawError>(())
/// ```
#[derive(Clone, Copy)]
pub struct UserLaw(&'static Definition);

/// Laws are the same where all of their text is.
static KNOWN: Mutex<Vec<&'static Definition>> = Mutex::new(Vec::new());

impl UserLaw {
    /// Most constants that are fitted.
    pub const MOST_CONSTANTS: usize = 8;
    /// Most different variables.
    pub const MOST_VARIABLES: usize = 32;

    /// As [`Self::new`], under any name.
    pub(super) fn under_any_name(
        id: &str,
        joint: usize,
        text: &str,
        shapes: &BTreeMap<String, [f64; 2]>,
    ) -> Result<Self, LawError> {
        check_id(id)?;
        let ranges = ranges(shapes)?;
        let of_text = |e: FormulaError| LawError { field: "law", offset: e.offset, message: e.message };
        let names: Vec<&str> = ranges.iter().map(|r| r.name.as_str()).collect();
        let read = read(text, &names).map_err(of_text)?;
        if let Some(k) = read.used.iter().position(|used| !used) {
            return wrong("shapes", format!("'{}' is not in the law", names[k]));
        }
        let coefficients = linear::coefficients(&read).map_err(of_text)?;
        let [constants, variables] = [Self::MOST_CONSTANTS, Self::MOST_VARIABLES];
        if coefficients.len() > constants || read.inputs.len() > variables {
            let most = format!("{constants} constants or {variables} variables");
            return wrong("law", format!("more than {most}; make two laws of it"));
        }
        Ok(Self::kept(Definition {
            id: id.to_owned(),
            joint,
            text: text.to_owned(),
            shapes: ranges,
            inputs: read.inputs,
            constants: read.constants,
            coefficients,
        }))
    }

    /// The one with this text.
    fn kept(new: Definition) -> Self {
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |old: &Definition| {
            (&old.id, old.joint, &old.text, &old.shapes) == (&new.id, new.joint, &new.text, &new.shapes)
        };
        if let Some(old) = known.iter().find(|old| same(old)) {
            return Self(old);
        }
        let new: &'static Definition = Box::leak(Box::new(new));
        known.push(new);
        Self(new)
    }

    /// Its name in the JSON.
    pub fn id(self) -> &'static str {
        &self.0.id
    }

    /// The joint (0-based) whose torque it is.
    pub fn joint(self) -> usize {
        self.0.joint
    }

    /// The law as it was written.
    pub fn text(self) -> &'static str {
        &self.0.text
    }

    /// The law with the text of a number in the place of each name that `number` knows.
    pub fn with_numbers(self, number: impl Fn(&str) -> Option<String>) -> String {
        let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let (mut out, mut rest) = (String::new(), self.text());
        while let Some(first) = rest.chars().next() {
            let of_name = |c: &char| is_of_name(*c) || is_of_name(first) && *c == '.';
            let length = rest.chars().take_while(of_name).map(char::len_utf8).sum::<usize>();
            let (word, after) = rest.split_at(length.max(first.len_utf8()));
            out.push_str(&number(word).unwrap_or_else(|| word.to_owned()));
            rest = after;
        }
        out
    }

    /// The constants that are fitted, in the order of the text: one column each.
    pub fn constants(self) -> impl ExactSizeIterator<Item = &'static str> {
        self.0.constants.iter().map(String::as_str)
    }

    /// Names of the shapes, in the order of a term's shape.
    pub fn shapes(self) -> impl ExactSizeIterator<Item = &'static str> {
        self.0.shapes.iter().map(|r| r.name.as_str())
    }

    /// Its variables as they are written: `q4`, `t`.
    pub fn inputs(self) -> Vec<String> {
        self.0.inputs.iter().map(|input| input.name()).collect()
    }

    /// The same in a robot; the name of the first variable of a joint that the robot does not have.
    ///
    /// # Errors
    /// That name.
    pub fn variables(self, robot: &Robot) -> Result<Vec<Variable>, String> {
        let of = |input: &Input| {
            let joint = || {
                let j = robot.joint_index(JointNumber(input.number));
                j.map(|j| j.0).ok_or_else(|| input.name())
            };
            Ok(match input.quantity {
                Quantity::Position => Variable::Position(joint()?),
                Quantity::Speed => Variable::Speed(joint()?),
                Quantity::Acceleration => Variable::Acceleration(joint()?),
                Quantity::Load => Variable::Load(joint()?),
                Quantity::Time => Variable::Time,
            })
        };
        self.0.inputs.iter().map(of).collect()
    }

    /// Whether it looks at the time in the motion.
    pub fn is_of_time(self) -> bool {
        self.0.inputs.iter().any(|input| input.quantity == Quantity::Time)
    }

    /// Whether it looks at an acceleration, which a plant only knows once its torques are.
    pub fn is_of_acceleration(self) -> bool {
        self.0.inputs.iter().any(|input| input.quantity == Quantity::Acceleration)
    }

    /// Whether it has the sign of one of its variables.
    pub fn has_sign_of(self, variable: usize) -> bool {
        self.0.coefficients.iter().any(|c| c.has_sign_of(variable))
    }

    /// What stands before each constant, at these values of the variables. `direction` is a variable whose sign is given,
    /// and that sign.
    pub fn columns(self, variables: &[f64], shape: &[f64], direction: Option<(usize, f64)>, out: &mut [f64]) {
        let at = At { inputs: variables, shape, direction };
        for (out, coefficient) in out.iter_mut().zip(&self.0.coefficients) {
            *out = coefficient.value(&at);
        }
    }

    /// Shapes to try: every combination of values over the ranges.
    pub fn grid(self) -> Vec<Vec<f64>> {
        range::grid(&self.0.shapes)
    }

    /// How shapes between those of the grid are searched: within the ranges.
    pub fn shape_search(self) -> ShapeSearch {
        range::shape_search(&self.0.shapes)
    }

    /// Whether a shape is one that the law may have.
    pub fn has_shape(self, shape: &[f64]) -> bool {
        range::hold(&self.0.shapes, shape)
    }

    /// Its constants and shapes with what they were found to be. The unit of a constant is that of the torque (`unit`)
    /// where what it stands before is a pure number, and follows from the law otherwise.
    pub fn parameters(
        self,
        [amplitude, sigma]: [&[f64]; 2],
        [shape, shape_sigma]: [&[f64]; 2],
        unit: &str,
    ) -> Vec<Parameter> {
        let constants = self.constants().zip(&self.0.coefficients).zip(amplitude.iter().zip(sigma));
        let constants = constants.map(|((name, coefficient), (a, s))| {
            Parameter::new(name, *a, *s, if coefficient.is_pure() { unit } else { "SI" })
        });
        let shapes = self.shapes().zip(shape.iter().zip(shape_sigma));
        constants.chain(shapes.map(|(name, (x, s))| Parameter::new(name, *x, *s, "SI"))).collect()
    }
}

fn wrong<T>(field: &'static str, message: String) -> Result<T, LawError> {
    Err(LawError { field, offset: 0, message })
}

fn check_id(id: &str) -> Result<(), LawError> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if id.is_empty() || id.len() > LONGEST_ID || !id.chars().all(plain) {
        let what =
            format!("expected lower-case letters, digits and underscores, at most {LONGEST_ID}, as magnet_2");
        return wrong("id", what);
    }
    Ok(())
}

impl PartialEq for UserLaw {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for UserLaw {}

impl Hash for UserLaw {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (&self.0.id, self.0.joint).hash(state);
    }
}

impl std::fmt::Debug for UserLaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} on {}: {}", self.0.id, self.0.joint, self.0.text)
    }
}

#[cfg(test)]
mod tests;
