//! A rigid body fixed to a link: its ten columns, and what they say about mass, centre and inertia.

use super::quantity::{Parameter, Quantities};
use crate::model::{Link, Robot, standard_idm};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// An effect of this form.
pub trait BodyOnLink: Sync {
    /// Frames (0-based) of the links that may carry it.
    fn links(&self, robot: &Robot) -> Vec<usize>;

    /// Joint (0-based) that it is named on when it is on a link; `None` for the whole robot.
    fn named_joint(&self, robot: &Robot, frame: usize) -> Option<usize>;
}

/// A rigid body from the ten parameters that were added to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEstimate {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the frame of the link, m.
    pub centre: [f64; 3],
    /// Principal moments about the centre of mass, kg.m², ascending.
    pub principal: [f64; 3],
    /// Mass times centre, kg.m.
    moment: [f64; 3],
    /// Moment of inertia about the z axis of the frame, kg.m².
    about_axis: f64,
    /// Whether a real body can have these parameters: positive mass, and principal moments that are positive and
    /// fulfil the triangle inequality (Traversaro et al. 2016), within the tolerance it was made with.
    pub consistent: bool,
}

impl BodyEstimate {
    /// From XX XY XZ YY YZ ZZ MX MY MZ M at the origin of the frame.
    ///
    /// Ten least-squares numbers need not be a body: `slack` (kg.m²) is by how much the triangle inequality may fail
    /// before the body is called inconsistent, a few standard deviations of the moments.
    pub fn from_parameters(p: &[f64], slack: f64) -> Self {
        let mass = p[9];
        let safe = if mass.abs() > 1e-9 { mass } else { 1e-9 };
        let c = Vector3::new(p[6], p[7], p[8]) / safe;
        let at_origin = Matrix3::new(p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5]);
        let steiner = (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass;
        let mut e = SymmetricEigen::new(at_origin - steiner).eigenvalues;
        e.as_mut_slice().sort_by(f64::total_cmp);
        let consistent = mass > 0.0 && e[0] > -slack && e[0] + e[1] > e[2] - slack;
        let centre = [c[0], c[1], c[2]];
        let moment = [p[6], p[7], p[8]];
        Self { mass, centre, principal: [e[0], e[1], e[2]], moment, about_axis: p[5], consistent }
    }
}

impl BodyEstimate {
    /// The quantities a person knows; `sigma` are standard deviations of the ten parameters, infinite where one is not
    /// determined.
    ///
    /// Where the mass is not known to be there, its centre means nothing: what the joint about the link's z axis, number
    /// `axis`, feels of the body is then told, its first moment about that axis and its moment of inertia.
    pub fn parameters(&self, sigma: &[f64], axis: Option<usize>) -> Vec<Parameter> {
        let undetermined = sigma.get(9).is_some_and(|s| *s >= self.mass.abs());
        let s = |k: usize| sigma.get(k).copied().filter(|s| s.is_finite()).unwrap_or(0.0);
        if let Some(axis) = axis.filter(|_| undetermined) {
            let [x, y, _] = self.moment;
            let moment = x.hypot(y);
            let spread = (x * s(6)).hypot(y * s(7)) / moment.max(1e-12);
            return vec![
                Parameter::new("moment", moment, spread, "kg.m"),
                Parameter::new("direction", y.atan2(x), spread / moment.max(1e-12), "rad"),
                Parameter::new("inertia", self.about_axis, s(5), "kg.m2"),
                Parameter::new("axis", axis as f64, 0.0, "1"),
                Parameter::new("physically_consistent", f64::from(self.consistent), 0.0, "1"),
            ];
        }
        let m = self.mass.abs().max(1e-9);
        vec![
            Parameter::new("mass", self.mass, s(9), "kg"),
            Parameter::new("x", self.centre[0], s(6) / m, "m"),
            Parameter::new("y", self.centre[1], s(7) / m, "m"),
            Parameter::new("z", self.centre[2], s(8) / m, "m"),
            Parameter::new("I1", self.principal[0], s(0), "kg.m2"),
            Parameter::new("I2", self.principal[1], s(3), "kg.m2"),
            Parameter::new("I3", self.principal[2], s(5), "kg.m2"),
            Parameter::new("physically_consistent", f64::from(self.consistent), 0.0, "1"),
        ]
    }
}

/// What the quantities of a body mean.
pub const BODY_SYMBOLS: &[(&str, &str)] = &[
    ("mass", "mass of the body"),
    ("x", "centre of the body along x of the link's frame"),
    ("y", "the same along y"),
    ("z", "the same along z"),
    ("I1", "smallest moment of inertia about the centre"),
    ("I2", "middle moment of inertia"),
    ("I3", "largest moment of inertia"),
    ("moment", "first moment about the axis of the joint, where the mass does not show"),
    ("direction", "direction of the first moment"),
    ("inertia", "moment of inertia about that axis"),
    ("axis", "number of the joint whose axis it is"),
    ("physically_consistent", "1 where a real body can have these numbers"),
];

/// What is told of a body in a sentence.
pub fn body_detail(q: &Quantities) -> String {
    if q.has("moment") {
        return format!(
            "a first moment of {} about axis {}; its mass does not show in this motion",
            q.text("moment"),
            q.text("axis")
        );
    }
    format!("a body of {} at ({}, {}, {})", q.text("mass"), q.text("x"), q.text("y"), q.text("z"))
}

/// The ten columns of a frame's inertial parameters at one state: `out[parameter][joint]`, zeros included.
pub fn body_columns(
    robot: &Robot,
    links: &[Link<f64>],
    frame: usize,
    state: [&[f64]; 3],
    out: &mut [Vec<f64>; 10],
) {
    for column in out.iter_mut() {
        column.fill(0.0);
    }
    standard_idm(links, robot.gravity, state[0], state[1], state[2], |joint, k, columns| {
        if k == frame {
            for (column, value) in out.iter_mut().zip(columns) {
                column[joint] = *value;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_away_from_the_origin_is_recognised() {
        let (m, c, i) = (2.0, [0.1, -0.2, 0.3], [0.01, 0.02, 0.025]);
        let mut p = [0.0; 10];
        p[0] = i[0] + m * (c[1] * c[1] + c[2] * c[2]);
        p[3] = i[1] + m * (c[0] * c[0] + c[2] * c[2]);
        p[5] = i[2] + m * (c[0] * c[0] + c[1] * c[1]);
        p[1] = -m * c[0] * c[1];
        p[2] = -m * c[0] * c[2];
        p[4] = -m * c[1] * c[2];
        for k in 0..3 {
            p[6 + k] = m * c[k];
        }
        p[9] = m;
        let body = BodyEstimate::from_parameters(&p, 1e-9);
        assert!(body.consistent);
        for k in 0..3 {
            assert!((body.centre[k] - c[k]).abs() < 1e-12 && (body.principal[k] - i[k]).abs() < 1e-12);
        }
        p[0] -= 0.06;
        assert!(!BodyEstimate::from_parameters(&p, 1e-4).consistent);
    }
}
