//! Misuse of the simulation, and plants that cannot exist. Equation numbers are those of Gautier and Briot.

use crate::model::JointNumber;
use thiserror::Error;

/// Why something cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A slice of the wrong length.
    #[error("{expected} {what} expected, {found} given")]
    Length {
        /// What was counted.
        what: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A number that is NaN or infinite.
    #[error("{name} is not a finite number")]
    NotFinite {
        /// The parameter or setting.
        name: String,
    },
    /// A parameter that cannot be negative.
    #[error("{name} = {value} is negative: no real {name} is")]
    NegativeParameter {
        /// The parameter.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A link whose mass distribution no body can have.
    #[error(
        "link {link} cannot exist: its pseudo-inertia has the eigenvalue {smallest:.3e}, all must be positive; \
         check its mass, first moments and inertia (the triangle inequality about the centre of mass)"
    )]
    InconsistentLink {
        /// Number j of the frame.
        link: usize,
        /// Smallest eigenvalue of the pseudo-inertia.
        smallest: f64,
    },
    /// Rotor inertias Ia that leave a motor with a negative one (26).
    #[error(
        "the Ia of the joints give motor {motor} the rotor inertia {inertia:.3e}: a motor that several joints turn \
         is part of the Ia of each of them"
    )]
    NegativeRotor {
        /// Number of the motor: that of its own joint.
        motor: JointNumber,
        /// Its inertia, kg.m2 at the motor.
        inertia: f64,
    },
    /// The mass matrix has lost its positive definiteness.
    #[error(
        "the mass matrix is not positive definite at t = {time:.4} s: the parameters do not belong to a real robot"
    )]
    MassMatrix {
        /// Simulated time, s.
        time: f64,
    },
    /// The state has left all bounds.
    #[error("the simulation diverged at t = {time:.4} s: lower the controller gains or the step")]
    Diverged {
        /// Simulated time, s.
        time: f64,
    },
    /// A setting out of its range.
    #[error("{what} must be {expected}, not {found}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
    /// A robot without limits.
    #[error("{}", without_limits(robot, missing, *joints))]
    NoLimits {
        /// The robot.
        robot: String,
        /// Which limits: keys of `limits:`.
        missing: Vec<&'static str>,
        /// Its joints.
        joints: usize,
    },
    /// A motion whose torque stays above the limits however slow it is.
    #[error(
        "the motion takes {share:.2} of a torque limit even when it is slow: gravity or friction alone needs too much"
    )]
    TorqueLimit {
        /// Largest share of a limit.
        share: f64,
    },
    /// A robot without the parameters that simulation needs.
    #[error(
        "{robot} has no nominal parameters: give them under `nominal:` in its YAML, or simulate a saved model"
    )]
    NoNominal {
        /// The robot.
        robot: String,
    },
}

/// Which limits a robot lacks, and what is to be written where.
fn without_limits(robot: &str, missing: &[&'static str], joints: usize) -> String {
    let names = match missing {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    };
    let numbers = (1..=joints).map(|j| format!("joint {j}")).collect::<Vec<_>>().join(", ");
    let keys: Vec<String> = missing.iter().map(|key| format!("{key}: [<{numbers}>]")).collect();
    format!(
        "{robot} has no {names} limits. Add to its YAML, under `limits:`, a key beside `frames:` (`dynid import` writes the YAML of a URDF):\n  \
         limits: {{{}}}\nwith one number for a symmetric limit, or [low, high], for each joint; rad, rad/s, rad/s2, of \
         prismatic joints m, m/s, m/s2",
        keys.join(", ")
    )
}
