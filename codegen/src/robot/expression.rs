//! Expressions over numbers, pi and the robot's constants.

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
