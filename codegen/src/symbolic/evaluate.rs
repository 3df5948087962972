//! Numeric value of expressions: for tests and for counting nothing by accident.

use super::expr::{Expr, Node, Symbol};
use super::graph::Graph;

/// Values of the inputs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// rad or m.
    pub q: Vec<f64>,
    /// rad/s or m/s.
    pub dq: Vec<f64>,
    /// rad/s2 or m/s2.
    pub ddq: Vec<f64>,
    /// Base parameters.
    pub chi: Vec<f64>,
}

impl Graph {
    /// Values of the outputs at a point that gives every input they need.
    pub fn evaluate(&self, outputs: &[Expr], point: &Point) -> Vec<f64> {
        let mut values = vec![0.0; self.len()];
        let value_of = |values: &[f64], e: Expr| {
            if e.is_negative() { -values[e.node()] } else { values[e.node()] }
        };
        for at in self.reachable(outputs) {
            let angle = |a: usize| {
                let angle = &self.angles()[a];
                angle.terms.iter().map(|&(j, k)| f64::from(k) * point.q[j]).sum::<f64>() + angle.constant.rest
            };
            values[at] = match self.node(at) {
                Node::Constant(bits) => f64::from_bits(bits),
                Node::Symbol(Symbol::Position(j)) => point.q[j],
                Node::Symbol(Symbol::Velocity(j)) => point.dq[j],
                Node::Symbol(Symbol::Acceleration(j)) => point.ddq[j],
                Node::Symbol(Symbol::Parameter(k)) => point.chi[k],
                Node::Sine(a) => angle(a).sin(),
                Node::Cosine(a) => angle(a).cos(),
                Node::Sign(a) => {
                    let x = value_of(&values, a);
                    if x == 0.0 { 0.0 } else { x.signum() }
                }
                Node::InverseRoot(a) => {
                    let square = value_of(&values, a);
                    if square > 0.0 { square.sqrt().recip() } else { 0.0 }
                }
                Node::Sum(a, b) => value_of(&values, a) + value_of(&values, b),
                Node::Product(a, b) => value_of(&values, a) * value_of(&values, b),
            };
        }
        outputs.iter().map(|&e| value_of(&values, e)).collect()
    }
}
