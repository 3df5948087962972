//! Why a robot has no recursive model.

pub use dynid_description::bounds::MAX_FRAMES;

/// Why a robot has no recursive model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecursiveModelError {
    /// The table is too long.
    #[error("{found} frames: at most {MAX_FRAMES} are supported")]
    TooManyFrames {
        /// Frames in the table.
        found: usize,
    },
    /// A parent that is not an earlier row.
    #[error("frame {frame}: its parent must be an earlier row of the table")]
    ParentOrder {
        /// 1-based row.
        frame: usize,
    },
    /// A frame that moves with joints that are not there.
    #[error("frame {frame}: it moves with joints that are not there, or with too many")]
    Dependent {
        /// 1-based row.
        frame: usize,
    },
    /// Friction or a spring on joints that are not there.
    #[error("{name}: friction or a spring on joints that are not there, or with coefficients that are none")]
    Coupling {
        /// Its name.
        name: String,
    },
    /// The gear matrix does not fit the joints.
    #[error("the gear matrix has {found} entries: {joints} joints need {}", joints * joints)]
    GearShape {
        /// Entries found.
        found: usize,
        /// Joints n.
        joints: usize,
    },
    /// A motor that does not turn with its own joint.
    #[error("gear row {motor}: its diagonal entry must not be zero and all entries must be finite")]
    GearDiagonal {
        /// 1-based motor.
        motor: usize,
    },
    /// A base or standard parameter that points outside its table.
    #[error("base parameter {name}: it refers to a standard parameter or a frame that does not exist")]
    Parameter {
        /// Its name.
        name: String,
    },
}
