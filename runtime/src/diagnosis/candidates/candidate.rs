//! What is tried: every effect of the catalogue at every place, with a grid of shapes, as columns on the rows.

use crate::diagnosis::candidates::trial::{Trial, columns};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::OWN_FRACTION_OF_DERIVATIVE;
use crate::effects::{Abscissa, EffectKind, Form, Place, SmoothingWindow, UserLaw};
use crate::parallel;

/// An effect at a place.
pub(in crate::diagnosis) struct Candidate {
    pub effect: EffectKind,
    pub place: Place,
    /// Joints whose residual the effect must explain a share of.
    pub own: Vec<usize>,
    pub trials: Vec<Trial>,
    /// How many shapes were tried to find the best.
    pub shapes: usize,
    /// The amplitude, where the effect's law leaves none free.
    pub fixed: Option<f64>,
    /// Whether a negative amplitude is something else.
    pub only_positive: bool,
}

impl Candidate {
    /// Whether it acts on the joints of another, in any order: a rotor that turns as much with one joint as with its neighbour
    /// is the same law from both.
    pub fn acts_where(&self, other: &Self) -> bool {
        self.own.len() == other.own.len() && self.own.iter().all(|j| other.own.contains(j))
    }

    /// Whether it is a number of the model that changes with time, of one joint or of all.
    pub fn is_trend(&self) -> bool {
        self.effect.properties().abscissa == Abscissa::Time
            || self.place.law().is_some_and(UserLaw::is_of_time)
    }
}

/// An effect at a place with the shapes to try.
pub(in crate::diagnosis) type Proposal = (EffectKind, Place, Vec<Vec<f64>>);

/// Places and shapes of every effect that this smoothing shows best, and of the laws of the user. `orders[j]` are ripple
/// orders seen on joint j.
pub(in crate::diagnosis) fn proposals(
    context: &Context<'_>,
    window: SmoothingWindow,
    change: bool,
    (orders, laws): (&[Vec<f64>], &[UserLaw]),
) -> Vec<Proposal> {
    let robot = context.model.robot();
    let mut list = Vec::new();
    for effect in EffectKind::ALL {
        let properties = effect.properties();
        if properties.window != window || !properties.sought.with(change) {
            continue;
        }
        let form = effect.form();
        for place in form.places(robot) {
            let mut shapes = form.shapes(place, &context.scales);
            if let Some(seen) = place.joint().and_then(|j| orders.get(j)) {
                shapes.extend(form.shapes_of_orders(seen));
            }
            list.push((effect, place, shapes));
        }
    }
    let of_user = EffectKind::UserLaw;
    if of_user.properties().window == window {
        let fits = |law: &&UserLaw| law.joint() < robot.joints() && law.variables(robot).is_ok();
        list.extend(laws.iter().filter(fits).map(|law| (of_user, Place::Law(*law), law.grid())));
    }
    list
}

/// Builds candidates on several threads; the order of the result does not depend on their number.
pub(in crate::diagnosis) fn build(
    context: &Context<'_>,
    design: &Design,
    proposals: &[Proposal],
    change: bool,
    threads: usize,
    report: &(dyn Fn(f64) + Sync),
) -> Vec<Candidate> {
    let built = parallel::map(threads, proposals.len(), |k| {
        let (effect, place, shapes) = &proposals[k];
        report(k as f64 / proposals.len() as f64);
        make(context, design, *effect, *place, shapes, change)
    });
    built.into_iter().filter(|c| !c.trials.is_empty()).collect()
}

/// One candidate with all of its shapes.
pub(in crate::diagnosis) fn make(
    context: &Context<'_>,
    design: &Design,
    effect: EffectKind,
    place: Place,
    shapes: &[Vec<f64>],
    change: bool,
) -> Candidate {
    let trials: Vec<Trial> = shapes
        .iter()
        .map(|shape| {
            let mut trial =
                Trial::new(design, shape.clone(), columns(context, design, effect, place, shape, change));
            if effect.form().is_curve() {
                // Of a curve, the motion shows what it passes.
                trial.needed = 1;
            }
            if matches!(effect.form(), Form::Sensitivity(_)) {
                trial.own_fraction = OWN_FRACTION_OF_DERIVATIVE;
            }
            if place.law().is_some() {
                // A person who wrote a constant down asks for it.
                trial.needed = trial.columns.len();
            }
            trial
        })
        .filter(|t| t.columns.iter().all(|c| c.iter().flat_map(|(_, v)| v).all(|x| x.is_finite())))
        .collect();
    Candidate {
        effect,
        place,
        own: place.joints(design.joints),
        shapes: trials.len(),
        trials,
        fixed: effect.form().fixed_amplitude(),
        only_positive: effect.form().only_positive(),
    }
}
