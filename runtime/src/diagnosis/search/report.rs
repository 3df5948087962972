//! How a search ended.

use crate::diagnosis::outcome::StopReason;
use crate::diagnosis::search::term::Accepted;

/// Why a search stopped, and what it took out of the model again.
pub(in crate::diagnosis) struct SearchReport {
    pub stop: StopReason,
    pub removed: Vec<Accepted>,
}
