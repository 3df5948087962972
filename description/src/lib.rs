//! A robot as plain numbers: what a generator of models and the programs that use the models both have to know.
//!
//! ```
//! use dynid_description::{Drive, Frame, JointKind, Limits, Robot};
//!
//! let frame = Frame::on_base(JointKind::Revolute);
//! let drive = Drive { gear: vec![100.0].into(), coupled_friction: vec![].into() };
//! let robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], vec![frame], drive, Limits::default());
//!
//! let names: Vec<&str> = robot.standard.iter().map(|p| p.name.as_ref()).collect();
//! assert_eq!(names[..3], ["XX1", "XY1", "XZ1"]);
//! assert_eq!(names[10..], ["Ia1", "Fv1", "Fc1", "off1"]);
//! let saved = serde_json::to_string(&robot)?;
//! assert_eq!(serde_json::from_str::<Robot>(&saved)?, robot);
//! # Ok::<(), serde_json::Error>(())
//! ```
#![deny(missing_docs)]

mod base_parameter;
pub mod bounds;
mod coupling;
mod dependent;
mod drive;
mod ellipsoid;
pub mod formula;
mod frame;
mod joint;
mod limits;
mod nominal;
mod parameter;
mod robot;
mod standard;
mod standard_parameter;

pub use base_parameter::BaseParameter;
pub use coupling::{Between, Coupling, CouplingLaw};
pub use dependent::{DependentFrame, MAX_TERMS, Motion, motions};
pub use drive::Drive;
pub use ellipsoid::Ellipsoid;
pub use frame::{Frame, JointKind};
pub use joint::{JointIndex, JointNumber};
pub use limits::Limits;
pub use nominal::Nominal;
pub use parameter::ParameterKind;
pub use robot::Robot;
pub use standard::standard_parameters;
pub use standard_parameter::StandardParameter;
