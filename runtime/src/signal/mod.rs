//! Filters, differentiation, decimation, spectra.
//!
//! [`prepare()`] makes a [`Motion`] of a recorded trajectory: a uniform grid, positions filtered without phase shift,
//! speeds and accelerations by central differences. The parts of it serve alone as well:
//!
//! ```
//! use dynid_runtime::signal::{Butterworth, Stencil, central_difference};
//!
//! let rate = 500.0;
//! let signal: Vec<f64> = (0..1000).map(|k| (3.0 * k as f64 / rate).sin()).collect();
//! let smooth = Butterworth::low_pass(4, 50.0, rate)?.zero_phase(&signal)?;
//! let mut speed = vec![0.0; smooth.len()];
//! central_difference(&smooth, rate, Stencil::Three, &mut speed);
//! assert!((speed[500] - 3.0 * (3.0_f64 * 500.0 / rate).cos()).abs() < 1e-3);
//! # Ok::<(), dynid_runtime::signal::SignalError>(())
//! ```

mod butterworth;
mod decimator;
mod difference;
mod error;
mod motion;
#[cfg(test)]
mod oracle;
mod prepare;
mod resample;
mod rounding;
mod speeds;
mod standstill;
mod welch;

pub use butterworth::{Butterworth, Section};
pub use decimator::{Decimator, KeptRows};
pub use difference::{Stencil, central_difference};
pub use error::SignalError;
pub use motion::Motion;
pub(crate) use prepare::smoothed;
pub use prepare::{Preparation, VelocitySource, prepare, prepare_all};
pub use resample::UniformGrid;
pub use rounding::rounding_of_means;
pub use speeds::{SpeedFault, contradicting_speeds};
pub use standstill::StandstillSpeeds;
pub use welch::{Spectrum, welch};
