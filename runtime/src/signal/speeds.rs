//! Recorded speeds beside the derivative of the recorded positions.
//!
//! Both are filtered alike. Recorded speeds are then regressed on the derivative of their own joint's position, and on
//! those of the other joints, at every lag up to [`LONGEST_LAG`]. Noise of the recorded speeds makes the regression less
//! sure and nothing else; noise of the positions makes its factor smaller, by no more than the inverse regression tells
//! (bounds of errors in variables; Frisch 1934). A noisy column is not told from a quiet one; a unit, a sign, a swapped column or a delay
//! is off by far more than its standard error.

use super::{Preparation, VelocitySource, prepare};
use crate::recording::Trajectory;

/// Longest delay that is looked for, s. Judgement: three periods of a slow fieldbus.
const LONGEST_LAG: f64 = 0.25;
/// A column that is late by less is no mistake: drives filter their speeds over some milliseconds.
const LATE: f64 = 0.01;
/// A factor that is nearer to one is a calibration and no unit.
const OFF: f64 = 0.05;
/// Standard errors that a factor or a delay must be off by.
const SURE: f64 = 4.0;
/// Least share of a column's squares that the derivative of a position makes for the column to be its speed.
const IS_SPEED: f64 = 0.5;
/// The same for a column to be that of another joint: a robot whose joints move together has them alike.
const IS_OTHER: f64 = 0.9;
/// Samples that are compared, at most: more make a factor no surer that is off by a twentieth.
const COMPARED: usize = 20_000;

/// A column of speeds that contradicts the positions: late and by a factor it is the derivative of a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedFault {
    /// Joint (0-based) whose speed the column is said to be.
    pub joint: usize,
    /// Joint (0-based) whose speed it is.
    pub of: usize,
    /// By which factor.
    pub factor: f64,
    /// By how much it is late, s; 0 where that is nothing.
    pub late: f64,
}

/// Columns of speeds that contradict the positions; none where there are no speeds, or motions are too short to tell.
pub fn contradicting_speeds(trajectories: &[Trajectory], preparation: &Preparation) -> Vec<SpeedFault> {
    let with = |velocity| Preparation { velocity, ..preparation.clone() };
    let mut motions: Vec<Compared> = Vec::new();
    for trajectory in trajectories.iter().filter(|t| t.velocity.is_some()) {
        let of_both =
            [VelocitySource::Recorded, VelocitySource::Positions].map(|v| prepare(trajectory, &with(v)));
        if let [Ok(recorded), Ok(ours)] = of_both {
            let edge = recorded.edge_samples;
            let inside = |x: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
                x.into_iter().map(|x| x[edge..x.len() - edge].to_vec()).collect()
            };
            let (rate, fixed) = (recorded.rate, recorded.fixed);
            motions.push(Compared { recorded: inside(recorded.dq), ours: inside(ours.dq), rate, fixed });
        }
    }
    let joints = motions.first().map_or(0, |m| m.recorded.len());
    let cutoff = |rate: f64| preparation.cutoff.unwrap_or_else(|| Preparation::default_cutoff(rate));
    // Values that a band-limited signal can choose freely.
    let free: f64 = motions.iter().map(|m| 2.0 * cutoff(m.rate) * m.seconds()).sum();
    (0..joints).filter_map(|j| fault(&motions, j, free)).collect()
}

/// One motion, filtered.
struct Compared {
    recorded: Vec<Vec<f64>>,
    ours: Vec<Vec<f64>>,
    rate: f64,
    fixed: Vec<usize>,
}

impl Compared {
    fn seconds(&self) -> f64 {
        self.recorded.first().map_or(0.0, |x| x.len() as f64 / self.rate)
    }
}

/// Regression of a column on the derivative of a position at a lag.
#[derive(Debug, Clone, Copy)]
struct Line {
    late: f64,
    factor: f64,
    /// Share of the column's squares that it makes.
    share: f64,
}

fn fault(motions: &[Compared], j: usize, free: f64) -> Option<SpeedFault> {
    let own = best(motions, j, j)?;
    if own.share < IS_SPEED {
        let joints = 0..motions.first()?.ours.len();
        let others = joints.filter(|&k| k != j).filter_map(|k| Some((k, best(motions, j, k)?)));
        let (of, line) = others.max_by(|a, b| a.1.share.total_cmp(&b.1.share))?;
        let late = if line.late.abs() > LATE { line.late } else { 0.0 };
        return (line.share > IS_OTHER).then_some(SpeedFault { joint: j, of, factor: line.factor, late });
    }
    let error = ((1.0 / own.share - 1.0).max(0.0) / free.max(1.0)).sqrt() * own.factor.abs();
    let at_once = line(motions, j, j, 0.0)?;
    // Noise of the positions makes the derivative larger than the speed: the factor is between the regression of the
    // column on the derivative and the inverse of that of the derivative on the column.
    let margin = OFF.max(SURE * error);
    let off = own.factor > 1.0 + margin || own.factor / own.share < 1.0 - margin;
    // A delay explains what the column without it leaves.
    let gain = (own.share - at_once.share) / (1.0 - own.share).max(1e-12) * free;
    let late = if own.late.abs() > LATE && gain > SURE * SURE { own.late } else { 0.0 };
    (off || late != 0.0).then_some(SpeedFault { joint: j, of: j, factor: own.factor, late })
}

