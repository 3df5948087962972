//! What is told of a finding.

/// A parameter is told to have shifted beyond this many standard deviations of the difference. Statistics.
pub(in crate::diagnosis) const SHIFTED: f64 = 3.0;
/// Step of a position, rad or m, over which the derivative of a torque is taken. Numerics: small against a turn, large
/// against rounding.
pub(in crate::diagnosis) const POSITION_STEP: f64 = 1e-4;
/// Step of a shape, relative to it, over which the derivative of its columns is taken. Mechanics: small against its
/// standard deviation, large against rounding.
pub(in crate::diagnosis) const SHAPE_STEP: f64 = 0.02;
/// The same for the derivative of a quantity.
pub(in crate::diagnosis) const QUANTITY_STEP: f64 = 1e-4;
/// Largest standard deviation of a shape that is told, relative to the shape. Judgement: beyond it nothing is known.
pub(in crate::diagnosis) const LARGEST_SHAPE_SIGMA: f64 = 10.0;
/// Standard deviation of a play, relative to it, where the joint rings above the band. Measured: every knock sets off a
/// ringing that is not seen, stiffness and damping are whatever leaves least of the knocks, and where between the flanks the
/// link is when the next one comes differs with them. A model of this kind is off by more than noise makes it
/// (model discrepancy, Kennedy and O'Hagan 2001): by 8 % (root mean square) in 53 simulated recordings of three robots.
pub(in crate::diagnosis) const PLAY_BESIDE_UNSEEN: f64 = 0.08;
/// Bins of a curve. Words and plots only.
pub(in crate::diagnosis) const BINS: usize = 40;
/// Part of a residual that a variable must order to be named. Words only.
pub(in crate::diagnosis) const ORDERED_BY_VARIABLE: f64 = 0.1;
/// Part of the mismatch of all joints below which a joint has none. Words only.
pub(in crate::diagnosis) const LEAST_MISMATCH: f64 = 0.02;
/// Fewest second differences that a noise floor is estimated from. Statistics: known to a quarter.
pub(in crate::diagnosis) const LEAST_DIFFERENCES: f64 = 10.0;
/// Part of what remains that must be more than noise to be told. Words only.
pub(in crate::diagnosis) const UNEXPLAINED: f64 = 0.3;
/// From so many times the error of fitted motion on, motions are said not to show what predicts motion that was held out. Words
/// only.
pub(in crate::diagnosis) const NOT_SHOWN: f64 = 5.0;
