//! dynid on the recordings of a fleet of robots.
//!
//! One recording is the unit of work: it is read and reduced where it lies, and what travels is a triangle of some 15 kB. The
//! engine is Apache DataFusion, in one process or on a Ballista cluster; dynid's part are functions with names
//! ([`functions`]), which a user's own SQL can call too. `docs/fleet.md` says what goes where and what was measured.
#![deny(missing_docs)]

mod cells;
pub mod cluster;
mod columns;
pub mod commands;
pub mod day;
pub mod diagnose;
pub mod engine;
pub mod error;
pub mod fetch;
pub mod fleet_file;
pub mod functions;
pub mod pattern;
pub mod place;
pub mod reduce;
pub mod rise;
pub mod run;
pub mod simulated;
pub mod stamp;
pub mod work;
