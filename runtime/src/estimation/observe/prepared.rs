//! A motion on its way into rows.

use super::select::Selection;
use super::source::{EquationColumns, Source};
use crate::signal::{Decimator, KeptRows, Motion};

/// A motion with its decimation.
pub(super) struct Prepared<'a> {
    pub source: Box<dyn Source + 'a>,
    pub motion: &'a Motion,
    pub decimator: Decimator,
    pub grid: KeptRows,
    pub equations: Vec<EquationColumns>,
    pub selection: Vec<Selection>,
    /// For each equation the columns of the moments at which dry friction changes its sign ([`super::reversals`]).
    pub reversals: Vec<Vec<Vec<f64>>>,
}
