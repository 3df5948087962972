//! Reference values from scipy, made by `runtime/tests/oracles/filters.py`.

use serde::Deserialize;

#[derive(Deserialize)]
pub(super) struct Oracle {
    pub filtfilt: Vec<FiltFilt>,
    pub decimate: Vec<Decimate>,
    pub spline: Vec<Spline>,
    pub gradient: Vec<Gradient>,
    pub welch: Vec<Welch>,
}

#[derive(Deserialize)]
pub(super) struct FiltFilt {
    pub order: usize,
    pub cutoff: f64,
    pub rate: f64,
    pub input: Vec<f64>,
    pub output: Vec<f64>,
}

#[derive(Deserialize)]
pub(super) struct Decimate {
    pub factor: usize,
    pub first: usize,
    pub input: Vec<f64>,
    pub output: Vec<f64>,
    pub taps: Vec<f64>,
}

#[derive(Deserialize)]
pub(super) struct Spline {
    pub time: Vec<f64>,
    pub input: Vec<f64>,
    pub rate: f64,
    pub output: Vec<f64>,
}

#[derive(Deserialize)]
pub(super) struct Gradient {
    pub rate: f64,
    pub input: Vec<f64>,
    pub output: Vec<f64>,
}

#[derive(Deserialize)]
pub(super) struct Welch {
    pub rate: f64,
    pub segment: usize,
    pub input: Vec<f64>,
    pub frequency: Vec<f64>,
    pub density: Vec<f64>,
}

pub(super) fn oracle() -> Oracle {
    serde_json::from_str(include_str!("../../tests/oracles/filters.json")).expect("the oracle file is JSON")
}

/// Largest difference, relative to the largest reference value.
pub(super) fn worst(ours: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(ours.len(), reference.len());
    let scale = reference.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    ours.iter().zip(reference).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale
}
