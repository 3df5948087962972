//! Errors of the model's own numbers: columns that are exact derivatives of the model, by dual numbers.

use super::quantity::Parameter;
use crate::model::{
    Dual, LANES, Lanes, Link, Model, RecursiveModel, RecursiveModelError, Row, StateSlices, torques,
};

/// Which of an effect's numbers is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// The joint that a finding is named on (0-based); `None` for the whole robot.
    pub joint: Option<usize>,
    /// What the effect counts its numbers by.
    pub index: usize,
    /// Name of the number.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
}

impl Variant {
    /// A number of one joint.
    pub fn joint(joint: usize, name: &'static str, unit: &'static str) -> Self {
        Self { joint: Some(joint), index: joint, name, unit }
    }
}

/// Everything that a model is evaluated with; an effect sets the slopes.
pub struct Seeds<'a> {
    /// Positions.
    pub q: &'a mut [Dual],
    /// Velocities.
    pub dq: &'a mut [Dual],
    /// Accelerations.
    pub ddq: &'a mut [Dual],
    /// Derivatives of the accelerations.
    pub jerk: &'a [f64],
    /// The table.
    pub rows: &'a mut [Row<Dual>],
    /// Gravity in frame 0.
    pub gravity: &'a mut [Dual; 3],
}

/// What is wrong with a recording rather than with a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distortion {
    /// Torques were recorded at other instants than positions. By how much, a model knows as a number of its own.
    Skew,
    /// The robot moved so many times faster than the times of the recording say.
    Faster(f64),
}

/// An effect whose torque is, for a small error e, e times the derivative of the model.
pub trait Sensitivity: Sync {
    /// The numbers that may be wrong.
    fn variants(&self, robot: &crate::model::Robot) -> Vec<Variant>;

    /// Whether all numbers are wrong together (one finding) or each by itself.
    fn together(&self) -> bool;

    /// The quantity that a person knows, from the length of the way along which the derivative was taken: the error
    /// itself where the number grows in proportion to it.
    fn quantity(&self, variant: &Variant, amplitude: f64, sigma: f64) -> Parameter {
        Parameter::new(variant.name, amplitude, sigma, variant.unit)
    }

    /// Columns of parameters that the robot as it is in the table hides and an error uncovers: joint and values at
    /// positions `q[j][t]`. They are fitted beside the derivative once the error is known not to be small.
    fn uncovered(&self, robot: &crate::model::Robot, q: &[Vec<f64>]) -> Vec<(usize, Vec<f64>)> {
        let _ = (robot, q);
        Vec::new()
    }

    /// The largest error, in units of its number, along the way to which derivatives are taken: an exponential factor of two, and
    /// more than a base tilts or a length is off.
    fn largest_error(&self) -> f64 {
        0.7
    }

    /// What an error of this length is, where it is in how the motion was recorded and not in the robot.
    fn in_recording(&self, amplitude: &[f64]) -> Option<Distortion> {
        let _ = amplitude;
        None
    }

