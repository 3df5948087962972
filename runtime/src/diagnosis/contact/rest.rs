//! Contact with a robot that holds still: torques beyond what gravity and static friction explain.
//!
//! A joint at rest takes any torque within its static friction without a trace in its position, so that only what
//! passes gravity by more than that band says something. What begins and ends while the robot stands is a push; what
//! is there when it comes to rest or still there when it leaves cannot be told from another load.

use crate::diagnosis::rules::{
    AVERAGED_AT_REST, GAP_AT_REST, LEVEL_AT_REST, ONE_IN_A_HUNDRED, SETTLING, SHORTEST_PUSH_AT_REST,
    SHORTEST_REST, STICTION,
};

use statrs::function::erf::erfc;

/// A joint that a push is seen on.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Pressed {
    /// 0-based.
    pub joint: usize,
    /// Mean torque beyond gravity while the push lasts, N.m or N.
    pub mean: f64,
    /// Largest torque beyond gravity, averaged over a tenth of a second.
    pub largest: f64,
    /// Standard deviation of both: where in its band static friction is cannot be seen.
    pub sigma: f64,
}

/// A push against the robot while it holds still.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Push {
    /// First and last instant, s.
    pub window: [f64; 2],
    /// Standard deviation of both, s.
    pub edges: [f64; 2],
    pub joints: Vec<Pressed>,
    /// Probability that static friction on any joint explains one like it in any of the times that the robot stands.
    pub doubt: f64,
}

/// A joint whose torque is off from the beginning or to the end of a stretch in which the robot stands.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Load {
    /// 0-based.
    pub joint: usize,
    /// Mean torque beyond gravity, N.m or N.
    pub torque: f64,
    /// When, s.
    pub window: [f64; 2],
}

/// One motion, seen from where the robot would stand without anything outside.
pub(in crate::diagnosis) struct Standing<'a> {
    /// Samples a second.
    pub rate: f64,
    /// Time of the first sample, s.
    pub start: f64,
    /// Torque beyond gravity and offset, `[j][t]`.
    pub beyond: &'a [Vec<f64>],
    /// Whether the whole robot holds still.
    pub still: &'a [bool],
    /// Coulomb friction of each joint; `None` where it is not known.
    pub coulomb: &'a [Option<f64>],
    /// Standard deviation of what else may hold it, unknown, where it stands.
    pub uneven: &'a [f64],
    /// Times that the robot stands in all motions: friction may hold a torque by accident in each.
    pub times: usize,
}

/// What is seen of the outside while the robot stands.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::diagnosis) struct Seen {
    pub pushes: Vec<Push>,
    pub loads: Vec<Load>,
    /// Time of standing that was looked at, s.
    pub time: f64,
}

/// A stretch of samples in which one joint is out of its band.
struct Run {
    joint: usize,
    /// First and last sample out of the band.
    inside: [usize; 2],
    /// Where the torque leaves the level before it, and comes to that behind it.
    outside: [usize; 2],
}

/// Looks for pushes and loads in all stretches of one motion in which the robot holds still.
pub(in crate::diagnosis) fn look(standing: &Standing<'_>) -> Seen {
    let mut seen = Seen::default();
    for stretch in stretches(standing.still, standing.rate) {
        seen.time += (stretch[1] - stretch[0]) as f64 / standing.rate;
        let mut runs = Vec::new();
        for (j, coulomb) in standing.coulomb.iter().enumerate() {
            let Some(coulomb) = *coulomb else { continue };
            let level = averaged(&standing.beyond[j][stretch[0]..stretch[1]], standing.rate);
            for [a, b] in out_of_band(&level, band(coulomb, standing.uneven[j]), standing.rate) {
                if a == 0 || b + 1 == level.len() {
                    let torque = level[a..=b].iter().sum::<f64>() / (b + 1 - a) as f64;
                    let window = [standing.time(stretch[0] + a), standing.time(stretch[0] + b)];
                    seen.loads.push(Load { joint: j, torque, window });
                    continue;
                }
                let outside = edges(&level, [a, b], standing.rate);
                let shifted = |x: [usize; 2]| x.map(|t| t + stretch[0]);
                runs.push(Run { joint: j, inside: shifted([a, b]), outside: shifted(outside) });
            }
        }
        runs.sort_by_key(|r| r.inside[0]);
        let pause = (GAP_AT_REST * standing.rate) as usize;
        let mut together: Vec<Vec<Run>> = Vec::new();
        for run in runs {
            let until = |runs: &Vec<Run>| runs.iter().map(|r| r.inside[1]).max().unwrap_or(0);
            match together.last_mut().filter(|t| run.inside[0] <= until(t) + pause) {
                Some(t) => t.push(run),
                None => together.push(vec![run]),
            }
        }
        let pushes = together.iter().map(|runs| push(standing, runs));
        seen.pushes.extend(pushes.filter(|push| push.doubt <= LEVEL_AT_REST));
    }
    seen
}

impl Standing<'_> {
    fn time(&self, t: usize) -> f64 {
        self.start + t as f64 / self.rate
    }
}

/// Stretches of a motion of this rate in which the robot holds still, without the settling after a motion: `[from, to)`.
pub(in crate::diagnosis) fn stretches(still: &[bool], rate: f64) -> Vec<[usize; 2]> {
    let settling = (SETTLING * rate) as usize;
    let shortest = (SHORTEST_REST * rate) as usize;
    let mut found = Vec::new();
    let mut t = 0;
    while t < still.len() {
        let end = (t..still.len()).find(|&k| !still[k]).unwrap_or(still.len());
        let from = if t == 0 { 0 } else { t + settling };
        // The robot pushes off shortly before it is seen to move.
        let to = if end == still.len() { end } else { end.saturating_sub(settling) };
        if to > from && to - from >= shortest.max(2) {
            found.push([from, to]);
        }
        t = end + 1;
    }
    found
}

