//! The hash-consed graph: every expression exists once, in a canonical sign, simplified as it is built.

use super::angle::{Angle, ConstantAngle};
use std::collections::HashMap;
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
        if self == Graph::ZERO { self } else { Expr(self.0 ^ 1) }
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
    /// first + second.
    Sum(Expr, Expr),
    /// first * second; a constant factor comes first.
    Product(Expr, Expr),
}

/// The arena of all expressions.
#[derive(Debug, Clone)]
pub struct Graph {
    nodes: Vec<Node>,
    index: HashMap<Node, usize>,
    angles: Vec<Angle>,
    compose_angles: bool,
    names: HashMap<usize, String>,
    pub(super) derivatives: HashMap<usize, Expr>,
}

impl Default for Graph {
    fn default() -> Self {
        Graph::new()
    }
}

impl Graph {
    /// 0.
    pub const ZERO: Expr = Expr(0);
    /// 1.
    pub const ONE: Expr = Expr(2);

    /// A graph that holds 0 and 1.
    pub fn new() -> Self {
        let mut graph = Graph {
            nodes: Vec::new(),
            index: HashMap::new(),
            angles: Vec::new(),
            compose_angles: false,
            names: HashMap::new(),
            derivatives: HashMap::new(),
        };
        graph.intern(Node::Constant(0.0_f64.to_bits()));
        graph.intern(Node::Constant(1.0_f64.to_bits()));
        graph
    }

    /// A graph that takes the sine and cosine of a sum or difference of two angles it knows from theirs, by six
    /// operations instead of another sine and cosine.
    pub fn composing_angles() -> Self {
        Graph { compose_angles: true, ..Graph::new() }
    }

    pub(super) fn intern(&mut self, node: Node) -> Expr {
        if let Some(&at) = self.index.get(&node) {
            return Expr::new(at, false);
        }
        let at = self.nodes.len();
        self.nodes.push(node);
        self.index.insert(node, at);
        Expr::new(at, false)
    }

