//! Fleets from end to end: in this process, on a cluster of processes of their own, from a web server. One program, because
//! linking the engine takes longer than running it.
#![allow(clippy::unwrap_used)]

mod cluster;
mod common;
mod embedded;
mod listing;
#[cfg(feature = "s3")]
mod s3;
mod store;
