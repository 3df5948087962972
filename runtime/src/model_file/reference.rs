//! A saved model as what is known of its robot: how well its parameters are known, and the reference that recordings are judged against.

use super::covariance::amplitude_name;
use super::error::FileError;
use super::identified::Identified;
use crate::diagnosis::Reference;
use crate::model::Robot;
use nalgebra::DMatrix;

impl Identified {
    /// Covariance of the base parameters of a robot, in its order, with the standard deviations that the file names and the
    /// correlations that it has; a row of zeros is of what is not determined, or not known.
    pub fn base_covariance(&self, robot: &Robot) -> DMatrix<f64> {
        let sigma = |name: &str| {
            let named = self.base_parameters.iter().find(|p| p.name == name);
            named.and_then(|p| p.sigma).filter(|s| s.is_finite() && *s > 0.0).unwrap_or(0.0)
        };
        let sigma: Vec<f64> = robot.base.iter().map(|b| sigma(&b.name)).collect();
        let place = |name: &str| self.covariance.as_ref()?.of.iter().position(|own| own == name);
        let places: Vec<Option<usize>> = robot.base.iter().map(|b| place(&b.name)).collect();
        let correlation = |i: usize, k: usize| {
            let (Some(known), Some(a), Some(b)) = (&self.covariance, places[i], places[k]) else {
                return 0.0;
            };
            let size = (known.entry(a, a) * known.entry(b, b)).sqrt();
            if size > 0.0 { known.entry(a, b) / size } else { 0.0 }
        };
        let n = sigma.len();
        DMatrix::from_fn(n, n, |i, k| sigma[i] * sigma[k] * if i == k { 1.0 } else { correlation(i, k) })
    }

    /// The model as a reference that recordings of the same robot are judged against. What the file has no covariance of
    /// is taken to vary by itself, with its standard deviation.
    ///
    /// # Errors
    /// The field that cannot be, and why.
    pub fn reference(&self, robot: &Robot) -> Result<Reference, FileError> {
        let wrong = |field: &str, what: &str| FileError::new(field.to_owned(), what);
        let missing = |name: String| wrong("base_parameters", &format!("{name} of the robot is not there"));
        let chi = self.chi(robot).map_err(missing)?;
        let own = |name: &str| self.base_parameters.iter().find(|p| p.name == name)?.sigma;
        let mut names: Vec<(String, f64)> = Vec::new();
        for base in robot.base.iter() {
            names.push((base.name.to_string(), own(&base.name).unwrap_or(f64::INFINITY)));
        }
        for (i, effect) in self.effects.iter().enumerate() {
            for k in 0..effect.amplitude.len() {
                let sigma = effect.sigma.get(k).copied().filter(|s| *s > 0.0).unwrap_or(f64::INFINITY);
                names.push((amplitude_name(i, k), sigma));
            }
        }
        let places: Vec<Option<usize>> = names
            .iter()
            .map(|(name, _)| self.covariance.as_ref()?.of.iter().position(|own| own == name))
            .collect();
        let n = names.len();
        let covariance = DMatrix::from_fn(n, n, |i, k| match (&self.covariance, places[i], places[k]) {
            (Some(known), Some(a), Some(b)) => known.entry(a, b),
            _ if i == k => names[i].1 * names[i].1,
            _ => 0.0,
        });
        let diagonal = places.iter().any(Option::is_none);
        let reference = Reference::new(chi, self.effects.clone(), self.delay, covariance, diagonal)
            .map_err(|error| wrong("covariance", &error.to_string()))?
            .delay_known_to(self.delay_sigma.unwrap_or(0.0))
            .differing_by(self.between_motions.clone());
        Ok(match &self.standstill {
            Some(speeds) => reference.standing_below(speeds.clone()),
            None => reference,
        })
    }
}