    /// What a node is.
    pub fn node(&self, index: usize) -> Node {
        self.nodes[index]
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// A graph always holds 0 and 1.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The angles whose sine or cosine is taken.
    pub fn angles(&self) -> &[Angle] {
        &self.angles
    }

    /// Gives a node a name for the reader of the generated code; the first name stays.
    pub fn name(&mut self, e: Expr, name: &str) {
        if matches!(self.nodes[e.node()], Node::Sum(..) | Node::Product(..)) {
            self.names.entry(e.node()).or_insert_with(|| name.to_owned());
        }
    }

    /// The name of a node, where it has one.
    pub fn name_of(&self, node: usize) -> Option<&str> {
        self.names.get(&node).map(String::as_str)
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> Expr {
        let magnitude = self.intern(Node::Constant(value.abs().to_bits()));
        magnitude.signed(value < 0.0)
    }

    /// The value of a constant expression.
    pub fn constant_value(&self, e: Expr) -> Option<f64> {
        match self.nodes[e.node()] {
            Node::Constant(bits) => {
                Some(if e.is_negative() { -f64::from_bits(bits) } else { f64::from_bits(bits) })
            }
            _ => None,
        }
    }

    /// An input.
    pub fn symbol(&mut self, symbol: Symbol) -> Expr {
        self.intern(Node::Symbol(symbol))
    }

    /// Sine and cosine of an angle: constants folded, quarter turns exact, the sign of the angle normalised.
    pub fn sin_cos(&mut self, angle: &Angle) -> (Expr, Expr) {
        if angle.is_constant() {
            let (s, c) = angle.constant.sin_cos();
            return (self.constant(s), self.constant(c));
        }
        let turns = angle.constant.quarter_turns;
        let mut canonical = angle.clone();
        canonical.constant = ConstantAngle { quarter_turns: 0, rest: angle.constant.rest };
        let flipped = canonical.terms[0].1 < 0;
        if flipped {
            canonical = -&canonical;
        }
        let (s, c) = self.variable_sin_cos(canonical);
        let s = s.signed(flipped);
        match turns {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }

    /// Sine and cosine of an angle in canonical form.
    fn variable_sin_cos(&mut self, canonical: Angle) -> (Expr, Expr) {
        let known = self.angles.iter().position(|known| *known == canonical);
        let parts = if known.is_none() && self.compose_angles { self.parts_of(&canonical) } else { None };
        if let Some((a, b, sign)) = parts {
            let (sa, ca) = (self.intern(Node::Sine(a)), self.intern(Node::Cosine(a)));
            let (sb, cb) = (self.intern(Node::Sine(b)).signed(sign < 0), self.intern(Node::Cosine(b)));
            let (left, right) = (self.mul(sa, cb), self.mul(ca, sb));
            let sine = self.add(left, right);
            let (left, right) = (self.mul(ca, cb), self.mul(sa, sb));
            return (sine, self.sub(left, right));
        }
        let at = known.unwrap_or_else(|| {
            self.angles.push(canonical);
            self.angles.len() - 1
        });
        (self.intern(Node::Sine(at)), self.intern(Node::Cosine(at)))
    }

    /// Two known angles a and b with a + b (1) or a - b (-1) equal to the angle.
    fn parts_of(&self, angle: &Angle) -> Option<(usize, usize, i32)> {
        for (i, a) in self.angles.iter().enumerate() {
            for (k, b) in self.angles.iter().enumerate() {
                if &(a + b) == angle {
                    return Some((i, k, 1));
                }
                if &(a + &-b) == angle {
                    return Some((i, k, -1));
                }
            }
        }
        None
    }

    /// -1, 0 or 1 with the sign of the operand.
    pub fn sign(&mut self, e: Expr) -> Expr {
        match self.constant_value(e) {
            Some(value) => self.constant(if value == 0.0 { 0.0 } else { value.signum() }),
            None => self.intern(Node::Sign(e.magnitude())).signed(e.is_negative()),
        }
    }

    /// The expression as coefficient * rest.
    fn split_coefficient(&self, e: Expr) -> (f64, Expr) {
        let sign = if e.is_negative() { -1.0 } else { 1.0 };
        match self.nodes[e.node()] {
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
        let is_product = |e: Expr| matches!(self.nodes[e.node()], Node::Product(..));
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
        let Node::Sum(x, y) = self.nodes[sum.node()] else { return None };
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
        match (self.nodes[s.node()], self.nodes[c.node()]) {
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
            match self.nodes[e.node()] {
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

    /// The nodes that the outputs need, ascending (operands first).
    pub fn reachable(&self, outputs: &[Expr]) -> Vec<usize> {
        let mut needed = vec![false; self.nodes.len()];
        for e in outputs {
            needed[e.node()] = true;
        }
        for at in (0..self.nodes.len()).rev() {
            if needed[at] {
                for operand in self.operands(at) {
                    needed[operand.node()] = true;
                }
            }
        }
        (0..self.nodes.len()).filter(|&at| needed[at]).collect()
    }

    /// The operands of a node.
    pub fn operands(&self, node: usize) -> impl Iterator<Item = Expr> + use<> {
        let (a, b) = match self.nodes[node] {
            Node::Sum(a, b) | Node::Product(a, b) => (Some(a), Some(b)),
            Node::Sign(a) => (Some(a), None),
            _ => (None, None),
        };
        a.into_iter().chain(b)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn xyz(g: &mut Graph) -> (Expr, Expr, Expr) {
        (g.symbol(Symbol::Velocity(0)), g.symbol(Symbol::Velocity(1)), g.symbol(Symbol::Velocity(2)))
    }

    #[test]
    fn equal_expressions_are_one_node_whatever_order_and_sign_they_were_built_in() {
        let mut g = Graph::new();
        let (x, y, _) = xyz(&mut g);
        assert_eq!(g.sub(x, y), -g.sub(y, x));
        assert_eq!(g.mul(-x, y), -g.mul(y, x));
        let a = g.add(x, y);
        assert_eq!(g.add(-y, -x), -a);
    }

    #[test]
    fn zeros_ones_and_like_terms_fold() {
        let mut g = Graph::new();
        let (x, y, _) = xyz(&mut g);
        assert_eq!(g.mul(Graph::ZERO, x), Graph::ZERO);
        assert_eq!(g.mul(x, -Graph::ONE), -x);
        assert_eq!(g.sub(x, x), Graph::ZERO);
        let three_x = g.scale(3.0, x);
        let two_x = g.scale(2.0, x);
        assert_eq!(g.sub(three_x, two_x), x);
        let sum = g.add(x, y);
        assert_eq!(g.sub(sum, y), x);
        let half = g.scale(0.5, two_x);
        assert_eq!(half, x);
    }

    #[test]
    fn the_squares_of_sine_and_cosine_add_up_to_what_they_multiply() {
        let mut g = Graph::new();
        let (x, _, _) = xyz(&mut g);
        let (s, c) = g.sin_cos(&Angle::joint(3));
        let a = g.product(&[s, x, s]);
        let b = g.product(&[c, c, x]);
        assert_eq!(g.add(a, b), x);
        assert_eq!(g.add(-a, -b), -x);
    }

    #[test]
    fn a_difference_of_known_angles_is_composed_where_that_is_wanted() {
        let mut g = Graph::composing_angles();
        let (a, b) = (Angle::joint(0), &Angle::joint(0) + &Angle::joint(1));
        g.sin_cos(&a);
        g.sin_cos(&b);
        let (s, c) = g.sin_cos(&Angle::joint(1));
        assert_eq!(g.angles().len(), 2);
        let point = super::super::Point { q: vec![0.4, -1.1], ..Default::default() };
        let values = g.evaluate(&[s, c], &point);
        assert!((values[0] - (-1.1_f64).sin()).abs() < 1e-15 && (values[1] - (-1.1_f64).cos()).abs() < 1e-15);
    }

    #[test]
    fn quarter_turns_leave_the_angle() {
        let mut g = Graph::new();
        let (s, c) = g.sin_cos(&Angle::joint(0));
        let turned =
            &Angle::joint(0) + &Angle::constant(ConstantAngle::from_radians(-std::f64::consts::FRAC_PI_2));
        assert_eq!(g.sin_cos(&turned), (-c, s));
        assert_eq!(g.sin_cos(&-&Angle::joint(0)), (-s, c));
        assert_eq!(g.angles().len(), 1);
    }
}