    /// Sets the slopes for one number.
    fn seed(&self, variant: &Variant, seeds: &mut Seeds<'_>);
}

/// The numbers of an effect that are wrong at a place: all of them, or the variant `v`; none beyond the last.
pub fn numbers_at(effect: &dyn Sensitivity, robot: &crate::model::Robot, v: usize) -> Vec<Variant> {
    let all = effect.variants(robot);
    if effect.together() { all } else { all.into_iter().skip(v).take(1).collect() }
}

/// A robot with errors of its numbers in it.
#[derive(Debug, Clone)]
pub struct Corrected {
    /// The table and gravity as they are; its base parameters are those of the table as it is written.
    pub robot: crate::model::Robot,
    /// How far each joint is from where its encoder sees it, rad or m.
    pub beyond_encoder: Vec<f64>,
}

/// Longest step along the way to errors, rad or m, and most of them: beyond, gravity is longer by a ten thousandth.
const STEP: f64 = 0.01;
const MOST_STEPS: f64 = 200.0;

/// A robot whose numbers are wrong by so much: where the [`Direction`] along the same errors ends.
pub fn corrected(
    robot: &crate::model::Robot,
    effect: &dyn Sensitivity,
    errors: &[(Variant, f64)],
) -> Corrected {
    let n = robot.joints();
    let still = vec![Dual::default(); n];
    let (mut q, mut dq, mut ddq, jerk) = (still.clone(), still.clone(), still, vec![0.0; n]);
    let mut rows: Vec<Row<Dual>> = robot.frames.iter().map(Row::new).collect();
    let mut gravity = robot.gravity.map(|g| Dual::new(g, 0.0));
    // Angles that are wrong together turn gravity along their common axis: in steps along the way.
    let steps =
        errors.iter().map(|(_, error)| (error.abs() / STEP).ceil()).fold(1.0, f64::max).min(MOST_STEPS);
    for (variant, error) in (0..steps as usize).flat_map(|_| errors) {
        let [q, dq, ddq] = [&mut q, &mut dq, &mut ddq].map(|x| &mut x[..]);
        let (rows, gravity) = (&mut rows[..], &mut gravity);
        effect.seed(variant, &mut Seeds { q, dq, ddq, jerk: &jerk, rows, gravity });
        let lengths = rows.iter_mut().flat_map(|row| [&mut row.d, &mut row.r]);
        for x in q.iter_mut().chain(gravity.iter_mut()).chain(lengths) {
            *x = Dual::new(x.value + error / steps * x.slope, 0.0);
        }
    }
    let mut robot = robot.clone();
    robot.gravity = gravity.map(|g| g.value);
    for (frame, row) in robot.frames.to_mut().iter_mut().zip(&rows) {
        (frame.d, frame.r) = (row.d.value, row.r.value);
    }
    Corrected { robot, beyond_encoder: q.iter().map(|q| q.value).collect() }
}

/// The same of the numbers at a place ([`numbers_at`]); `None` where there are none, or what is wrong is in the recording.
pub fn corrected_at(
    robot: &crate::model::Robot,
    effect: &dyn Sensitivity,
    v: usize,
    errors: &[f64],
) -> Option<Corrected> {
    if effect.in_recording(errors).is_some() {
        return None;
    }
    let errors: Vec<_> = numbers_at(effect, robot, v).into_iter().zip(errors.iter().copied()).collect();
    (!errors.is_empty()).then(|| corrected(robot, effect, &errors))
}

impl Corrected {
    /// With more errors, of the numbers of an effect that are wrong at a place. `None` where these are not the robot's.
    pub fn then(&self, effect: &dyn Sensitivity, v: usize, errors: &[f64]) -> Option<Self> {
        let mut more = corrected_at(&self.robot, effect, v, errors)?;
        more.beyond_encoder.iter_mut().zip(&self.beyond_encoder).for_each(|(all, before)| *all += before);
        Some(more)
    }

    /// Where joints are that encoders see at positions `q[j][t]`.
    pub fn real_positions(&self, q: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let joints = q.iter().zip(&self.beyond_encoder);
        joints.map(|(q, beyond)| q.iter().map(|q| q + beyond).collect()).collect()
    }
}

/// A model whose derivatives have no entry left out: entries that vanish only because gravity is vertical count.
///
/// # Errors
/// A robot whose table the recursive model cannot be made of.
pub fn derivable(robot: &crate::model::Robot) -> Result<RecursiveModel, RecursiveModelError> {
    let mut tilted = robot.clone();
    tilted.gravity = [1.3, -2.1, -9.4];
    RecursiveModel::new(tilted)
}

/// Where a derivative is taken: with respect to `variants[which]`, as the mean along the straight path on which every
/// variant grows from nothing to `at` (missing values are 0).
///
/// The values of `at` times these means add up to the whole change of the torque, however large it is.
#[derive(Clone, Copy)]
pub struct Direction<'a> {
    /// The effect whose numbers they are.
    pub effect: &'a dyn Sensitivity,
    /// The numbers that may be wrong together.
    pub variants: &'a [Variant],
    /// The one that the column is for.
    pub which: usize,
    /// How wrong each is.
    pub at: &'a [f64],
}

/// Most points of the path that a mean is taken over (midpoint rule).
const MOST_POINTS: usize = 16;

/// Way from one point to the next, rad or a part of what is wrong: over it derivatives, which are sines and cosines of angles
/// and polynomials of lengths, bend so little that their mean is that in the middle to one in ten thousand.
const WAY: f64 = 0.05;

