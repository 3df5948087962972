//! Numbers of joints that are far off: the zeros of encoders, as where a table has another convention, and the factors of the
//! torques of drives.
//!
//! The derivative by an angle says where a small one leads, and of a quarter of a turn next to nothing. The model is linear in its
//! parameters at every value, so that each is one fit. A scan needs neither all instants nor the mean of a column over a window:
//! over the width of a window a column bends far less than it differs from that of another angle.

mod descent;
mod instants;
mod zeros;

// Single numbers, and what imitates them, are looked for by the diagnosis.
#[cfg(feature = "diagnosis")]
pub(crate) use descent::Descent;
pub(crate) use instants::Instants;
#[cfg(feature = "diagnosis")]
pub(crate) use instants::{Number, Wrong};
#[cfg(feature = "diagnosis")]
pub(crate) use zeros::Zeros;
pub(crate) use zeros::zeros;

/// Instants that numbers are tried on. Numerics: some rows for every parameter.
pub(crate) const INSTANTS: usize = 240;
/// Least angle, rad, and logarithm of a factor that are taken: derivatives at nothing lead to smaller ones. Mechanics.
pub(crate) const LEAST: f64 = 0.35;
/// A number is taken for wrong where one joint is left with this part of its squares by it, the others as they are. Judgement: a
/// smaller error is a law among others, and no other physics is imitated so well.
pub(crate) const LEAVES: f64 = 0.5;
/// No joint is left with so many times its squares.
pub(crate) const WORSENS: f64 = 1.25;
/// Sums of the joints' logarithms of squares that differ by less leave as little. Statistics: some sixty independent rows tell a
/// tenth of the squares of one joint.
pub(crate) const AS_LITTLE: f64 = 0.1;
