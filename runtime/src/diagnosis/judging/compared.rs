//! Units of a recording in which nothing has changed, each with the motion that it is compared with.

use crate::diagnosis::judging::projection::Projection;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::wald::Wald;
use crate::diagnosis::judging::white_products::{Products, sum};
use nalgebra::DMatrix;

/// A part of the motion that is compared with the rest.
pub(super) struct Compared {
    /// Inner products over the part and the rest.
    pub whole: DMatrix<f64>,
    /// Its first columns: the model, and where it may be there in all motion, the law.
    pub model: Option<Projection>,
    /// Units that are each compared with this whole.
    pub units: Vec<usize>,
}

impl Compared {
    pub fn new(whole: DMatrix<f64>, m: usize, units: Vec<usize>) -> Self {
        Self { model: Projection::of(&whole, m), whole, units }
    }

    /// Wald's statistic of the law in a unit.
    pub fn wald(&self, unit: &DMatrix<f64>, (p, k): (usize, usize)) -> Option<Wald> {
        Wald::beside(self.model.as_ref()?, &self.whole, unit, (p, k))
    }
}

/// The units in which nothing has changed, each with what it is compared with: against a baseline its other motions, or
/// its other units where it is one motion; without one, the whole recording `all`.
pub(super) fn undisturbed(units: &Units, products: &Products, all: &DMatrix<f64>, m: usize) -> Vec<Compared> {
    let count = units.units.len();
    if !units.change() {
        return vec![Compared::new(all.clone(), m, (0..count).collect())];
    }
    if let Some(others) = with_other_motions(units, products, m, |f| !units.is_target(f)) {
        return others;
    }
    with_other_units(units, products, m)
}

/// The units of a baseline, each with all of it.
pub(super) fn with_other_units(units: &Units, products: &Products, m: usize) -> Vec<Compared> {
    let old: Vec<usize> = (0..units.units.len()).filter(|&u| !units.units[u].target).collect();
    let whole = sum(&products.units, |u| !units.units[u].target);
    vec![Compared::new(whole, m, old)]
}

/// The units of some motions, each with the others of these motions; `None` where there are not two of them.
pub(super) fn with_other_motions(
    units: &Units,
    products: &Products,
    m: usize,
    taken: impl Fn(usize) -> bool,
) -> Option<Vec<Compared>> {
    if !units.are_several(&taken) {
        return None;
    }
    let of_unit = |u: usize| {
        let file = units.units[u].file;
        let whole = sum(&products.files, |f| taken(f) && f != file) + &products.units[u];
        Compared::new(whole, m, vec![u])
    };
    Some((0..units.units.len()).filter(|&u| taken(units.units[u].file)).map(of_unit).collect())
}
