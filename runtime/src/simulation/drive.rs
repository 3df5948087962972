//! Friction, offsets and rotor inertias of the drives, as torques on the coordinates of a plant.

use nalgebra::DMatrix;

use super::SimulationError;
use crate::model::{ParameterKind, Robot, StandardParameter};

/// One place where dry friction acts: a joint, a motor that several joints turn, or a combination of joints.
#[derive(Debug, Clone)]
pub(crate) struct DryElement {
    /// Slip velocity = sum of factor * velocity of the coordinate.
    pub direction: Vec<(usize, f64)>,
    /// The joint, where the element is one joint's own; effects add to its level.
    pub joint: Option<usize>,
    /// Coulomb torque, N.m or N.
    pub level: f64,
}

impl DryElement {
    /// Slip velocity for the given velocities of the coordinates.
    #[inline]
    pub fn slip(&self, dq: &[f64]) -> f64 {
        self.direction.iter().map(|&(c, factor)| factor * dq[c]).sum()
    }

    /// Adds `scale` times the element's direction to torques on the coordinates.
    #[inline]
    pub fn add(&self, scale: f64, torque: &mut [f64]) {
        for &(c, factor) in &self.direction {
            torque[c] += factor * scale;
        }
    }
}

/// Viscous and dry friction and offsets, on the motor-side coordinates.
#[derive(Debug, Clone)]
pub(crate) struct DriveFriction {
    /// (row, column, coefficient) of the viscous matrix.
    pub viscous: Vec<(usize, usize, f64)>,
    /// (coordinate, torque).
    pub offset: Vec<(usize, f64)>,
    /// Joints first, then motors with friction of their own and combinations of joints.
    pub elements: Vec<DryElement>,
}

impl DriveFriction {
    /// Collects the friction parameters of a parameter set. `coordinate[j]` is the coordinate on which the motor
    /// side of joint j sits. Joints without Coulomb friction get an element only with `every_joint`.
    ///
    /// # Errors
    /// A negative friction coefficient: such a plant would feed itself.
    pub fn new<'a>(
        robot: &Robot,
        parameters: impl Iterator<Item = (&'a str, &'a StandardParameter, f64)>,
        coordinate: &[usize],
        every_joint: bool,
    ) -> Result<Self, SimulationError> {
        let joint_of = robot.joint_of_frame();
        let n = coordinate.len();
        let mut viscous = DMatrix::<f64>::zeros(n, n);
        let mut offset = Vec::new();
        let mut coulomb = vec![0.0; n];
        let mut combined = Vec::new();
        for (name, parameter, value) in parameters {
            let Some(j) = joint_of[parameter.frame] else { continue };
            if parameter.kind.is_friction() && value < 0.0 {
                return Err(SimulationError::NegativeParameter { name: name.to_string(), value });
            }
            if value == 0.0 {
                continue;
            }
            match parameter.kind {
                ParameterKind::Fc => coulomb[j] += value,
                ParameterKind::Off => offset.push((coordinate[j], value)),
                kind if kind.is_viscous() => {
                    let form = robot.acts_on(parameter);
                    for &(a, ca) in &form {
                        for &(b, cb) in &form {
                            viscous[(a, b)] += value * ca * cb;
                        }
                    }
                }
                kind if kind.is_coulomb() => {
                    let form = robot.acts_on(parameter);
                    let direction = form.into_iter().map(|(s, c)| (coordinate[s], c)).collect();
                    combined.push(DryElement { direction, joint: None, level: value });
                }
                _ => {}
            }
        }
        let mut elements: Vec<DryElement> = (0..n)
            .filter(|&j| every_joint || coulomb[j] > 0.0)
            .map(|j| DryElement { direction: vec![(coordinate[j], 1.0)], joint: Some(j), level: coulomb[j] })
            .collect();
        elements.extend(combined);
        let viscous = (0..n * n)
            .filter(|&k| viscous[(k / n, k % n)] != 0.0)
            .map(|k| (coordinate[k / n], coordinate[k % n], viscous[(k / n, k % n)]))
            .collect();
        Ok(Self { viscous, offset, elements })
    }
}

/// Inertia Ja of each rotor at the motor, from `inertia[j]` = Ia_j: equation (26) of Gautier and Briot solved,
/// Ja = ((N∘N)ᵀ)⁻¹·Ia. Where N∘N has no inverse (a differential) Ia_m stands for N_mm²·Ja_m.
pub(crate) fn rotor_inertias(robot: &Robot, inertia: &[f64]) -> Vec<f64> {
    let n = inertia.len();
    let gear = DMatrix::from_row_slice(n, n, &robot.drive.gear);
    match gear.map(|x| x * x).transpose().try_inverse() {
        Some(inverse) => (0..n).map(|m| (0..n).map(|j| inverse[(m, j)] * inertia[j]).sum()).collect(),
        None => (0..n).map(|m| inertia[m] / (gear[(m, m)] * gear[(m, m)])).collect(),
    }
}

/// Nᵀ·diag(Ja)·N: what the rotors add to the mass matrix, n x n row-major, from `inertia[j]` = Ia_j.
pub(crate) fn rotor_matrix(robot: &Robot, inertia: &[f64]) -> Vec<f64> {
    let n = inertia.len();
    let ja = rotor_inertias(robot, inertia);
    let gear = |m: usize, j: usize| robot.drive.gear[m * n + j];
    (0..n * n).map(|k| (0..n).map(|m| gear(m, k / n) * ja[m] * gear(m, k % n)).sum()).collect()
}
