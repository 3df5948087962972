//! The hash-consed graph: every expression exists once, in a canonical sign, simplified as it is built.

use super::angle::Angle;
use super::expr::{Expr, Node, Symbol};
use std::collections::HashMap;

/// The arena of all expressions.
#[derive(Debug, Clone)]
pub struct Graph {
    nodes: Vec<Node>,
    index: HashMap<Node, usize>,
    pub(super) angles: Vec<Angle>,
    pub(super) compose_angles: bool,
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
    pub const ZERO: Expr = Expr::ZERO;
    /// 1.
    pub const ONE: Expr = Expr::ONE;

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

    /// -1, 0 or 1 with the sign of the operand.
    pub fn sign(&mut self, e: Expr) -> Expr {
        match self.constant_value(e) {
            Some(value) => self.constant(if value == 0.0 { 0.0 } else { value.signum() }),
            None => self.intern(Node::Sign(e.magnitude())).signed(e.is_negative()),
        }
    }

    /// 1 / sqrt(e); 0 where e is not above 0.
    pub fn inverse_root(&mut self, e: Expr) -> Expr {
        match self.constant_value(e) {
            Some(value) => self.constant(if value > 0.0 { value.sqrt().recip() } else { 0.0 }),
            None => self.intern(Node::InverseRoot(e)),
        }
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
            Node::Sign(a) | Node::InverseRoot(a) => (Some(a), None),
            _ => (None, None),
        };
        a.into_iter().chain(b)
    }
}

#[cfg(test)]
mod tests {
    use super::super::angle::ConstantAngle;
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
