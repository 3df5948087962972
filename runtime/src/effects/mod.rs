//! The catalogue of physics that the standard model leaves out: one file per effect.
//!
//! An effect is written once. Laws of a single joint are a [`JointLaw`]: evaluated sample by sample they are columns
//! of an identification, evaluated inside an integrator they are a torque of a simulation. Errors of the model's own
//! numbers are a [`Sensitivity`]: their columns are exact derivatives of the model. Compliant transmissions are a
//! [`Compliance`]: their torque is the response of the link that is driven through them.

mod added_mass;
mod asymmetric_friction;
mod backlash;
mod base_tilt;
mod compliance;
mod contact;
mod coupled_transmission;
mod friction_drift;
mod friction_level_change;
mod geometry_error;
mod joint_elasticity;
mod joint_law;
mod kind;
mod load_dependent_friction;
mod nonlinear_viscous;
mod payload;
mod position_dependent_friction;
mod position_offset;
mod presliding_hysteresis;
mod rigid_body;
mod sensitivity;
mod spring;
mod stribeck;
mod term;
mod time_delay;
mod torque_constant_error;
mod torque_ripple;
mod torque_saturation;
mod wrong_sample_rate;

pub use compliance::{Compliance, Transmission, deflection};
pub use contact::{JointTorque, Wrench, unit_force_torques};
pub use coupled_transmission::CoupledTransmission;
pub use joint_law::{At, JointLaw, Scale};
pub use kind::{EffectKind, Form, Words};
pub use rigid_body::{BodyOnLink, Lump, body_columns};
pub use sensitivity::{Direction, Seeds, Sensitivity, Variant, derivable, derivative};
pub use term::{EffectTerm, Parameter, Place, TermScale};
