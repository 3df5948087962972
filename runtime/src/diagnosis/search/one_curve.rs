//! Several curves of one joint, over a variable each, as one law over two.
//!
//! A search that goes forward finds the variables of a law one after the other: a cable that runs over two joints is a
//! spring over the first and something over the second. One law over both that explains what they explain together says
//! what it is: a torque that depends on these two.

use crate::diagnosis::candidates::free_form::best_of_pairs;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, FreeLaw, Place, SmoothingWindow, Variable};

impl Search<'_> {
    /// Names one law over two variables where several curves of a joint are over these, one at least over any.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(super) fn one_curve(&mut self, settings: &Settings) -> Result<(), SingularDesign> {
        let joints = self.model.slow.design.joints;
        for joint in 0..joints {
            let is_curve = |t: &Accepted| t.place == Place::Joint(joint) && variables(t, joints).is_some();
            let curves: Vec<&Accepted> = self.model.terms.iter().filter(|t| is_curve(t)).collect();
            if curves.len() < 2 || !curves.iter().any(|t| t.effect == EffectKind::FreeForm) {
                continue;
            }
            let mut over: Vec<Variable> =
                curves.iter().filter_map(|t| variables(t, joints)).flatten().collect();
            over.sort_unstable();
            over.dedup();
            let law = |search: &mut Self| {
                let (context, regression) = (&search.model.context, &search.model.slow);
                let law = best_of_pairs(context, regression, joint, &over, search.model.change)?;
                search.slow.push(law);
                let accepted = search.one_law((EffectKind::FreeForm, Place::Joint(joint)), settings);
                search.slow.pop();
                accepted
            };
            self.put_in_place_of(&is_curve, SmoothingWindow::Slow, law)?;
        }
        Ok(())
    }
}

/// Variables that a law of one of so many joints is a curve over; `None` where it is another law.
fn variables(term: &Accepted, joints: usize) -> Option<Vec<Variable>> {
    let joint = term.place.joint()?;
    match term.effect {
        EffectKind::Spring | EffectKind::PositionDependentTorque => Some(vec![Variable::Position(joint)]),
        EffectKind::FreeForm => {
            let law = FreeLaw::from_shape(&term.shape, joints)?;
            Some(law.axes.iter().map(|a| a.variable).collect())
        }
        _ => None,
    }
}
