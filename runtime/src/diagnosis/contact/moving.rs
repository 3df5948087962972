//! Pushes against a robot that moves: from the rows of a model's residual to windows, forces and how sure they are.

use crate::diagnosis::contact::felt::{Around, Felt, wrench};
use crate::diagnosis::contact::noise::Noise;
use crate::diagnosis::contact::scan::{Pushed, scan};
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::contact::track::{Left, Track};
use crate::diagnosis::contact::windows::{duration, told};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{CONTACT_MARGIN, LARGEST_PUSHED_FRACTION};
use crate::effects::ContactForce;

/// What a look at a residual finds.
pub(in crate::diagnosis) struct Look {
    pub pushes: Vec<Pushed>,
    noise: Noise,
    /// Probability that one of all windows of the recording comes as far by accident, up to which it is a push.
    level: f64,
}

/// Looks for pushes in what a model leaves on the rows of a design that known contacts are left out of; `known` were found in
/// another look at them.
pub(in crate::diagnosis) fn look(
    context: &Context<'_>,
    design: &Design,
    left: &Left<'_>,
    known: &[Pushed],
    level: f64,
) -> Look {
    let signals = context.signals;
    let first = signals.iter().position(|s| s.is_target).unwrap_or(0);
    let step = signals.get(first).map_or(design.step, |s| design.spacing(first) as f64 / s.rate);
    let tracks: Vec<Track> =
        (0..design.joints).map(|joint| Track::of(context, design, left, joint)).collect();
    let (pushes, noise) = scan(&tracks, known, step, level);
    Look { pushes, noise, level }
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
