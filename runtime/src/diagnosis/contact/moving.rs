//! Pushes against a robot that moves: from the rows of a model's residual to windows, forces and how sure they are.

use crate::diagnosis::contact::felt::{Around, Felt, wrench};
use crate::diagnosis::contact::noise::Noise;
use crate::diagnosis::contact::pushed::Pushed;
use crate::diagnosis::contact::scan::{Scan, scan};
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::contact::track::{Left, Track};
use crate::diagnosis::contact::windows::{duration, told};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{CONTACT_MARGIN, LARGEST_PUSHED_FRACTION};
use crate::effects::ContactForce;

/// What a look at a residual finds.
pub(in crate::diagnosis) struct Look {
    pub pushes: Vec<Pushed>,
    /// Those among the certain ones that are accidents.
    pub accidents: Vec<Pushed>,
    noise: Noise,
    /// Probability that one of all windows of the recording comes as far by accident, up to which it is a push.
    level: f64,
}

/// Looks for pushes in what a model leaves on the rows of a design that known contacts are left out of, beside `pushes` that were
/// found in another look at them, and others that are certain.
pub(in crate::diagnosis) fn look(
    context: &Context<'_>,
    design: &Design,
    left: &Left<'_>,
    pushes: (&[Pushed], &[Pushed]),
    level: f64,
) -> Look {
    let signals = context.signals;
    let first = signals.iter().position(|s| s.is_target).unwrap_or(0);
    let step = signals.get(first).map_or(design.step, |s| design.spacing(first) as f64 / s.rate);
    let tracks: Vec<Track> =
        (0..design.joints).map(|joint| Track::of(context, design, left, joint)).collect();
    let Scan { pushes, accidents, noise } = scan(&tracks, pushes, step, level);
    Look { pushes, accidents, noise, level }
}

/// The pushes that were seen, with what all joints feel of them on `around`, whose rows leave nothing out. `None` where
/// there are none, or they take so much of the recording that they are no exception.
pub(in crate::diagnosis) fn seen(around: &Around<'_>, look: &Look) -> Option<Contacts> {
    let of_push = |push: &Pushed| {
        let felt = Felt::of(around, &look.noise, push.motion, push.places);
        // No surer than what is told of it: the sizes of its torques over their standard deviations.
        let doubt = push.doubt.max(felt.doubt(&look.noise));
        (doubt <= look.level && !felt.squares(around, push.joint).swing()).then_some((felt, doubt))
    };
    let contacts = told_as_contacts(around, &look.pushes, of_push);
    let targets = around.context.signals.iter().filter(|s| s.is_target);
    let all: f64 = targets.map(|s| s.len() as f64 / s.rate).sum();
    let pushed: f64 = contacts.wrenches.iter().map(|w| duration(&[w.window])).sum();
    (pushed > 0.0 && pushed <= LARGEST_PUSHED_FRACTION * all).then_some(contacts)
}

/// Pushes that are certain by themselves, with what all joints feel of them. `None` where no joint does.
pub(in crate::diagnosis) fn certain(around: &Around<'_>, look: &Look, pushes: &[Pushed]) -> Option<Contacts> {
    let of_push = |push: &Pushed| {
        let felt = Felt::of_residual(around, &look.noise, push.motion, push.places);
        let doubt = push.doubt.max(felt.doubt_of(push.joint));
        Some((felt, doubt))
    };
    Some(told_as_contacts(around, pushes, of_push)).filter(|contacts| !contacts.wrenches.is_empty())
}

/// Pushes whose rows are not used, before anything is said of them.
pub(in crate::diagnosis) fn set_aside(signals: &[Signals], design: &Design, pushes: &[Pushed]) -> Contacts {
    let mut contacts = Contacts::none(signals.len());
    for push in pushes {
        let spacing = design.spacing(push.motion);
        let [from, to] = push.places.map(|place| signals[push.motion].time(place * spacing));
        contacts.windows[push.motion].push([from - CONTACT_MARGIN, to + CONTACT_MARGIN]);
    }
    contacts
}

/// Pushes as contacts: what joints feel of each, and how likely it is an accident.
fn told_as_contacts(
    around: &Around<'_>,
    pushes: &[Pushed],
    of_push: impl Fn(&Pushed) -> Option<(Felt, f64)>,
) -> Contacts {
    let mut contacts = Contacts::none(around.context.signals.len());
    for push in pushes {
        let Some((felt, doubt)) = of_push(push) else { continue };
        let edges = push.edges.map(|e| e * around.step(push.motion));
        let Some(wrench) = wrench(around, &felt, (push.joint, edges, doubt)) else { continue };
        let window = [wrench.window[0] - CONTACT_MARGIN, wrench.window[1] + CONTACT_MARGIN];
        contacts.windows[push.motion].push(window);
        contacts.doubt = contacts.doubt.min(doubt);
        contacts.squares += felt.squares(around, push.joint);
        contacts.wrenches.push(wrench);
    }
    contacts
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
