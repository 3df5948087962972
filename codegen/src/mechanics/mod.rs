//! From the table, symbolically: kinematics, energy h, power dh, inverse dynamic rows, mass matrix and bias.

mod columns;
mod drive;
mod energy;
mod forward;
mod geometry;
mod inverse;
mod model;
mod motion;
mod vector;

pub use geometry::{Geometry, Link, Rotation};
pub use model::{Equations, ModelCounts, ModelError};

#[cfg(test)]
mod random_tables;
#[cfg(test)]
mod tests;