/// Means over [`AVERAGED_AT_REST`] around each sample, over less at the ends.
pub(super) fn averaged(x: &[f64], rate: f64) -> Vec<f64> {
    let half = ((0.5 * AVERAGED_AT_REST * rate) as usize).max(1);
    let mut sums = vec![0.0];
    for v in x {
        sums.push(sums[sums.len() - 1] + v);
    }
    (0..x.len())
        .map(|t| {
            let (a, b) = (t.saturating_sub(half), (t + half + 1).min(x.len()));
            (sums[b] - sums[a]) / (b - a) as f64
        })
        .collect()
}

/// First and last samples of all times, [`SHORTEST_PUSH_AT_REST`] or longer, in which a level is out of its band on one side.
fn out_of_band(level: &[f64], band: f64, rate: f64) -> Vec<[usize; 2]> {
    let pause = (GAP_AT_REST * rate) as usize;
    let mut runs: Vec<([usize; 2], f64)> = Vec::new();
    for (t, x) in level.iter().enumerate().filter(|(_, x)| x.abs() > band) {
        match runs.last_mut().filter(|(run, sign)| t <= run[1] + 1 + pause && x * *sign > 0.0) {
            Some((run, _)) => run[1] = t,
            None => runs.push(([t, t], x.signum())),
        }
    }
    let long = |run: &[usize; 2]| (run[1] + 1 - run[0]) as f64 / rate >= SHORTEST_PUSH_AT_REST;
    runs.into_iter().map(|(run, _)| run).filter(long).collect()
}

/// Where a level begins to rise towards a run, and where it has fallen behind it: as far as it rises and falls
/// steadily, seen in steps of [`AVERAGED_AT_REST`].
fn edges(level: &[f64], run: [usize; 2], rate: f64) -> [usize; 2] {
    let step = ((AVERAGED_AT_REST * rate) as usize).max(1);
    let sign = level[run[0]].signum();
    // A steady rise gains at least a tenth of what it has at the band in a step.
    let least = 0.1 * level[run[0]].abs().min(level[run[1]].abs());
    let mut from = run[0];
    while from >= step && sign * (level[from] - level[from - step]) > least {
        from -= step;
    }
    let mut to = run[1];
    while to + step < level.len() && sign * (level[to] - level[to + step]) > least {
        to += step;
    }
    [from, to]
}

fn push(standing: &Standing<'_>, runs: &[Run]) -> Push {
    let first = runs.iter().map(|r| r.outside[0]).min().unwrap_or(0);
    let last = runs.iter().map(|r| r.outside[1]).max().unwrap_or(0);
    let crossed = [
        runs.iter().map(|r| r.inside[0]).min().unwrap_or(first),
        runs.iter().map(|r| r.inside[1]).max().unwrap_or(last),
    ];
    // Somewhere between the first rise and the band, all instants alike; no better than the averaging.
    let spread = |samples: usize| (samples as f64 / standing.rate).max(AVERAGED_AT_REST) / 12.0_f64.sqrt();
    let mut joints: Vec<Pressed> = Vec::new();
    let mut doubt: f64 = 1.0;
    for run in runs {
        let Some(coulomb) = standing.coulomb[run.joint] else { continue };
        let level = averaged(&standing.beyond[run.joint][run.inside[0]..=run.inside[1]], standing.rate);
        let mean = level.iter().sum::<f64>() / level.len() as f64;
        let largest = level.iter().copied().fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
        // All of the band alike.
        let sigma = coulomb / 3.0_f64.sqrt();
        doubt = doubt.min(held(
            largest,
            coulomb,
            standing.uneven[run.joint],
            standing.coulomb.len() * standing.times,
        ));
        match joints.iter_mut().find(|p| p.joint == run.joint) {
            Some(p) if p.largest.abs() < largest.abs() => (p.mean, p.largest) = (mean, largest),
            Some(_) => {}
            None => joints.push(Pressed { joint: run.joint, mean, largest, sigma }),
        }
    }
    joints.sort_by_key(|p| p.joint);
    Push {
        window: [standing.time(first), standing.time(last)],
        edges: [spread(crossed[0] - first), spread(last - crossed[1])],
        joints,
        doubt,
    }
}

/// Standard deviation of the torque that holds a joint.
///
/// Static friction is Coulomb friction times 1 + x, x normal with the spread that makes [`STICTION`] rare, and beside it is what else
/// is `uneven` along the path.
fn spread(coulomb: f64, uneven: f64) -> f64 {
    (coulomb * (STICTION - 1.0) / ONE_IN_A_HUNDRED).hypot(uneven)
}

/// The torque beyond gravity that a joint at rest passes once in a hundred times.
pub(super) fn band(coulomb: f64, uneven: f64) -> f64 {
    coulomb + ONE_IN_A_HUNDRED * spread(coulomb, uneven)
}

/// Probability that a joint at rest takes a torque without being pushed, on any of so many joints and times.
fn held(torque: f64, coulomb: f64, uneven: f64, chances: usize) -> f64 {
    let z = (torque.abs() - coulomb) / spread(coulomb, uneven).max(1e-12);
    (chances as f64 * 0.5 * erfc(z / 2.0_f64.sqrt())).min(1.0)
}

#[cfg(test)]
#[path = "rest_tests.rs"]
mod tests;
