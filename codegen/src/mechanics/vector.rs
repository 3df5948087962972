//! Three-vectors of expressions.

use crate::symbolic::{Expr, Graph};

/// Components along x, y and z of a frame.
pub type Vector = [Expr; 3];

pub const ZERO: Vector = [Graph::ZERO; 3];

pub fn add(g: &mut Graph, a: Vector, b: Vector) -> Vector {
    [g.add(a[0], b[0]), g.add(a[1], b[1]), g.add(a[2], b[2])]
}

pub fn negate(a: Vector) -> Vector {
    a.map(|e| -e)
}

pub fn scale(g: &mut Graph, s: Expr, a: Vector) -> Vector {
    a.map(|e| g.mul(s, e))
}

pub fn dot(g: &mut Graph, a: Vector, b: Vector) -> Expr {
    let terms = [g.mul(a[0], b[0]), g.mul(a[1], b[1]), g.mul(a[2], b[2])];
    g.sum(&terms)
}

pub fn cross(g: &mut Graph, a: Vector, b: Vector) -> Vector {
    let mut component = |i: usize, j: usize| {
        let (left, right) = (g.mul(a[i], b[j]), g.mul(a[j], b[i]));
        g.sub(left, right)
    };
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// Matrix of numbers times vector.
pub fn apply(g: &mut Graph, m: &[[f64; 3]; 3], v: Vector) -> Vector {
    m.map(|row| {
        let terms = [g.scale(row[0], v[0]), g.scale(row[1], v[1]), g.scale(row[2], v[2])];
        g.sum(&terms)
    })
}

/// Names the components `<name>x`, `<name>y`, `<name>z`.
pub fn name(g: &mut Graph, v: Vector, name: &str) {
    for (e, axis) in v.into_iter().zip(["x", "y", "z"]) {
        g.name(e, &format!("{name}{axis}"));
    }
}
