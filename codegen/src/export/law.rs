//! A law as a tree that both languages print.

use crate::emit::Binding;
use dynid_description::formula::{Algebra, FormulaError, joint_variable, parse};

/// A variable of a joint: an array and the joint's place in it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Input {
    /// `q`, `dq`, `ddq` or `load`.
    pub array: &'static str,
    /// 0-based.
    pub joint: usize,
    /// As it is written: `q4`.
    pub name: String,
}

/// The formula of a law.
#[derive(Debug, Clone, PartialEq)]
pub enum LawFormula {
    /// A number.
    Number(f64),
    /// A variable.
    Input(Input),
    /// Minus a value.
    Negative(Box<LawFormula>),
    /// Two values with one of `+-*/^` between them.
    Combined(char, Box<[LawFormula; 2]>),
    /// A function, as an index into [`FUNCTIONS`].
    Call(usize, Box<LawFormula>),
}

/// The functions of a law: their names in a law, in C, in Rust.
pub const FUNCTIONS: [[&str; 3]; 9] = [
    ["sin", "sin", "sin"],
    ["cos", "cos", "cos"],
    ["tan", "tan", "tan"],
    ["tanh", "tanh", "tanh"],
    ["exp", "exp", "exp"],
    ["ln", "log", "ln"],
    ["abs", "fabs", "abs"],
    ["sqrt", "sqrt", "sqrt"],
    ["sign", "sign", "sign"],
];

/// Prefixes of variables; the longer ones first.
const ARRAYS: [&str; 4] = ["ddq", "dq", "load", "q"];

/// Reads a law of a robot whose joints have these numbers.
///
/// # Errors
/// What is wrong with it, and where.
pub fn read(text: &str, numbers: &[usize]) -> Result<LawFormula, FormulaError> {
    parse(text, &mut Names { numbers })
}

impl LawFormula {
    /// Every variable, as often as it is there.
    pub fn inputs(&self) -> Box<dyn Iterator<Item = &Input> + '_> {
        match self {
            LawFormula::Number(_) => Box::new(std::iter::empty()),
            LawFormula::Input(input) => Box::new(std::iter::once(input)),
            LawFormula::Negative(a) | LawFormula::Call(_, a) => a.inputs(),
            LawFormula::Combined(_, both) => Box::new(both.iter().flat_map(|a| a.inputs())),
        }
    }

    /// How tightly its outermost operator binds.
    pub fn binding(&self) -> Binding {
        match self {
            LawFormula::Combined('+' | '-', _) => Binding::Sum,
            LawFormula::Combined('*' | '/', _) => Binding::Product,
            LawFormula::Negative(_) => Binding::Sign,
            LawFormula::Number(_)
            | LawFormula::Input(_)
            | LawFormula::Combined(..)
            | LawFormula::Call(..) => Binding::Atom,
        }
    }

    /// How tightly the operands of the operator must bind to stand without parentheses.
    pub fn operands(operator: char) -> [Binding; 2] {
        match operator {
            '+' | '-' => [Binding::Sum, Binding::Product],
            _ => [Binding::Product, Binding::Sign],
        }
    }

    /// Names in Rust of its functions beyond sign, sine and cosine; `powf` is one.
    pub fn functions(&self) -> Vec<&'static str> {
        match self {
            LawFormula::Number(_) | LawFormula::Input(_) => Vec::new(),
            LawFormula::Negative(a) => a.functions(),
            LawFormula::Call(k, a) => {
                let own = Some(FUNCTIONS[*k][2]).filter(|name| !["sign", "sin", "cos"].contains(name));
                own.into_iter().chain(a.functions()).collect()
            }
            LawFormula::Combined(operator, both) => {
                let own = (*operator == '^').then_some("powf");
                own.into_iter().chain(both.iter().flat_map(LawFormula::functions)).collect()
            }
        }
    }
}

struct Names<'a> {
    numbers: &'a [usize],
}

impl Algebra for Names<'_> {
    type Value = LawFormula;
    const OPERATORS: &'static str = "+-*/^";
    const PARTS: &'static str =
        "numbers, pi, q<j>, dq<j>, ddq<j>, load<j>, functions, + - * / ^ and parentheses";
    const HAS_FUNCTIONS: bool = true;

    fn number(&mut self, value: f64) -> LawFormula {
        LawFormula::Number(value)
    }

    fn name(&mut self, name: &str, offset: usize) -> Result<LawFormula, FormulaError> {
        if name == "pi" {
            return Ok(LawFormula::Number(std::f64::consts::PI));
        }
        for array in ARRAYS {
            let joint = joint_variable(name, array)
                .and_then(|number| self.numbers.iter().position(|&known| known == number));
            if let Some(joint) = joint {
                return Ok(LawFormula::Input(Input { array, joint, name: name.to_owned() }));
            }
        }
        Err(FormulaError::new(offset, format!("'{name}' is no variable of a joint")))
    }

    fn call(
        &mut self,
        function: &str,
        offset: usize,
        argument: LawFormula,
    ) -> Result<LawFormula, FormulaError> {
        match FUNCTIONS.iter().position(|names| names[0] == function) {
            Some(k) => Ok(LawFormula::Call(k, Box::new(argument))),
            None => Err(FormulaError::new(offset, format!("'{function}' is no function"))),
        }
    }

    fn negative(&mut self, operand: LawFormula) -> LawFormula {
        LawFormula::Negative(Box::new(operand))
    }

    fn combined(
        &mut self,
        operator: char,
        both: [LawFormula; 2],
        _: usize,
    ) -> Result<LawFormula, FormulaError> {
        Ok(LawFormula::Combined(operator, Box::new(both)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn variables_are_of_the_joints_numbers() {
        let law = read("0.5*ln(dq3)^2 - load1", &[1, 3]).unwrap();
        let inputs: Vec<(&str, usize)> = law.inputs().map(|i| (i.array, i.joint)).collect();
        assert_eq!(inputs, [("dq", 1), ("load", 0)]);
        assert_eq!(law.functions(), ["powf", "ln"]);
        assert!(read("q2", &[1, 3]).unwrap_err().message.contains("q2"));
        assert!(read("t", &[1, 3]).is_err());
    }
}
