//! Motions of one joint that show friction, springs and what is like them: the family that an experiment is chosen from.

use super::fourier::{FourierJoint, FourierMotion};
use super::limits::Limits;
use super::motion::ExcitingMotion;
use super::point_to_point::{PointToPointMotion, Profile};

/// How long a motion lasts, about, s: laws of speed need rows at every speed, and a robot is not kept waiting.
const LASTS: f64 = 40.0;
/// Fewest and most strokes of a motion.
const STROKES: [usize; 2] = [4, 80];
/// Shares of the speed limit and of the travel that strokes have.
const SPEEDS: [f64; 6] = [0.01, 0.03, 0.1, 0.25, 0.5, 0.9];
const TRAVELS: [f64; 5] = [0.01, 0.05, 0.2, 0.5, 1.0];
/// Where the other joints stand, as shares of their travel about the middle, for strokes in several poses.
const POSES: [f64; 3] = [-0.7, 0.0, 0.7];
/// Share of their speed limit with which they go there.
const BETWEEN: f64 = 0.3;
/// The two harmonics of a sum of sines, and its period, s.
const HARMONICS: [usize; 2] = [1, 7];
const PERIODS: [f64; 3] = [5.0, 10.0, 20.0];

/// A motion and what it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    /// In words.
    pub what: String,
    pub motion: ExcitingMotion,
}

/// A pose that is gone to, and the share of the joints' speed limits that is used on the way.
type Leg = (Vec<f64>, f64);

/// All motions of the family for a joint (0-based) within limits.
pub(super) fn family(limits: &Limits, joint: usize) -> Vec<Candidate> {
    let mut all = Vec::new();
    let percent = |x: f64| 100.0 * x;
    for speed in SPEEDS {
        for travel in TRAVELS {
            let (s, t) = (percent(speed), percent(travel));
            let what = format!("strokes of {t} % of the travel at up to {s} % of the speed");
            all.extend(candidate(what.clone(), limits, strokes(limits, joint, travel, speed, &[0.0])));
            if limits.position.len() > 1 {
                let legs = strokes(limits, joint, travel, speed, &POSES);
                all.extend(candidate(format!("{what}, in three poses of the other joints"), limits, legs));
            }
        }
        let what = format!("reversals of growing travel at up to {} % of the speed", percent(speed));
        all.extend(candidate(what, limits, growing(limits, joint, speed)));
    }
    for travel in TRAVELS {
        let what = format!("strokes of {} % of the travel at six speeds", percent(travel));
        all.extend(candidate(what, limits, at_all_speeds(limits, joint, travel)));
    }
    all.extend(PERIODS.map(|period| sines(limits, joint, period)));
    all
}

fn middle(limits: &Limits) -> Vec<f64> {
    limits.position.iter().map(|[low, high]| 0.5 * (low + high)).collect()
}

/// The middle with one joint off it by a share of half of its travel.
fn off(limits: &Limits, joint: usize, share: f64, others: f64) -> Vec<f64> {
    let place = |(j, [low, high]): (usize, &[f64; 2])| {
        0.5 * (low + high) + 0.5 * (high - low) * if j == joint { share } else { others }
    };
    limits.position.iter().enumerate().map(place).collect()
}

/// Time of a leg, s.
fn needed(limits: &Limits, from: &[f64], (to, share): &Leg) -> f64 {
    let [speed, peak] = Profile::TrapezoidalAcceleration.peaks();
    let of = |j: usize| {
        let way = (to[j] - from[j]).abs();
        (way * speed / (share * limits.velocity[j])).max((way * peak / limits.acceleration[j]).sqrt())
    };
    (0..from.len()).map(of).fold(1e-3, f64::max)
}

