//! Laws that are no larger than what stays unexplained.
//!
//! Where more of a joint's torque stays unexplained than a law explains, physics of that size may be there which no law of
//! the catalogue describes. Some of them always resemble it: the best of many columns takes a share of whatever is left.
//! Such a law may pass every test and come back in other motion, because what it resembles does. And a law that is
//! smaller than noise, where it acts, changes what is predicted by less than that. Both are told as small, with how large
//! they had to be.

use crate::diagnosis::candidates::candidate::make;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::search::bench::Size;
use crate::diagnosis::search::gate::{OwnPart, own_part};
use crate::diagnosis::search::small_law::SmallLaw;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::parallel;

impl Search<'_> {
    /// Takes out the laws that are no larger than what stays unexplained on any of their joints, one at a time, first the one
    /// that the others replace best. With a baseline, what differs between days decides instead.
    ///
    /// # Errors
    /// [`SingularDesign`] where the model without a law has no fit.
    pub(super) fn take_out_small(&mut self) -> Result<(), SingularDesign> {
        if self.model.change {
            return Ok(());
        }
        loop {
            let sizes = parallel::map(self.threads(), self.model.terms.len(), |k| self.size_of(k));
            let mut least: Option<(usize, Size, f64)> = None;
            for (k, size) in sizes.into_iter().enumerate() {
                let Some((size, gain)) = size? else { continue };
                if size.law < size.needed && least.is_none_or(|(_, _, g)| gain < g) {
                    least = Some((k, size, gain));
                }
            }
            let Some((k, size, _)) = least else { return Ok(()) };
            let Accepted { effect, place, own, .. } = self.model.terms.remove(k);
            self.small.push(SmallLaw { effect, place, own, size });
            self.refit_and_update()?;
        }
    }

    /// How large a term is beside all others, and what it gains in units of the noise variance.
    fn size_of(&self, k: usize) -> Result<Option<(Size, f64)>, SingularDesign> {
        let term = &self.model.terms[k];
        let window = term.effect.properties().window;
        let model = self.model.without(k)?;
        let regression = model.regression(window);
        let design = &regression.design;
        let shape = std::slice::from_ref(&term.shape);
        let candidate = make(&model.context, design, term.effect, term.place, shape, model.change);
        let part = if self.model.is_large_error(k) {
            // Parameters that were fitted without it make something else of it.
            Some(part_of_large_error(regression, self.model.regression(window))?)
        } else {
            own_part(regression, &candidate, 0)
        };
        Ok(part.and_then(|part| {
            let size = model.bench(window).largest_size(design, &term.shows_on, &part.change, &part.left)?;
            Some((size, part.gain))
        }))
    }
}

/// What changes between regressions without and with a large error of the robot's numbers.
fn part_of_large_error(without: &Regression, with: &Regression) -> Result<OwnPart, SingularDesign> {
    let left = with.residual();
    let change = without.residual().iter().zip(&left).map(|(without, with)| without - with).collect();
    Ok(OwnPart { gain: without.gain_against(with)?, change, left })
}
