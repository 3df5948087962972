//! Why motions cannot be observed.

use crate::model::JointNumber;
use crate::signal::SignalError;

/// Misuse of the observation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObserveError {
    /// Too many joints.
    #[error("{found} joints: at most 32 are supported")]
    TooManyJoints {
        /// Joints of the robot.
        found: usize,
    },
    /// A motion of another robot.
    #[error("{motion} has {found} joints: the robot has {expected}")]
    Joints {
        /// Name of the motion.
        motion: String,
        /// Joints of the motion.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// Channels of different length.
    #[error("{motion}: its channels do not have the same number of samples")]
    Samples {
        /// Name of the motion.
        motion: String,
    },
    /// A fixed joint that is none.
    #[error("{motion}: joint {joint} is said to be fixed, but there is no such joint")]
    FixedJoint {
        /// Name of the motion.
        motion: String,
        /// Its number, or one that no joint has.
        joint: JointNumber,
    },
    /// Band or rate that mean nothing.
    #[error("{what} must be a positive number of Hz, not {value}")]
    Frequency {
        /// `band` or `rate`.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The standstill policy names another number of joints.
    #[error("{found} standstill speeds: the robot has {expected} joints")]
    StandstillSpeeds {
        /// Speeds given.
        found: usize,
        /// Joints of the robot.
        expected: usize,
    },
    /// Observations that do not go together.
    #[error("the observations have different unknowns or equations")]
    OtherUnknowns,
    /// No row is left in any motion.
    #[error("no row can be used: {reason}")]
    NoRows {
        /// Why.
        reason: String,
    },
    /// The decimation filter cannot be made.
    #[error(transparent)]
    Signal(#[from] SignalError),
}
