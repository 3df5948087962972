//! How much a prior counts beside the data: the largest weight at which the error to be expected is about the least (Mallows
//! 1973; Stein 1981).
//!
//! The minimum x(γ) of [`Search`] has base parameters that differ from the true ones, in units of their uncertainty, by an error
//! whose expected square is that of
//!
//! ‖K x(γ) - chi‖² + 2 c df(γ) - c n, df = tr ∂(K x)/∂chi,
//!
//! n being the number of base parameters that the data determine and df how many of them the data decide at that weight, the
//! bounds that hold a body included. It holds whatever the truth is, a wrong prior or no body at all: of the prior nothing is
//! assumed. A prior that agrees with the data leaves the first term where it is and saves of the second; one that does not
//! raises the first. In the metric of their information base parameters are torques of the motion that was recorded, so that
//! the weight is that of the least error of these.
//!
//! c is the variance of chi over that of its covariance, as it is estimated from the largest model in Mallows' Cp and in quasi
//! likelihood (Burnham and Anderson 2002, section 2.5): the least distance that bodies can have over the number of directions
//! that they cannot follow, n - df there, and never less than 1. Robots are made of bodies, so that what no body has is an error.
//! Given these directions the least distance is a chi squared of as many (Shapiro 1988).
//!
//! With next to no weight a body that the data hold back stands at the rim of what bodies can be, and little tells its expected
//! error from that of others. Of weights that differ by less than c, the error of one identified parameter, the largest is taken.

use nalgebra::DVector;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::prior::NearPriorError;
use super::prior_problem::Search;

/// The first weight of the prior, with which the data hardly count, and the factor from one to the next.
const FIRST: f64 = 1e12;
const NEXT: f64 = 0.1;
/// The last weight, and the change of the distance over a decade, relative to it and to one parameter, that ends the way
/// earlier.
const LAST: f64 = 1e-8;
const SETTLED: f64 = 1e-3;
/// Bisections of the logarithm of the weight between two of a decade.
const BISECTIONS: usize = 8;

/// Parameters that are nearest to a prior of some weight.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub gamma: f64,
    pub x: DVector<f64>,
    /// Squared distance of their base parameters from the identified ones.
    pub distance: f64,
}

/// A weight and why.
#[derive(Debug, Clone)]
pub(super) struct Chosen {
    pub minimum: Minimum,
    /// df: how many base parameters the data decide.
    pub freedom: f64,
    /// c.
    pub dispersion: f64,
    /// Chance of a least distance as large as this one where bodies have the true values.
    pub p_value: f64,
}

impl Minimum {
    fn new(search: &Search, gamma: f64, start: DVector<f64>) -> Result<Self, NearPriorError> {
        let x = search.minimum(gamma, start)?;
        Ok(Self { gamma, distance: search.distance(&x), x })
    }

    /// df.
    fn freedom(&self, search: &Search) -> Result<f64, NearPriorError> {
        let not_found = NearPriorError::NotConverged;
        let (step, _) = search.newton(self.gamma, &self.x).ok_or(not_found)?;
        Ok(step.part_of(&(&search.normal / self.gamma)).ok_or(not_found)?.sum())
    }
}

/// Minima with less and less weight of the prior, until the distance has settled: the last one is the least that there is.
pub(super) fn path(search: &Search) -> Result<Vec<Minimum>, NearPriorError> {
    let mut path = vec![Minimum::new(search, FIRST, search.start.clone())?];
    while let Some(last) = path.last()
        && last.gamma > LAST
    {
        let next = last.gamma * NEXT;
        // Where rounding takes over, the way is at its end.
        let Ok(found) = Minimum::new(search, next, last.x.clone()) else { break };
        let settled = next < 1.0 && last.distance - found.distance < SETTLED * (1.0 + found.distance);
        path.push(found);
        if settled {
            break;
        }
    }
    Ok(path)
}

/// The minimum of the largest weight whose expected error is the least of a path but for that of one parameter.
pub(super) fn choose(search: &Search, path: &[Minimum]) -> Result<Chosen, NearPriorError> {
    let freedoms: Vec<f64> = path.iter().map(|m| m.freedom(search)).collect::<Result<_, _>>()?;
    let (Some(last), Some(freedom)) = (path.last(), freedoms.last()) else {
        return Err(NearPriorError::NotConverged);
    };
    let lost = (search.determined as f64 - freedom).max(1.0);
    let dispersion = (last.distance / lost).max(1.0);
    let p_value = ChiSquared::new(lost).map_or(f64::NAN, |chi2| chi2.sf(last.distance));
    let expected = |distance: f64, freedom: f64| distance + 2.0 * dispersion * freedom;
    let risks: Vec<f64> = path.iter().zip(&freedoms).map(|(m, f)| expected(m.distance, *f)).collect();
    let allowed = risks.iter().copied().fold(f64::INFINITY, f64::min) + dispersion;
    let first = risks.iter().position(|risk| *risk <= allowed).unwrap_or(path.len() - 1);
    let mut chosen = (path[first].clone(), freedoms[first]);
    if let Some(before) = first.checked_sub(1) {
        // From bodies nearer to the prior, which are farther from the rim of what is possible.
        let mut above = path[before].clone();
        for _ in 0..BISECTIONS {
            let middle = (chosen.0.gamma * above.gamma).sqrt();
            let found = Minimum::new(search, middle, above.x.clone())?;
            let freedom = found.freedom(search)?;
            if expected(found.distance, freedom) <= allowed {
                chosen = (found, freedom);
            } else {
                above = found;
            }
        }
    }
    let (minimum, freedom) = chosen;
    Ok(Chosen { minimum, freedom, dispersion, p_value })
}

#[cfg(test)]
#[path = "prior_weight_tests.rs"]
mod tests;
