//! Sums and products of a graph, simplified as they are built.

use super::expr::{Expr, Node};
use super::graph::Graph;

impl Graph {
    /// The expression as coefficient * rest.
    fn split_coefficient(&self, e: Expr) -> (f64, Expr) {
        let sign = if e.is_negative() { -1.0 } else { 1.0 };
        match self.node(e.node()) {
            Node::Product(first, rest) => match self.constant_value(first) {
                Some(value) => (sign * value, rest),
                None => (sign, e.magnitude()),
            },
            _ => (sign, e.magnitude()),
        }
    }

    /// Sum.
    pub fn add(&mut self, a: Expr, b: Expr) -> Expr {
        if a == Graph::ZERO {
            return b;
        }
        if b == Graph::ZERO {
            return a;
        }
        if let (Some(x), Some(y)) = (self.constant_value(a), self.constant_value(b)) {
            return self.constant(sum_of_constants(x, y));
        }
        let (ca, ra) = self.split_coefficient(a);
        let (cb, rb) = self.split_coefficient(b);
        if ra == rb {
            return self.scale(sum_of_constants(ca, cb), ra);
        }
        if let Some(simple) = self.like_products(a, b) {
            return simple;
        }
        if let Some(simple) = self.cancelled(a, b).or_else(|| self.cancelled(b, a)) {
            return simple;
        }
        if let Some(simple) = self.pythagoras(a, b) {
            return simple;
        }
        let (first, second) = if a.node() < b.node() { (a, b) } else { (b, a) };
        let negative = first.is_negative();
        self.intern(Node::Sum(first.magnitude(), second.signed(negative))).signed(negative)
    }

    /// (x * y) * z and x * (y * z) are like terms however they were put together.
    fn like_products(&mut self, a: Expr, b: Expr) -> Option<Expr> {
        let is_product = |e: Expr| matches!(self.node(e.node()), Node::Product(..));
        if !is_product(a) || !is_product(b) {
            return None;
        }
        let ((ca, fa), (cb, fb)) = (self.monomial(a), self.monomial(b));
        if fa != fb {
            return None;
        }
        let rest = self.split_coefficient(a).1;
        let inner = self.monomial(rest).0;
        Some(self.scale(sum_of_constants(ca, cb) / inner, rest))
    }

    /// Constant and other factors of nested products, the factors ascending.
    fn monomial(&self, e: Expr) -> (f64, Vec<Expr>) {
        let mut coefficient = if e.is_negative() { -1.0 } else { 1.0 };
        let mut factors = self.factors(e);
        factors.retain(|&f| match self.constant_value(f) {
            Some(value) => {
                coefficient *= value;
                false
            }
            None => true,
        });
        (coefficient, factors)
    }

    /// (x + y) - x = y.
    fn cancelled(&self, sum: Expr, other: Expr) -> Option<Expr> {
        let Node::Sum(x, y) = self.node(sum.node()) else { return None };
        let (x, y) = (x.signed(sum.is_negative()), y.signed(sum.is_negative()));
        if x == -other {
            Some(y)
        } else if y == -other {
            Some(x)
        } else {
            None
        }
    }

    /// s*s*x + c*c*x = x, for a common rest x.
    fn pythagoras(&mut self, a: Expr, b: Expr) -> Option<Expr> {
        if a.is_negative() != b.is_negative() {
            return None;
        }
        let fa = self.factors(a.magnitude());
        let fb = self.factors(b.magnitude());
        if fa.len() != fb.len() || fa.len() < 2 {
            return None;
        }
        let (only_a, only_b) = (difference(&fa, &fb), difference(&fb, &fa));
        let (&[s, s2], &[c, c2]) = (&only_a[..], &only_b[..]) else { return None };
        if s != s2 || c != c2 {
            return None;
        }
        match (self.node(s.node()), self.node(c.node())) {
            (Node::Sine(x), Node::Cosine(y)) | (Node::Cosine(x), Node::Sine(y)) if x == y => {
                let rest = difference(&fa, &only_a);
                let product = self.product(&rest);
                Some(product.signed(a.is_negative()))
            }
            _ => None,
        }
    }

    /// The factors of nested products, ascending.
    pub fn factors(&self, e: Expr) -> Vec<Expr> {
        let mut pending = vec![e.magnitude()];
        let mut factors = Vec::new();
        while let Some(e) = pending.pop() {
            match self.node(e.node()) {
                Node::Product(a, b) => pending.extend([a, b]),
                _ => factors.push(e),
            }
        }
        factors.sort();
        factors
    }

    /// Difference.
    pub fn sub(&mut self, a: Expr, b: Expr) -> Expr {
        self.add(a, -b)
    }

    /// value * e.
    pub fn scale(&mut self, value: f64, e: Expr) -> Expr {
        let value = self.constant(value);
        self.mul(value, e)
    }

    /// Product.
    pub fn mul(&mut self, a: Expr, b: Expr) -> Expr {
        let negative = a.is_negative() != b.is_negative();
        let (a, b) = (a.magnitude(), b.magnitude());
        if a == Graph::ZERO || b == Graph::ZERO {
            return Graph::ZERO;
        }
        if a == Graph::ONE {
            return b.signed(negative);
        }
        if b == Graph::ONE {
            return a.signed(negative);
        }
        let (va, vb) = (self.constant_value(a), self.constant_value(b));
        let product = match (va, vb) {
            (Some(x), Some(y)) => self.constant(x * y),
            (Some(x), None) => self.scaled(x, a, b),
            (None, Some(y)) => self.scaled(y, b, a),
            (None, None) => self.intern(Node::Product(a.min(b), a.max(b))),
        };
        product.signed(negative)
    }

    /// constant * e with a constant factor of e folded in.
    fn scaled(&mut self, value: f64, constant: Expr, e: Expr) -> Expr {
        let (inner, rest) = self.split_coefficient(e);
        if inner == 1.0 {
            return self.intern(Node::Product(constant, e));
        }
        self.scale(value * inner, rest)
    }

    /// Sum of several terms, left to right.
    pub fn sum(&mut self, terms: &[Expr]) -> Expr {
        terms.iter().fold(Graph::ZERO, |total, &term| self.add(total, term))
    }

    /// Product of several factors, left to right.
    pub fn product(&mut self, factors: &[Expr]) -> Expr {
        factors.iter().fold(Graph::ONE, |total, &factor| self.mul(total, factor))
    }
}

/// Sum; what two numbers that cancel leave of their rounding errors is zero.
fn sum_of_constants(x: f64, y: f64) -> f64 {
    let sum = x + y;
    if sum.abs() <= 4.0 * f64::EPSILON * x.abs().max(y.abs()) { 0.0 } else { sum }
}

/// Members of `a` (sorted) that are not in `b` (sorted), counted with multiplicity.
fn difference(a: &[Expr], b: &[Expr]) -> Vec<Expr> {
    let mut rest = b.to_vec();
    a.iter()
        .copied()
        .filter(|e| match rest.iter().position(|x| x == e) {
            Some(at) => {
                rest.remove(at);
                false
            }
            None => true,
        })
        .collect()
}
