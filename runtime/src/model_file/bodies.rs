//! How an identified model was made one of bodies, as it is saved.

use serde::{Deserialize, Serialize};

/// How near the base parameters of bodies are to the identified ones, and what keeps them from being nearer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bodies {
    /// Number of base parameters that the data determine.
    pub determined: usize,
    /// Squared distance of their values from the identified ones, in units of their uncertainty.
    pub distance: f64,
    /// The least that bodies can have of it.
    pub least: f64,
    /// Weight of the prior: the largest with about the least expected error of the torques (Mallows' Cp).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior_weight: Option<f64>,
    /// How many of the determined base parameters the data decide with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_data: Option<f64>,
    /// Variance of the identified values over that of their covariance, by the least distance; 1 or more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dispersion: Option<f64>,
    /// Relative error of the torques as they were identified, and with the bodies of the least distance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_errors: Option<[Option<f64>; 2]>,
    /// Each moving body's ellipsoid, where the prior has geometry.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ellipsoids: Vec<LinkEllipsoid>,
    /// Distance and least distance without any ellipsoid, where there are some.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_ellipsoids: Option<[f64; 2]>,
    /// Links and rotors that cannot be as they were identified, the one that costs most first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub impossible: Vec<Impossible>,
}

/// What holds the body of a link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinkEllipsoid {
    /// Row of the table.
    pub frame: usize,
    /// Name of the link in the prior.
    pub link: String,
    /// How far within it the body lies: 1 for a point at the centre, 0.4 for one that fills it evenly, 0 at the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// The same of the prior.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_of_prior: Option<f64>,
    /// Whether the body would leave it.
    pub active: bool,
    /// Why there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub none_because: Option<String>,
}

/// A link or a rotor that no body can be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Impossible {
    /// `link 5`, `rotor 3`, by the table.
    pub what: String,
    /// The least distance where it alone need not be a body, or positive.
    pub least: f64,
    /// Relative error of the torques there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_error: Option<f64>,
}