fn strokes(limits: &Limits, joint: usize, travel: f64, speed: f64, poses: &[f64]) -> Vec<Leg> {
    let ends = |others| [-travel, travel].map(|share| off(limits, joint, share, others));
    let [low, high] = ends(0.0);
    let each = needed(limits, &low, &(high, speed));
    let count = (LASTS / each / poses.len() as f64) as usize;
    if count * poses.len() < STROKES[0] {
        return Vec::new();
    }
    let mut legs = Vec::new();
    for &others in poses {
        let [low, high] = ends(others);
        legs.push((low.clone(), BETWEEN));
        for k in 0..count.clamp(2, STROKES[1] / poses.len()) {
            legs.push((if k % 2 == 0 { high.clone() } else { low.clone() }, speed));
        }
    }
    legs
}

fn growing(limits: &Limits, joint: usize, speed: f64) -> Vec<Leg> {
    let mut legs = Vec::new();
    let (mut lasts, mut before) = (0.0, middle(limits));
    let mut travel = TRAVELS[0];
    while lasts < LASTS && travel <= 1.0 {
        for sign in [1.0, -1.0, 1.0, -1.0] {
            let leg = (off(limits, joint, sign * travel, 0.0), speed);
            lasts += needed(limits, &before, &leg);
            before.clone_from(&leg.0);
            legs.push(leg);
        }
        travel *= 1.35;
    }
    legs
}

fn at_all_speeds(limits: &Limits, joint: usize, travel: f64) -> Vec<Leg> {
    let [low, high] = [-travel, travel].map(|share| off(limits, joint, share, 0.0));
    let mut legs = vec![(low.clone(), BETWEEN)];
    let mut lasts = 0.0;
    'all: for _ in 0..STROKES[1] {
        for speed in SPEEDS.into_iter().rev() {
            for to in [&high, &low] {
                let leg = (to.clone(), speed);
                let time = needed(limits, if to == &high { &low } else { &high }, &leg);
                if lasts + time > LASTS {
                    break 'all;
                }
                lasts += time;
                legs.push(leg);
            }
        }
    }
    legs
}

fn candidate(what: String, limits: &Limits, legs: Vec<Leg>) -> Option<Candidate> {
    if legs.len() < STROKES[0] {
        return None;
    }
    let mut points = vec![middle(limits)];
    let mut times = vec![0.0];
    let mut now = 0.0;
    for leg in legs {
        let before = points.last()?;
        if *before == leg.0 {
            continue;
        }
        now += needed(limits, before, &leg);
        times.push(now);
        points.push(leg.0);
    }
    let profile = Profile::TrapezoidalAcceleration;
    let motion = PointToPointMotion { points, profile, times, pause: 0.0 };
    Some(Candidate { what, motion: ExcitingMotion::PointToPoint(motion) })
}

fn sines(limits: &Limits, joint: usize, period: f64) -> Candidate {
    let mut cosine = vec![0.0; HARMONICS[1]];
    for harmonic in HARMONICS {
        cosine[harmonic - 1] = 1.0 / harmonic as f64;
    }
    let still = |center: f64| FourierJoint { center, cosine: Vec::new(), sine: Vec::new() };
    let mut joints: Vec<FourierJoint> = middle(limits).into_iter().map(still).collect();
    let mut own = FourierJoint::at_rest_at_start(0.0, &cosine, &vec![0.0; cosine.len()]);
    let shape = own.bounds(period);
    let [low, high] = limits.position[joint];
    let reach = 0.5 * (shape.position[1] - shape.position[0]);
    let size = (0.5 * (high - low) / reach)
        .min(limits.velocity[joint] / shape.velocity)
        .min(limits.acceleration[joint] / shape.acceleration);
    own.scale(size);
    own.center = 0.5 * (low + high) - 0.5 * (shape.position[0] + shape.position[1]) * size;
    joints[joint] = own;
    let periods = (LASTS / period) as usize;
    let what = format!("sines of two frequencies, {} s and {:.2} s", period, period / HARMONICS[1] as f64);
    Candidate { what, motion: ExcitingMotion::Fourier(FourierMotion { period, periods, joints }) }
}
