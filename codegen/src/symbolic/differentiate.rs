//! Derivatives of expressions.

use super::expr::{Expr, Node, Symbol};
use super::graph::Graph;
use std::collections::HashMap;

impl Graph {
    /// Total time derivative: q -> dq -> ddq; base parameters are constant.
    ///
    /// The derivative of an acceleration is not known to the models; it counts as zero. So does that of a sign.
    pub fn time_derivative(&mut self, e: Expr) -> Expr {
        let mut known = std::mem::take(&mut self.derivatives);
        let result = self.derivative(e, &mut known, &mut |g, symbol| match symbol {
            Symbol::Position(j) => g.symbol(Symbol::Velocity(j)),
            Symbol::Velocity(j) => g.symbol(Symbol::Acceleration(j)),
            Symbol::Acceleration(_) | Symbol::Parameter(_) => Graph::ZERO,
        });
        self.derivatives = known;
        result
    }

    /// Partial derivative with respect to one input.
    pub fn partial(&mut self, e: Expr, variable: Symbol) -> Expr {
        self.derivative(e, &mut HashMap::new(), &mut |_, symbol| {
            if symbol == variable { Graph::ONE } else { Graph::ZERO }
        })
    }

    /// States the time derivative of a node that mechanics knows in a better form (`dw` of `w`).
    pub fn set_time_derivative(&mut self, e: Expr, derivative: Expr) {
        if self.constant_value(e).is_none() {
            self.derivatives.entry(e.node()).or_insert(derivative.signed(e.is_negative()));
        }
    }

    /// Forward differentiation; operands have smaller indices, so one ascending sweep suffices.
    fn derivative(
        &mut self,
        e: Expr,
        known: &mut HashMap<usize, Expr>,
        rate: &mut dyn FnMut(&mut Graph, Symbol) -> Expr,
    ) -> Expr {
        for at in self.reachable(&[e]) {
            if known.contains_key(&at) {
                continue;
            }
            let value = match self.node(at) {
                Node::Constant(_) | Node::Sign(_) => Graph::ZERO,
                Node::Symbol(symbol) => rate(self, symbol),
                Node::Sine(angle) => {
                    let rate = self.angle_rate(angle, rate);
                    let c = self.intern(Node::Cosine(angle));
                    self.mul(c, rate)
                }
                Node::Cosine(angle) => {
                    let rate = self.angle_rate(angle, rate);
                    let s = self.intern(Node::Sine(angle));
                    -self.mul(s, rate)
                }
                Node::InverseRoot(a) => {
                    let root = Expr::new(at, false);
                    let (cubed, da) = (self.product(&[root, root, root]), signed_lookup(known, a));
                    let product = self.mul(cubed, da);
                    -self.scale(0.5, product)
                }
                Node::Sum(a, b) => {
                    let (da, db) = (signed_lookup(known, a), signed_lookup(known, b));
                    self.add(da, db)
                }
                Node::Product(a, b) => {
                    let (da, db) = (signed_lookup(known, a), signed_lookup(known, b));
                    let left = self.mul(da, b);
                    let right = self.mul(a, db);
                    self.add(left, right)
                }
            };
            known.insert(at, value);
        }
        signed_lookup(known, e)
    }

    fn angle_rate(&mut self, angle: usize, rate: &mut dyn FnMut(&mut Graph, Symbol) -> Expr) -> Expr {
        let terms = self.angles()[angle].terms.clone();
        let mut total = Graph::ZERO;
        for (joint, k) in terms {
            let d = rate(self, Symbol::Position(joint));
            let term = self.scale(f64::from(k), d);
            total = self.add(total, term);
        }
        total
    }
}

/// The derivative of an operand; every operand was visited before what is built from it.
fn signed_lookup(known: &HashMap<usize, Expr>, e: Expr) -> Expr {
    known.get(&e.node()).copied().unwrap_or(Graph::ZERO).signed(e.is_negative())
}

#[cfg(test)]
mod tests {
    use super::super::{Angle, Point};
    use super::*;

    #[test]
    fn total_and_partial_derivatives_agree_with_differences() {
        let mut g = Graph::new();
        let (s, c) = g.sin_cos(&(&Angle::joint(0) + &Angle::joint(1)));
        let (q, dq) = (g.symbol(Symbol::Position(1)), g.symbol(Symbol::Velocity(0)));
        let a = g.mul(s, dq);
        let b = g.mul(q, c);
        let f = g.sub(a, b);
        let f = g.mul(f, f);
        let total = g.time_derivative(f);
        let partial = g.partial(f, Symbol::Position(1));
        let state = |t: f64, extra: f64| Point {
            q: vec![0.3 + 0.7 * t, -0.4 + 0.2 * t + extra],
            dq: vec![0.7 + 0.5 * t, 0.2],
            ddq: vec![0.5, 0.0],
            chi: vec![],
        };
        let value = |g: &Graph, e: Expr, p: &Point| g.evaluate(&[e], p)[0];
        let h = 1e-6;
        let numeric = (value(&g, f, &state(h, 0.0)) - value(&g, f, &state(-h, 0.0))) / (2.0 * h);
        assert!((numeric - value(&g, total, &state(0.0, 0.0))).abs() < 1e-9);
        let numeric = (value(&g, f, &state(0.0, h)) - value(&g, f, &state(0.0, -h))) / (2.0 * h);
        assert!((numeric - value(&g, partial, &state(0.0, 0.0))).abs() < 1e-9);
    }
}
