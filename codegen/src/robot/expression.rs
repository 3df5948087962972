//! Expressions over numbers, pi and the robot's constants.

use std::fmt;

/// A constant expression of the table, as written.
#[derive(Debug, Clone, PartialEq)]
pub enum Expression {
    /// A decimal number.
    Number(f64),
    /// pi.
    Pi,
    /// A named constant of the robot, with its value.
    Constant(String, f64),
    /// Minus the operand.
    Neg(Box<Expression>),
    /// Sum.
    Add(Box<Expression>, Box<Expression>),
    /// Difference.
    Sub(Box<Expression>, Box<Expression>),
    /// Product.
    Mul(Box<Expression>, Box<Expression>),
    /// Quotient.
    Div(Box<Expression>, Box<Expression>),
}

impl Expression {
    /// The number 0, which stands for every entry of the table that is not there.
    pub const ZERO: Expression = Expression::Number(0.0);

    /// What the expression comes to. A parsed expression is finite.
    pub fn value(&self) -> f64 {
        match self {
            Expression::Number(x) | Expression::Constant(_, x) => *x,
            Expression::Pi => std::f64::consts::PI,
            Expression::Neg(a) => -a.value(),
            Expression::Add(a, b) => a.value() + b.value(),
            Expression::Sub(a, b) => a.value() - b.value(),
            Expression::Mul(a, b) => a.value() * b.value(),
            Expression::Div(a, b) => a.value() / b.value(),
        }
    }

    /// How tightly the outermost operator binds: 1 sum, 2 product, 3 sign, 4 nothing to bind.
    fn precedence(&self) -> u8 {
        match self {
            Expression::Add(..) | Expression::Sub(..) => 1,
            Expression::Mul(..) | Expression::Div(..) => 2,
            Expression::Neg(_) => 3,
            Expression::Number(x) if x.is_sign_negative() => 3,
            Expression::Number(_) | Expression::Pi | Expression::Constant(..) => 4,
        }
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, at_least: u8) -> fmt::Result {
        if self.precedence() < at_least {
            f.write_str("(")?;
            self.write(f, 0)?;
            return f.write_str(")");
        }
        let binary = |f: &mut fmt::Formatter<'_>, a: &Expression, op: &str, b: &Expression, left, right| {
            a.write(f, left)?;
            f.write_str(op)?;
            b.write(f, right)
        };
        match self {
            Expression::Number(x) if *x == 0.0 || (1e-6..1e9).contains(&x.abs()) => write!(f, "{x}"),
            Expression::Number(x) => write!(f, "{x:e}"),
            Expression::Pi => f.write_str("pi"),
            Expression::Constant(name, _) => f.write_str(name),
            Expression::Neg(a) => {
                f.write_str("-")?;
                a.write(f, 4)
            }
            Expression::Add(a, b) => binary(f, a, " + ", b, 1, 2),
            Expression::Sub(a, b) => binary(f, a, " - ", b, 1, 2),
            Expression::Mul(a, b) => binary(f, a, "*", b, 2, 3),
            Expression::Div(a, b) => binary(f, a, "/", b, 2, 3),
        }
    }
}

/// As a person would write it in the table: `q2` apart, `-pi/2`, `2*(d3 + 0.1)`.
impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, 0)
    }
}
