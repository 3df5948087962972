//! Motions at the full rate, ready for laws and models.

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::rules::{RATE_PER_CUTOFF, RECORDED_BAND, SAMPLES_PER_SECOND};
use crate::effects::Corrected;
use crate::model::{Model, ParameterKind, Robot, StandardParameter, States};
use crate::recording::Trajectory;
use crate::signal::{
    Butterworth, Motion, Preparation, Stencil, central_difference, prepare, rounding_of_means,
};

/// One motion: positions filtered and differentiated three times, torques through the same filter. `[j][t]`.
#[derive(Clone)]
pub(in crate::diagnosis) struct Signals {
    pub name: String,
    /// Whether it belongs to the recording that is diagnosed; otherwise to the baseline.
    pub is_target: bool,
    pub rate: f64,
    pub start: f64,
    pub q: Vec<Vec<f64>>,
    pub dq: Vec<Vec<f64>>,
    pub ddq: Vec<Vec<f64>>,
    pub jerk: Vec<Vec<f64>>,
    pub torque: Vec<Vec<f64>>,
    /// Standard deviation of the error of slow torques by the steps that they are recorded in, per joint.
    pub rounding: Vec<f64>,
    /// Samples at which what is known of the robot says nothing of a joint's torque, `[j][t]`; empty where there are none.
    pub unknown: Vec<Vec<bool>>,
    /// Samples at each end that the filters' edge effects reach.
    pub edge_samples: usize,
    /// Torques that are known and not part of `torque`, where there are any.
    known: Option<Vec<Vec<f64>>>,
    /// What the torques are made from again when another skew is taken out; `None` for a motion taken as it is.
    recorded: Option<Recorded>,
}

/// Torques as recorded, on the uniform grid.
#[derive(Clone)]
struct Recorded {
    torque: Vec<Vec<f64>>,
    rate: f64,
    /// Every so many samples are kept.
    stride: usize,
    filter: Butterworth,
    /// Of the filter, Hz.
    cutoff: f64,
    /// Skew that has been taken out, s.
    delay: f64,
}

impl Recorded {
    /// Filtered torques, moved by `delay`.
    fn delayed(&self, delay: f64) -> Result<Vec<Vec<f64>>, DiagnosisError> {
        let filtered = |x: &Vec<f64>| Ok(self.filter.zero_phase(&shifted(x, delay * self.rate))?);
        let torque = self.torque.iter().map(filtered).collect::<Result<Vec<_>, DiagnosisError>>()?;
        Ok(thinned(torque, self.stride))
    }
}

/// Every `stride`-th sample of each series.
fn thinned(x: Vec<Vec<f64>>, stride: usize) -> Vec<Vec<f64>> {
    x.into_iter().map(|v| v.into_iter().step_by(stride).collect()).collect()
}

fn differentiated(x: &[f64], rate: f64) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    central_difference(x, rate, Stencil::Seven, &mut out);
    out
}

impl Signals {
    /// Filters and differentiates a motion. `delay`: skew of the torques behind the positions, which is taken out, s;
    /// `cutoff`: of the filter of positions and torques, Hz.
    ///
    /// # Errors
    /// [`DiagnosisError::Signal`] where the motion is too short for the filter or its time stamps are wrong.
    pub fn new(
        trajectory: &Trajectory,
        is_target: bool,
        delay: f64,
        cutoff: f64,
    ) -> Result<Self, DiagnosisError> {
        let stamps = trajectory.time.len().max(2) - 1;
        let span = trajectory.time.last().unwrap_or(&0.0) - trajectory.time.first().unwrap_or(&0.0);
        let rate = if span > 0.0 { stamps as f64 / span } else { 1.0 };
        let settings =
            Preparation { cutoff: Some((rate / RATE_PER_CUTOFF).min(cutoff)), ..Preparation::default() };
        let motion = prepare(trajectory, &settings)?;
        let rate = motion.rate;
        // All signals are limited to the cut-off: more samples a second say nothing more.
        let stride = (rate / SAMPLES_PER_SECOND).floor().max(1.0) as usize;
        let cutoff = (rate / RATE_PER_CUTOFF).min(cutoff);
        let filter = Butterworth::low_pass(settings.order, cutoff, rate)?;
        let jerk = motion.ddq.iter().map(|x| differentiated(x, rate)).collect();
        let rounding = motion.torque.iter().map(|x| rounding_of_means(x)).collect();
        let recorded = Recorded { torque: motion.torque, rate, stride, filter, cutoff, delay };
        Ok(Self {
            name: motion.name,
            is_target,
            rate: rate / stride as f64,
            start: motion.start,
            q: thinned(motion.q, stride),
            dq: thinned(motion.dq, stride),
            ddq: thinned(motion.ddq, stride),
            jerk: thinned(jerk, stride),
            torque: recorded.delayed(delay)?,
            rounding,
            unknown: Vec::new(),
            edge_samples: motion.edge_samples.div_ceil(stride),
            known: None,
            recorded: Some(recorded),
        })
    }

