//! Why there is no diagnosis.

/// The normal equations of a design have no solution, ridge and all: a column or a torque is not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the normal equations of {columns} columns cannot be solved: a column or a torque is not a finite number"
)]
pub struct SingularDesign {
    /// Columns of the design.
    pub columns: usize,
}

/// Why the data cannot support a diagnosis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// A signal could not be prepared.
    #[error(transparent)]
    Signal(#[from] crate::signal::SignalError),
    /// The recursive model could not be built.
    #[error(transparent)]
    Model(#[from] crate::model::RecursiveModelError),
    /// A fit of the standard model or of a model with effects failed.
    #[error(transparent)]
    Singular(#[from] SingularDesign),
    /// A setting that cannot be.
    #[error("{option} {value}: it must be a positive, finite number")]
    Setting {
        /// Which.
        option: &'static str,
        /// What it was set to.
        value: f64,
    },
    /// Speeds of standstill for another number of joints.
    #[error("{given} speeds of standstill are given for a robot of {joints} joints")]
    StandstillSpeeds {
        /// Speeds given.
        given: usize,
        /// Joints of the robot.
        joints: usize,
    },
    /// The baseline is of a robot with another number of joints.
    #[error("the baseline has {given} joints, the recording {joints}: it is another robot's")]
    OtherBaseline {
        /// Joints of the baseline.
        given: usize,
        /// Joints of the robot.
        joints: usize,
    },
    /// No motion at all.
    #[error("the recording has no motion")]
    NoMotion,
    /// No joint moves for long enough, and no baseline tells what the robot is like.
    #[error(
        "no joint moves for long enough to conclude anything: joint {joint} moves most, in {rows} usable rows of the {needed} that a joint needs; let at least one joint move back and forth for ten seconds at two speeds, or give a baseline in which the robot moves"
    )]
    NothingMoves {
        /// Number j of the joint that moves most.
        joint: usize,
        /// Its rows.
        rows: usize,
        /// Rows that a joint needs.
        needed: usize,
    },
    /// Fewer rows than numbers.
    #[error(
        "the motion is too short: {rows} usable rows for {parameters} parameters of the standard model that it determines; record at least {times} times as long"
    )]
    TooShort {
        /// Rows of all joints.
        rows: usize,
        /// Parameters that they determine.
        parameters: usize,
        /// How much longer it should be.
        times: usize,
    },
    /// The standard model does not describe the recording at all.
    #[error(
        "the standard model explains only {explained:.0} % of the torque: is this the right robot, with the right units and joint order?"
    )]
    AnotherRobot {
        /// Per cent.
        explained: f64,
    },
}
