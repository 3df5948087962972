//! Laws of the model that show in one passage only: something outside explains them as well.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::passage::{Elsewhere, Passage};
use crate::diagnosis::rules::{LARGEST_PUSHED_FRACTION, SCAN_LONGEST};
use crate::diagnosis::search::state::Search;
use crate::effects::{EffectKind, SmoothingWindow};
use crate::parallel;

impl Search<'_> {
    /// The laws of the model that no other part of the motion shows, by their places among the terms, and their passages. Fast
    /// laws ring or ripple, as nothing does that pushes, and numbers that are far off are no small laws.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(in crate::diagnosis) fn of_single_passages(&self) -> Result<Vec<(usize, Passage)>, SingularDesign> {
        let longest = self.longest_push(0.0);
        let of_term = |k: usize| {
            let term = &self.model.terms[k];
            if term.effect.properties().window != SmoothingWindow::Slow
                || term.effect == EffectKind::FrictionLevelChange
                || term.fixed.is_some()
                || term.is_transient
                || self.model.is_large_error(k)
            {
                return Ok(None);
            }
            let regression = &self.model.slow;
            let passage = regression.passage(regression.term_columns[k].clone(), term.inflation, longest)?;
            let is_single = |passage: &Passage| passage.elsewhere != Elsewhere::Shows;
            Ok(passage.filter(is_single).map(|passage| (k, passage)))
        };
        let found = parallel::map(self.threads(), self.model.terms.len(), of_term);
        found.into_iter().filter_map(Result::transpose).collect()
    }

    /// Places of slow rows that a push may take, as an exception beside others of so many seconds.
    pub(in crate::diagnosis) fn longest_push(&self, others: f64) -> usize {
        let design = &self.model.slow.design;
        let places: usize = design.target_spans().iter().map(|(_, span)| span.len()).sum();
        let pushed = LARGEST_PUSHED_FRACTION * places as f64 * design.step - others;
        (pushed.clamp(0.0, SCAN_LONGEST) / design.step) as usize
    }
}
