//! Rotor inertia, friction, offsets and springs, with motors that several joints turn: (9), (25), (26).
//! Equation numbers are those of Gautier and Briot.

use super::between::Distance;
use super::error::ModelError;
use super::geometry::Geometry;
use crate::robot::RobotTable;
use crate::symbolic::{Expr, Graph, Symbol};
use dynid_description::{Coupling, ParameterKind, StandardParameter};
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// Columns of the drive parameters: the gear per unit of its diagonal, and the quadratic forms of the rotor inertias.
#[derive(Debug, Clone)]
pub struct DriveColumns {
    /// N[m][j] / N[m][m].
    relative: Vec<Vec<f64>>,
    /// A_j: ddq -> torques per unit Ia_j.
    inertia: Vec<Vec<Vec<f64>>>,
    couplings: Vec<Coupling>,
}

impl DriveColumns {
    /// From the gear matrix (motor speed = gear * joint speed).
    ///
    /// # Errors
    /// A motor that does not turn with its own joint.
    pub fn new(robot: &RobotTable) -> Result<Self, ModelError> {
        let drive = &robot.drive;
        for (row, (m, frame)) in drive.gear.iter().zip(robot.joint_frames().into_iter().enumerate()) {
            if row[m] == 0.0 {
                return Err(ModelError::ZeroGear { motor: robot.frames[frame].j });
            }
        }
        let relative =
            drive.gear.iter().enumerate().map(|(m, row)| row.iter().map(|x| x / row[m]).collect()).collect();
        let value = |x: &BigRational| x.to_f64().unwrap_or(f64::NAN);
        let inertia = drive
            .rotor_matrices()
            .iter()
            .map(|form| form.iter().map(|row| row.iter().map(value).collect()).collect())
            .collect();
        Ok(DriveColumns { relative, inertia, couplings: robot.couplings.clone() })
    }

    /// A_j of the rotor inertia Ia_j, row-major.
    pub fn rotor_form(&self, joint: usize) -> &[Vec<f64>] {
        &self.inertia[joint]
    }

    /// Torques of all joints per unit of a drive parameter of joint `joint`.
    pub fn column(
        &self,
        g: &mut Graph,
        geometry: &Geometry,
        parameter: &StandardParameter,
        joint: usize,
    ) -> Vec<Expr> {
        let n = self.relative.len();
        if let Some(distance) = self.distance(g, geometry, parameter) {
            let level = distance.level(g, self.rest_of_length(parameter));
            return distance.half_gradient.iter().map(|&slope| g.mul(level, slope)).collect();
        }
        let mut column = vec![Graph::ZERO; n];
        let dq = g.symbol(Symbol::Velocity(joint));
        match parameter.kind {
            ParameterKind::Ia => {
                for (row, weights) in self.inertia[joint].iter().enumerate() {
                    column[row] = weighted(g, weights, Symbol::Acceleration);
                }
            }
            ParameterKind::Fv => column[joint] = dq,
            ParameterKind::Fc => column[joint] = g.sign(dq),
            ParameterKind::Off => column[joint] = Graph::ONE,
            _ => {
                let form = self.acts_on(parameter, joint);
                let level = self.on_combination(g, parameter, &form);
                for (row, share) in form.into_iter().enumerate().filter(|(_, share)| *share != 0.0) {
                    column[row] = g.scale(share, level);
                }
            }
        }
        column
    }

    /// The combination of joints that friction of a motor, or a coupling of the table, acts on: one number per joint.
    fn acts_on(&self, parameter: &StandardParameter, joint: usize) -> Vec<f64> {
        match parameter.coupling {
            None => self.relative[joint].clone(),
            Some(k) => {
                let mut form = vec![0.0; self.relative.len()];
                self.couplings[k].terms.iter().for_each(|&(joint, c)| form[joint] = c);
                form
            }
        }
    }

    /// The torque on the combination `form` of joints, per unit of the parameter.
    fn on_combination(&self, g: &mut Graph, parameter: &StandardParameter, form: &[f64]) -> Expr {
        match parameter.kind {
            ParameterKind::Fvm | ParameterKind::Fvc => weighted(g, form, Symbol::Velocity),
            ParameterKind::Fcm | ParameterKind::Fcc => {
                let speed = weighted(g, form, Symbol::Velocity);
                g.sign(speed)
            }
            ParameterKind::K => {
                let s = weighted(g, form, Symbol::Position);
                let rest = g.constant(self.rest(parameter));
                g.sub(s, rest)
            }
            ParameterKind::KR => -Graph::ONE,
            _ => Graph::ZERO,
        }
    }

