//! Sines and cosines of the angles of a graph.

use super::angle::{Angle, ConstantAngle};
use super::expr::{Expr, Node};
use super::graph::Graph;

impl Graph {
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
}
