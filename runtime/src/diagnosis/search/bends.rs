//! Friction that bends with the speed, as it stands in a recording and in its baseline.
//!
//! Where these move at other speeds, friction whose law nobody knows is another one in each of them for every law that comes
//! near it: what has changed must show beside bends that are common to both.

use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::judging::calibration::calibrate;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::white_products::Background;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::search::gate::Gate;
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::state::Search;
use crate::effects::{EffectKind, Place};

/// Whether an effect is friction that bends with the speed.
pub(super) fn is_bend(effect: EffectKind) -> bool {
    matches!(effect, EffectKind::Stribeck | EffectKind::NonlinearViscous)
}

impl Search<'_> {
    /// Friction of a joint that bends near rest, at once, and late: in the recording and in its baseline, or in the recording only.
    fn bends(&self, joint: usize, design: &Design, since_baseline: bool) -> Vec<Vec<f64>> {
        let (context, place) = (&self.model.context, Place::Joint(joint));
        let of = |effect: EffectKind, which: fn(usize) -> usize| {
            let shapes = effect.form().shapes(place, &context.scales);
            let shape = shapes.get(which(shapes.len())).cloned().unwrap_or_default();
            dense_columns(context, design, effect, place, &shape, since_baseline)
        };
        let near_rest = of(EffectKind::Stribeck, |count| count / 2);
        let at_once = of(EffectKind::NonlinearViscous, |_| 0);
        let late = of(EffectKind::NonlinearViscous, |count| count.saturating_sub(1));
        [near_rest, at_once, late].concat()
    }

    /// Bends of a joint's friction that a change of its level is judged beside: those of both recordings, and where a law that bends
    /// it has been found, those of the recording alone, as what such a law misses of the joint's own curve is no level.
    pub(super) fn bends_beside_level(&self, joint: usize, design: &Design) -> Vec<Vec<f64>> {
        let mut bends = self.bends(joint, design, false);
        if self.model.terms.iter().any(|term| is_bend(term.effect) && term.place == Place::Joint(joint)) {
            bends.extend(self.bends(joint, design, true));
        }
        bends
    }

    /// Whether a candidate of a round, where it is friction that bends otherwise than in the baseline, is certain beside bends that
    /// have not changed.
    pub(super) fn is_new_bend(&self, candidate: &Ranked, own: &Gate, least_confidence: f64) -> bool {
        let (regression, law) = self.of(candidate);
        let (bench, design) = (self.model.bench(candidate.window), &regression.design);
        // A reference has no rows that would show them.
        let may_stand = bench.units.change() && is_bend(law.effect);
        let Some(joint) = law.place.joint().filter(|_| may_stand) else { return true };
        let with_bends = [&design.columns[..], &self.bends(joint, design, false)].concat();
        let regressors = Regressors { shared: &with_bends, ..bench.regressors(design) };
        let background = Background::new(&bench.units, &regressors, &regression.residual(), self.threads());
        let columns = self.columns(candidate);
        let law = self.law(candidate, &columns, &own.left);
        let beside = calibrate(&bench.units, &regressors, &background, &law);
        beside.is_some_and(|found| found.evidence().confidence(self.tries()) >= least_confidence)
    }
}
