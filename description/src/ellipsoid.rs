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

impl Ellipsoid {
    /// One with these radii, m, along axes that are turned by roll, pitch and yaw, rad: Rot(z, yaw) Rot(y, pitch) Rot(x, roll).
    ///
    /// ```
    /// use dynid_description::Ellipsoid;
    ///
    /// let upright = Ellipsoid::with_axes([0.0; 3], [0.3, 0.1, 0.1], [0.0, -std::f64::consts::FRAC_PI_2, 0.0]);
    /// assert!((upright.shape[2][2].sqrt() - 0.3).abs() < 1e-15, "x is up");
    /// ```
    pub fn with_axes(centre: [f64; 3], radii: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
        let axes = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        // Products in one order, so that the matrix is symmetric to the last digit.
        let entry = |i: usize, k: usize| {
            let (i, k) = (i.min(k), i.max(k));
            (0..3).map(|a| axes[i][a] * axes[k][a] * radii[a] * radii[a]).sum()
        };
        Self { centre, shape: std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k))) }
    }
}
