//! Reading the expressions of a table: numbers, pi, `q<j>`, constants, + - * / and parentheses.

use super::expression::Expression;
use dynid_description::formula::{Algebra, FormulaError, parse};

/// An expression that may have joint variables added to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Formula {
    /// Joint variables: number j, coefficient, and position in the text.
    pub variables: Vec<(usize, f64, usize)>,
    /// Everything else; `None` where there is nothing else.
    pub constant: Option<Expression>,
}

/// Reads an expression. `constants` are the names that it may use.
pub(super) fn parse_formula(text: &str, constants: &[(String, f64)]) -> Result<Formula, FormulaError> {
    let formula = parse(text, &mut Table { constants })?;
    if let Some(constant) = &formula.constant {
        let value = constant.value();
        if !value.is_finite() {
            return error(0, format!("'{text}' is not finite ({value})"));
        }
    }
    Ok(formula)
}

fn error<T>(offset: usize, message: impl Into<String>) -> Result<T, FormulaError> {
    Err(FormulaError::new(offset, message))
}

/// The j of `q<j>`.
pub(super) fn joint_variable(name: &str) -> Option<usize> {
    dynid_description::formula::joint_variable(name, "q")
}

/// What a table cannot say.
pub(super) const NO_SOLVER: &str = "an angle or a length is a sum of joint variables with constant coefficients; a loop \
    whose angles are no such sum, as of four bars that are no parallelogram, needs a numerical solver, which dynid has not";

/// Names of functions that the angles of a general loop would need.
const FUNCTIONS: [&str; 9] = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "hypot"];

/// What expressions of a table mean.
struct Table<'a> {
    constants: &'a [(String, f64)],
}

impl Algebra for Table<'_> {
    type Value = Formula;
    const OPERATORS: &'static str = "+-*/";
    const PARTS: &'static str = "numbers, pi, q<j>, constants, + - * / and parentheses";
    const HAS_FUNCTIONS: bool = false;

    fn number(&mut self, value: f64) -> Formula {
        only(Expression::Number(value))
    }

    fn name(&mut self, name: &str, offset: usize) -> Result<Formula, FormulaError> {
        if name == "pi" {
            return Ok(only(Expression::Pi));
        }
        if let Some(j) = joint_variable(name) {
            return Ok(Formula { variables: vec![(j, 1.0, offset)], constant: None });
        }
        match self.constants.iter().find(|(known, _)| known == name) {
            Some((_, value)) => Ok(only(Expression::Constant(name.to_owned(), *value))),
            None => error(offset, self.unknown(name)),
        }
    }

    fn call(&mut self, function: &str, offset: usize, _: Formula) -> Result<Formula, FormulaError> {
        error(offset, self.unknown(function))
    }

    fn negative(&mut self, mut operand: Formula) -> Formula {
        operand.variables.iter_mut().for_each(|v| v.1 = -v.1);
        operand.constant = operand.constant.map(negative);
        operand
    }

    fn combined(
        &mut self,
        operator: char,
        [left, right]: [Formula; 2],
        offset: usize,
    ) -> Result<Formula, FormulaError> {
        match operator {
            '+' | '-' => Ok(sum(left, right, operator)),
            _ => product(left, right, operator, offset),
        }
    }
}

impl Table<'_> {
    fn unknown(&self, name: &str) -> String {
        let word = name.trim_start_matches('.').to_ascii_lowercase();
        if ["nan", "inf", "infinity"].contains(&word.as_str()) {
            return format!("'{name}' is not a finite number");
        }
        if FUNCTIONS.contains(&word.as_str()) {
            return format!("'{name}' is a function: {NO_SOLVER}");
        }
        let known = self.constants.iter().map(|(known, _)| known.as_str()).chain(["pi"]);
        let names = known.collect::<Vec<_>>().join(", ");
        format!("unknown constant '{name}': expected a number, q<j> or one of {names}")
    }
}

fn only(constant: Expression) -> Formula {
    Formula { variables: Vec::new(), constant: Some(constant) }
}

fn sum(mut left: Formula, mut right: Formula, operator: char) -> Formula {
    if operator == '-' {
        right.variables.iter_mut().for_each(|v| v.1 = -v.1);
    }
    left.variables.append(&mut right.variables);
    left.constant = match (left.constant, right.constant, operator) {
        (a, None, _) => a,
        (None, b, '+') => b,
        (None, Some(b), _) => Some(negative(b)),
        (Some(a), Some(b), '+') => Some(Expression::Add(Box::new(a), Box::new(b))),
        (Some(a), Some(b), _) => Some(Expression::Sub(Box::new(a), Box::new(b))),
    };
    left
}

/// `offset` is where the right side starts.
fn product(left: Formula, right: Formula, operator: char, offset: usize) -> Result<Formula, FormulaError> {
    if let Some(&(j, _, at)) = right.variables.first()
        && (operator == '/' || !left.variables.is_empty())
    {
        return error(at, format!("q{j} may only be added, or multiplied by a number: {NO_SOLVER}"));
    }
    let (mut moving, factor) = if right.variables.is_empty() { (left, right) } else { (right, left) };
    let factor = factor.constant.unwrap_or(Expression::ZERO);
    let value = factor.value();
    if operator == '/' && value == 0.0 {
        return error(offset, format!("division by zero: {factor} is 0"));
    }
    for variable in &mut moving.variables {
        variable.1 = if operator == '*' { variable.1 * value } else { variable.1 / value };
    }
    let variable_only = !moving.variables.is_empty() && moving.constant.is_none();
    if !variable_only {
        let a = Box::new(moving.constant.unwrap_or(Expression::ZERO));
        let b = Box::new(factor);
        moving.constant = Some(if operator == '*' { Expression::Mul(a, b) } else { Expression::Div(a, b) });
    }
    Ok(moving)
}

fn negative(operand: Expression) -> Expression {
    match operand {
        Expression::Number(value) if value > 0.0 => Expression::Number(-value),
        other => Expression::Neg(Box::new(other)),
    }
}
