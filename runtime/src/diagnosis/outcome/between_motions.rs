//! How much a joint's torques differ from one motion to the next.

use serde::{Deserialize, Serialize};

/// How much laws of one joint differ between motions in which nothing has changed: mean statistics, for each of a law's
/// numbers, of a change in one stretch of motion against all other motions; 1 where noise is all that differs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BetweenMotions {
    /// Of laws, friction's level being free in every motion.
    pub laws: f64,
    /// Degrees of freedom that [`Self::laws`] is known with.
    pub laws_freedom: f64,
    /// Of viscous and Coulomb friction.
    pub friction: f64,
    /// Degrees of freedom that [`Self::friction`] is known with.
    pub friction_freedom: f64,
    /// Mean duration of a stretch, s.
    pub stretch: f64,
}

impl BetweenMotions {
    /// Whether every number is one that there can be.
    pub fn is_possible(&self) -> bool {
        let positive = [self.laws_freedom, self.friction_freedom, self.stretch];
        let statistics = [self.laws, self.friction];
        positive.iter().all(|x| x.is_finite() && *x > 0.0)
            && statistics.iter().all(|x| x.is_finite() && *x >= 0.0)
    }
}
