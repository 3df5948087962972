//! What of a URDF is taken, and how.

use dynid_description::bounds::NEGLIGIBLE;

/// What of a URDF is taken, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportOptions {
    /// Name of the link that does not move: frame 0; the root where it is not given.
    pub base: Option<String>,
    /// Name of the last link of a chain; every joint beyond the base moves where it is not given.
    pub tip: Option<String>,
    /// Angles this close to a multiple of pi/4, rad, are taken for it.
    pub snap: f64,
    /// Gravity in the frame of the URDF's root link, m/s2.
    pub gravity: [f64; 3],
}

impl Default for ImportOptions {
    /// The whole tree, gravity along -z of the root. Below the tolerance an angle is a rounding error for dynid's tables too.
    fn default() -> Self {
        Self { base: None, tip: None, snap: NEGLIGIBLE, gravity: [0.0, 0.0, -9.81] }
    }
}
