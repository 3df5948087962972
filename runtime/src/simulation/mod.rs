//! A robot that exists only as numbers: plant, controller, sensors, and motions that excite it.
#![allow(
    clippy::needless_range_loop,
    reason = "joints, coordinates and matrix entries are numbered as in the equations"
)]

mod cholesky;
mod closed_loop;
mod consistency;
mod controller;
mod coupled_friction;
mod didim;
mod drive;
mod driven;
mod effect;
mod error;
pub mod excitation;
mod extra;
mod forward;
mod integrator;
mod less_friction;
mod lu;
mod plant;
mod push;
mod reference;
pub mod replay;
mod residue;
mod rosenbrock;
mod scheme;
mod sensors;
mod steps;
mod stiction;
mod stiff;
mod world;

pub use closed_loop::{LoopSettings, Simulation, simulate};
pub use consistency::check_standard;
pub use controller::ControllerSettings;
pub use didim::{DidimError, DidimEstimate, DidimSettings, Experiment, didim, simulated_motions};
pub use error::SimulationError;
pub use extra::{ExtraTorque, Instant};
pub use plant::{ElasticJoint, Hold, Plant, State};
pub use reference::{Reference, SampledReference};
pub use residue::Residue;
pub use scheme::Scheme;
pub use sensors::SensorSettings;
pub use world::World;

#[cfg(test)]
mod recovery_tests;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod world_tests;
