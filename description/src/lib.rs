//! A robot as plain numbers: what a generator of models and the programs that use the models both have to know.
#![deny(missing_docs)]

mod base_parameter;
mod drive;
mod frame;
mod joint;
mod limits;
mod nominal;
mod parameter;
mod robot;
mod standard;

pub use base_parameter::BaseParameter;
pub use drive::Drive;
pub use frame::{Frame, JointKind};
pub use joint::{JointIndex, JointNumber};
pub use limits::Limits;
pub use nominal::Nominal;
pub use parameter::{ParameterKind, StandardParameter};
pub use robot::Robot;
pub use standard::standard_parameters;
