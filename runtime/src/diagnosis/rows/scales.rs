//! How fast, how far and how hard each joint moves: what the shapes of laws are multiples of.

use crate::diagnosis::rows::signals::{ModelTorques, Signals};
use crate::diagnosis::rules::{SIGMA_PER_MAD, TOP_SPEED_PERCENT};
use crate::effects::Scale;
use crate::model::Model;
use crate::statistics::median::median;

/// Scales of every joint over motions, for given standard parameters.
pub(in crate::diagnosis) fn scales(model: &dyn Model, signals: &[Signals], chi: &[f64]) -> Vec<Scale> {
    over(model, &signals.iter().collect::<Vec<_>>(), chi)
}

/// The same over the motions of a recording beside those of its baseline: a law of what has changed knows nothing of positions
/// that were reached before, or of how long motions took. Of joints that are never faster than `slowest` in it, over all.
pub(in crate::diagnosis) fn scales_of_target(
    model: &dyn Model,
    signals: &[Signals],
    chi: &[f64],
    slowest: &[f64],
) -> Vec<Scale> {
    let targets: Vec<&Signals> = signals.iter().filter(|s| s.is_target).collect();
    let mut of_target = over(model, &targets, chi);
    let moves = |(scale, slowest): (&Scale, &f64)| scale.speed > *slowest;
    if targets.len() < signals.len() && !of_target.iter().zip(slowest).all(moves) {
        let all = scales(model, signals, chi);
        for ((scale, all), slowest) in of_target.iter_mut().zip(all).zip(slowest) {
            if !moves((scale, slowest)) {
                *scale = all;
            }
        }
    }
    of_target
}

fn over(model: &dyn Model, signals: &[&Signals], chi: &[f64]) -> Vec<Scale> {
    let robot = model.robot();
    let n = robot.joints();
    let kinds = robot.joint_kinds();
    let speeds = top_speeds(signals.iter().copied(), n);
    let moving = || signals.iter().filter(|s| s.len() > 0);
    let start = moving().map(|s| s.time(0)).reduce(f64::min).unwrap_or(0.0);
    let duration = moving().map(|s| s.time(s.len() - 1) - start).fold(0.0, f64::max);
    let mut torque = vec![0.0_f64; n];
    for &s in signals {
        for (j, series) in ModelTorques::new(model, chi, s).total.iter().enumerate() {
            torque[j] = series.iter().fold(torque[j], |a, b| a.max(b.abs()));
        }
    }
    let fast = fast_torques(signals, n);
    (0..n)
        .map(|j| {
            let positions = signals.iter().flat_map(|s| s.q[j].iter());
            let (low, high) =
                positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
            Scale {
                speed: speeds[j].max(1e-9),
                range: (high - low).max(1e-9),
                centre: if low <= high { 0.5 * (low + high) } else { 0.0 },
                torque: torque[j].max(1e-9),
                start,
                duration,
                gear: robot.drive.gear.get(j * n + j).map_or(1.0, |g| g.abs()),
                fast: fast[j],
                kind: kinds[j],
            }
        })
        .collect()
}

/// Standard deviation of what the recorded torque of a joint has above the cut-off of the signals, from its median: a few
/// blows do not count.
fn fast_torques(signals: &[&Signals], joints: usize) -> Vec<f64> {
    (0..joints)
        .map(|j| {
            let mut sizes: Vec<f64> = signals.iter().flat_map(|s| s.fast_torque(j)).map(f64::abs).collect();
            SIGMA_PER_MAD * median(&mut sizes)
        })
        .collect()
}

/// Speed that 98 % of the samples of a joint do not pass, in the fastest motion.
pub(in crate::diagnosis) fn top_speeds<'a>(
    signals: impl Iterator<Item = &'a Signals> + Clone,
    joints: usize,
) -> Vec<f64> {
    (0..joints)
        .map(|j| {
            signals
                .clone()
                .map(|s| {
                    let mut v: Vec<f64> = s.dq[j].iter().map(|x| x.abs()).collect();
                    v.sort_by(f64::total_cmp);
                    v.get(v.len() * TOP_SPEED_PERCENT / 100).copied().unwrap_or(0.0)
                })
                .fold(0.0, f64::max)
        })
        .collect()
}
