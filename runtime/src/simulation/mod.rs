//! A robot that exists only as numbers: plant, controller, sensors, and motions that excite it.
//!
//! A [`Plant`] moves under motor torques, with stick and slip decided exactly; [`simulate`] closes the loop around it and
//! records what sensors see; [`excitation`] designs motions that make parameters visible.
//!
//! ```
//! use dynid_runtime::simulation::Plant;
//! # use dynid_runtime::model::{Drive, Frame, JointKind, Limits, RecursiveModel, Robot};
//! # let row = Frame::on_base(JointKind::Revolute);
//! # let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
//! # let mut robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], vec![row], drive, Limits::default());
//! # robot.base = robot.base.iter().filter(|p| ["ZZ1", "Fv1", "Fc1"].contains(&&*p.name)).cloned().collect();
//! # let model = RecursiveModel::new(robot)?;
//!
//! // An axis with 2 kg.m2 and Coulomb friction of 0.5 N.m, under 1.5 N.m for two seconds.
//! let mut plant = Plant::new(&model, &[2.0, 0.0, 0.5])?;
//! let mut state = plant.state(&[0.0], &[0.0]);
//! for _ in 0..2000 {
//!     plant.advance(&mut state, &[1.5], 1e-3)?;
//! }
//! assert!((state.dq[0] - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![allow(
    clippy::needless_range_loop,
    reason = "joints, coordinates and matrix entries are numbered as in the equations"
)]

mod closed_loop;
mod consistency;
mod controller;
mod coupled_friction;
mod didim;
mod drive;
mod driven;
mod effect;
mod elastic;
mod error;
pub mod excitation;
mod extra;
mod forward;
mod free;
mod integrator;
mod less_friction;
mod lu;
mod motion_file;
mod planned;
mod plant;
mod push;
mod reference;
#[cfg(feature = "diagnosis")]
pub mod replay;
mod residue;
mod rosenbrock;
mod scheme;
mod sensors;
mod state;
mod steps;
mod stiction;
mod stiff;
mod uncovered;
mod user;
mod work;
mod world;

pub use closed_loop::{LoopSettings, Simulation, simulate};
pub use consistency::check_standard;
pub use controller::ControllerSettings;
pub use didim::{DidimError, DidimEstimate, DidimSettings, Experiment, didim, simulated_motions};
pub use elastic::ElasticJoint;
pub use error::SimulationError;
pub use extra::{ExtraTorque, Instant};
pub use motion_file::{MotionFileError, from_csv, sampled, to_csv};
pub use planned::{PlanError, Planned, apart};
pub use plant::Plant;
pub use reference::{Reference, SampledReference, SampledReferenceError};
pub use residue::Residue;
pub use scheme::Scheme;
pub use sensors::SensorSettings;
pub use state::{Hold, State};
pub use world::World;

#[cfg(test)]
mod recovery_tests;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod world_tests;
