//! Which windows of time one force on one link explains.

use crate::diagnosis::contact::force::{JointRow, PushedLink, UnitForces, best_link};
use crate::diagnosis::contact::residual::{Energies, RobustResidual, energies};
use crate::diagnosis::contact::squares::Squares;
use crate::diagnosis::contact::windows::{duration, windows};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{
    CONTACT_MARGIN, FORCE_EXPLAINS, FORCE_PREDICTS, LARGEST_PUSHED_FRACTION, LEAST_INSTANTS, PUSHED,
    PUSHED_TOGETHER, REMAINING_FRACTION,
};
use crate::effects::ContactForce;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Windows with an outside force.
#[derive(Clone)]
pub(in crate::diagnosis) struct Contacts {
    /// Times per signal that no other row may use.
    pub windows: Vec<Vec<[f64; 2]>>,
    pub wrenches: Vec<ContactForce>,
    /// Of the rows in the windows.
    pub squares: Squares,
    /// Probability that the clearest of them is an accident.
    pub doubt: f64,
}

impl Contacts {
    /// None in so many motions.
    pub fn none(motions: usize) -> Self {
        Self {
            windows: vec![Vec::new(); motions],
            wrenches: Vec::new(),
            squares: Squares::default(),
            doubt: 1.0,
        }
    }

    /// Both together, where there are both.
    pub fn joined(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        let (mut all, other) = match (one, other) {
            (Some(one), Some(other)) => (one, other),
            (one, other) => return one.or(other),
        };
        for (windows, more) in all.windows.iter_mut().zip(other.windows) {
            windows.extend(more);
        }
        all.wrenches.extend(other.wrenches);
        all.squares += other.squares;
        all.doubt = all.doubt.min(other.doubt);
        Some(all)
    }
}

/// A window that one force explains.
struct Explained {
    wrench: ContactForce,
    squares: Squares,
}

/// Rows of all joints per instant of a window.
type Instants = BTreeMap<usize, Vec<JointRow>>;

/// Looks for contacts on rows that leave nothing out. `None` where there are none, or where so much of the motion
/// stands out that it is no exception.
pub(in crate::diagnosis) fn find(
    context: &Context<'_>,
    design: &Design,
    signals: &[Signals],
) -> Option<Contacts> {
    let robust = RobustResidual::of(design);
    let energies = energies(design, &robust.residual, &robust.sigma);
    let pushed = pushed_windows(&energies, signals, design.joints)?;
    let mut contacts = Contacts::none(signals.len());
    for (k, windows) in pushed.iter().enumerate() {
        for &w in windows {
            if let Some(explained) = explain(context, design, &robust, k, w) {
                contacts.windows[k].push([w[0] - CONTACT_MARGIN, w[1] + CONTACT_MARGIN]);
                // What happened before the change is set aside, and is no news.
                if !signals[k].is_target {
                    continue;
                }
                contacts.wrenches.push(explained.wrench);
                contacts.squares += explained.squares;
            }
        }
    }
    (!contacts.wrenches.is_empty()).then_some(contacts)
}

/// Windows per signal in which several joints stand out together; `None` where there are none or too many.
fn pushed_windows(energies: &Energies, signals: &[Signals], joints: usize) -> Option<Vec<Vec<[f64; 2]>>> {
    let together = PUSHED_TOGETHER.min(joints);
    let of_signal = |(k, s): (usize, &Signals)| {
        windows(
            energies
                .range((k, 0)..(k + 1, 0))
                .map(|(&(_, t), energy)| (s.time(t), energy.mean() > PUSHED && energy.pushed >= together)),
        )
    };
    let found: Vec<Vec<[f64; 2]>> = signals.iter().enumerate().map(of_signal).collect();
    // The share that pushes may have is one of the motion that is diagnosed, however long a baseline is.
    let targets = || signals.iter().zip(&found).filter(|(s, _)| s.is_target);
    let pushed: f64 = targets().map(|(_, w)| duration(w)).sum();
    let all: f64 = targets().map(|(s, _)| s.len() as f64 / s.rate).sum();
    (pushed > 0.0 && pushed <= LARGEST_PUSHED_FRACTION * all).then_some(found)
}

/// Whether the instants of the contacts still stand out of the noise (`sigma` per joint) in a residual.
pub(in crate::diagnosis) fn remain(
    contacts: &Contacts,
    design: &Design,
    residual: &[f64],
    sigma: &[f64],
    signals: &[Signals],
) -> bool {
    let (mut sum, mut count) = (0.0, 0);
    for (&(k, t), energy) in &energies(design, residual, sigma) {
        let time = signals[k].time(t);
        if contacts
            .wrenches
            .iter()
            .any(|w| w.motion == signals[k].name && (w.window[0]..=w.window[1]).contains(&time))
        {
            sum += energy.squares;
            count += energy.rows;
        }
    }
    sum > REMAINING_FRACTION * PUSHED * count as f64
}