    /// The same motion in a time that runs so many times faster, to evaluate a model on: its torques are not made anew
    /// from the recording.
    pub fn faster(&self, factor: f64) -> Self {
        let scaled = |x: &[Vec<f64>], power: i32| -> Vec<Vec<f64>> {
            let by = factor.powi(power);
            x.iter().map(|of_joint| of_joint.iter().map(|v| by * v).collect()).collect()
        };
        Self {
            rate: factor * self.rate,
            start: self.start / factor,
            dq: scaled(&self.dq, 1),
            ddq: scaled(&self.ddq, 2),
            jerk: scaled(&self.jerk, 3),
            recorded: None,
            ..self.clone()
        }
    }

    /// Takes another skew of the torques out; nothing else changes.
    ///
    /// # Errors
    /// [`DiagnosisError::Signal`] where the motion is too short for the filter.
    pub fn set_delay(&mut self, delay: f64) -> Result<(), DiagnosisError> {
        if let Some(recorded) = &mut self.recorded {
            recorded.delay = delay;
            self.torque = recorded.delayed(delay)?;
            self.leave_known_out();
        }
        Ok(())
    }

    /// Takes torques that are known out of the recorded ones, `[j][t]`.
    pub fn take_out(&mut self, known: Vec<Vec<f64>>) {
        self.known = Some(known);
        self.leave_known_out();
    }

    /// Torques as they were recorded, with what was known and taken out of them, `[j][t]`.
    pub fn whole_torque(&self) -> Vec<Vec<f64>> {
        let mut torque = self.torque.clone();
        for (torque, known) in torque.iter_mut().zip(self.known.iter().flatten()) {
            torque.iter_mut().zip(known).for_each(|(t, k)| *t += k);
        }
        torque
    }

    fn leave_known_out(&mut self) {
        for (torque, known) in self.torque.iter_mut().zip(self.known.iter().flatten()) {
            leave_out(torque, known);
        }
    }

    /// A motion as it is: for the torques of terms.
    pub fn of_motion(motion: &Motion) -> Self {
        let jerk = motion.ddq.iter().map(|x| differentiated(x, motion.rate)).collect();
        Self {
            name: motion.name.clone(),
            is_target: true,
            rate: motion.rate,
            start: motion.start,
            q: motion.q.clone(),
            dq: motion.dq.clone(),
            ddq: motion.ddq.clone(),
            jerk,
            torque: motion.torque.clone(),
            rounding: vec![0.0; motion.torque.len()],
            unknown: Vec::new(),
            edge_samples: motion.edge_samples,
            known: None,
            recorded: None,
        }
    }

    /// The same instants at other positions, speeds and accelerations, without torques: what a model makes of them.
    pub fn without_torque(name: &str, rate: f64, start: f64, [q, dq, ddq]: [Vec<Vec<f64>>; 3]) -> Self {
        let nothing: Vec<Vec<f64>> = q.iter().map(|x| vec![0.0; x.len()]).collect();
        Self {
            name: name.to_owned(),
            is_target: true,
            rate,
            start,
            q,
            dq,
            ddq,
            jerk: nothing.clone(),
            rounding: vec![0.0; nothing.len()],
            torque: nothing,
            unknown: Vec::new(),
            edge_samples: 0,
            known: None,
            recorded: None,
        }
    }

    /// The same motion of joints that are where a robot with errors of its numbers has them.
    pub fn seen_by(&self, robot: &Corrected) -> Self {
        Self { q: robot.real_positions(&self.q), ..self.clone() }
    }

    /// The same positions, each reached infinitely slowly.
    pub fn at_rest(&self) -> Self {
        let still: Vec<Vec<f64>> = self.q.iter().map(|x| vec![0.0; x.len()]).collect();
        Self::without_torque(&self.name, self.rate, self.start, [self.q.clone(), still.clone(), still])
    }

    /// The torque of a joint as it was recorded, and the highest frequency that it holds, Hz: what is faster than the
    /// filter lets through still shows in it. Where samples are left out, what is fast would be folded into what is
    /// slow, and it is the filtered torque.
    pub fn recorded_torque(&self, joint: usize) -> (Vec<f64>, f64) {
        match &self.recorded {
            Some(r) if r.stride == 1 => {
                let mut torque = shifted(&r.torque[joint], r.delay * r.rate);
                if let Some(known) = &self.known {
                    leave_out(&mut torque, &known[joint]);
                }
                (torque, RECORDED_BAND * r.rate)
            }
            Some(r) => (self.torque[joint].clone(), r.cutoff),
            None => (self.torque[joint].clone(), RECORDED_BAND * self.rate),
        }
    }

    /// The highest frequency that positions and torques hold, Hz: the cut-off of their filter.
    pub fn cutoff(&self) -> f64 {
        self.recorded.as_ref().map_or(RECORDED_BAND * self.rate, |r| r.cutoff)
    }

    /// What the recorded torque of a joint has above the cut-off of the filter; nothing where that is not known.
    pub fn fast_torque(&self, joint: usize) -> Vec<f64> {
        let Some(r) = &self.recorded else { return Vec::new() };
        let mut whole = thinned(vec![shifted(&r.torque[joint], r.delay * r.rate)], r.stride).remove(0);
        leave_out(&mut whole, &self.torque[joint]);
        if let Some(known) = &self.known {
            leave_out(&mut whole, &known[joint]);
        }
        let end = whole.len().saturating_sub(self.edge_samples);
        whole.drain(..end).skip(self.edge_samples).collect()
    }

