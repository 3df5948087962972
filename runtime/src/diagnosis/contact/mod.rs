//! Contact: windows of time in which something outside pushed the robot.

pub(in crate::diagnosis) mod force;
pub(in crate::diagnosis) mod residual;
pub(in crate::diagnosis) mod search;
pub(in crate::diagnosis) mod windows;
