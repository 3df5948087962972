//! Operation counts.

use super::expr::{Expr, Node};
use super::graph::Graph;
use std::fmt;

/// Arithmetic of one evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OperationCounts {
    /// Multiplications.
    pub multiplications: usize,
    /// Additions and subtractions; a result that only changes sign counts as one.
    pub additions: usize,
    /// Sine and cosine of one angle, taken together.
    pub sincos: usize,
    /// Reciprocals of square roots.
    pub roots: usize,
}

impl OperationCounts {
    /// Multiplications and additions.
    pub fn arithmetic(self) -> usize {
        self.multiplications + self.additions
    }

    /// Arithmetic with a sine and cosine worth what they cost beside it, measured: 21 operations for one sample, 45 a
    /// sample in lanes. The reciprocal of a root takes two divisions' time.
    pub fn weighted(self) -> usize {
        self.arithmetic() + 30 * self.sincos + 15 * self.roots
    }
}

impl fmt::Display for OperationCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} multiplications, {} additions, {} sine/cosine pairs",
            self.multiplications, self.additions, self.sincos
        )?;
        if self.roots > 0 { write!(f, ", {} inverse roots", self.roots) } else { Ok(()) }
    }
}

impl Graph {
    /// What evaluating the outputs together costs, every shared node once.
    pub fn operation_counts(&self, outputs: &[Expr]) -> OperationCounts {
        let mut counts = OperationCounts::default();
        let mut angles = vec![false; self.angles().len()];
        for at in self.reachable(outputs) {
            match self.node(at) {
                Node::Product(..) => counts.multiplications += 1,
                Node::Sum(..) => counts.additions += 1,
                Node::Sine(a) | Node::Cosine(a) => angles[a] = true,
                Node::InverseRoot(_) => counts.roots += 1,
                Node::Constant(_) | Node::Symbol(_) | Node::Sign(_) => {}
            }
        }
        for (angle, _) in self.angles().iter().zip(&angles).filter(|(_, used)| **used) {
            counts.sincos += 1;
            counts.additions += angle.terms.len() - 1 + usize::from(angle.constant.rest != 0.0);
            counts.multiplications += angle.terms.iter().filter(|t| t.1.abs() != 1).count();
        }
        let uses = self.uses(outputs);
        counts.additions +=
            outputs.iter().filter(|e| e.is_negative() && !self.sign_is_free(**e, &uses)).count();
        counts
    }

    /// How often each node is an operand or an output of what the outputs need.
    pub fn uses(&self, outputs: &[Expr]) -> Vec<usize> {
        let mut uses = vec![0; self.len()];
        for at in self.reachable(outputs) {
            self.operands(at).for_each(|e| uses[e.node()] += 1);
        }
        outputs.iter().for_each(|e| uses[e.node()] += 1);
        uses
    }

    /// A constant, a product with a constant factor, and a difference that nothing else uses take a sign at no cost.
    fn sign_is_free(&self, e: Expr, uses: &[usize]) -> bool {
        match self.node(e.node()) {
            Node::Constant(_) => true,
            Node::Product(first, _) => self.constant_value(first).is_some(),
            Node::Sum(_, second) => second.is_negative() && uses[e.node()] == 1,
            _ => false,
        }
    }
}
