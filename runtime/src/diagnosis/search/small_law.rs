//! What is there and not named.

use crate::diagnosis::search::bench::Size;
use crate::effects::{EffectKind, Place};

/// A law that is there and too small to be named.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct SmallLaw {
    pub effect: EffectKind,
    pub place: Place,
    pub own: Vec<usize>,
    pub size: Size,
}