impl Direction<'_> {
    fn points(&self) -> usize {
        let longest = self.variants.iter().zip(self.at).map(|(_, x)| x.abs()).fold(0.0, f64::max);
        ((longest / WAY).ceil() as usize).clamp(1, MOST_POINTS)
    }

    /// Share of the path from the point before (from nothing for the first) to a point.
    fn step(&self, point: usize) -> f64 {
        (if point == 0 { 0.5 } else { 1.0 }) / self.points() as f64
    }

    /// Moves the states to a point of the path from the point before.
    fn advance_states(&self, point: usize, seeds: &mut Seeds<'_>) {
        self.advance(point, seeds, |seeds, moved| {
            for group in [&mut *seeds.q, &mut *seeds.dq, &mut *seeds.ddq] {
                group.iter_mut().for_each(moved);
            }
        });
    }

    /// Moves the table and gravity.
    fn advance_robot(&self, point: usize, seeds: &mut Seeds<'_>) {
        self.advance(point, seeds, |seeds, moved| {
            seeds.gravity.iter_mut().for_each(moved);
            for row in seeds.rows.iter_mut() {
                moved(&mut row.d);
                moved(&mut row.r);
            }
        });
    }

    fn advance(
        &self,
        point: usize,
        seeds: &mut Seeds<'_>,
        each: impl Fn(&mut Seeds<'_>, &dyn Fn(&mut Dual)),
    ) {
        let share = self.step(point);
        for (variant, &e) in self.variants.iter().zip(self.at) {
            if e == 0.0 {
                continue;
            }
            self.effect.seed(variant, seeds);
            each(seeds, &|x| *x = Dual::new(x.value + share * e * x.slope, 0.0));
        }
    }
}

/// Derivative of the model's torque with respect to one number, for every joint and sample.
///
/// `model` is [`derivable`]; `gravity` is the real one. `states` is q, dq, ddq and jerk, `[j][t]`; `out[j][t]` is filled.
pub fn derivative(
    model: &RecursiveModel,
    gravity: [f64; 3],
    chi: &[f64],
    direction: &Direction<'_>,
    states: [&[Vec<f64>]; 4],
    out: &mut [Vec<f64>],
) {
    let robot = model.robot();
    let n = robot.joints();
    let samples = states[0].first().map_or(0, Vec::len);
    for series in out.iter_mut() {
        series.clear();
        series.resize(samples, 0.0);
    }
    if let Some(whole) = secant(robot, gravity, chi, direction, states) {
        for (series, whole) in out.iter_mut().zip(whole) {
            *series = whole;
        }
        return;
    }
    let points = direction.points();
    let variant = &direction.variants[direction.which];
    let mut rows: Vec<Row<Dual>> = robot.frames.iter().map(Row::new).collect();
    let mut pull = gravity.map(|g| Dual::new(g, 0.0));
    let mut lanes: [Lane; LANES] = std::array::from_fn(|_| Lane::new(n));
    let robots = robots_at(robot, direction, &mut lanes[0], &mut rows, &mut pull);
    let pattern = model.pattern();
    let mut entries = vec![Dual::default(); pattern.columns.len()];
    let mut packed = [0; 3].map(|_| vec![Dual::default(); n]);
    for first in (0..samples).step_by(LANES) {
        let used = LANES.min(samples - first);
        for (k, lane) in lanes.iter_mut().enumerate() {
            // Lanes beyond the end repeat the last sample.
            lane.set(states, first + k.min(used - 1));
        }
        for (point, (links, gravity)) in robots.iter().enumerate() {
            for lane in &mut lanes {
                lane.states.iter_mut().flatten().for_each(|x| x.slope = 0.0);
                let mut seeds = lane.seeds(&mut rows, &mut pull);
                direction.advance_states(point, &mut seeds);
                direction.effect.seed(variant, &mut seeds);
            }
            pack(&lanes, &mut packed);
            let [q, dq, ddq] = &packed;
            model.idm_with(links, *gravity, q, dq, ddq, &mut entries);
            for (j, series) in out.iter_mut().enumerate() {
                let mut slope = Lanes::splat(0.0);
                for e in pattern.rows[j]..pattern.rows[j + 1] {
                    slope += entries[e].slope * Lanes::splat(chi[pattern.columns[e]]);
                }
                for (x, slope) in series[first..first + used].iter_mut().zip(slope.to_array()) {
                    *x += slope / points as f64;
                }
            }
        }
    }
}

