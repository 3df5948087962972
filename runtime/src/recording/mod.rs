//! Recordings: manifests, files, units, trajectories.

mod trajectory;

pub use trajectory::Trajectory;
