//! A joint with compliance and play.

use super::SimulationError;

/// Compliance and play between motor and link of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticJoint {
    /// 0-based joint.
    pub joint: usize,
    /// N.m/rad or N/m.
    pub stiffness: f64,
    /// N.m.s/rad or N.s/m.
    pub damping: f64,
    /// Total play, rad or m; 0 for none.
    pub play: f64,
}

/// Whether a joint can be simulated, given the rotor inertia of each.
pub(super) fn check_elastic(joint: &ElasticJoint, inertia: &[f64]) -> Result<(), SimulationError> {
    let setting = |what, expected, found| Err(SimulationError::Setting { what, expected, found });
    let Some(&rotor) = inertia.get(joint.joint) else {
        return setting("the elastic joint", "the number of a joint of the robot", (joint.joint + 1) as f64);
    };
    if !(joint.stiffness > 0.0 && joint.stiffness.is_finite()) {
        return setting("the stiffness of an elastic joint", "positive", joint.stiffness);
    }
    if !(joint.damping >= 0.0 && joint.damping.is_finite()) {
        return setting("the damping of an elastic joint", "zero or positive", joint.damping);
    }
    if !(joint.play >= 0.0 && joint.play.is_finite()) {
        return setting("the play of a joint", "zero or positive", joint.play);
    }
    if rotor <= 0.0 {
        return setting("Ia of an elastic joint", "positive", rotor);
    }
    Ok(())
}
