//! Where the mass of a link can be.

use serde::{Deserialize, Serialize};

/// The points p with (p - centre)ᵀ shape⁻¹ (p - centre) at most 1, in some frame, m.
///
/// ```
/// use dynid_description::Ellipsoid;
///
/// let ball = Ellipsoid { centre: [0.1, 0.0, 0.0], shape: [[0.04, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.04]] };
/// assert_eq!(ball.shape[0][0].sqrt(), 0.2, "its radius");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ellipsoid {
    /// Its centre, m.
    pub centre: [f64; 3],
    /// Symmetric and positive definite, m²: eigenvectors are its axes, eigenvalues the squares of its radii.
    pub shape: [[f64; 3]; 3],
}