/// The link and the force that explain a window, if one force on one link does.
fn explain(
    context: &Context<'_>,
    design: &Design,
    robust: &RobustResidual,
    signal: usize,
    window: [f64; 2],
) -> Option<Explained> {
    let s = &context.signals[signal];
    let instants = instants(design, robust, s, signal, window);
    let torque = instants.values().flatten().map(|row| (row.y / row.sigma).powi(2)).sum();
    let mut before = 0.0;
    for rows in instants.values() {
        before += rows.iter().map(|row| (row.residual / row.sigma).powi(2)).sum::<f64>();
    }
    let at_instants = instants.iter().map(|(&t, rows)| (t, rows.as_slice()));
    let PushedLink { left, frame, forces } = best_link(context, s, at_instants)?;
    if 1.0 - left / before < FORCE_EXPLAINS || forces.len() < LEAST_INSTANTS {
        return None;
    }
    // Held out: each instant is predicted with the mean force of its neighbours.
    let mut after = 0.0;
    for (i, (&t, rows)) in instants.iter().enumerate() {
        let neighbours: Vec<&Vector3<f64>> =
            [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|k| forces.get(k)).collect();
        let mean = neighbours.iter().copied().sum::<Vector3<f64>>() / neighbours.len().max(1) as f64;
        after += UnitForces::at(context, frame, s, t).left(rows, &mean);
    }
    if 1.0 - after / before < FORCE_PREDICTS {
        return None;
    }
    let mean = forces.iter().sum::<Vector3<f64>>() / forces.len() as f64;
    let largest = forces.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).copied().unwrap_or(mean);
    let wrench = ContactForce {
        motion: s.name.clone(),
        window,
        link: frame + 1,
        force: [largest[0], largest[1], largest[2]],
        mean_force: [mean[0], mean[1], mean[2]],
        ..ContactForce::default()
    };
    Some(Explained { wrench, squares: Squares { before, after, torque } })
}

/// Rows within a window.
fn instants(
    design: &Design,
    robust: &RobustResidual,
    s: &Signals,
    signal: usize,
    window: [f64; 2],
) -> Instants {
    let mut instants = Instants::new();
    for joint in 0..design.joints {
        for r in design.of_joint(joint) {
            let at = design.rows[r];
            let time = s.time(at.centre);
            if at.signal == signal && time >= window[0] && time <= window[1] {
                let sigma = robust.sigma[joint];
                let row = JointRow { joint, residual: robust.residual[r], y: design.torque(r), sigma };
                instants.entry(at.centre).or_default().push(row);
            }
        }
    }
    instants
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::contact::residual::Energy;

    /// A motion of ten seconds at 100 samples a second; every other sample is a row, pushed within these times.
    fn found(pushes: &[[f64; 2]], joints_pushed: usize) -> Option<Vec<Vec<[f64; 2]>>> {
        let signals = [Signals::of_motion(&crate::signal::Motion {
            name: "made up".into(),
            rate: 100.0,
            start: 0.0,
            q: vec![vec![0.0; 1000]; 3],
            dq: vec![vec![0.0; 1000]; 3],
            ddq: vec![vec![0.0; 1000]; 3],
            torque: vec![vec![0.0; 1000]; 3],
            fixed: vec![],
            edge_samples: 0,
        })];
        let mut energies = Energies::new();
        for t in (0..1000).step_by(2) {
            let time = t as f64 / 100.0;
            let pushed = pushes.iter().any(|p| (p[0]..=p[1]).contains(&time));
            let (squares, pushed) = if pushed { (60.0, joints_pushed) } else { (3.0, 0) };
            energies.insert((0, t), Energy { squares, rows: 3, pushed });
        }
        pushed_windows(&energies, &signals, 3)
    }

    #[test]
    fn instants_that_stand_out_on_two_joints_are_a_window() {
        assert_eq!(found(&[[2.0, 2.5]], 2), Some(vec![vec![[2.0, 2.5]]]));
        assert_eq!(found(&[[2.0, 2.1], [2.2, 2.5]], 2), Some(vec![vec![[2.0, 2.5]]]));
    }

    #[test]
    fn what_one_joint_feels_alone_what_is_short_and_what_lasts_are_none() {
        assert_eq!(found(&[[2.0, 2.5]], 1), None);
        assert_eq!(found(&[[2.0, 2.1]], 2), None);
        assert_eq!(found(&[[2.0, 6.0]], 2), None);
        assert_eq!(found(&[], 2), None);
    }
}
