//! Two small robots, and recordings of them with known physics beyond the standard model.

// Each test program uses its own part of this.
#![allow(dead_code, unused_imports)]

mod hidden;
mod robots;

pub use hidden::{Hidden, term};
pub use robots::{Loop, SimulatedRobot, planar, planar_that_knows, planar_with, scara};
