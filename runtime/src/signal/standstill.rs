//! Where a joint moves, and where sign(dq) is noise.

use super::{KeptRows, Motion};

/// Speeds below which the sign of a joint's speed says nothing about its friction.
///
/// A row near standstill enters the Coulomb column with a sign that noise has chosen, or during the first
/// micrometres in which friction has not built up yet; both bias Coulomb friction low. The threshold of a joint is
/// the larger of 2 % of its fast speed (95th percentile of |dq|) and six times the noise of its speed where
/// the recording is quietest. A joint that never moves gets a threshold above all of its speeds.
#[derive(Debug, Clone, PartialEq)]
pub struct StandstillSpeeds {
    /// Per joint, rad/s or m/s.
    pub thresholds: Vec<f64>,
    /// Noise of dq where it is quietest, per joint, rad/s or m/s.
    pub noise: Vec<f64>,
    /// 95th percentile of |dq|, per joint, rad/s or m/s.
    pub fast: Vec<f64>,
}

/// Share of the fast speed.
const SHARE: f64 = 0.02;
/// Noise levels.
const NOISE: f64 = 6.0;
/// Length of the stretches that noise is estimated on, s.
const STRETCH: f64 = 0.1;

impl StandstillSpeeds {
    /// Thresholds common to all motions of a recording, so that a joint is judged alike in each.
    pub fn of(motions: &[Motion]) -> Self {
        let joints = motions.iter().map(|m| m.dq.len()).max().unwrap_or(0);
        let mut speeds = Vec::new();
        let (mut thresholds, mut noise, mut fast) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..joints {
            speeds.clear();
            let mut quietest = f64::INFINITY;
            for motion in motions {
                let Some(dq) = motion.dq.get(j) else { continue };
                let start = motion.edge_samples.min(dq.len());
                let dq = &dq[start..dq.len().saturating_sub(motion.edge_samples).max(start)];
                speeds.extend(dq.iter().map(|v| v.abs()));
                quietest = quietest.min(quietest_stretch(dq, motion.rate));
            }
            let quantile = if speeds.is_empty() {
                0.0
            } else {
                let at = (speeds.len() - 1) * 95 / 100;
                *speeds.select_nth_unstable_by(at, f64::total_cmp).1
            };
            let floor = if quietest.is_finite() { quietest } else { 0.0 };
            thresholds.push((SHARE * quantile).max(NOISE * floor));
            noise.push(floor);
            fast.push(quantile);
        }
        Self { thresholds, noise, fast }
    }

    /// For each joint, whether it moves at each kept row: faster than its threshold at the row, and without a
    /// change of direction within `reach` samples to each side, where the decimator's weights lie (its factor is half of
    /// the main lobe: beyond it lie side lobes with a tenth of the weight). A joint declared fixed does not move.
    pub fn moving(&self, motion: &Motion, kept: &KeptRows, reach: usize) -> Vec<Vec<bool>> {
        let of_joint = |(j, dq): (usize, &Vec<f64>)| {
            let threshold = self.thresholds.get(j).copied().unwrap_or(0.0);
            let fixed = motion.fixed.contains(&j);
            let mask = kept.centres().map(|at| {
                let Some(&v) = dq.get(at) else { return false };
                let around = &dq[at.saturating_sub(reach)..(at + reach + 1).min(dq.len())];
                !fixed && v.abs() > threshold && around.iter().all(|x| x * v > 0.0)
            });
            mask.collect()
        };
        motion.dq.iter().enumerate().map(of_joint).collect()
    }
}

/// Smallest rms deviation from a straight line over stretches of `STRETCH`; infinite if there is none.
fn quietest_stretch(dq: &[f64], rate: f64) -> f64 {
    let length = ((STRETCH * rate).round() as usize).max(8);
    dq.chunks_exact(length).map(deviation_from_line).fold(f64::INFINITY, f64::min)
}

fn deviation_from_line(y: &[f64]) -> f64 {
    let n = y.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let mean = y.iter().sum::<f64>() / n;
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (k, v) in y.iter().enumerate() {
        let (x, v) = (k as f64 - middle, v - mean);
        xy += x * v;
        xx += x * x;
        yy += v * v;
    }
    ((yy - xy * xy / xx).max(0.0) / (n - 2.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Decimator;

    fn motion(dq: Vec<Vec<f64>>) -> Motion {
        let zero = vec![vec![0.0; dq[0].len()]; dq.len()];
        Motion {
            name: "test".into(),
            rate: 500.0,
            start: 0.0,
            q: zero.clone(),
            ddq: zero.clone(),
            torque: zero,
            dq,
            fixed: vec![],
            edge_samples: 10,
        }
    }

    /// Noise of about `level` that needs no generator.
    fn noise(k: usize, level: f64) -> f64 {
        level * ((k * k % 1009) as f64 / 1009.0 - 0.5) * 12f64.sqrt()
    }

    #[test]
    fn rows_near_standstill_and_around_reversals_are_marked() {
        let dq: Vec<f64> = (0..4000).map(|k| 2.0 * (k as f64 * 0.01).sin() + noise(k, 1e-3)).collect();
        let m = motion(vec![dq]);
        let still = StandstillSpeeds::of(std::slice::from_ref(&m));
        assert!(still.thresholds[0] > 0.03 && still.thresholds[0] < 0.05, "{still:?}");
        let kept = Decimator::new(5).expect("valid").kept_rows(10..3990);
        let moving = &still.moving(&m, &kept, 2)[0];
        for (at, moves) in kept.centres().zip(moving) {
            let speed = 2.0 * (at as f64 * 0.01).sin();
            if speed.abs() > 0.06 {
                assert!(moves, "row at {at} with {speed} rad/s");
            }
            if speed.abs() < 0.015 {
                assert!(!moves, "row at {at} with {speed} rad/s");
            }
        }
    }

    #[test]
    fn a_joint_at_rest_never_moves_and_neither_does_a_fixed_one() {
        let rest: Vec<f64> = (0..4000).map(|k| noise(k, 1e-3)).collect();
        let moves: Vec<f64> = (0..4000).map(|k| 1.0 + (k as f64 * 0.01).sin() * 0.5).collect();
        let mut m = motion(vec![rest, moves.clone(), moves]);
        m.fixed = vec![2];
        let still = StandstillSpeeds::of(std::slice::from_ref(&m));
        let kept = Decimator::new(5).expect("valid").kept_rows(10..3990);
        let mask = still.moving(&m, &kept, 2);
        assert!(mask[0].iter().all(|m| !m));
        assert!(mask[1].iter().all(|m| *m));
        assert!(mask[2].iter().all(|m| !m));
    }

    #[test]
    fn no_motion_at_all_is_no_error() {
        assert!(StandstillSpeeds::of(&[]).thresholds.is_empty());
        let short = motion(vec![vec![1.0; 5]]);
        assert_eq!(StandstillSpeeds::of(&[short]).thresholds, [0.0]);
    }
}
