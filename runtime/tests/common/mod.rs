//! Two small robots, and recordings of them with known physics beyond the standard model.

mod hidden;
#[allow(dead_code)]
mod robots;

pub use hidden::Hidden;
// Each test program uses its own part of this.
#[allow(unused_imports)]
pub use robots::{SimulatedRobot, planar, scara};
