//! Contact: windows of time in which something outside pushed the robot.

pub(in crate::diagnosis) mod absorbed;
pub(in crate::diagnosis) mod borne_once;
pub(in crate::diagnosis) mod common;
pub(in crate::diagnosis) mod curves;
pub(in crate::diagnosis) mod felt;
pub(in crate::diagnosis) mod force;
pub(in crate::diagnosis) mod half_waves;
pub(in crate::diagnosis) mod in_place;
pub(in crate::diagnosis) mod largest;
pub(in crate::diagnosis) mod memory;
pub(in crate::diagnosis) mod moving;
pub(in crate::diagnosis) mod noise;
pub(in crate::diagnosis) mod residual;
pub(in crate::diagnosis) mod rest;
pub(in crate::diagnosis) mod scan;
pub(in crate::diagnosis) mod search;
pub(in crate::diagnosis) mod silent;
pub(in crate::diagnosis) mod spread;
pub(in crate::diagnosis) mod squares;
pub(in crate::diagnosis) mod standing;
pub(in crate::diagnosis) mod suspects;
pub(in crate::diagnosis) mod track;
pub(in crate::diagnosis) mod uneven;
pub(in crate::diagnosis) mod white;
pub(in crate::diagnosis) mod windows;
