//! Explanation: from accepted effects to numbers, curves and sentences.

pub(in crate::diagnosis) mod curves;
pub(in crate::diagnosis) mod explain;
pub(in crate::diagnosis) mod quantities;
pub(in crate::diagnosis) mod standstill;
pub(in crate::diagnosis) mod words;
