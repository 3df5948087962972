//! The columns of the terms of a model, put into the regression of a window.

use crate::diagnosis::candidates::gains::gain_columns;
use crate::diagnosis::candidates::nuisances::more_of_standing_laws;
use crate::diagnosis::candidates::trial::{columns_there, dense_columns};
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::regression::{Besides, Regression, TermColumns};
use crate::diagnosis::rows::additions::NumberError;
use crate::diagnosis::rows::context::{Context, MadeOf};
use crate::diagnosis::search::term::{Accepted, Law};
use crate::effects::{EffectKind, Form, JointLaw};
use crate::model::Robot;
use crate::parallel;
use std::sync::Arc;

/// Columns of laws that were made before.
pub(super) type LastingColumns = Vec<Lasting>;

/// Columns of a law, which stay what they are while what they are made of does.
#[derive(Clone)]
pub(super) struct Lasting {
    law: Law,
    /// What they were made of; nothing for a law of a joint over recorded quantities.
    made_of: Option<MadeOf>,
    columns: Arc<Vec<Vec<f64>>>,
}

impl Lasting {
    /// Whether it has the columns of a term.
    fn is_of(&self, term: &Accepted, context: &Context<'_>) -> bool {
        let (effect, place, shape) = &self.law;
        (*effect, *place, shape) == (term.effect, term.place, &term.shape)
            && self.made_of.as_ref().is_none_or(|made_of| made_of.is_still(context))
    }
}

/// The joint whose torques are recorded larger, where a term is that.
pub(super) fn recorded_larger_on(term: &Accepted) -> Option<usize> {
    term.place.joint().filter(|_| term.effect == EffectKind::TorqueConstantError)
}

/// A term that is a large error of the robot's numbers, or of a drive.
pub(super) fn large_error(
    robot: &Robot,
    term: &Accepted,
    factors: &[f64],
    change: bool,
) -> Option<NumberError> {
    let (effect, place) = (term.effect, term.place);
    match recorded_larger_on(term) {
        Some(joint) => {
            let (errors, in_baseline) = (vec![factors[joint]], !change);
            Some(NumberError { effect, place, errors, in_baseline }).filter(NumberError::is_large)
        }
        None => NumberError::of_robot(robot, (effect, place), &term.shape, !change),
    }
}

/// Whether the columns of a term are made of recorded quantities alone.
fn lasts(term: &Accepted) -> bool {
    let of_recorded = |law: &dyn JointLaw| !law.looks_at_torque() && !law.needs_gravity(&term.shape);
    !term.effect.properties().follows_parameters
        && matches!(term.effect.form(), Form::Joint(law) if of_recorded(law))
}

/// Puts the terms into a regression; `lasting` are columns that some of them had.
pub(super) fn put_terms(
    regression: &mut Regression,
    (context, change): (&Context<'_>, bool),
    (terms, factors, lasting): (&[Accepted], &[f64], &mut LastingColumns),
    deviation: f64,
) -> Result<(), SingularDesign> {
    let design = &regression.design;
    let known = more_of_standing_laws(context, design);
    let robot = context.model.robot();
    let errors: Vec<_> = terms.iter().filter_map(|term| large_error(robot, term, factors, change)).collect();
    let bent = match regression.bent.as_ref().filter(|bent| bent.is_near(&errors)) {
        Some(bent) => Some(bent.clone()),
        None => context.bent((design, regression.plain()), errors),
    };
    let had = |term: &Accepted| {
        lasting.iter().find(|before| before.is_of(term, context)).map(|before| before.columns.clone())
    };
    let columns = parallel::map(context.threads, terms.len(), |k| {
        let term = &terms[k];
        let law = (term.effect, term.place);
        let large = bent.as_ref().and_then(|bent| bent.errors.iter().find(|e| (e.effect, e.place) == law));
        let there =
            large.and_then(|_| columns_there(context, design, law, &term.shape, change)).map(Arc::new);
        let columns = there.or_else(|| had(term)).unwrap_or_else(|| {
            Arc::new(dense_columns(context, design, term.effect, term.place, &term.shape, change))
        });
        TermColumns {
            columns,
            derived_at: large.map_or_else(Vec::new, |e| e.errors.clone()),
            fixed: term.fixed,
            uncovered: context.uncovered(law, &term.shape),
            is_curve: term.effect.form().is_curve(),
            curve_on: term.curve_on(),
        }
    });
    let of_term = |(term, made): (&Accepted, &TermColumns)| Lasting {
        law: term.law(),
        made_of: (!lasts(term)).then(|| context.made_of()),
        columns: made.columns.clone(),
    };
    let is_along_the_way = |made: &TermColumns| made.derived_at.is_empty();
    *lasting = terms.iter().zip(&columns).filter(|(_, made)| is_along_the_way(made)).map(of_term).collect();
    let besides = Besides { known, gains: gain_columns(context, design), deviation, bent };
    regression.set_terms(columns, besides)
}
