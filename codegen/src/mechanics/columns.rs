//! The wrench that a body needs per unit of one of its inertial parameters.

use super::motion::FrameMotion;
use super::vector::{self, Vector};
use crate::symbolic::Graph;
use dynid_description::ParameterKind;

/// Force, and moment at the origin of the frame, in the axes of the frame.
#[derive(Debug, Clone, Copy)]
pub struct Wrench {
    /// N per unit parameter.
    pub force: Vector,
    /// N.m per unit parameter.
    pub moment: Vector,
}

/// f = M a + U MS and m = J dw + w x (J w) + MS x a for one unit parameter (Khalil and Dombre 2002, chapter 9).
pub fn body_wrench(g: &mut Graph, motion: &FrameMotion, kind: ParameterKind) -> Wrench {
    let [x, y, z] = motion.w;
    let [dx, dy, dz] = motion.dw;
    let [ax, ay, az] = motion.a;
    let u = &motion.u;
    let couple = |moment: Vector| Wrench { force: vector::ZERO, moment };
    let column = |k: usize| [u[0][k], u[1][k], u[2][k]];
    match kind {
        ParameterKind::XX => {
            let (xz, xy) = (g.mul(x, z), g.mul(x, y));
            couple([dx, xz, -xy])
        }
        ParameterKind::YY => {
            let (yz, xy) = (g.mul(y, z), g.mul(x, y));
            couple([-yz, dy, xy])
        }
        ParameterKind::ZZ => {
            let (yz, xz) = (g.mul(y, z), g.mul(x, z));
            couple([yz, -xz, dz])
        }
        ParameterKind::XY => {
            let difference = squares(g, x, y);
            couple([-u[2][0], u[2][1], difference])
        }
        ParameterKind::XZ => {
            let difference = squares(g, z, x);
            couple([u[1][0], difference, -u[1][2]])
        }
        ParameterKind::YZ => {
            let difference = squares(g, y, z);
            couple([difference, -u[0][1], u[0][2]])
        }
        ParameterKind::MX => Wrench { force: column(0), moment: [Graph::ZERO, -az, ay] },
        ParameterKind::MY => Wrench { force: column(1), moment: [az, Graph::ZERO, -ax] },
        ParameterKind::MZ => Wrench { force: column(2), moment: [-ay, ax, Graph::ZERO] },
        ParameterKind::M => Wrench { force: motion.a, moment: vector::ZERO },
        _ => Wrench { force: vector::ZERO, moment: vector::ZERO },
    }
}

fn squares(g: &mut Graph, a: crate::symbolic::Expr, b: crate::symbolic::Expr) -> crate::symbolic::Expr {
    let (aa, bb) = (g.mul(a, a), g.mul(b, b));
    g.sub(aa, bb)
}
