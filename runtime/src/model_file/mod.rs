//! A saved model: one JSON file that predicts and simulates anywhere, without the robot's YAML and without this build.
//!
//! It is an [`Identified`] model: the base parameters with their uncertainty, the effects and the delay that were found
//! with them, the band they were identified in, the robot's whole table as numbers, and a [`fingerprint`] of it that
//! says whether a robot of the same name is still the same robot. [`read`] refuses a file with the path of the first
//! field that cannot be: nothing that it returns can make an evaluation fail for its shape.
//!
//! ```text
//! schema_version   1
//! dynid_version    what wrote it
//! robot            name, or path of the YAML as it was given
//! table            gravity, frames, drive, limits, parameters and their regrouping
//! fingerprint      16 hexadecimal digits
//! base_parameters  chi, in the table's order
//! effects, delay   what a diagnosis found; seconds by which torques are later than positions
//! band             Hz, of the equations that chi was identified from
//! ```
//!
//! A file without `schema_version` is one from before there were any: it has no table, and is read with the robot that
//! its `robot` names.

mod bodies;
mod check;
mod covariance;
mod error;
mod fingerprint;
mod identified;
mod reference;
mod robot_yaml;
mod rows;
mod table;

pub use bodies::{Bodies, Impossible, LinkEllipsoid};
pub use check::{check, read};
pub use covariance::Covariance;
pub use error::FileError;
pub use fingerprint::{difference, fingerprint};
pub use identified::{
    EssentialParameters, Identified, NamedParameter, RecordedFrom, SCHEMA, SimulatedStates, doubt,
};
pub use robot_yaml::to_yaml;
pub use rows::{EquationRows, EvaluatedRows};

#[cfg(test)]
mod tests;
