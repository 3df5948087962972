//! Lines over a position: order spectra and torque ripple.

/// Highest order per motor turn: beyond the sixth harmonic of a motor's torque. Mechanics; torque_ripple.
pub(in crate::diagnosis) const HIGHEST_ORDER: f64 = 7.0;
/// Gear that is assumed where a smaller one or none is known: few robots have a larger one. Mechanics.
pub(in crate::diagnosis) const ASSUMED_GEAR: f64 = 100.0;
/// Most orders of a spectrum. Times only.
pub(in crate::diagnosis) const MOST_ORDERS: usize = 600;
/// Periods that must fit into the travel. Statistics: fewer are a slow curve over the position.
pub(in crate::diagnosis) const LEAST_PERIODS: f64 = 4.0;
/// Orders are this many waves over the travel apart: 2.5 within the width of a peak. Statistics.
pub(in crate::diagnosis) const ORDER_STEP: f64 = 0.4;
/// Part of half of the sampling rate up to which a wave is fitted. Mechanics.
pub(in crate::diagnosis) const PART_OF_NYQUIST: f64 = 0.6;
/// Samples a second that a spectrum uses. Times only.
pub(in crate::diagnosis) const SPECTRUM_RATE: f64 = 1000.0;
/// Fewest samples of a spectrum's value. Statistics.
pub(in crate::diagnosis) const LEAST_SAMPLES: f64 = 100.0;
/// Spectra use samples faster than this many times the standstill speed: the noise of the sign is gone. Mechanics.
pub(in crate::diagnosis) const SPECTRUM_STANDSTILL_FACTOR: f64 = 3.0;
/// A peak stands out above this many medians. Statistics: of Rayleigh's amplitudes one in 6e4 does.
pub(in crate::diagnosis) const PEAK_OVER_MEDIAN: f64 = 4.0;
/// Peaks of a joint that are tried as ripple beside the orders of the catalogue. Judgement.
pub(in crate::diagnosis) const PEAKS: usize = 2;

/// Orders per motor turn that cogging, current offsets, gear teeth and wave generators have. Mechanics.
pub(in crate::diagnosis) const LINE_MULTIPLES: [f64; 6] = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0];
/// Part of the sampling rate up to which recorded torques are taken for what they say. Mechanics: four fifths of what
/// can be sampled at all.
pub(in crate::diagnosis) const RECORDED_BAND: f64 = 0.4;
/// Parts of that band in which a wave is sought. Mechanics: a position loop reaches a twentieth to a fifth of the rate at
/// which a robot is recorded, and its motor answers to no ripple that is faster.
pub(in crate::diagnosis) const LINE_BANDS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
/// Part of the cut-off of the positions below which a wave has its whole amplitude. Mechanics: there a filter of the fourth
/// order, forwards and backwards, lets 99.6 % of the acceleration through that a controller leaves of it.
pub(in crate::diagnosis) const LINE_FOLLOWED: f64 = 0.5;
/// Largest standard deviation of an amplitude from there, as a part of what all of the motion shows. Judgement: what is known
/// worse than by a third is told as the torque shows it, with a deviation of what it may lack.
pub(in crate::diagnosis) const LINE_TOLD: f64 = 1.0 / 3.0;
/// Orders of a spectrum that are looked at besides.
pub(in crate::diagnosis) const LINE_PICKED: usize = 4;
/// How far a known order must stand above the larger median of the orders on both sides of it to be a line of a motion.
/// Statistics: an amplitude of noise does once in 2,000 orders (`statistics::greatest_of`); how sure the line of all motions is,
/// of all orders that were tried, is judged besides.
pub(in crate::diagnosis) const LINE_ABOVE: f64 = 3.3;
/// The same for an order that was picked from a spectrum. Statistics: once in 60,000.
pub(in crate::diagnosis) const LINE_PICKED_ABOVE: f64 = 4.2;
/// Least fraction that one half of a motion predicts for the other. Judgement: a line worth its name; lines of noise
/// stay below 0.012.
pub(in crate::diagnosis) const LINE_LEAST_FRACTION: f64 = 0.02;
/// What is slower than so many waves is not the line. Mechanics.
pub(in crate::diagnosis) const LINE_SLOWER: f64 = 4.0;
/// Waves that each half of a motion must pass. Statistics.
pub(in crate::diagnosis) const LINE_LEAST_WAVES: f64 = 8.0;
/// Samples that each half must have. Statistics.
pub(in crate::diagnosis) const LINE_LEAST_SAMPLES: usize = 100;
/// Orders on each side that a line is compared with. Statistics: a median of sixteen on each side.
pub(in crate::diagnosis) const LINE_AROUND: usize = 16;
/// Steps of what the travel resolves that a line covers itself on each side. Mechanics: its main lobe.
pub(in crate::diagnosis) const LINE_COVERED: usize = 3;
