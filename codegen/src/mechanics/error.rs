//! Why a robot has no model.

/// Why a robot has no model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A motor must turn with its own joint.
    #[error(
        "the gear ratio of motor {motor} to its own joint is zero; give a matrix with a diagonal free of zeros"
    )]
    ZeroGear {
        /// Number of the motor: j of its own joint in the table.
        motor: usize,
    },
}
