//! How well a push that was hidden is told: when, where, and how strong.

use dynid_runtime::diagnosis::Diagnosis;
use dynid_runtime::effects::{ContactForce, EffectKind};
use serde::{Deserialize, Serialize};

use crate::hide::Hidden;
use crate::motions;

/// What a diagnosis says about the push that was hidden.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// Length that the hidden and the found window share, of what they cover together.
    pub overlap: f64,
    /// Windows that have nothing to do with it.
    pub besides: usize,
    /// Whether its link, or its joint alone, is what it was found on or may have been.
    pub place: bool,
    /// Error of the mean force or torque over the window that was found, in its standard deviations: root mean square
    /// over the axes; `None` where no such number is told.
    pub error: Option<f64>,
    /// Confidence of the finding.
    pub confidence: f64,
}

/// The windows of a diagnosis against a hidden contact; `None` where none of them is at its time.
pub fn told(found: &Diagnosis, hidden: &Hidden) -> Option<Told> {
    let contact = found.findings.iter().find(|f| f.effect == EffectKind::Contact.id())?;
    let number = |name: &str| hidden.numbers.iter().find(|(n, _)| *n == name).map(|(_, x)| *x);
    let truth = [number("from")?, number("to")?];
    let shared = |w: &ContactForce| {
        let shared = w.window[1].min(truth[1]) - w.window[0].max(truth[0]);
        if w.motion == motions::name(0) { shared.max(0.0) } else { 0.0 }
    };
    let best = contact.contacts.iter().max_by(|a, b| shared(a).total_cmp(&shared(b)))?;
    let common = shared(best);
    if common <= 0.0 {
        return None;
    }
    let besides = contact.contacts.iter().filter(|w| shared(w) <= 0.0).count();
    let covered = (truth[1] - truth[0]) + (best.window[1] - best.window[0]) - common;
    let height = mean_height(truth, best.window);
    let (place, error) = match number("pushed_joint") {
        Some(joint) => {
            let own = best.joint_torques.iter().find(|t| t.joint as f64 == joint);
            let error = own.map(|t| (t.mean - height * number("torque").unwrap_or(0.0)).abs() / t.sigma);
            (own.is_some() && best.joint_torques.len() == 1, error)
        }
        None => {
            let right = |link: usize| Some(link as f64) == number("link");
            let place = right(best.link) || best.or_links.iter().any(|l| right(*l));
            (
                place && best.force != [0.0; 3],
                best.force_sigma.map(|sigma| force_error(best, sigma, height, &number)),
            )
        }
    };
    Some(Told { overlap: common / covered, besides, place, error, confidence: contact.confidence })
}

/// Error of the mean force in its standard deviations, root mean square over the axes.
fn force_error(
    push: &ContactForce,
    sigma: [f64; 3],
    height: f64,
    number: &dyn Fn(&str) -> Option<f64>,
) -> f64 {
    let truth = ["x", "y", "z"].map(|axis| height * number(axis).unwrap_or(0.0));
    let squares = (0..3).map(|k| ((push.mean_force[k] - truth[k]) / sigma[k]).powi(2));
    (squares.sum::<f64>() / 3.0).sqrt()
}

/// Mean over a window of a push that rises and falls as a squared sine, as a part of its height.
fn mean_height([from, to]: [f64; 2], window: [f64; 2]) -> f64 {
    let steps = 1000;
    let at = |k: usize| window[0] + (window[1] - window[0]) * (k as f64 + 0.5) / f64::from(steps);
    let height = |t: f64| {
        if t <= from || t >= to {
            0.0
        } else {
            (std::f64::consts::PI * (t - from) / (to - from)).sin().powi(2)
        }
    };
    (0..steps as usize).map(|k| height(at(k))).sum::<f64>() / f64::from(steps)
}
