//! Two small robots, and recordings of them with known physics beyond the standard model.

mod hidden;
mod robots;

pub use hidden::Hidden;
pub use robots::{SimulatedRobot, planar, scara};
