//! Errors of the model's own numbers: columns that are exact derivatives of the model, by dual numbers.

use crate::model::{Dual, LANES, Lanes, Link, Model, RecursiveModel, RecursiveModelError, Row};

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

/// An effect whose torque is, for a small error e, e times the derivative of the model.
pub trait Sensitivity: Sync {
    /// The numbers that may be wrong.
    fn variants(&self, robot: &crate::model::Robot) -> Vec<Variant>;

    /// Whether all numbers are wrong together (one finding) or each by itself.
    fn together(&self) -> bool {
        false
    }

    /// Sets the slopes for one number.
    fn seed(&self, variant: &Variant, seeds: &mut Seeds<'_>);
}

/// A model whose derivatives have no entry left out: entries that vanish only because gravity is vertical count.
pub fn derivable(robot: &crate::model::Robot) -> Result<RecursiveModel, RecursiveModelError> {
    let mut tilted = robot.clone();
    tilted.gravity = [1.3, -2.1, -9.4];
    RecursiveModel::new(tilted)
}

/// Where a derivative is taken: with respect to `variants[which]`, as the mean along the straight path on which every
/// variant grows from nothing to `at` (missing values are 0).
///
/// The values of `at` times these means add up to the whole change of the torque, however large it is.
#[derive(Debug, Clone, Copy)]
pub struct Direction<'a> {
    /// The numbers that may be wrong together.
    pub variants: &'a [Variant],
    /// The one that the column is for.
    pub which: usize,
    /// How wrong each is.
    pub at: &'a [f64],
}

/// Points of the path that a mean is taken over (midpoint rule).
const POINTS: usize = 4;

