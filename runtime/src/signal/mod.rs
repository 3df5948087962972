//! Filters, differentiation, decimation, spectra.

mod butterworth;
mod decimator;
mod difference;
mod error;
mod motion;
#[cfg(test)]
mod oracle;
mod prepare;
mod resample;
mod standstill;
mod welch;

pub use butterworth::{Butterworth, Section};
pub use decimator::{Decimator, KeptRows};
pub use difference::{Stencil, central_difference};
pub use error::SignalError;
pub use motion::Motion;
pub use prepare::{Preparation, VelocitySource, prepare, prepare_all};
pub use resample::UniformGrid;
pub use standstill::StandstillSpeeds;
pub use welch::{Spectrum, welch};
