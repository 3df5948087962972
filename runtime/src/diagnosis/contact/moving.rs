//! Pushes against a robot that moves, seen joint by joint: from the rows of a model's residual to forces and windows.

use crate::diagnosis::contact::force::{JointRow, as_torques, best_link};
use crate::diagnosis::contact::scan::{Pushed, Track, scan, together};
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::judging::autocorrelation::Places;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{CONTACT_MARGIN, FORCE_EXPLAINS};
use crate::effects::{ContactForce, JointTorque};

/// Looks for pushes in what a model leaves of the torques on the rows of a design; `sigma` is the residual's level on
/// each joint.
pub(in crate::diagnosis) fn in_motion(
    context: &Context<'_>,
    design: &Design,
    residual: &[f64],
    sigma: &[f64],
) -> Option<Contacts> {
    let signals = context.signals;
    let first = signals.iter().position(|s| s.is_target)?;
    let step = design.spacing(first) as f64 / signals[first].rate;
    let tracks: Vec<Track> = (0..design.joints)
        .map(|joint| {
            let of_motion = |(k, rows): (usize, &Vec<(usize, usize)>)| {
                (signals[k].is_target, rows.iter().map(|&(place, r)| (place, residual[r])).collect())
            };
            Track {
                joint,
                motions: Places::of(design, joint).motions().iter().enumerate().map(of_motion).collect(),
            }
        })
        .collect();
    let groups = together(scan(&tracks, step), step);
    if groups.is_empty() {
        return None;
    }
    let mut contacts = Contacts {
        windows: vec![Vec::new(); signals.len()],
        wrenches: Vec::new(),
        before: 0.0,
        after: 0.0,
        torque: 0.0,
        doubt: 1.0,
    };
    for group in &groups {
        let wrench = wrench(context, design, &tracks, group);
        let (from, to) = (wrench.window[0] - CONTACT_MARGIN, wrench.window[1] + CONTACT_MARGIN);
        contacts.windows[group[0].motion].push([from, to]);
        for p in group {
            contacts.doubt = contacts.doubt.min(p.doubt);
            let weight = 1.0 / (sigma[p.joint] * sigma[p.joint]);
            let places = Places::of(design, p.joint);
            let Some(rows) = places.motions().get(p.motion) else { continue };
            let inside: Vec<usize> = rows
                .iter()
                .filter(|(place, _)| (p.places[0]..=p.places[1]).contains(place))
                .map(|(_, r)| *r)
                .collect();
            for (i, &r) in inside.iter().enumerate() {
                let around = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
                let around: Vec<f64> = around.filter_map(|k| inside.get(k)).map(|&k| residual[k]).collect();
                let mean = around.iter().sum::<f64>() / around.len().max(1) as f64;
                contacts.before += weight * residual[r].powi(2);
                contacts.after += weight * (residual[r] - mean).powi(2);
                contacts.torque += weight * design.y[r].powi(2);
            }
        }
        contacts.wrenches.push(wrench);
    }
    Some(contacts)
}

/// Keeps the pushes of which another look still finds something.
pub(in crate::diagnosis) fn still_there(found: Contacts, again: Option<&Contacts>) -> Option<Contacts> {
    let again = again?;
    let seen = |w: &ContactForce| {
        again
            .wrenches
            .iter()
            .any(|a| a.motion == w.motion && a.window[0] <= w.window[1] && w.window[0] <= a.window[1])
    };
    let wrenches: Vec<ContactForce> = found.wrenches.iter().filter(|w| seen(w)).cloned().collect();
    (!wrenches.is_empty()).then_some(Contacts { wrenches, ..found })
}

/// A push as a force on a link where at least two joints feel it and one force explains them; else as joint torques.
fn wrench(context: &Context<'_>, design: &Design, tracks: &[Track], group: &[Pushed]) -> ContactForce {
    let motion = group[0].motion;
    let s = &context.signals[motion];
    let spacing = design.spacing(motion);
    let first = group.iter().min_by_key(|p| p.places[0]).unwrap_or(&group[0]);
    let last = group.iter().max_by_key(|p| p.places[1]).unwrap_or(&group[0]);
    let time = |place: usize| s.time(place * spacing);
    let step = spacing as f64 / s.rate;
    let felt = group.iter().map(|p| {
        let largest = largest_mean(&tracks[p.joint].inside(motion, p.places), p.mean);
        JointTorque { joint: p.joint, mean: p.mean, largest, sigma: p.sigma }
    });
    let mut wrench = as_torques(
        context.model.robot(),
        &s.name,
        [time(first.places[0]), time(last.places[1])],
        [first.edges[0] * step, last.edges[1] * step],
        felt.collect(),
    );
    if group.len() < 2 {
        return wrench;
    }
    let places = [first.places[0], last.places[1]];
    let rows: Vec<JointRow> =
        tracks.iter().filter_map(|track| felt_by(track, motion, places, group)).collect();
    let whole: f64 = rows.iter().map(|row| (row.residual / row.sigma).powi(2)).sum();
    // Where the robot is in the middle of the push.
    let middle = ((places[0] + places[1]) / 2 * spacing).min(s.len().saturating_sub(1));
    let best = best_link(context, s, std::iter::once((middle, rows.as_slice())));
    if let Some(link) = best.filter(|link| 1.0 - link.left / whole >= FORCE_EXPLAINS) {
        let mean = link.forces.first().map_or([0.0; 3], |f| [f[0], f[1], f[2]]);
        // The largest torques against the means tell how much more the push was at its height.
        let ratio = wrench
            .joint_torques
            .iter()
            .map(|t| t.largest / t.mean)
            .filter(|r| r.is_finite())
            .fold(1.0, f64::max);
        wrench.link = link.frame + 1;
        wrench.mean_force = mean;
        wrench.force = mean.map(|f| f * ratio);
    }
    wrench
}

/// The largest mean of five rows of a push, at least its whole mean.
fn largest_mean(inside: &[f64], mean: f64) -> f64 {
    let means = inside.chunks(5).map(|c| c.iter().sum::<f64>() / c.len() as f64);
    means.fold(mean, |a, b| if b.abs() > a.abs() { b } else { a })
}

/// What a joint feels while others are pushed: joints that feel nothing say so. `None` where it has no rows.
fn felt_by(track: &Track, motion: usize, places: [usize; 2], group: &[Pushed]) -> Option<JointRow> {
    let felt = group.iter().find(|p| p.joint == track.joint);
    let inside = track.inside(motion, places);
    if inside.is_empty() && felt.is_none() {
        return None;
    }
    let mean = felt.map_or_else(|| inside.iter().sum::<f64>() / inside.len() as f64, |p| p.mean);
    let spread = || {
        let squares: f64 = track.motions.iter().flat_map(|m| &m.1).map(|(_, r)| r * r).sum();
        let count: usize = track.motions.iter().map(|m| m.1.len()).sum();
        // Of a mean of as many rows, half of them independent.
        (squares / count.max(1) as f64 * 2.0 / inside.len() as f64).sqrt()
    };
    let sigma = felt.map_or_else(spread, |p| p.sigma).max(1e-12);
    Some(JointRow { joint: track.joint, residual: mean, y: 0.0, sigma })
}
