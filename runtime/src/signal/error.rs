//! What a caller of the signal routines can get wrong.

use thiserror::Error;

/// Misuse, or a signal that is too short for what was asked.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// A cut-off that is not between 0 and half the sampling rate.
    #[error("cut-off {cutoff} Hz: it must lie between 0 and {limit} Hz, half the sampling rate")]
    Cutoff {
        /// The cut-off asked for, Hz.
        cutoff: f64,
        /// Half the sampling rate, Hz.
        limit: f64,
    },
    /// A filter order of 0 or above 20.
    #[error("filter order {0}: it must lie between 1 and 20")]
    Order(usize),
    /// Too few samples.
    #[error("{name}: {samples} samples, at least {needed} are needed to {purpose}")]
    TooShort {
        /// The motion or signal.
        name: String,
        /// Samples it has.
        samples: usize,
        /// Samples it needs.
        needed: usize,
        /// What they are needed for.
        purpose: &'static str,
    },
    /// A sampling rate that is not positive and finite.
    #[error("sampling rate {0} Hz: it must be positive and finite")]
    Rate(f64),
    /// Time stamps that do not increase, or are not finite.
    #[error("{name}: time does not increase at row {row}")]
    Time {
        /// The motion.
        name: String,
        /// First row (0-based) whose time is not after the one before it.
        row: usize,
    },
    /// Channels that do not have one value per time stamp.
    #[error("{name}: a channel has {found} values for {expected} time stamps")]
    Shape {
        /// The motion.
        name: String,
        /// Values found.
        found: usize,
        /// Values expected.
        expected: usize,
    },
    /// A value that is not finite.
    #[error("{name}: a value is not finite")]
    NotFinite {
        /// The motion or signal.
        name: String,
    },
    /// A decimation factor of 0.
    #[error("decimation by 0: the factor must be at least 1")]
    Factor,
    /// A pass band that is not between 0 and the new Nyquist frequency.
    #[error("cut-off at {0} of the new Nyquist frequency: it must lie above 0 and at most at 1")]
    Band(f64),
    /// A filter longer than the working memory allows: a band or a rate far below the recording's.
    #[error("a filter of {0:e} samples is too long: the band or the rate is too low for this recording")]
    TooManyTaps(f64),
    /// More samples than the working memory allows.
    #[error("{name}: {samples} samples on the uniform grid are too many; are the time stamps right?")]
    TooLong {
        /// The motion.
        name: String,
        /// Samples that the grid would have.
        samples: f64,
    },
}
