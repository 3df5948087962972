//! Where a frame stands on its parent, and how the inertial parameters of a body read in the parent's frame.

use crate::exact::{Angles, Form, Number, decimal};
use crate::robot::{Expression, RobotTable, TableRow};
use dynid_description::JointKind;

/// XX XY XZ YY YZ ZZ MX MY MZ M.
pub(super) type Inertia = [Form; 10];

/// Row and column of each of the six entries of an inertia matrix.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Rotation and origin of a frame in its parent's, for joint variable 0.
///
/// The constant part of a joint's own variable is left out (theta of a revolute joint, r of a prismatic one): it
/// shifts the variable's zero, which no relation between parameters depends on.
pub(super) struct Placement {
    pub rotation: [[Form; 3]; 3],
    pub origin: [Form; 3],
}

/// The angles of a table.
pub(super) fn angles_of(robot: &RobotTable) -> Angles {
    Angles::of(robot.frames.iter().flat_map(|f| [f.gamma.value(), f.alpha.value(), f.theta.value()]))
}

impl Placement {
    pub fn of(frame: &TableRow, angles: &Angles) -> Placement {
        let (cg, sg) = cos_sin(&frame.gamma, angles);
        let (ca, sa) = cos_sin(&frame.alpha, angles);
        let (ct, st) = match frame.kind {
            JointKind::Revolute => (Form::one(), Form::zero()),
            _ => cos_sin(&frame.theta, angles),
        };
        let r = if frame.kind == JointKind::Prismatic { Form::zero() } else { length(&frame.r) };
        let (b, d) = (length(&frame.b), length(&frame.d));
        let (nst, nsa, nsg) = (minus(&st), minus(&sa), minus(&sg));
        let (zero, one) = (Form::zero, Form::one);
        let about_z = |c: &Form, s: &Form, ns: &Form| {
            [[c.clone(), ns.clone(), zero()], [s.clone(), c.clone(), zero()], [zero(), zero(), one()]]
        };
        let about_x =
            [[one(), zero(), zero()], [zero(), ca.clone(), nsa.clone()], [zero(), sa.clone(), ca.clone()]];
        let turned = product(&about_z(&cg, &sg, &nsg), &about_x);
        let rotation = product(&turned, &about_z(&ct, &st, &nst));
        // Trans(z, b), then d along the turned x and r along the turned z.
        let mut origin = [0, 1, 2].map(|i: usize| turned[i][0].times(&d).plus(&turned[i][2].times(&r)));
        origin[2] = origin[2].plus(&b);
        Placement { rotation, origin }
    }

    /// The parameters of a body, given at this frame, at the parent's frame.
    pub fn on_parent(&self, body: &Inertia) -> Inertia {
        let [xx, xy, xz, yy, yz, zz, mx, my, mz, mass] = body;
        let tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| row.map(Form::clone));
        let transposed = [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| self.rotation[j][i].clone()));
        let tensor = product(&product(&self.rotation, &tensor), &transposed);
        let first = [0, 1, 2].map(|i: usize| {
            let row = &self.rotation[i];
            row[0].times(mx).plus(&row[1].times(my)).plus(&row[2].times(mz))
        });
        let p = &self.origin;
        let dot = |a: &[Form; 3], b: &[Form; 3]| {
            a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
        };
        // J + (2 s.p + M p.p) 1 - (s pT + p sT + M p pT), with s the first moments.
        let trace = dot(&first, p).scaled(Number::from(2)).plus(&dot(p, p).times(mass));
        let mut moved: Inertia = Default::default();
        for (k, (i, j)) in ENTRIES.into_iter().enumerate() {
            let cross =
                first[i].times(&p[j]).plus(&p[i].times(&first[j])).plus(&p[i].times(&p[j]).times(mass));
            moved[k] = tensor[i][j].minus(&cross);
            if i == j {
                moved[k] = moved[k].plus(&trace);
            }
        }
        for i in 0..3 {
            moved[6 + i] = first[i].plus(&p[i].times(mass));
        }
        moved[9] = mass.clone();
        moved
    }
}

fn minus(a: &Form) -> Form {
    a.scaled(-Number::ONE)
}

fn product(a: &[[Form; 3]; 3], b: &[[Form; 3]; 3]) -> [[Form; 3]; 3] {
    let entry = |i: usize, j: usize| (0..3).fold(Form::zero(), |sum, k| sum.plus(&a[i][k].times(&b[k][j])));
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

fn cos_sin(angle: &Expression, angles: &Angles) -> (Form, Form) {
    let value = angle.value();
    let exact = angles.rotation(value);
    if Angles::is_special(value) {
        (Form::number(exact.cos), Form::number(exact.sin))
    } else {
        Form::cos_sin(&angle.to_string(), exact.cos, exact.sin)
    }
}

/// A length that an expression leaves over from rounding is zero.
const NOTHING: f64 = 1e-12;

/// A length of the table.
pub(super) fn length(expression: &Expression) -> Form {
    if expression.value().abs() < NOTHING { Form::zero() } else { form(expression) }
}

fn form(expression: &Expression) -> Form {
    match expression {
        Expression::Number(x) => Form::number(decimal(*x).into()),
        Expression::Pi => Form::named("pi", decimal(std::f64::consts::PI).into()),
        Expression::Constant(name, x) => Form::named(name, decimal(*x).into()),
        Expression::Neg(a) => minus(&form(a)),
        Expression::Add(a, b) => form(a).plus(&form(b)),
        Expression::Sub(a, b) => form(a).minus(&form(b)),
        Expression::Mul(a, b) => form(a).times(&form(b)),
        // The parser refuses a division by zero.
        Expression::Div(a, b) => form(a).over(&form(b)).unwrap_or_else(Form::zero),
    }
}
