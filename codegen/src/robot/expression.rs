//! Expressions over numbers, pi and the robot's constants.

use std::f64::consts::FRAC_PI_4;
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

/// A multiple of pi/4 that is meant to be one, rad: the rounding of an expression.
const EXACT: f64 = 1e-12;
/// An angle this close to a multiple of pi/4 without being one gets a warning, rad.
const NEAR: f64 = 1e-4;
/// The coarsest rounding that is taken for one, rad: 1.57 and 3.14, but not 0.79.
const COARSEST: f64 = 2e-3;

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

    /// A number in the expression that is a multiple of pi/4 rounded to the digits it is written with, or the value of
    /// the whole within 1e-4 rad of one without being it; with the multiple, both without sign.
    pub(super) fn rounded_multiple(&self) -> Option<(f64, i64)> {
        let multiple = |x: f64, within: f64| {
            let eighths = (x.abs() / FRAC_PI_4).round();
            let distance = (x.abs() - eighths * FRAC_PI_4).abs();
            (eighths > 0.0 && distance > EXACT && distance <= within).then_some((x.abs(), eighths as i64))
        };
        let number = |x: f64| {
            let text = x.abs().to_string();
            let decimals = text.split_once('.').map_or(0, |(_, after)| after.len());
            multiple(x, (0.5 * 10_f64.powi(-(decimals as i32))).min(COARSEST))
        };
        let inside = match self {
            Expression::Number(x) | Expression::Constant(_, x) => number(*x),
            Expression::Pi => None,
            Expression::Neg(a) => a.rounded_multiple(),
            Expression::Add(a, b) | Expression::Sub(a, b) => {
                a.rounded_multiple().or_else(|| b.rounded_multiple())
            }
            // A factor is no angle.
            Expression::Mul(..) | Expression::Div(..) => None,
        };
        inside.or_else(|| multiple(self.value(), NEAR))
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