    /// Where a spring is at rest, as far as the table knows; 0 where it does not.
    fn rest(&self, parameter: &StandardParameter) -> f64 {
        parameter.coupling.and_then(|k| self.couplings[k].law.rest()).unwrap_or(0.0)
    }

    /// The distance that a spring between two points acts on.
    fn distance(
        &self,
        g: &mut Graph,
        geometry: &Geometry,
        parameter: &StandardParameter,
    ) -> Option<Distance> {
        let coupling = &self.couplings[parameter.coupling?];
        Some(Distance::new(g, geometry, &coupling.law.between()?, &coupling.terms))
    }

    /// The length at rest of a spring between two points per unit of K; `None` for KR.
    fn rest_of_length(&self, parameter: &StandardParameter) -> Option<f64> {
        (parameter.kind == ParameterKind::K).then(|| self.rest(parameter))
    }

    /// Energy per unit of a rotor inertia, or of a spring; friction and offsets store none.
    pub fn energy(
        &self,
        g: &mut Graph,
        geometry: &Geometry,
        parameter: &StandardParameter,
        joint: usize,
    ) -> Expr {
        if let Some(distance) = self.distance(g, geometry, parameter) {
            let length = distance.length(g);
            let Some(rest) = self.rest_of_length(parameter) else { return -length };
            let (half, stretched) = (g.scale(0.5, distance.square), g.scale(rest, length));
            return g.sub(half, stretched);
        }
        if parameter.kind.is_spring() {
            let form = self.acts_on(parameter, joint);
            let s = weighted(g, &form, Symbol::Position);
            if parameter.kind == ParameterKind::KR {
                return -s;
            }
            let half = g.scale(0.5, s);
            let rest = g.constant(self.rest(parameter));
            let mean = g.sub(half, rest);
            return g.mul(s, mean);
        }
        if parameter.kind != ParameterKind::Ia {
            return Graph::ZERO;
        }
        let mut double = Graph::ZERO;
        for (row, weights) in self.inertia[joint].iter().enumerate() {
            let momentum = weighted(g, weights, Symbol::Velocity);
            let dq = g.symbol(Symbol::Velocity(row));
            let term = g.mul(dq, momentum);
            double = g.add(double, term);
        }
        g.scale(0.5, double)
    }

    /// Power per unit of a drive parameter: dqT times its column; of what acts on a combination of joints, its speed times the torque on it.
    pub fn power(
        &self,
        g: &mut Graph,
        geometry: &Geometry,
        parameter: &StandardParameter,
        joint: usize,
    ) -> Expr {
        if let Some(distance) = self.distance(g, geometry, parameter) {
            let speeds: Vec<Expr> = (0..distance.half_gradient.len())
                .map(|k| {
                    let dq = g.symbol(Symbol::Velocity(k));
                    g.mul(dq, distance.half_gradient[k])
                })
                .collect();
            let (speed, level) = (g.sum(&speeds), distance.level(g, self.rest_of_length(parameter)));
            return g.mul(speed, level);
        }
        if parameter.kind > ParameterKind::Off {
            let form = self.acts_on(parameter, joint);
            let speed = weighted(g, &form, Symbol::Velocity);
            let level = self.on_combination(g, parameter, &form);
            return g.mul(speed, level);
        }
        let mut total = Graph::ZERO;
        for (row, entry) in self.column(g, geometry, parameter, joint).into_iter().enumerate() {
            let dq = g.symbol(Symbol::Velocity(row));
            let term = g.mul(dq, entry);
            total = g.add(total, term);
        }
        total
    }
}

fn weighted(g: &mut Graph, weights: &[f64], symbol: impl Fn(usize) -> Symbol) -> Expr {
    let mut total = Graph::ZERO;
    for (joint, &weight) in weights.iter().enumerate() {
        let s = g.symbol(symbol(joint));
        let term = g.scale(weight, s);
        total = g.add(total, term);
    }
    total
}
