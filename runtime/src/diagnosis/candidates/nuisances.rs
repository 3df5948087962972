//! Columns that are always fitted and never named: what every recording of a real robot has, and what other laws would
//! otherwise be taken for.

use crate::diagnosis::candidates::trial::{delay_columns, dense_columns, term_columns, term_columns_in};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::PRESLIDING_NUISANCE;
use crate::effects::{EffectKind, EffectTerm, Place};
use crate::signal::{Stencil, central_difference};
use std::ops::Range;

/// Columns of the skew of the torques, the first of them.
pub(in crate::diagnosis) const SKEW_COLUMNS: usize = 1;
/// Nuisances of each joint, which come next.
pub(in crate::diagnosis) const NUISANCES: usize = 2;

/// Where the columns of a reference's laws begin among those that are always there.
pub(in crate::diagnosis) fn standing_from(joints: usize) -> usize {
    SKEW_COLUMNS + NUISANCES * joints
}

/// All columns that are fitted beside the base parameters and never named: the skew of the torques, the nuisances, the laws
/// of a reference, and, against a baseline or a reference (`change`), the recording's own friction as the last three of
/// every joint.
pub(in crate::diagnosis) fn always_there(
    context: &Context<'_>,
    design: &Design,
    change: bool,
) -> Vec<Vec<f64>> {
    let mut out = delay_columns(context, design, |_| true);
    out.extend(nuisance_columns(context, design));
    out.extend(standing_columns(context, design));
    if change {
        out.extend(target_friction_columns(context, design));
    }
    out
}

/// The laws of a reference on all rows, one column per amplitude, with the scales that they were made with.
fn standing_columns(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    let Some(reference) = &context.reference else { return Vec::new() };
    reference.standing().flat_map(|term| term_columns(context, design, term)).collect()
}

/// Columns of a design that are curves of a reference, see [`Design::shrunk`].
pub(in crate::diagnosis) fn standing_curves(context: &Context<'_>, design: &Design) -> Vec<Range<usize>> {
    let mut next = design.parameters + standing_from(design.joints);
    let standing = context.reference.iter().flat_map(|reference| reference.standing());
    let of = |term: &EffectTerm| {
        let columns = next..next + term.amplitude.len();
        next = columns.end;
        term.effect.form().is_curve().then_some(columns)
    };
    standing.filter_map(of).collect()
}

/// Torque that the laws of a reference have beyond the one that was taken out of the recorded torques, on all rows: joints that
/// carry more than the reference knows of have more friction that follows the load, and a channel hears the laws that are new
/// on the joint that it hears. `None` where there is nothing of this kind.
pub(in crate::diagnosis) fn more_of_standing_laws(
    context: &Context<'_>,
    design: &Design,
) -> Option<Vec<f64>> {
    let (reference, before) = (context.reference.as_ref()?, context.additions_before());
    let (joints, now) = (context.model.robot().joints(), context.additions());
    let more_is_heard =
        now.laws != before.laws && reference.standing().any(|term| term.looks_at_torque(joints));
    if now.bodies == before.bodies && !more_is_heard {
        return None;
    }
    let without = context.with(before);
    // In motions of a baseline that the body or the law is not in there is nothing more.
    let has_more =
        |k: usize| context.chi_in(k) != without.chi_in(k) || more_is_heard && context.signals[k].is_target;
    let differs: Vec<bool> = (0..context.signals.len()).map(has_more).collect();
    let mut more = vec![0.0; design.rows.len()];
    for term in reference.standing() {
        let columns = |context| term_columns_in(context, design, term, |k| differs[k]);
        for ((now, before), a) in columns(context).into_iter().zip(columns(&without)).zip(&term.amplitude) {
            more.iter_mut()
                .zip(now.iter().zip(before))
                .for_each(|(m, (now, before))| *m += a * (now - before));
        }
    }
    Some(more)
}

/// Per joint, on all rows: the second derivative of the model's torque, which is what a difference between the filters
/// of positions and torques leaves, and position noise times inertia; and friction that builds up over a short
/// displacement after a reversal.
fn nuisance_columns(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    for j in 0..design.joints {
        let mut on_joint = Vec::new();
        for (k, s) in context.signals.iter().enumerate() {
            let curvature = twice_differentiated(&context.torques(k).rigid[j], s.rate);
            design.sample(j, k, &curvature, &mut on_joint);
        }
        let mut column = vec![0.0; design.rows.len()];
        column[design.of_joint(j)].copy_from_slice(&on_joint);
        out.push(column);
        let shape = [PRESLIDING_NUISANCE * context.scales[j].range];
        out.extend(dense_columns(
            context,
            design,
            EffectKind::PreslidingHysteresis,
            Place::Joint(j),
            &shape,
            false,
        ));
    }
    // Columns keep their number and order: what is no number is left at zero, and then not fitted.
    for column in out.iter_mut().filter(|c| c.iter().any(|x| !x.is_finite())) {
        column.fill(0.0);
    }
    out
}

/// Viscous friction, Coulomb friction and an offset of one joint, on the joint's rows.
pub(in crate::diagnosis) fn friction_columns(
    context: &Context<'_>,
    design: &Design,
    joint: usize,
) -> Vec<Vec<f64>> {
    let mut out = vec![Vec::new(); 3];
    for (k, s) in context.signals.iter().enumerate() {
        let sign: Vec<f64> = s.dq[joint].iter().map(|v| if *v > 0.0 { 1.0 } else { -1.0 }).collect();
        let one = vec![1.0; s.len()];
        for (column, series) in out.iter_mut().zip([&s.dq[joint], &sign, &one]) {
            design.sample(joint, k, series, column);
        }
    }
    out
}

/// The friction columns of every joint, on the rows of the recording that is diagnosed and zero on a baseline's:
/// three for each joint.
fn target_friction_columns(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    for j in 0..design.joints {
        let range = design.of_joint(j);
        for on_joint in friction_columns(context, design, j) {
            let mut column = vec![0.0; design.rows.len()];
            for (r, value) in range.clone().zip(on_joint) {
                if context.signals[design.rows[r].signal].is_target {
                    column[r] = value;
                }
            }
            out.push(column);
        }
    }
    out
}

fn twice_differentiated(x: &[f64], rate: f64) -> Vec<f64> {
    let (mut once, mut twice) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    central_difference(x, rate, Stencil::Seven, &mut once);
    central_difference(&once, rate, Stencil::Seven, &mut twice);
    twice
}
