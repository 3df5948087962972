//! What is done with rows where a joint hardly moves.

use crate::signal::StandstillSpeeds;

/// What is done with rows where the joint of the equation hardly moves.
///
/// At rest the sign of the speed is noise and friction takes any value below its break-away level, so that such
/// rows pull Coulomb friction towards zero. The power model keeps all rows: what rests has no power.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Standstill {
    /// Rows are left out where the joint is slower than 2 % of its fast speed or than the noise of its speed, or
    /// turns within the reach of the row: [`StandstillSpeeds`].
    #[default]
    Automatic,
    /// The same with speeds that were detected before: on the first piece of a long recording.
    Detected(StandstillSpeeds),
    /// Every row is used.
    Keep,
    /// Rows where the joint is slower than this share of its fastest speed in the motion are left out.
    BelowShare(f64),
    /// Rows where joint j is slower than the j-th value, rad/s or m/s, are left out.
    Below(Vec<f64>),
}
