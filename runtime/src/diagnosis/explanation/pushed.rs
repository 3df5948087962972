//! Errors on motion that was held out, where something pushed the robot: before and after are told of the same rows.
//!
//! A push is an event: no other motion tells of it, and no law is fitted to its rows. But what the model leaves of them
//! tells of the push itself: it lasts, so that an instant is predicted from those beside it.

use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::contact::squares::mean_beside;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::hull::Curve;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{ContactForce, SmoothingWindow};
use crate::model::JointIndex;

/// The standard model, which knows of no push, on all rows of which the curves of the `model` say something.
///
/// # Errors
/// [`SingularDesign`] where a split has no fit.
pub(in crate::diagnosis) fn unaware(
    model: &ExtendedModel<'_>,
    all: &Design,
) -> Result<HeldOutSquares, SingularDesign> {
    let sigma = Fit::weighted(all, &model.slow.sigma)?.sigma;
    let curve = |term: &Accepted| {
        let joint = term.curve_on()?;
        let of_joint = |column: Vec<f64>| column[all.of_joint(joint)].to_vec();
        Some(Curve { joint, columns: model.columns_of(all, term).into_iter().map(of_joint).collect() })
    };
    let curves: Vec<Curve> = model.terms.iter().filter_map(curve).collect();
    HeldOutSquares::of(all, &sigma, model.change, &curves)
}

/// What was held out without pushes, with the rows of their windows added to it. Nothing was fitted to these: they are
/// what the `model` leaves, on joints that feel the push less the mean of the rows beside.
pub(in crate::diagnosis) fn aware(
    model: &ExtendedModel<'_>,
    all: &Design,
    contacts: &Contacts,
    mut held: HeldOutSquares,
) -> HeldOutSquares {
    let residual = model.residual_on(all, SmoothingWindow::Slow);
    let outside = &model.slow.design;
    for (segment, left, whole) in &mut held.by_segment {
        for joint in 0..all.joints {
            let feels = feels(model, contacts, (all.segments[*segment].signal, joint));
            for rows in stretches_besides(all, outside, joint, *segment) {
                let values: Vec<f64> = rows.iter().map(|&r| residual[r]).collect();
                let push = |i: usize| if feels { mean_beside(&values, i) } else { 0.0 };
                let squares = (0..rows.len()).map(|i| (values[i] - push(i)).powi(2)).sum::<f64>();
                let torques = rows.iter().map(|&r| all.torque(r).powi(2)).sum::<f64>();
                held.left[joint] += squares;
                held.whole[joint] += torques;
                *left += squares;
                *whole += torques;
            }
        }
    }
    held
}

/// Whether a joint feels one of the contacts of a motion: one that a force explains is felt by all.
fn feels(model: &ExtendedModel<'_>, contacts: &Contacts, (motion, joint): (usize, usize)) -> bool {
    let number = model.context.model.robot().joint_number(JointIndex(joint)).0;
    let name = &model.context.signals[motion].name;
    let of_motion = |push: &&ContactForce| push.motion == *name;
    contacts.wrenches.iter().filter(of_motion).any(|push| {
        push.joint_torques.is_empty() || push.joint_torques.iter().any(|torque| torque.joint == number)
    })
}

/// Rows of a joint in a segment that another design of the same instants leaves out, those that follow each other
/// together.
fn stretches_besides(all: &Design, outside: &Design, joint: usize, segment: usize) -> Vec<Vec<usize>> {
    let spacing = all.spacing(all.segments[segment].signal);
    let kept: Vec<usize> = outside.ranges[joint][segment].clone().map(|r| outside.rows[r].centre).collect();
    let mut stretches: Vec<Vec<usize>> = Vec::new();
    for r in all.ranges[joint][segment].clone() {
        let centre = all.rows[r].centre;
        if kept.binary_search(&centre).is_ok() {
            continue;
        }
        match stretches.last_mut() {
            Some(rows) if rows.last().is_some_and(|&last| centre - all.rows[last].centre <= spacing) => {
                rows.push(r);
            }
            _ => stretches.push(vec![r]),
        }
    }
    stretches
}
