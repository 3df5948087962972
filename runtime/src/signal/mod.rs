//! Filters, differentiation, decimation, spectra.

mod motion;

pub use motion::Motion;
