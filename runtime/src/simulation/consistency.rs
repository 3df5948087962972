//! Physical consistency of standard parameters: what a real body can have.
//! Equation numbers are those of Gautier and Briot.

use nalgebra::{Matrix4, SymmetricEigen};

use super::SimulationError;
use super::drive::rotor_inertias;
use crate::model::{JointIndex, ParameterKind, Robot};

/// Checks that a standard parameter set can belong to real bodies.
///
/// The pseudo-inertia of every link, fixed ones included, is positive definite (Wensing, Kim and Slotine 2018);
/// a link whose ten parameters are all zero does not exist and passes. Rotor inertias, at the motors as well
/// (26), and friction coefficients are not negative.
///
/// # Errors
/// [`SimulationError::InconsistentLink`] names the first link that cannot exist,
/// [`SimulationError::NegativeParameter`] the first parameter with the wrong sign,
/// [`SimulationError::NegativeRotor`] the first motor whose inertia would be negative,
/// [`SimulationError::Length`] a set of the wrong length.
pub fn check_standard(robot: &Robot, standard: &[f64]) -> Result<(), SimulationError> {
    if standard.len() != robot.standard.len() {
        return Err(SimulationError::Length {
            what: "standard parameters",
            expected: robot.standard.len(),
            found: standard.len(),
        });
    }
    for (parameter, &value) in robot.standard.iter().zip(standard) {
        use ParameterKind::{Ia, M};
        if !value.is_finite() {
            return Err(SimulationError::NotFinite { name: parameter.name.to_string() });
        }
        if (matches!(parameter.kind, M | Ia) || parameter.kind.is_friction()) && value < 0.0 {
            return Err(SimulationError::NegativeParameter { name: parameter.name.to_string(), value });
        }
    }
    let joint_of = robot.joint_of_frame();
    let mut inertia = vec![0.0; robot.joints()];
    for (parameter, &value) in robot.standard.iter().zip(standard) {
        if let (ParameterKind::Ia, Some(j)) = (parameter.kind, joint_of[parameter.frame]) {
            inertia[j] = value;
        }
    }
    for (motor, &rotor) in rotor_inertias(robot, &inertia).iter().enumerate() {
        if rotor < 0.0 {
            let motor = robot.joint_number(JointIndex(motor));
            return Err(SimulationError::NegativeRotor { motor, inertia: rotor });
        }
    }
    for frame in 0..robot.frames.len() {
        let pseudo = pseudo_inertia(robot, standard, frame);
        if pseudo.iter().all(|&x| x == 0.0) {
            continue;
        }
        let eigenvalues = SymmetricEigen::new(pseudo).eigenvalues;
        let smallest = eigenvalues.min();
        if smallest <= 1e-12 * eigenvalues.amax() {
            return Err(SimulationError::InconsistentLink { link: frame + 1, smallest });
        }
    }
    Ok(())
}

/// Pseudo-inertia of a link: [[Σ, MS], [MSᵀ, M]] with Σ = ½·tr(J)·E - J, kg.m², kg.m, kg.
fn pseudo_inertia(robot: &Robot, standard: &[f64], frame: usize) -> Matrix4<f64> {
    let of = |kind: ParameterKind| {
        robot
            .standard
            .iter()
            .zip(standard)
            .find(|(p, _)| p.frame == frame && p.kind == kind)
            .map_or(0.0, |(_, &value)| value)
    };
    use ParameterKind::{M, MX, MY, MZ, XX, XY, XZ, YY, YZ, ZZ};
    let half_trace = 0.5 * (of(XX) + of(YY) + of(ZZ));
    let (xy, xz, yz) = (-of(XY), -of(XZ), -of(YZ));
    let (x, y, z) = (half_trace - of(XX), half_trace - of(YY), half_trace - of(ZZ));
    Matrix4::new(
        x,
        xy,
        xz,
        of(MX), //
        xy,
        y,
        yz,
        of(MY), //
        xz,
        yz,
        z,
        of(MZ), //
        of(MX),
        of(MY),
        of(MZ),
        of(M),
    )
}