    pub fn len(&self) -> usize {
        self.q.first().map_or(0, Vec::len)
    }

    pub fn time(&self, t: usize) -> f64 {
        self.start + t as f64 / self.rate
    }
}

/// Takes a known torque out of one that was recorded.
fn leave_out(torque: &mut [f64], known: &[f64]) {
    torque.iter_mut().zip(known).for_each(|(t, k)| *t -= k);
}

/// The signal `samples` later: linear interpolation, the ends held.
fn shifted(x: &[f64], samples: f64) -> Vec<f64> {
    if samples == 0.0 || x.is_empty() {
        return x.to_vec();
    }
    let last = (x.len() - 1) as f64;
    (0..x.len())
        .map(|k| {
            let at = (k as f64 + samples).clamp(0.0, last);
            let low = at.floor() as usize;
            let high = (low + 1).min(x.len() - 1);
            x[low] + (at - low as f64) * (x[high] - x[low])
        })
        .collect()
}

/// Torques of the standard model for given parameters, split by what makes them. `[j][t]`.
#[derive(Clone)]
pub(in crate::diagnosis) struct ModelTorques {
    /// Inertia, centrifugal, Coriolis, gravity, rotors.
    pub rigid: Vec<Vec<f64>>,
    /// The same without the rotors whose inertias are parameters of their own.
    pub link: Vec<Vec<f64>>,
    /// Viscous and Coulomb friction.
    pub friction: Vec<Vec<f64>>,
    /// Everything.
    pub total: Vec<Vec<f64>>,
}

const BLOCK: usize = 256;

fn part(x: &[Vec<f64>], first: usize, count: usize) -> Vec<&[f64]> {
    x.iter().map(|v| &v[first..first + count]).collect()
}

/// Every row of IDM in blocks: `each(first sample, samples, entries with stride BLOCK)`.
pub(in crate::diagnosis) fn each_block(
    model: &dyn Model,
    s: &Signals,
    mut each: impl FnMut(usize, usize, &[f64]),
) {
    let mut out = vec![0.0; model.pattern().columns.len() * BLOCK];
    let mut first = 0;
    while first < s.len() {
        let count = BLOCK.min(s.len() - first);
        let (q, dq, ddq) = (part(&s.q, first, count), part(&s.dq, first, count), part(&s.ddq, first, count));
        model.idm_block(States { q: &q, dq: &dq, ddq: &ddq }, BLOCK, &mut out);
        each(first, count, &out);
        first += count;
    }
}

impl ModelTorques {
    pub fn new(model: &dyn Model, chi: &[f64], s: &Signals) -> Self {
        let n = s.q.len();
        let zero = || vec![vec![0.0; s.len()]; n];
        // Each entry belongs to one of these; all else are their sums.
        let (mut link, mut rotors, mut friction, mut offset) = (zero(), zero(), zero(), zero());
        let kinds: Vec<ParameterKind> =
            model.robot().base.iter().map(|b| model.robot().standard[b.standard].kind).collect();
        let pattern = model.pattern().clone();
        each_block(model, s, |first, count, entries| {
            for j in 0..n {
                for e in pattern.rows[j]..pattern.rows[j + 1] {
                    let k = pattern.columns[e];
                    let part = match kinds[k] {
                        kind if kind.is_friction() => &mut friction,
                        ParameterKind::Off => &mut offset,
                        kind if kind <= ParameterKind::M || kind.is_spring() => &mut link,
                        _ => &mut rotors,
                    };
                    let values = &entries[e * BLOCK..e * BLOCK + count];
                    for (o, v) in part[j][first..first + count].iter_mut().zip(values) {
                        *o += v * chi[k];
                    }
                }
            }
        });
        let sum = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
            a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + b).collect()).collect()
        };
        let rigid = sum(&link, &rotors);
        let total = sum(&sum(&rigid, &friction), &offset);
        Self { rigid, link, friction, total }
    }
}

/// The linear forms of dq whose sign enters the row of each joint: its own speed, those of coupled motors, and those that
/// friction between links acts on.
pub(in crate::diagnosis) fn directions(robot: &Robot) -> Vec<Vec<Vec<f64>>> {
    let n = robot.joints();
    let mut forms: Vec<Vec<Vec<f64>>> = (0..n)
        .map(|j| {
            let mut own = vec![0.0; n];
            own[j] = 1.0;
            vec![own]
        })
        .collect();
    let combined = |p: &&StandardParameter| matches!(p.kind, ParameterKind::Fcm | ParameterKind::Fcc);
    for parameter in robot.standard.iter().filter(combined) {
        let mut form = vec![0.0; n];
        robot.acts_on(parameter).into_iter().for_each(|(joint, c)| form[joint] = c);
        for (j, forms) in forms.iter_mut().enumerate() {
            if form[j] != 0.0 && !forms.contains(&form) {
                forms.push(form.clone());
            }
        }
    }
    forms
}
