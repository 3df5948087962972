//! Where in a robot an effect acts.

use super::user_law::UserLaw;
use serde::{Deserialize, Serialize};

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
    /// A joint, and the one whose torque it feels.
    Hears(usize, usize),
    /// The joint of a law of the user, with the law.
    Law(UserLaw),
    /// The whole robot.
    Robot,
}

impl Place {
    /// The joint, where it is one.
    pub fn joint(self) -> Option<usize> {
        if let Self::Joint(j) = self { Some(j) } else { None }
    }

    /// The number of the variant, where it is one.
    pub fn variant(self) -> Option<usize> {
        if let Self::Variant(v) = self { Some(v) } else { None }
    }

    /// The frame, where it is one.
    pub fn link(self) -> Option<usize> {
        if let Self::Link(k) = self { Some(k) } else { None }
    }

    /// The two joints, where there are two.
    pub fn pair(self) -> Option<[usize; 2]> {
        if let Self::Pair(a, b) = self { Some([a, b]) } else { None }
    }

    /// The joint that feels another one, and that one.
    pub fn hears(self) -> Option<[usize; 2]> {
        if let Self::Hears(a, b) = self { Some([a, b]) } else { None }
    }

    /// The law of the user, where there is one.
    pub fn law(self) -> Option<UserLaw> {
        if let Self::Law(law) = self { Some(law) } else { None }
    }

    /// The joint whose state and scales a law of a joint at this place is made from: its own, the one that it feels, or
    /// where all joints share a law, the first one for all.
    pub fn law_of(self) -> Option<usize> {
        match self {
            Self::Joint(j) | Self::Hears(_, j) => Some(j),
            Self::Robot => Some(0),
            Self::Variant(_) | Self::Link(_) | Self::Pair(..) | Self::Law(_) => None,
        }
    }

    /// Joints, of `count`, whose residual something at this place must explain a share of.
    pub fn joints(self, count: usize) -> Vec<usize> {
        match self {
            Self::Joint(j) | Self::Hears(j, _) => vec![j],
            Self::Pair(a, b) => vec![a, b],
            Self::Law(law) => vec![law.joint()],
            Self::Variant(_) | Self::Link(_) | Self::Robot => (0..count).collect(),
        }
    }
}