/// The lag at which a column is most like the derivative of a position.
fn best(motions: &[Compared], j: usize, k: usize) -> Option<Line> {
    let step = motions.iter().map(|m| 1.0 / m.rate).fold(f64::INFINITY, f64::min).max(LATE / 4.0);
    let count = (LONGEST_LAG / step) as i64;
    let lines = (-count..=count).filter_map(|l| line(motions, j, k, l as f64 * step));
    // Of equals the one without delay.
    lines.max_by(|a, b| (a.share - 1e-9 * a.late.abs()).total_cmp(&(b.share - 1e-9 * b.late.abs())))
}

fn line(motions: &[Compared], j: usize, k: usize, late: f64) -> Option<Line> {
    let (mut rr, mut ro, mut oo) = (0.0, 0.0, 0.0);
    let all: usize = motions.iter().map(|m| m.recorded[j].len()).sum();
    let stride = (all / COMPARED).max(1);
    for motion in motions.iter().filter(|m| !m.fixed.contains(&j) && !m.fixed.contains(&k)) {
        let lag = (late * motion.rate).round() as i64;
        let margin = (LONGEST_LAG * motion.rate).ceil() as usize;
        let len = motion.recorded[j].len();
        for t in (margin..len.saturating_sub(margin)).step_by(stride) {
            let (r, o) = (motion.recorded[j][t], motion.ours[k][(t as i64 - lag) as usize]);
            rr += r * r;
            ro += r * o;
            oo += o * o;
        }
    }
    (rr > 0.0 && oo > 0.0).then(|| Line { late, factor: ro / oo, share: ro * ro / (rr * oo) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Two joints for 8 s at 500 Hz; the columns of speeds from the true ones, and noise of a share of their size.
    fn recording(column: impl Fn(f64) -> [f64; 2], noise: f64) -> Vec<Trajectory> {
        let mut random = Pcg64::seed_from_u64(7);
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) / 500.0).collect();
        let mut velocity = vec![Vec::new(); 2];
        for &t in &time {
            for (out, v) in velocity.iter_mut().zip(column(t)) {
                out.push(v + noise * (random.random::<f64>() - 0.5));
            }
        }
        let of = |f: &dyn Fn(f64) -> f64| time.iter().map(|&t| f(t)).collect();
        vec![Trajectory {
            name: "run".into(),
            position: vec![of(&|t| (2.0 * t).sin()), of(&|t| (3.3 * t).cos())],
            velocity: Some(velocity),
            torque: vec![of(&|t| t), of(&|t| t)],
            time: time.clone(),
            fixed: vec![],
        }]
    }

    fn truth(t: f64) -> [f64; 2] {
        [2.0 * (2.0 * t).cos(), -3.3 * (3.3 * t).sin()]
    }

    fn told(column: impl Fn(f64) -> [f64; 2], noise: f64) -> Vec<SpeedFault> {
        let preparation = Preparation { cutoff: Some(20.0), ..Preparation::default() };
        contradicting_speeds(&recording(column, noise), &preparation)
    }

    #[test]
    fn speeds_that_are_right_are_not_doubted_however_noisy() {
        for noise in [0.0, 0.5, 5.0, 50.0] {
            assert_eq!(told(truth, noise), [], "noise {noise}");
        }
        // Noise of the positions, which the derivative has and the speeds have not, makes their factor small.
        let mut shaking = recording(truth, 0.0);
        let mut random = Pcg64::seed_from_u64(9);
        for q in shaking[0].position.iter_mut().flatten() {
            *q += 0.03 * (random.random::<f64>() - 0.5);
        }
        let preparation = Preparation { cutoff: Some(20.0), ..Preparation::default() };
        assert_eq!(contradicting_speeds(&shaking, &preparation), []);
        // Some milliseconds of a drive's filter, and a joint that stands.
        assert_eq!(told(|t| truth(t - 0.004), 0.01), []);
    }

    #[test]
    fn another_unit_or_sign_is_told_with_its_joint_and_factor() {
        let found = told(|t| [truth(t)[0].to_degrees(), truth(t)[1]], 1.0);
        assert!(
            matches!(found[..], [SpeedFault { joint: 0, of: 0, factor, .. }] if (factor - 57.3).abs() < 0.5)
        );
        let found = told(|t| [truth(t)[0], -truth(t)[1]], 0.5);
        assert!(
            matches!(found[..], [SpeedFault { joint: 1, of: 1, factor, .. }] if (factor + 1.0).abs() < 0.05)
        );
    }

    #[test]
    fn columns_that_are_exchanged_are_told_as_those_of_the_other_joint() {
        let found = told(|t| [truth(t)[1], truth(t)[0]], 0.1);
        let pairs: Vec<[usize; 2]> = found.iter().map(|f| [f.joint, f.of]).collect();
        assert_eq!(pairs, [[0, 1], [1, 0]]);
    }

    #[test]
    fn a_column_that_is_late_is_told_with_its_delay() {
        let found = told(|t| [truth(t - 0.05)[0], truth(t)[1]], 0.1);
        assert!(
            matches!(found[..], [SpeedFault { joint: 0, of: 0, late, .. }] if (late - 0.05).abs() < 0.006),
            "{found:?}"
        );
    }
}
