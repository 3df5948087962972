//! Mass matrix by composite bodies and bias by Newton-Euler (Walker and Orin 1982).

use super::error::MAX_FRAMES;
use super::kinematics::{Link, propagate};
use super::vector::{Mat3, Vec3, add, apply, cross, multiply, scale};
use crate::model::{JointKind, Number};

/// The ten inertial parameters of one body at the origin of its frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inertia {
    /// Inertia matrix, kg.m2.
    pub j: Mat3<f64>,
    /// First moment, kg.m.
    pub ms: Vec3<f64>,
    /// Mass, kg.
    pub m: f64,
}

impl Inertia {
    /// Adds a value to one parameter, by its place in XX XY XZ YY YZ ZZ MX MY MZ M.
    pub fn add_parameter(&mut self, kind: usize, value: f64) {
        match kind {
            0 => self.j[0][0] += value,
            1 | 2 => {
                self.j[0][kind] += value;
                self.j[kind][0] += value;
            }
            3 => self.j[1][1] += value,
            4 => {
                self.j[1][2] += value;
                self.j[2][1] += value;
            }
            5 => self.j[2][2] += value,
            6..=8 => self.ms[kind - 6] += value,
            _ => self.m += value,
        }
    }

    /// Adds a child body seen from this frame: rotation and origin of the child's frame.
    fn add_child(&mut self, child: &Inertia, rotation: &Mat3<f64>, origin: Vec3<f64>) {
        let ms = apply(rotation, child.ms);
        let turned = multiply(rotation, &child.j);
        let transposed = std::array::from_fn(|r| std::array::from_fn(|c| rotation[c][r]));
        let j = multiply(&turned, &transposed);
        // -(P^ MS^ + MS^ P^) - M P^ P^ with a^ b^ = b aT - (a.b) 1.
        let inner = 2.0 * super::vector::dot(origin, ms) + child.m * super::vector::dot(origin, origin);
        for r in 0..3 {
            for c in 0..3 {
                let outer = origin[r] * ms[c] + ms[r] * origin[c] + child.m * origin[r] * origin[c];
                self.j[r][c] += j[r][c] - outer + if r == c { inner } else { 0.0 };
            }
        }
        self.ms = add(self.ms, add(ms, scale(child.m, origin)));
        self.m += child.m;
    }

    /// Force and moment at the origin that give the body the acceleration (dv, dw) at the velocity w.
    #[inline(always)]
    pub fn wrench<T: Number>(&self, w: Vec3<T>, dw: Vec3<T>, dv: Vec3<T>) -> (Vec3<T>, Vec3<T>) {
        let (j, ms, m) =
            (self.j.map(|row| row.map(T::constant)), self.ms.map(T::constant), T::constant(self.m));
        let force = add(scale(m, dv), add(cross(dw, ms), cross(w, cross(w, ms))));
        let moment = add(apply(&j, dw), add(cross(w, apply(&j, w)), cross(ms, dv)));
        (force, moment)
    }
}

/// Links with their bodies.
pub(super) struct RigidBodies<'a> {
    pub links: &'a [Link<f64>],
    /// m/s².
    pub gravity: [f64; 3],
    /// Of each link by itself.
    pub inertia: &'a [Inertia; MAX_FRAMES],
}

/// Adds the rigid bodies' mass matrix to `mass` (n x n, row-major) and their bias to `bias` (n).
pub(super) fn add_mass_and_bias(
    bodies: &RigidBodies<'_>,
    q: &[f64],
    dq: &[f64],
    mass: &mut [f64],
    bias: &mut [f64],
) {
    let &RigidBodies { links, gravity, inertia } = bodies;
    let n = q.len();
    let at_rest = [0.0; MAX_FRAMES];
    let motion = propagate(links, gravity, q, dq, &at_rest[..n]);
    let mut composite = *inertia;
    let mut wrenches = [([0.0; 3], [0.0; 3]); MAX_FRAMES];
    let mut transforms = [([[0.0; 3]; 3], [0.0; 3]); MAX_FRAMES];
    for k in 0..links.len() {
        let body = &motion[k];
        wrenches[k] = inertia[k].wrench(body.w, body.dw, body.dv);
        transforms[k] = links[k].transform_at(q);
    }
    for k in (0..links.len()).rev() {
        let (rotation, origin) = transforms[k];
        let kind = links[k].kind();
        if kind != JointKind::Fixed {
            let (force, moment) = wrenches[k];
            let on_axis = if kind == JointKind::Prismatic { force[2] } else { moment[2] };
            let own = links[k].terms().each();
            own.iter().for_each(|&(joint, c)| bias[joint] += c * on_axis);
            let (w, v) = unit_twist(kind);
            let (mut force, mut moment) = composite[k].wrench([0.0; 3], w, v);
            let mut at = Some(k);
            while let Some(a) = at {
                if links[a].kind() != JointKind::Fixed {
                    let m = if links[a].kind() == JointKind::Prismatic { force[2] } else { moment[2] };
                    for (&(joint, c), &(i, d)) in own
                        .iter()
                        .flat_map(|term| links[a].terms().each().iter().map(move |other| (term, other)))
                    {
                        mass[joint * n + i] += c * d * m;
                        if a != k {
                            mass[i * n + joint] += c * d * m;
                        }
                    }
                }
                (force, moment) = to_parent(&transforms[a], force, moment);
                at = links[a].parent();
            }
        }
        if let Some(p) = links[k].parent() {
            let child = composite[k];
            composite[p].add_child(&child, &rotation, origin);
            let (force, moment) = to_parent(&transforms[k], wrenches[k].0, wrenches[k].1);
            wrenches[p] = (add(wrenches[p].0, force), add(wrenches[p].1, moment));
        }
    }
}

fn unit_twist(kind: JointKind) -> (Vec3<f64>, Vec3<f64>) {
    let axis = [0.0, 0.0, 1.0];
    if kind == JointKind::Prismatic { ([0.0; 3], axis) } else { (axis, [0.0; 3]) }
}

fn to_parent(
    (rotation, origin): &(Mat3<f64>, Vec3<f64>),
    force: Vec3<f64>,
    moment: Vec3<f64>,
) -> (Vec3<f64>, Vec3<f64>) {
    let force = apply(rotation, force);
    (force, add(apply(rotation, moment), cross(*origin, force)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_point_mass_has_the_inertia_of_a_point_mass() {
        let mut body = Inertia::default();
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        body.add_child(&Inertia { m: 2.0, ..Inertia::default() }, &unit, [1.0, 2.0, 3.0]);
        assert_eq!(body.ms, [2.0, 4.0, 6.0]);
        assert_eq!(body.j, [[26.0, -4.0, -6.0], [-4.0, 20.0, -12.0], [-6.0, -12.0, 10.0]]);
    }
}
