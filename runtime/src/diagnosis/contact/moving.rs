//! Pushes against a robot that moves: from the rows of a model's residual to windows, forces and how sure they are.

use crate::diagnosis::contact::curves::curves;
use crate::diagnosis::contact::felt::{Around, Felt, wrench};
use crate::diagnosis::contact::scan::{Noise, Pushed, Track, scan};
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::contact::windows::{duration, told};
use crate::diagnosis::judging::autocorrelation::Places;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{
    CONTACT_MARGIN, CREEPING, LARGEST_PUSHED_FRACTION, REVERSAL_LEFT_OUT, SETTLING,
};
use crate::effects::ContactForce;

/// What a look at a residual finds.
pub(in crate::diagnosis) struct Look {
    pushes: Vec<Pushed>,
    noise: Noise,
    /// Probability that one of all windows of the recording comes as far by accident, up to which it is a push.
    level: f64,
}

/// What a model leaves of the torques.
pub(in crate::diagnosis) struct Left<'a> {
    /// Of every row.
    pub residual: &'a [f64],
    /// Columns on the same rows of which every joint may have its own part: what is like them is no push.
    pub beside: &'a [Vec<f64>],
    /// Columns on the same rows that the model was fitted with.
    pub fitted: &'a [Vec<f64>],
}

/// Looks for pushes in what a model leaves on the rows of a design that known contacts are left out of.
pub(in crate::diagnosis) fn look(
    context: &Context<'_>,
    design: &Design,
    left: &Left<'_>,
    level: f64,
) -> Look {
    let signals = context.signals;
    let first = signals.iter().position(|s| s.is_target).unwrap_or(0);
    let step = signals.get(first).map_or(design.step, |s| design.spacing(first) as f64 / s.rate);
    let tracks: Vec<Track> = (0..design.joints).map(|joint| track(context, design, left, joint)).collect();
    let (pushes, noise) = scan(&tracks, step, level);
    Look { pushes, noise, level }
}

/// The rows of a joint, but for those at which it creeps or is near its own reversals, and those near the beginning and the
/// end of a motion: what friction, play and flexible gears do there comes and goes as a push does.
fn track(context: &Context<'_>, design: &Design, left: &Left<'_>, joint: usize) -> Track {
    let signals = context.signals;
    let places = Places::of(design, joint);
    let mut kept: Vec<usize> = Vec::new();
    let creeping = CREEPING * context.scales[joint].speed;
    let mut of_motion = |(k, rows): (usize, &Vec<(usize, usize)>)| {
        let s = &signals[k];
        let reach = (REVERSAL_LEFT_OUT * s.rate) as usize;
        let mut near = near_reversals(&s.dq[joint], reach);
        near.iter_mut().zip(&s.dq[joint]).for_each(|(near, dq)| *near |= dq.abs() < creeping);
        let settling = ((SETTLING * s.rate) as usize + s.edge_samples).min(near.len());
        near[..settling].fill(true);
        let end = near.len() - settling;
        near[end..].fill(true);
        let rows = rows.iter().filter(|(_, r)| !near[design.rows[*r].centre]);
        let rows: Vec<(usize, usize)> = rows.copied().collect();
        kept.extend(rows.iter().map(|&(_, r)| r));
        (s.is_target, rows.iter().map(|&(place, r)| (place, left.residual[r])).collect())
    };
    let motions = places.motions().iter().enumerate().map(&mut of_motion).collect();
    let at: Vec<(usize, usize)> =
        kept.iter().map(|&r| (design.rows[r].signal, design.rows[r].centre)).collect();
    let mut beside = curves(context, joint, &at);
    let on_kept = |column: &Vec<f64>| -> Vec<f64> { kept.iter().map(|&r| column[r]).collect() };
    beside.extend(left.beside.iter().map(on_kept));
    let of_joint = |column: &Vec<f64>| {
        if kept.iter().any(|&r| column[r] != 0.0) { on_kept(column) } else { Vec::new() }
    };
    Track { joint, motions, beside, columns: left.fitted.iter().map(of_joint).collect() }
}

