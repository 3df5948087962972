//! Windows that may be pushes: one joint alone, or all joints together, do there what they hardly do by themselves.

use crate::diagnosis::contact::half_waves::{HalfWaves, Window};
use crate::diagnosis::contact::largest::{Chances, Law};
use crate::diagnosis::rules::SCAN_SUSPECT;
use std::collections::BTreeMap;

/// A window that one joint tells most of.
pub(super) struct Suspect {
    /// Probability that any window comes as far by accident.
    doubt: f64,
    /// Of the joint alone.
    surprise: f64,
    /// Place of the joint among those that are scanned.
    pub joint: usize,
    pub motion: usize,
    pub window: Window,
}

/// Surprise of a joint's window, and the joint's place among those that are scanned.
type Surprised = (f64, usize, Window);

/// Windows that one of [`SCAN_SUSPECT`] recordings has by accident, the surest first. `joints` are scanned, each with what its
/// largest windows do by themselves; `together` is the probability that all of them come as far by accident as they do in a window
/// of so many places.
pub(super) fn suspects(
    joints: &[(Option<Law>, &HalfWaves)],
    chances: Chances,
    together: impl Fn(usize, &[Option<f64>]) -> f64,
) -> Vec<Suspect> {
    let mut of_windows: BTreeMap<[usize; 3], Vec<Surprised>> = BTreeMap::new();
    for (k, (law, waves)) in joints.iter().enumerate() {
        let Some(law) = law else { continue };
        for (motion, window) in waves.of_targets() {
            let surprise = law.surprise(window.square());
            if surprise > 0.0 {
                let at = [motion, window.length, window.from];
                of_windows.entry(at).or_default().push((surprise, k, window));
            }
        }
    }
    let mut suspects = Vec::new();
    for ([motion, ..], felt) in of_windows {
        let Some(&(surprise, joint, window)) = felt.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        let mut doubt = chances.of_one(surprise);
        // What joints have in common only takes away from what they do together.
        let sum = felt.iter().map(|(surprise, ..)| surprise).sum::<f64>();
        if felt.len() > 1 && chances.of_all(sum) <= SCAN_SUSPECT {
            let mut deviations = vec![None; joints.len()];
            felt.iter().for_each(|(_, k, window)| deviations[*k] = Some(window.deviation));
            let [from, to] = joints[joint].1.places(window);
            doubt = doubt.min(together(to - from, &deviations));
        }
        if doubt <= SCAN_SUSPECT {
            suspects.push(Suspect { doubt, surprise, joint, motion, window });
        }
    }
    suspects.sort_by(|a, b| a.doubt.total_cmp(&b.doubt).then(b.surprise.total_cmp(&a.surprise)));
    suspects
}
