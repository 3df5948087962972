//! What is tried: every effect of the catalogue at every place, with a grid of shapes, as columns on the rows.

use crate::diagnosis::candidates::trial::{Trial, columns};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::effects::{EffectKind, Form, Place};
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

/// Which effects are looked for, and on which rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::diagnosis) enum SmoothingWindow {
    /// As slow as the motion.
    Slow,
    /// Faster than the motion.
    Fast,
}

/// The smoothing window that shows an effect best.
pub(in crate::diagnosis) fn smoothing_window(effect: EffectKind) -> SmoothingWindow {
    match effect {
        EffectKind::TorqueRipple | EffectKind::JointElasticity | EffectKind::Backlash => {
            SmoothingWindow::Fast
        }
        _ => SmoothingWindow::Slow,
    }
}

/// Places and shapes of every effect that this window shows. `orders[j]` are ripple orders seen on joint j.
pub(in crate::diagnosis) fn proposals(
    context: &Context<'_>,
    wanted: SmoothingWindow,
    change: bool,
    orders: &[Vec<f64>],
) -> Vec<(EffectKind, Place, Vec<Vec<f64>>)> {
    let robot = context.model.robot();
    let n = robot.joints();
    let mut list = Vec::new();
    for effect in EffectKind::ALL {
        if smoothing_window(effect) != wanted || (effect.needs_baseline() && !change) {
            continue;
        }
        match effect.form() {
            Form::Joint(law) => {
                for (j, seen) in orders.iter().enumerate() {
                    let mut shapes = law.shapes(&context.scales[j]);
                    if effect == EffectKind::TorqueRipple {
                        shapes.extend(seen.iter().map(|&o| vec![o]));
                    }
                    list.push((effect, Place::Joint(j), shapes));
                }
            }
            Form::Sensitivity(law) => {
                // The same robot in two recordings has the same geometry, and the delay is taken out of all anyway.
                if effect == EffectKind::TimeDelay || (change && effect == EffectKind::GeometryError) {
                    continue;
                }
                let count = if law.together() { 1 } else { law.variants(robot).len() };
                list.extend((0..count).map(|v| (effect, Place::Variant(v), vec![vec![]])));
            }
            Form::Compliance(law) => {
                let shapes: Vec<Vec<f64>> = law.shapes().iter().map(|s| s.to_vec()).collect();
                list.extend((0..n).map(|j| (effect, Place::Joint(j), shapes.clone())));
            }
            Form::Body(law) => {
                list.extend(law.links(robot).into_iter().map(|l| (effect, Place::Link(l), vec![vec![]])));
            }
            Form::Coupled => {
                let shapes: Vec<Vec<f64>> =
                    crate::effects::CoupledTransmission::RATIOS.iter().map(|&r| vec![r]).collect();
                for b in 1..n {
                    for (a, c) in [(b - 1, b), (b, b - 1)] {
                        let known = robot.drive.gear.get(c * n + a).is_some_and(|g| *g != 0.0);
                        if !known {
                            list.push((effect, Place::Pair(a, c), shapes.clone()));
                        }
                    }
                }
            }
            Form::Window => {}
        }
    }
    list
}

/// Builds candidates on several threads; the order of the result does not depend on their number.
pub(in crate::diagnosis) fn build(
    context: &Context<'_>,
    design: &Design,
    proposals: &[(EffectKind, Place, Vec<Vec<f64>>)],
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
            Trial::new(design, shape.clone(), columns(context, design, effect, place, shape, change))
        })
        .filter(|t| t.columns.iter().all(|c| c.iter().flat_map(|(_, v)| v).all(|x| x.is_finite())))
        .collect();
    let own = match (effect.form(), place) {
        (_, Place::Joint(j)) => vec![j],
        (_, Place::Pair(a, b)) => vec![a, b],
        _ => (0..design.joints).collect(),
    };
    let fixed = matches!(effect.form(), Form::Compliance(_)).then_some(1.0);
    let only_positive = matches!(effect.form(), Form::Joint(law) if law.only_positive());
    Candidate { effect, place, own, shapes: trials.len(), trials, fixed, only_positive }
}
