//! Reading expressions: numbers, names, operators, parentheses and functions. What they mean is said by an [`Algebra`]:
//! the entries of a robot's table and a user's laws are read by the same parser.

mod error;
mod tokens;

use error::error;
use tokens::{Token, tokenize};

pub use error::FormulaError;

/// What the parts of an expression mean.
pub trait Algebra {
    /// What an expression comes to.
    type Value;
    /// Its operators, of `+-*/^`.
    const OPERATORS: &'static str;
    /// What an expression has, for messages.
    const PARTS: &'static str;
    /// Whether a name before a parenthesis is a function.
    const HAS_FUNCTIONS: bool;

    /// A number.
    fn number(&mut self, value: f64) -> Self::Value;

    /// A name at `offset` characters.
    ///
    /// # Errors
    /// A name that means nothing.
    fn name(&mut self, name: &str, offset: usize) -> Result<Self::Value, FormulaError>;

    /// A function of an argument.
    ///
    /// # Errors
    /// A name that is no function.
    fn call(
        &mut self,
        function: &str,
        offset: usize,
        argument: Self::Value,
    ) -> Result<Self::Value, FormulaError>;

    /// Minus a value.
    fn negative(&mut self, operand: Self::Value) -> Self::Value;

    /// Two values with an operator between them; the second one starts at `offset`.
    ///
    /// # Errors
    /// Values that do not go together like this.
    fn combined(
        &mut self,
        operator: char,
        both: [Self::Value; 2],
        offset: usize,
    ) -> Result<Self::Value, FormulaError>;
}

/// Reads an expression. Powers bind tighter than a sign in front and are read from the right, as is usual.
///
/// # Errors
/// The first thing in the text that is wrong.
pub fn parse<A: Algebra>(text: &str, algebra: &mut A) -> Result<A::Value, FormulaError> {
    let tokens = tokenize(text, A::OPERATORS, A::PARTS)?;
    let mut parser = Parser { tokens: &tokens, next: 0, end: text.chars().count(), algebra };
    let value = parser.sum()?;
    match parser.tokens.get(parser.next) {
        None => Ok(value),
        Some((Token::Symbol(')'), offset)) => error(*offset, "')' without its '('"),
        Some((_, offset)) => {
            let operators: Vec<String> = A::OPERATORS.chars().map(String::from).collect();
            error(*offset, format!("expected an operator ({}) before this", operators.join(" ")))
        }
    }
}

/// The j of `<prefix><j>`: a joint's number as the table counts it, from 1.
pub fn joint_variable(name: &str, prefix: &str) -> Option<usize> {
    let digits = name.strip_prefix(prefix)?;
    if digits.is_empty() || digits.starts_with('0') || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    digits.parse().ok()
}

struct Parser<'a, A> {
    tokens: &'a [(Token, usize)],
    next: usize,
    end: usize,
    algebra: &'a mut A,
}

