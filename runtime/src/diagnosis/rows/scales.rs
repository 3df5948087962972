//! How fast, how far and how hard each joint moves: what the shapes of laws are multiples of.

use crate::diagnosis::rows::signals::{ModelTorques, Signals};
use crate::diagnosis::rules::{SIGMA_PER_MAD, TOP_SPEED_PERCENT};
use crate::effects::Scale;
use crate::model::{Model, ParameterKind};
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
    let (fast, inertia) = (fast_torques(signals, n), inertias_with_rotors(model, signals, chi));
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
                inertia: inertia[j],
                kind: kinds[j],
            }
        })
        .collect()
}

/// Samples of a motion on which inertias are worked out. Numerics.
const INERTIAS: usize = 50;

/// Least inertia that each joint moves, where that of its rotor is no parameter of its own; zero for other joints.
fn inertias_with_rotors(model: &dyn Model, signals: &[&Signals], chi: &[f64]) -> Vec<f64> {
    let robot = model.robot();
    let n = robot.joints();
    let (still, mut bias, mut mass) = (vec![0.0; n], vec![0.0; n], vec![0.0; n * n]);
    let mut least = vec![f64::INFINITY; n];
    for s in signals {
        for t in (0..s.len()).step_by(s.len().div_ceil(INERTIAS).max(1)) {
            let q: Vec<f64> = s.q.iter().map(|q| q[t]).collect();
            model.mass_and_bias(chi, &q, &still, &mut mass, &mut bias);
            least.iter_mut().enumerate().for_each(|(j, least)| *least = least.min(mass[j * n + j]));
        }
    }
    let joint_of = robot.joint_of_frame();
    let rotors =
        robot.base.iter().map(|b| &robot.standard[b.standard]).filter(|p| p.kind == ParameterKind::Ia);
    let own: Vec<usize> = rotors.filter_map(|p| joint_of[p.frame]).collect();
    let has_its_own = |j: usize| own.contains(&j);
    let known =
        |(j, least): (usize, f64)| if has_its_own(j) || !least.is_finite() { 0.0 } else { least.max(0.0) };
    least.into_iter().enumerate().map(known).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Motion;
    use crate::simulation::testing::arm;

    /// A motion of the arm in which every joint swings by its reach, once a second.
    fn swinging(reach: &[f64], seconds: f64, target: bool) -> Signals {
        let samples = (200.0 * seconds) as usize;
        let over_time = |of: &dyn Fn(f64) -> f64| (0..samples).map(|t| of(t as f64 / 200.0)).collect();
        let w = std::f64::consts::TAU;
        let series = |order: i32| -> Vec<Vec<f64>> {
            let phase = f64::from(order) * std::f64::consts::FRAC_PI_2;
            reach.iter().map(|r| over_time(&|t| r * w.powi(order) * (w * t + phase).sin())).collect()
        };
        let motion = Motion {
            name: "m".into(),
            rate: 200.0,
            start: 0.0,
            q: series(0),
            dq: series(1),
            ddq: series(2),
            torque: series(0),
            fixed: vec![],
            edge_samples: 10,
        };
        let mut signals = Signals::of_motion(&motion);
        signals.is_target = target;
        signals
    }

    #[test]
    fn what_has_changed_is_measured_by_the_recording_and_not_by_its_baseline() {
        let (model, standard) = arm();
        let chi = model.robot().base_from_standard(&standard);
        let n = model.robot().joints();
        let mut near = vec![0.2; n];
        near[1] = 0.0;
        let both = [swinging(&vec![1.0; n], 20.0, false), swinging(&near, 5.0, true)];
        let scales = scales_of_target(&model, &both, &chi, &vec![0.1; n]);
        assert!((scales[0].range - 0.4).abs() < 1e-3 && (scales[0].duration - 5.0).abs() < 0.1);
        // One that holds still is as it was before.
        assert!((scales[1].range - 2.0).abs() < 1e-3, "{}", scales[1].range);
    }

    #[test]
    fn the_inertia_of_a_joint_is_that_with_its_rotor_where_no_parameter_tells_them_apart() {
        let of = |parameters: &[&str], chi: &[f64]| {
            let signals = swinging(&[1.0], 4.0, true);
            inertias_with_rotors(&crate::testing::vertical_axis(parameters), &[&signals], chi)
        };
        assert_eq!(of(&["ZZ1", "Fv1"], &[2.5, 0.3]), [2.5]);
        assert_eq!(of(&["ZZ1", "Ia1", "Fv1"], &[2.0, 0.5, 0.3]), [0.0]);
    }
}