/// The same of a single number of the robot that is far off: the mean along the way is the whole change over its length. `None`
/// where the way is short or several numbers share it.
fn secant(
    robot: &crate::model::Robot,
    gravity: [f64; 3],
    chi: &[f64],
    direction: &Direction<'_>,
    states: [&[Vec<f64>]; 4],
) -> Option<Vec<Vec<f64>>> {
    let (&[variant], &[error, ..]) = (direction.variants, direction.at) else { return None };
    if direction.points() == 1 || direction.effect.in_recording(direction.at).is_some() {
        return None;
    }
    let written = crate::model::Robot { gravity, ..robot.clone() };
    let there = corrected(&written, direction.effect, &[(variant, error)]);
    let [q, dq, ddq, _] = states;
    let q_there = there.real_positions(q);
    let torques_of = |robot, q: &[Vec<f64>]| -> Option<Vec<Vec<f64>>> {
        let model = RecursiveModel::new(robot).ok()?;
        Some(torques(&model, chi, StateSlices::new(q, dq, ddq).states()))
    };
    let (here, mut whole) = (torques_of(written, q)?, torques_of(there.robot, &q_there)?);
    for (whole, here) in whole.iter_mut().flatten().zip(here.iter().flatten()) {
        *whole = (*whole - here) / error;
    }
    Some(whole)
}

/// Links and gravity of the robot at a point of the path.
type RobotAt = (Vec<Link<Wide>>, [Wide; 3]);

/// The robot itself at every point of the path, seeded: it is the same for all samples.
fn robots_at(
    robot: &crate::model::Robot,
    direction: &Direction<'_>,
    lane: &mut Lane,
    rows: &mut [Row<Dual>],
    pull: &mut [Dual; 3],
) -> Vec<RobotAt> {
    let variant = &direction.variants[direction.which];
    (0..direction.points())
        .map(|point| {
            let mut seeds = lane.seeds(rows, pull);
            direction.advance_robot(point, &mut seeds);
            let (mut rows, mut pull) = (seeds.rows.to_vec(), *seeds.gravity);
            direction.effect.seed(variant, &mut Seeds { rows: &mut rows, gravity: &mut pull, ..seeds });
            let rows: Vec<Row<Wide>> = rows.iter().map(wide_row).collect();
            let links = Link::with_rows(robot, &rows);
            (links, pull.map(wide))
        })
        .collect()
}

/// Puts the samples side by side: `packed[group][j]` of q, dq, ddq.
fn pack(lanes: &[Lane; LANES], packed: &mut [Vec<Wide>; 3]) {
    for (group, packed) in packed.iter_mut().enumerate() {
        for (j, x) in packed.iter_mut().enumerate() {
            let of = |part: fn(&Dual) -> f64| {
                Lanes::new(std::array::from_fn(|k| part(&lanes[k].states[group][j])))
            };
            *x = Dual::new(of(|x| x.value), of(|x| x.slope));
        }
    }
}

/// Duals of several samples side by side.
type Wide = Dual<Lanes>;

/// One sample of those that are evaluated side by side: q, dq and ddq, and the jerk.
struct Lane {
    states: [Vec<Dual>; 3],
    jerk: Vec<f64>,
}

impl Lane {
    fn new(joints: usize) -> Self {
        Self { states: [0; 3].map(|_| vec![Dual::default(); joints]), jerk: vec![0.0; joints] }
    }

    fn set(&mut self, states: [&[Vec<f64>]; 4], t: usize) {
        for (own, series) in self.states.iter_mut().zip(states) {
            for (x, series) in own.iter_mut().zip(series) {
                *x = Dual::new(series[t], 0.0);
            }
        }
        for (x, series) in self.jerk.iter_mut().zip(states[3]) {
            *x = series[t];
        }
    }

    fn seeds<'a>(&'a mut self, rows: &'a mut [Row<Dual>], gravity: &'a mut [Dual; 3]) -> Seeds<'a> {
        let [q, dq, ddq] = &mut self.states;
        Seeds { q, dq, ddq, jerk: &self.jerk, rows, gravity }
    }
}

fn wide(x: Dual) -> Wide {
    Dual::new(Lanes::splat(x.value), Lanes::splat(x.slope))
}

fn wide_row(row: &Row<Dual>) -> Row<Wide> {
    Row {
        gamma: wide(row.gamma),
        b: wide(row.b),
        alpha: wide(row.alpha),
        d: wide(row.d),
        theta: wide(row.theta),
        r: wide(row.r),
    }
}
