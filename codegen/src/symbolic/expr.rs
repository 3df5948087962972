//! What a graph is made of: inputs, nodes, and nodes with a sign.

use std::ops::Neg;

/// An input of the generated functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Symbol {
    /// q of a joint.
    Position(usize),
    /// Its first time derivative.
    Velocity(usize),
    /// Its second time derivative.
    Acceleration(usize),
    /// A base parameter chi_k.
    Parameter(usize),
}

/// A node with a sign. Signs live on the edges, so that x and -x share one node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Expr(u32);

impl Expr {
    /// 0.
    pub const ZERO: Expr = Expr(0);
    /// 1.
    pub const ONE: Expr = Expr(2);

    /// A node by its index, with a sign.
    pub fn new(node: usize, negative: bool) -> Self {
        Expr(((node as u32) << 1) | u32::from(negative))
    }

    /// Index of the node; operands have smaller indices than what is built from them.
    pub fn node(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether the node is taken with a minus.
    pub fn is_negative(self) -> bool {
        self.0 & 1 == 1
    }

    /// The node without its sign.
    pub fn magnitude(self) -> Self {
        Expr(self.0 & !1)
    }

    pub(super) fn signed(self, negative: bool) -> Self {
        if negative { -self } else { self }
    }
}

impl Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        // Zero has one sign only.
        if self == Self::ZERO { self } else { Expr(self.0 ^ 1) }
    }
}

/// What a node is. Constants are not negative, factors have no sign, the first term of a sum has none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant, as the bits of a non-negative f64.
    Constant(u64),
    /// An input.
    Symbol(Symbol),
    /// Sine of an angle of the graph.
    Sine(usize),
    /// Cosine of an angle of the graph.
    Cosine(usize),
    /// -1, 0 or 1.
    Sign(Expr),
    /// 1 / sqrt(x), 0 where x is not above 0.
    InverseRoot(Expr),
    /// first + second.
    Sum(Expr, Expr),
    /// first * second; a constant factor comes first.
    Product(Expr, Expr),
}
