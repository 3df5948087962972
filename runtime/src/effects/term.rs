//! An accepted effect as part of a model: what it is, where, and its numbers.

use super::{EffectKind, Scale, Wrench};
use serde::{Deserialize, Serialize};

/// A quantity with its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Standard deviation; 0 where it is not known.
    pub sigma: f64,
    /// SI unit.
    pub unit: String,
}

impl Parameter {
    /// A quantity.
    pub fn new(name: &str, value: f64, sigma: f64, unit: &str) -> Self {
        Self { name: name.into(), value, sigma, unit: unit.into() }
    }
}

/// Where in the robot an effect acts; joints and frames are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// A joint.
    Joint(usize),
    /// One of the numbers of a sensitivity, as its effect counts its variants.
    Variant(usize),
    /// A frame that carries a body.
    Link(usize),
    /// Two joints, the second one's motor turning with both.
    Pair(usize, usize),
    /// The whole robot.
    Robot,
}

/// An effect that has become part of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectTerm {
    /// Which.
    pub effect: EffectKind,
    /// Where.
    pub place: Place,
    /// Numbers j of the joints it is named on.
    pub joints: Vec<usize>,
    /// Shape of the law, as the effect defines it.
    pub shape: Vec<f64>,
    /// Amplitude of each column.
    pub amplitude: Vec<f64>,
    /// Standard deviation of each amplitude.
    pub sigma: Vec<f64>,
    /// Scales the law was made with, where it is a law of a joint.
    pub scale: Option<TermScale>,
    /// Forces, where it is a contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wrenches: Vec<Wrench>,
}

/// [`Scale`], saved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct TermScale {
    pub speed: f64,
    pub range: f64,
    pub torque: f64,
    pub duration: f64,
    pub gear: f64,
    pub prismatic: bool,
}

impl TermScale {
    /// A revolute joint with speed, travel, torque, time and gear of one: shapes are numbers in SI as they stand.
    pub const UNIT: Self =
        Self { speed: 1.0, range: 1.0, torque: 1.0, duration: 1.0, gear: 1.0, prismatic: false };
}

impl From<Scale> for TermScale {
    fn from(s: Scale) -> Self {
        Self {
            speed: s.speed,
            range: s.range,
            torque: s.torque,
            duration: s.duration,
            gear: s.gear,
            prismatic: s.prismatic,
        }
    }
}

impl From<TermScale> for Scale {
    fn from(s: TermScale) -> Self {
        Self {
            speed: s.speed,
            range: s.range,
            torque: s.torque,
            duration: s.duration,
            gear: s.gear,
            prismatic: s.prismatic,
        }
    }
}
