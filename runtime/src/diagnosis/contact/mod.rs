//! Contact: windows of time in which something outside pushed the robot.

pub(in crate::diagnosis) mod search;