/// Whether a speed changes its sign within so many samples of each.
fn near_reversals(dq: &[f64], reach: usize) -> Vec<bool> {
    let mut near = vec![false; dq.len()];
    for t in (1..dq.len()).filter(|&t| dq[t] * dq[t - 1] <= 0.0) {
        near[t.saturating_sub(reach)..(t + reach).min(dq.len())].fill(true);
    }
    near
}

/// The pushes that were seen, with what all joints feel of them on `around`, whose rows leave nothing out. `None` where
/// there are none, or they take so much of the recording that they are no exception.
pub(in crate::diagnosis) fn seen(around: &Around<'_>, look: &Look) -> Option<Contacts> {
    let mut contacts = Contacts::none(around.context.signals.len());
    for push in &look.pushes {
        let felt = Felt::of(around, &look.noise, push.motion, push.places);
        let edges = push.edges.map(|e| e * around.step(push.motion));
        let found = (push.joint, edges, push.doubt);
        let Some((wrench, doubt)) = wrench(around, &felt, &look.noise, found) else { continue };
        let squares = felt.squares(around, push.joint);
        if doubt > look.level || squares.swing() {
            continue;
        }
        let window = [wrench.window[0] - CONTACT_MARGIN, wrench.window[1] + CONTACT_MARGIN];
        contacts.windows[push.motion].push(window);
        contacts.doubt = contacts.doubt.min(doubt);
        contacts.squares += squares;
        contacts.wrenches.push(wrench);
    }
    let targets = around.context.signals.iter().filter(|s| s.is_target);
    let all: f64 = targets.map(|s| s.len() as f64 / s.rate).sum();
    let pushed: f64 = contacts.wrenches.iter().map(|w| duration(&[w.window])).sum();
    (pushed > 0.0 && pushed <= LARGEST_PUSHED_FRACTION * all).then_some(contacts)
}

/// Of contacts that were found otherwise, those of which a joint feels more than it does by accident, each with how sure
/// it is.
pub(in crate::diagnosis) fn confirmed(
    found: &Contacts,
    around: &Around<'_>,
    look: &Look,
) -> Option<Contacts> {
    let mut contacts = Contacts { wrenches: Vec::new(), doubt: 1.0, ..found.clone() };
    for wrench in &found.wrenches {
        let signals = around.context.signals.iter();
        let Some(motion) = signals.enumerate().find(|(_, s)| s.is_target && s.name == wrench.motion) else {
            continue;
        };
        let places = wrench.window.map(|t| around.place(motion.0, t));
        let felt = Felt::of(around, &look.noise, motion.0, places);
        let doubt = felt.doubt(&look.noise);
        if doubt <= look.level {
            contacts.doubt = contacts.doubt.min(doubt);
            let force_sigma = felt.force_sigma(around, wrench.link);
            contacts.wrenches.push(ContactForce {
                force_sigma,
                confidence: Some(told(doubt)),
                ..wrench.clone()
            });
        }
    }
    (!contacts.wrenches.is_empty()).then_some(contacts)
}

/// The pushes of another look, whose model was fitted without them, at the times at which they were found.
pub(in crate::diagnosis) fn still_there(found: Contacts, again: Option<Contacts>) -> Option<Contacts> {
    let again = again?;
    let seen = |w: &&ContactForce| {
        found
            .wrenches
            .iter()
            .any(|a| a.motion == w.motion && a.window[0] <= w.window[1] && w.window[0] <= a.window[1])
    };
    let wrenches: Vec<ContactForce> = again.wrenches.iter().filter(seen).cloned().collect();
    (!wrenches.is_empty()).then_some(Contacts { wrenches, windows: found.windows, ..again })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_around_a_change_of_sign_are_near_a_reversal() {
        let dq: Vec<f64> = (0..20).map(|k| f64::from(k) - 9.5).collect();
        let near = near_reversals(&dq, 3);
        assert_eq!((0..20).filter(|&k| near[k]).collect::<Vec<_>>(), vec![7, 8, 9, 10, 11, 12]);
        assert!(near_reversals(&[1.0; 9], 3).iter().all(|x| !x));
        assert!(near_reversals(&[], 3).is_empty());
    }
}
