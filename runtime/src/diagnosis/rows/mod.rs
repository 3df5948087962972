//! Rows: torques and columns of a recording, where a joint surely moves.

pub(in crate::diagnosis) mod additions;
pub(in crate::diagnosis) mod bent;
mod by_blocks;
mod columns;
pub(in crate::diagnosis) mod context;
pub(in crate::diagnosis) mod design;
pub(in crate::diagnosis) mod fit;
pub(in crate::diagnosis) mod free;
pub(in crate::diagnosis) mod gram;
pub(in crate::diagnosis) mod links;
pub(in crate::diagnosis) mod motion;
pub(in crate::diagnosis) mod prior;
pub(in crate::diagnosis) mod scales;
pub(in crate::diagnosis) mod selection;
pub(in crate::diagnosis) mod series;
pub(in crate::diagnosis) mod signals;
pub(in crate::diagnosis) mod uncovered;
pub(in crate::diagnosis) mod user;