impl Direction<'_> {
    fn points(&self) -> usize {
        if self.at.iter().all(|x| *x == 0.0) { 1 } else { POINTS }
    }

    /// Share of the path from the point before (from nothing for the first) to a point.
    fn step(&self, point: usize) -> f64 {
        (if point == 0 { 0.5 } else { 1.0 }) / self.points() as f64
    }

    /// Moves the states to a point of the path from the point before.
    fn advance_states(&self, effect: &dyn Sensitivity, point: usize, seeds: &mut Seeds<'_>) {
        self.advance(effect, point, seeds, |seeds, moved| {
            for group in [&mut *seeds.q, &mut *seeds.dq, &mut *seeds.ddq] {
                group.iter_mut().for_each(moved);
            }
        });
    }

    /// Moves the table and gravity.
    fn advance_robot(&self, effect: &dyn Sensitivity, point: usize, seeds: &mut Seeds<'_>) {
        self.advance(effect, point, seeds, |seeds, moved| {
            seeds.gravity.iter_mut().for_each(moved);
            for row in seeds.rows.iter_mut() {
                moved(&mut row.d);
                moved(&mut row.r);
            }
        });
    }

    fn advance(
        &self,
        effect: &dyn Sensitivity,
        point: usize,
        seeds: &mut Seeds<'_>,
        each: impl Fn(&mut Seeds<'_>, &dyn Fn(&mut Dual)),
    ) {
        let share = self.step(point);
        for (variant, &e) in self.variants.iter().zip(self.at) {
            if e == 0.0 {
                continue;
            }
            effect.seed(variant, seeds);
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
    effect: &dyn Sensitivity,
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
    let points = direction.points();
    let variant = &direction.variants[direction.which];
    let mut rows: Vec<Row<Dual>> = robot.frames.iter().map(Row::new).collect();
    let mut pull = gravity.map(|g| Dual::new(g, 0.0));
    let mut lanes: [Lane; LANES] = std::array::from_fn(|_| Lane::new(n));
    // The robot itself at every point, seeded: it is the same for all samples.
    let robots: Vec<(Vec<Link<Wide>>, [Wide; 3])> = (0..points)
        .map(|point| {
            let mut seeds = lanes[0].seeds(&mut rows, &mut pull);
            direction.advance_robot(effect, point, &mut seeds);
            let (mut rows, mut pull) = (seeds.rows.to_vec(), *seeds.gravity);
            effect.seed(variant, &mut Seeds { rows: &mut rows, gravity: &mut pull, ..seeds });
            let links = robot.frames.iter().zip(&rows).map(|(f, r)| Link::new(f, &wide_row(r))).collect();
            (links, pull.map(wide))
        })
        .collect();
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
                direction.advance_states(effect, point, &mut seeds);
                effect.seed(variant, &mut seeds);
            }
            for (group, packed) in packed.iter_mut().enumerate() {
                for (j, x) in packed.iter_mut().enumerate() {
                    let of = |part: fn(&Dual) -> f64| {
                        Lanes::new(std::array::from_fn(|k| part(&lanes[k].states[group][j])))
                    };
                    *x = Dual::new(of(|x| x.value), of(|x| x.slope));
                }
            }
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::{EffectKind, Form};
    use super::*;
    use crate::model::{
        BaseParameter, Drive, Frame, JointKind, Limits, Robot, standard_parameters, torques_at,
    };
    use std::borrow::Cow;

    fn arm() -> Robot {
        let row = |parent, alpha, d, r| Frame {
            parent,
            kind: JointKind::Revolute,
            gamma: 0.0,
            b: 0.0,
            alpha,
            d,
            theta: 0.0,
            r,
        };
        let frames = vec![
            row(None, 0.0, 0.0, 0.3),
            row(Some(0), -std::f64::consts::FRAC_PI_2, 0.1, 0.0),
            row(Some(1), 0.0, 0.4, 0.05),
        ];
        let standard = standard_parameters(&frames, &[]);
        let base = standard
            .iter()
            .enumerate()
            .map(|(k, p)| BaseParameter {
                name: p.name.clone(),
                standard: k,
                combination: Cow::Owned(vec![(k, 1.0)]),
                relation: p.name.clone(),
                unit: Cow::Borrowed("1"),
            })
            .collect();
        Robot {
            name: "arm".into(),
            description: "three axes".into(),
            gravity: [0.0, 0.0, -9.81],
            frames: frames.into(),
            drive: Drive {
                gear: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].into(),
                coupled_friction: vec![].into(),
            },
            limits: Limits::default(),
            standard: standard.into(),
            base: Cow::Owned(base),
            nominal: None,
        }
    }

    fn torque(robot: &Robot, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
        torques_at(&RecursiveModel::new(robot.clone()).unwrap(), chi, q, dq, ddq)
    }

    #[test]
    fn columns_agree_with_differences_of_a_changed_robot() {
        let robot = arm();
        let model = derivable(&robot).unwrap();
        let chi: Vec<f64> = (0..robot.base.len()).map(|k| 0.3 + (k as f64 * 0.7).sin()).collect();
        let (q, dq, ddq, jerk) = ([0.3, -0.8, 1.1], [0.9, -1.4, 0.6], [2.0, 1.0, -3.0], [5.0, -7.0, 4.0]);
        let wrap = |x: [f64; 3]| x.iter().map(|&v| vec![v]).collect::<Vec<_>>();
        let states = [wrap(q), wrap(dq), wrap(ddq), wrap(jerk)];
        let h = 1e-6;
        for kind in EffectKind::ALL {
            let Form::Sensitivity(effect) = kind.form() else { continue };
            for variant in effect.variants(&robot) {
                let mut out = vec![Vec::new(); 3];
                let signals = [&states[0], &states[1], &states[2], &states[3]].map(Vec::as_slice);
                let alone = Direction { variants: &[variant], which: 0, at: &[] };
                derivative(&model, robot.gravity, &chi, effect, &alone, signals, &mut out);
                let moved = |e: f64| {
                    let mut robot = robot.clone();
                    let (mut q, mut dq, mut ddq) = (q, dq, ddq);
                    match kind {
                        EffectKind::PositionOffset => q[variant.index] += e,
                        EffectKind::WrongSampleRate => {
                            dq = dq.map(|x| x * (1.0 + e));
                            ddq = ddq.map(|x| x * (1.0 + e) * (1.0 + e));
                        }
                        EffectKind::TimeDelay => {
                            for j in 0..3 {
                                q[j] -= e * dq[j];
                                dq[j] -= e * ddq[j];
                                ddq[j] -= e * jerk[j];
                            }
                        }
                        EffectKind::GeometryError => {
                            let row = &mut robot.frames.to_mut()[variant.index / 2];
                            if variant.index.is_multiple_of(2) { row.d += e } else { row.r += e }
                        }
                        _ => {
                            let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][variant.index];
                            robot.gravity[0] += e * axis[1] * -9.81;
                            robot.gravity[1] -= e * axis[0] * -9.81;
                        }
                    }
                    torque(&robot, &chi, &q, &dq, &ddq)
                };
                let (plus, minus) = (moved(h), moved(-h));
                for j in 0..3 {
                    let expected = (plus[j] - minus[j]) / (2.0 * h);
                    assert!(
                        (out[j][0] - expected).abs() < 1e-6,
                        "{kind:?} {variant:?} {j}: {} {expected}",
                        out[j][0]
                    );
                }
            }
        }
    }

    #[test]
    fn means_along_the_path_add_up_to_the_whole_change_of_a_large_error() {
        let robot = arm();
        let model = derivable(&robot).unwrap();
        let chi: Vec<f64> = (0..robot.base.len()).map(|k| 0.3 + (k as f64 * 0.7).sin()).collect();
        let (q, dq, ddq) = ([0.3, -0.8, 1.1], [0.9, -1.4, 0.6], [2.0, 1.0, -3.0]);
        let wrap = |x: [f64; 3]| x.iter().map(|&v| vec![v]).collect::<Vec<_>>();
        let states = [wrap(q), wrap(dq), wrap(ddq), wrap([0.0; 3])];
        let signals = [&states[0], &states[1], &states[2], &states[3]].map(Vec::as_slice);
        let whole = |kind: EffectKind, at: &[f64]| {
            let Form::Sensitivity(effect) = kind.form() else { return vec![0.0; 3] };
            let variants = effect.variants(&robot);
            let variants = if effect.together() { &variants[..] } else { &variants[1..2] };
            let mut sum = vec![0.0; 3];
            for (which, e) in at.iter().enumerate() {
                let mut out = vec![Vec::new(); 3];
                let direction = Direction { variants, which, at };
                derivative(&model, robot.gravity, &chi, effect, &direction, signals, &mut out);
                sum.iter_mut().zip(&out).for_each(|(s, o)| *s += e * o[0]);
            }
            sum
        };
        let before = torque(&robot, &chi, &q, &dq, &ddq);
        let close = |found: Vec<f64>, after: Vec<f64>| {
            let change: Vec<f64> = after.iter().zip(&before).map(|(a, b)| a - b).collect();
            let size = change.iter().map(|x| x * x).sum::<f64>().sqrt();
            for (f, c) in found.iter().zip(&change) {
                assert!((f - c).abs() < 0.01 * size, "{found:?} {change:?}");
            }
        };
        close(whole(EffectKind::PositionOffset, &[0.4]), torque(&robot, &chi, &[0.3, -0.4, 1.1], &dq, &ddq));
        let (x, y) = (0.15, -0.2);
        let angle = f64::hypot(x, y);
        let axis = [x / angle, y / angle];
        let mut tilted = robot.clone();
        tilted.gravity = [axis[1], -axis[0], 0.0].map(|u| u * -9.81 * angle.sin());
        tilted.gravity[2] = -9.81 * angle.cos();
        close(whole(EffectKind::BaseTilt, &[x, y]), torque(&tilted, &chi, &q, &dq, &ddq));
    }
}
