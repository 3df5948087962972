//! What is known of a robot's bodies beforehand, and what it must agree with.

use nalgebra::DMatrix;

use crate::model::{Ellipsoid, ParameterKind, Robot};

/// What is known of a robot's bodies before any recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Each frame's body, XX XY XZ YY YZ ZZ MX MY MZ M at its origin; its pseudo-inertia must be positive definite.
    /// `None` for a frame that carries nothing: its parameters are 0.
    pub bodies: Vec<Option<[f64; 10]>>,
    /// What of each frame's link is known and fixed on it (a tool), not counted in `bodies`.
    pub attached: Vec<[f64; 10]>,
    /// Rotor inertia of each joint, where it is known.
    pub rotors: Vec<Option<f64>>,
    /// What each frame's body lies in, without what is attached; `None` where nothing is known.
    pub ellipsoids: Vec<Option<Ellipsoid>>,
}

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NearPriorError {
    /// Arguments of other lengths than the robot has parameters, frames or joints.
    #[error("prior, parameters and covariance are not those of one robot")]
    Shape,
    /// A prior body with a density that is negative or vanishes.
    #[error("the prior of frame {} is no body", .0 + 1)]
    Prior(usize),
    /// An ellipsoid whose shape is not positive definite.
    #[error("the ellipsoid of frame {} has no volume", .0 + 1)]
    Ellipsoid(usize),
    /// A link or rotor of which parameters are known to be 0, but not all ten of a link.
    #[error(
        "frame {}: some of its parameters are known to be 0, which no body and no rotor has: all ten of a link are (massless), or none",
        .0 + 1
    )]
    Known(usize),
    /// No parameter has an uncertainty.
    #[error("no base parameter has an uncertainty: nothing says how near they must be")]
    NoInformation,
    /// Newton's method did not arrive.
    #[error("the search for bodies did not converge")]
    NotConverged,
}

/// Whether the arguments are of one robot, and its known parameters of bodies as a whole.
pub(super) fn check(
    robot: &Robot,
    chi: &[f64],
    covariance: &DMatrix<f64>,
    prior: &Prior,
) -> Result<(), NearPriorError> {
    let n = robot.base.len();
    let shapes = chi.len() == n
        && covariance.shape() == (n, n)
        && prior.bodies.len() == robot.frames.len()
        && prior.attached.len() == robot.frames.len()
        && prior.ellipsoids.len() == robot.frames.len()
        && prior.rotors.len() == robot.joints();
    if !shapes {
        return Err(NearPriorError::Shape);
    }
    for frame in 0..robot.frames.len() {
        let zero = |of: &dyn Fn(ParameterKind) -> bool| {
            robot.known.iter().map(|&k| &robot.standard[k]).filter(|p| p.frame == frame && of(p.kind)).count()
        };
        let body = zero(&|kind| ParameterKind::INERTIAL.contains(&kind));
        if zero(&|kind| kind == ParameterKind::Ia) > 0
            || body > 0 && (body < 10 || prior.bodies[frame].is_some())
        {
            return Err(NearPriorError::Known(frame));
        }
    }
    Ok(())
}
