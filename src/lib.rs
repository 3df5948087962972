//! From a modified Denavit-Hartenberg table to a dynamic model that can be trusted.
//!
//! [`models`] holds the closed-form regressors generated from `robots/` at build time, [`robots`] finds a robot
//! by name or by path; identification, simulation and diagnosis live in [`dynid_runtime`].
#![deny(missing_docs)]

pub mod arguments;
pub mod body_report;
pub mod commands;
pub mod compared;
pub mod errors;
pub mod estimated;
pub mod failure;
pub mod meshes;
pub mod models;
pub mod motions;
pub mod near_bodies;
pub mod origin;
pub mod output;
pub mod pages;
pub mod paper_tables;
pub mod provenance;
pub mod ranges;
pub mod recorded;
pub mod recording_files;
pub mod robots;
pub mod saved;
pub mod speeds;
pub mod start;
pub mod truth;
pub mod urdf_files;
pub mod verdict;
pub mod words;
