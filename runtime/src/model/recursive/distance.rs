//! The distance of two points that are fixed in frames, and how it changes with a joint.

use crate::model::{Between, JointKind, Number, Robot};

/// One frame on the way from a point to the base.
#[derive(Debug, Clone)]
struct Step {
    kind: JointKind,
    terms: Vec<(usize, f64)>,
    theta: f64,
    r: f64,
    /// Rot(z, gamma) Rot(x, alpha).
    orientation: [[f64; 3]; 3],
    /// Trans(z, b), then d along the turned x axis.
    offset: [f64; 3],
}

/// Two points with the frames that carry one of them and not the other.
#[derive(Debug, Clone)]
pub(super) struct Distance {
    ends: [([f64; 3], Vec<Step>); 2],
}

impl Distance {
    /// Of a robot whose indices are in range.
    pub fn new(robot: &Robot, between: &Between) -> Self {
        let motions = robot.motions();
        let way = |end: usize| {
            let mut frames = Vec::new();
            let mut at = between.frames[end];
            while let Some(k) = at {
                frames.push(k);
                at = robot.frames[k].parent;
            }
            frames
        };
        let ways = [way(0), way(1)];
        let end = |end: usize| {
            let own = ways[end].iter().filter(|k| !ways[1 - end].contains(k));
            let step = |&k: &usize| {
                let f = &robot.frames[k];
                let ((sg, cg), (sa, ca)) = (f.gamma.sin_cos(), f.alpha.sin_cos());
                Step {
                    kind: motions[k].kind,
                    terms: motions[k].terms.clone(),
                    theta: f.theta,
                    r: f.r,
                    orientation: [[cg, -sg * ca, sg * sa], [sg, cg * ca, -cg * sa], [0.0, sa, ca]],
                    offset: [cg * f.d, sg * f.d, f.b],
                }
            };
            (between.points[end], own.map(step).collect())
        };
        Self { ends: [end(0), end(1)] }
    }

    /// l^2, and l dl/dq of a joint.
    #[inline(always)]
    pub fn square_and_slope<T: Number>(&self, q: &[T], joint: usize) -> (T, T) {
        let (a, da) = place(&self.ends[0], q, joint);
        let (b, db) = place(&self.ends[1], q, joint);
        let (mut square, mut slope) = (T::constant(0.0), T::constant(0.0));
        for k in 0..3 {
            let apart = b[k] - a[k];
            square += apart * apart;
            slope += apart * (db[k] - da[k]);
        }
        (square, slope)
    }
}

/// A point in the frame that both are on, and its derivative by a joint.
#[inline(always)]
fn place<T: Number>((point, steps): &([f64; 3], Vec<Step>), q: &[T], joint: usize) -> ([T; 3], [T; 3]) {
    let zero = T::constant(0.0);
    let (mut p, mut dp) = (point.map(T::constant), [zero; 3]);
    for step in steps {
        let mut moved = zero;
        let mut share = 0.0;
        for &(k, c) in &step.terms {
            moved += T::constant(c) * q[k];
            share += if k == joint { c } else { 0.0 };
        }
        p[2] += T::constant(step.r);
        let mut theta = T::constant(step.theta);
        match step.kind {
            JointKind::Prismatic => {
                p[2] += moved;
                dp[2] += T::constant(share);
            }
            _ => theta += moved,
        }
        let (s, c) = theta.sin_cos();
        let turn = |v: [T; 3]| [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]];
        (p, dp) = (turn(p), turn(dp));
        if step.kind == JointKind::Revolute {
            dp[0] -= T::constant(share) * p[1];
            dp[1] += T::constant(share) * p[0];
        }
        let outer = |v: [T; 3]| {
            step.orientation.map(|row| {
                T::constant(row[0]) * v[0] + T::constant(row[1]) * v[1] + T::constant(row[2]) * v[2]
            })
        };
        (p, dp) = (outer(p), outer(dp));
        for (x, offset) in p.iter_mut().zip(step.offset) {
            *x += T::constant(offset);
        }
    }
    (p, dp)
}
