//! Common factors taken out of sums: k a + k b as k (a + b), where that saves a product.

use super::expr::{Expr, Node};
use super::graph::Graph;

impl Graph {
    /// The outputs with common factors taken out of their sums, or as they are where that does not save an operation.
    ///
    /// A sum is taken with all sums in it that have no other use; of its products those that nothing else uses can give a
    /// factor, and the factor that most of them share goes first. Named sums stay what they are.
    pub fn factored(&mut self, outputs: &[Expr]) -> Vec<Expr> {
        let mut best = outputs.to_vec();
        loop {
            let next = self.factored_once(&best);
            let count = |outputs: &[Expr]| self.operation_counts(outputs).arithmetic();
            if count(&next) >= count(&best) {
                return best;
            }
            best = next;
        }
    }

    fn factored_once(&mut self, outputs: &[Expr]) -> Vec<Expr> {
        let uses = self.uses(outputs);
        let mut anew: Vec<Expr> = (0..self.len()).map(|at| Expr::new(at, false)).collect();
        for at in self.reachable(outputs) {
            let new = match self.node(at) {
                Node::Sum(a, b) => {
                    let mut terms = Vec::new();
                    self.terms_of(Expr::new(at, false), true, &uses, &mut terms);
                    match self.common_factor(&terms, &uses) {
                        Some(factor) => self.with_factor_out(&terms, factor, &uses, &anew),
                        None => {
                            let (a, b) = (moved(a, &anew), moved(b, &anew));
                            self.add(a, b)
                        }
                    }
                }
                Node::Product(a, b) => {
                    let (a, b) = (moved(a, &anew), moved(b, &anew));
                    self.mul(a, b)
                }
                Node::Sign(a) => self.sign(moved(a, &anew)),
                Node::InverseRoot(a) => self.inverse_root(moved(a, &anew)),
                _ => continue,
            };
            if let Some(name) = self.name_of(at).map(str::to_owned) {
                self.name(new, &name);
            }
            anew[at] = new;
        }
        outputs.iter().map(|&e| moved(e, &anew)).collect()
    }

    /// The terms of a sum, through sums without a name and without another use.
    fn terms_of(&self, e: Expr, top: bool, uses: &[usize], terms: &mut Vec<Expr>) {
        let inner = top || (uses[e.node()] == 1 && self.name_of(e.node()).is_none());
        match self.node(e.node()) {
            Node::Sum(a, b) if inner => {
                for term in [a, b] {
                    self.terms_of(if e.is_negative() { -term } else { term }, false, uses, terms);
                }
            }
            _ => terms.push(e),
        }
    }

    /// The factors of a term that only this term uses, through products without a name and without another use.
    fn own_factors(&self, term: Expr, uses: &[usize]) -> Vec<Expr> {
        let mut pending = vec![term.magnitude()];
        let mut factors = Vec::new();
        while let Some(e) = pending.pop() {
            let inner = uses[e.node()] == 1 && self.name_of(e.node()).is_none();
            match self.node(e.node()) {
                Node::Product(a, b) if inner => pending.extend([b, a]),
                _ => factors.push(e),
            }
        }
        factors
    }

    /// The factor that most terms share, the first one of several.
    fn common_factor(&self, terms: &[Expr], uses: &[usize]) -> Option<Expr> {
        let lists: Vec<Vec<Expr>> = terms.iter().map(|&t| self.own_factors(t, uses)).collect();
        let products = || lists.iter().filter(|list| list.len() > 1);
        let shared = |factor: &Expr| products().filter(|list| list.contains(factor)).count();
        let mut best: Option<(usize, Expr)> = None;
        for factor in products().flatten() {
            let count = shared(factor);
            if count > 1 && best.is_none_or(|(most, _)| count > most) {
                best = Some((count, *factor));
            }
        }
        best.map(|(_, factor)| factor)
    }

    fn with_factor_out(&mut self, terms: &[Expr], factor: Expr, uses: &[usize], anew: &[Expr]) -> Expr {
        let (mut inner, mut rest) = (Graph::ZERO, Graph::ZERO);
        for &term in terms {
            let mut factors = self.own_factors(term, uses);
            match factors.iter().position(|&f| f == factor) {
                Some(at) if factors.len() > 1 => {
                    factors.remove(at);
                    let factors: Vec<Expr> = factors.iter().map(|&f| moved(f, anew)).collect();
                    let product = self.product(&factors);
                    inner = self.add(inner, if term.is_negative() { -product } else { product });
                }
                _ => rest = self.add(rest, moved(term, anew)),
            }
        }
        let product = self.mul(moved(factor, anew), inner);
        self.add(product, rest)
    }
}

/// What became of an expression.
fn moved(e: Expr, anew: &[Expr]) -> Expr {
    let new = anew[e.node()];
    if e.is_negative() { -new } else { new }
}

#[cfg(test)]
mod tests {
    use super::super::{Point, Symbol};
    use super::*;

    #[test]
    fn a_factor_that_products_share_is_taken_out_of_their_sum() {
        let mut g = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|k| g.symbol(Symbol::Velocity(k)));
        let (kx, ky, kz) = (g.scale(0.3, x), g.scale(0.3, y), g.scale(0.3, z));
        let sum = g.sum(&[kx, z, -ky]);
        let outputs = g.factored(&[sum]);
        assert_eq!(g.operation_counts(&outputs).multiplications, 1);
        let point = Point { dq: vec![0.4, -1.1, 2.0], ..Point::default() };
        let (before, after) = (g.evaluate(&[sum], &point)[0], g.evaluate(&outputs, &point)[0]);
        assert!((before - after).abs() < 1e-15);
        // The products are there anyway.
        assert_eq!(g.factored(&[sum, kx, ky, kz]), [sum, kx, ky, kz]);
    }
}