impl<A: Algebra> Parser<'_, A> {
    fn offset(&self) -> usize {
        self.tokens.get(self.next).map_or(self.end, |&(_, offset)| offset)
    }

    /// Takes the next token if it is one of the symbols.
    fn accept(&mut self, symbols: &str) -> Option<char> {
        match self.tokens.get(self.next) {
            Some((Token::Symbol(c), _)) if symbols.contains(*c) => {
                self.next += 1;
                Some(*c)
            }
            _ => None,
        }
    }

    fn sum(&mut self) -> Result<A::Value, FormulaError> {
        let mut left = self.product()?;
        while let Some(operator) = self.accept("+-") {
            let at = self.offset();
            let right = self.product()?;
            left = self.algebra.combined(operator, [left, right], at)?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<A::Value, FormulaError> {
        let mut left = self.signed()?;
        while let Some(operator) = self.accept("*/") {
            let at = self.offset();
            let right = self.signed()?;
            left = self.algebra.combined(operator, [left, right], at)?;
        }
        Ok(left)
    }

    fn signed(&mut self) -> Result<A::Value, FormulaError> {
        match self.accept("+-") {
            Some('-') => {
                let operand = self.signed()?;
                Ok(self.algebra.negative(operand))
            }
            Some(_) => self.signed(),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Result<A::Value, FormulaError> {
        let base = self.primary()?;
        if self.accept("^").is_none() {
            return Ok(base);
        }
        let at = self.offset();
        let exponent = self.signed()?;
        self.algebra.combined('^', [base, exponent], at)
    }

    fn primary(&mut self) -> Result<A::Value, FormulaError> {
        let offset = self.offset();
        let Some((token, _)) = self.tokens.get(self.next) else {
            return error(offset, "the expression ends where a number, a name or '(' was expected");
        };
        self.next += 1;
        match token {
            Token::Number(value) => Ok(self.algebra.number(*value)),
            Token::Name(name) if A::HAS_FUNCTIONS && self.accept("(").is_some() => {
                let argument = self.closed()?;
                self.algebra.call(name, offset, argument)
            }
            Token::Name(name) => self.algebra.name(name, offset),
            Token::Symbol('(') => self.closed(),
            Token::Symbol(_) => error(offset, "expected a number, a name or '(' before this operator"),
        }
    }

    /// What stands between parentheses, the first of which has been taken.
    fn closed(&mut self) -> Result<A::Value, FormulaError> {
        let inner = self.sum()?;
        if self.accept(")").is_none() {
            return error(self.offset(), "expected ')'");
        }
        Ok(inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers, with one constant `x` and a function `twice`.
    struct Numbers;

    impl Algebra for Numbers {
        type Value = f64;
        const OPERATORS: &'static str = "+-*/^";
        const PARTS: &'static str = "numbers";
        const HAS_FUNCTIONS: bool = true;

        fn number(&mut self, value: f64) -> f64 {
            value
        }

        fn name(&mut self, name: &str, offset: usize) -> Result<f64, FormulaError> {
            if name == "x" { Ok(10.0) } else { error(offset, format!("no {name}")) }
        }

        fn call(&mut self, function: &str, offset: usize, argument: f64) -> Result<f64, FormulaError> {
            if function == "twice" {
                Ok(2.0 * argument)
            } else {
                error(offset, format!("no function {function}"))
            }
        }

        fn negative(&mut self, operand: f64) -> f64 {
            -operand
        }

        fn combined(&mut self, operator: char, [a, b]: [f64; 2], _: usize) -> Result<f64, FormulaError> {
            Ok(match operator {
                '+' => a + b,
                '-' => a - b,
                '*' => a * b,
                '/' => a / b,
                _ => a.powf(b),
            })
        }
    }

    #[test]
    fn operators_bind_as_is_usual() {
        for (text, value) in [
            ("1 - 2 - 3", -4.0),
            ("8 / 2 / 2", 2.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("2*x^2", 200.0),
            ("twice(1 + x)*3", 66.0),
            ("--1e1", 10.0),
        ] {
            assert_eq!(parse(text, &mut Numbers), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        for (text, offset, what) in [
            ("1 + ", 4, "ends where"),
            ("(1", 2, "expected ')'"),
            ("1)", 1, "without its '('"),
            ("2 x", 2, "(+ - * / ^)"),
            ("1 + 2;", 5, "';' does not belong"),
            ("twice(*1)", 6, "before this operator"),
            ("half(1)", 0, "no function half"),
            ("x + y", 4, "no y"),
        ] {
            let found = parse(text, &mut Numbers).expect_err(text);
            assert!(found.offset == offset && found.message.contains(what), "{text}: {found:?}");
        }
        let long = "1+".repeat(150);
        assert!(parse(&long, &mut Numbers).is_err_and(|e| e.message.contains("longer than")));
    }

    #[test]
    fn a_joint_variable_has_a_number_from_one() {
        assert_eq!(joint_variable("dq12", "dq"), Some(12));
        for name in ["q0", "q01", "q", "qa", "dq1"] {
            assert_eq!(joint_variable(name, "q"), None, "{name}");
        }
    }
}
