//! Random series for the tests.

use crate::{Observation, Series};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

pub(crate) struct Noise(pub(crate) Pcg64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed))
    }

    /// Standard normal (Box and Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        let (u, v): (f64, f64) = (1.0 - self.0.random::<f64>(), self.0.random());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.0.random()
    }

    /// Stationary AR(1) with unit variance.
    pub(crate) fn ar1(&mut self, days: usize, rho: f64) -> Vec<f64> {
        let mut state = self.normal();
        (0..days)
            .map(|_| {
                let now = state;
                state = rho * state + (1.0 - rho * rho).sqrt() * self.normal();
                now
            })
            .collect()
    }
}

/// A series of one value a day from day 20000 on.
pub(crate) fn series(robot: &str, values: impl IntoIterator<Item = f64>) -> Series {
    let observations = (20_000..)
        .zip(values)
        .map(|(day, value)| Observation { day, value, sigma: 0.1, temperature: None, load: None })
        .collect();
    Series {
        robot: robot.into(),
        table: "arm".into(),
        parameter: "Fc1".into(),
        unit: "N.m".into(),
        observations,
    }
}

/// A healthy fleet of one parameter: own level, AR(1) of unit variance.
pub(crate) fn fleet(noise: &mut Noise, robots: usize, days: usize, rho: f64) -> Vec<Series> {
    (0..robots)
        .map(|r| {
            let level = 50.0 + 3.0 * noise.normal();
            series(&format!("r{r:03}"), noise.ar1(days, rho).into_iter().map(|x| level + x))
        })
        .collect()
}
