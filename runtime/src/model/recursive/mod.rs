//! The recursive reference model: numeric Newton-Euler over the table, for a robot that has no generated code.

mod columns;
mod composite;
mod distance;
mod drive;
mod error;
mod group;
mod kinematics;
mod newton_euler;
mod pattern;
#[cfg(test)]
mod tests;
mod torque;
mod vector;

pub use columns::{standard_energy, standard_idm, standard_power};
pub use error::{MAX_FRAMES, RecursiveModelError};
pub use kinematics::{Link, Row};
pub use newton_euler::RecursiveModel;
