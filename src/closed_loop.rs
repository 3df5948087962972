//! A diagnosis checked by forward simulation: the identified robot follows the recorded motion in closed loop, once
//! without and once with what was found, and its torques are set beside the recorded ones.

use dynid_runtime::diagnosis::{Diagnosis, DiagnosisError, Settings, slowest_speeds};
use dynid_runtime::effects::{EffectTerm, Form, Place};
use dynid_runtime::estimation::choose_bandwidth;
use dynid_runtime::model::{Model, ParameterKind, Robot};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Butterworth, Motion, Preparation, SignalError, prepare_all};
use dynid_runtime::simulation::{
    ElasticJoint, ExtraTorque, Instant, LoopSettings, Plant, SampledReference, SensorSettings,
    SimulatedEffects, SimulationError, simulate,
};
use serde::Serialize;
use thiserror::Error;

/// Torques are compared below this frequency, Hz, or the recording's own band where that is lower.
const BAND: f64 = 25.0;
/// Control rate of the simulation at least, Hz; and with compliant joints, whose resonance a slower loop would excite.
const RATE: f64 = 1000.0;
const FAST_RATE: f64 = 4000.0;
/// The loop settles from where the recording starts for this long, s.
const SETTLING: f64 = 0.2;

/// Recorded and simulated torques.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Which recording was followed.
    pub recording: String,
    /// Length of its motions, s.
    pub duration: f64,
    /// Relative error of the torques with the standard model simulated.
    pub before: f64,
    /// The same with the findings.
    pub after: f64,
    /// Joint by joint.
    pub per_joint_before: Vec<f64>,
    /// Joint by joint, with the findings.
    pub per_joint_after: Vec<f64>,
    /// Largest distance of each joint from the recorded motion, standard model, rad or m.
    pub tracking_before: Vec<f64>,
    /// The same with the findings.
    pub tracking_after: Vec<f64>,
    /// Findings that a simulation along a recorded motion does not have.
    pub left_out: Vec<String>,
    /// The first motion: time, and for each joint what was recorded and simulated.
    #[serde(skip)]
    pub first: Compared,
}

/// Torques of one motion, `[joint][row]`, in the band of the comparison.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Compared {
    /// s.
    pub time: Vec<f64>,
    /// Recorded.
    pub recorded: Vec<Vec<f64>>,
    /// Simulated without the findings.
    pub before: Vec<Vec<f64>>,
    /// Simulated with them.
    pub after: Vec<Vec<f64>>,
}

/// Why a recording cannot be set beside a simulation.
#[derive(Debug, Error)]
pub enum ClosedLoopError {
    /// The identified parameters are no robot that could move: not every set that fits torques is.
    #[error("the identified robot cannot be simulated {which} the findings: {error}")]
    Simulation {
        /// `without` or `with`.
        which: &'static str,
        /// What the simulation says.
        error: SimulationError,
    },
    /// The recording cannot be prepared.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// The recording has no speeds to tell motion from rest by.
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
}

/// Lets the standard model and the model with the findings follow the motions of a recording.
///
/// The controller feeds the standard model's torque forward and closes the loop on the positions with the robot's
/// nominal gains, or with gains that place every joint's poles at 8 Hz.
///
/// # Errors
/// Parameters that cannot be simulated, motions that cannot be prepared.
pub fn closed_loop(
    model: &dyn Model,
    name: &str,
    motions: &[Trajectory],
    diagnosis: &Diagnosis,
    progress: &dyn Fn(f64),
) -> Result<ClosedLoop, ClosedLoopError> {
    let n = model.robot().joints();
    let chosen = choose_bandwidth(motions)?;
    let band = chosen.band.min(BAND);
    let settings = Preparation { cutoff: Some(chosen.cutoff), ..Preparation::default() };
    let (prepared, _) = prepare_all(motions, &settings)?;
    let slowest = slowest_speeds(model, motions, &Settings::default())?;
    let terms = diagnosis.terms();
    let variants: [(&'static str, &[f64], &[EffectTerm]); 2] =
        [("without", &diagnosis.standard.chi, &[]), ("with", &diagnosis.model.chi, &terms)];
    let mut squares = [vec![0.0; n], vec![0.0; n]];
    let mut whole = vec![0.0; n];
    let mut tracking = [vec![0.0_f64; n], vec![0.0_f64; n]];
    let mut first = Compared::default();
    let mut duration = 0.0;
    for (k, motion) in prepared.iter().enumerate() {
        let recorded = smooth(&shifted(motion, diagnosis.delay), motion.rate, band)?;
        let mut simulated = Vec::new();
        for (v, &(which, chi, terms)) in variants.iter().enumerate() {
            let (torques, errors) = follow(model, motion, &diagnosis.standard.chi, chi, terms)
                .map_err(|error| ClosedLoopError::Simulation { which, error })?;
            simulated.push(smooth(&torques, motion.rate, band)?);
            tracking[v].iter_mut().zip(errors).for_each(|(most, e)| *most = most.max(e));
            progress((k as f64 + 0.5 * (v + 1) as f64) / prepared.len() as f64);
        }
        let rows = compared_rows(motion);
        duration += rows.len() as f64 / motion.rate;
        for j in 0..n {
            for t in rows.clone().filter(|&t| motion.dq[j][t].abs() > slowest[j]) {
                whole[j] += recorded[j][t].powi(2);
                for (squares, torque) in squares.iter_mut().zip(&simulated) {
                    squares[j] += (recorded[j][t] - torque[j][t]).powi(2);
                }
            }
        }
        if k == 0 {
            let cut = |signals: &[Vec<f64>]| signals.iter().map(|x| x[rows.clone()].to_vec()).collect();
            first = Compared {
                time: rows.clone().map(|t| motion.start + t as f64 / motion.rate).collect(),
                recorded: cut(&recorded),
                before: cut(&simulated[0]),
                after: cut(&simulated[1]),
            };
        }
    }
    let ratio = |a: f64, b: f64| if b > 0.0 { (a / b).sqrt() } else { 0.0 };
    let overall = |left: &[f64]| ratio(left.iter().sum(), whole.iter().sum());
    let per_joint = |left: &[f64]| left.iter().zip(&whole).map(|(a, b)| ratio(*a, *b)).collect();
    let [before, after] = squares;
    let [tracking_before, tracking_after] = tracking;
    Ok(ClosedLoop {
        recording: name.to_owned(),
        duration,
        before: overall(&before),
        after: overall(&after),
        per_joint_before: per_joint(&before),
        per_joint_after: per_joint(&after),
        tracking_before,
        tracking_after,
        left_out: left_out(model, &diagnosis.model.chi, &terms),
        first,
    })
}

/// Rows that no filter and no start has spoiled.
fn compared_rows(motion: &Motion) -> std::ops::Range<usize> {
    let samples = motion.q.first().map_or(0, Vec::len);
    let first = motion.spoiled.max((SETTLING * motion.rate) as usize);
    first..samples.saturating_sub(motion.spoiled).max(first)
}

/// Torques of a simulated robot that follows a motion, at its samples, and how far each joint is from it at most.
fn follow(
    model: &dyn Model,
    motion: &Motion,
    known: &[f64],
    chi: &[f64],
    terms: &[EffectTerm],
) -> Result<(Vec<Vec<f64>>, Vec<f64>), SimulationError> {
    let reference = SampledReference {
        step: 1.0 / motion.rate,
        q: motion.q.clone(),
        dq: motion.dq.clone(),
        ddq: motion.ddq.clone(),
        fixed: motion.fixed.clone(),
    };
    let rate = if terms.iter().any(|t| elastic(t).is_some()) { FAST_RATE } else { RATE };
    let every = (rate / motion.rate).ceil().max(1.0);
    let mut known = known.to_vec();
    // What a drive feeds forward does not push.
    let _ = LessFriction::taken_from(model.robot(), &mut known);
    let mut settings = LoopSettings::nominal(model, &known, &reference, every * motion.rate, 0);
    settings.record_every = every as usize;
    settings.sensors = SensorSettings::default();
    // Where the recording is, the drives could do it.
    settings.controller.torque_limits = Vec::new();
    let mut plant = plant(model, chi, terms)?;
    let run = simulate(&mut plant, &reference, &settings, &mut |_| {})?;
    let samples = motion.q.first().map_or(0, Vec::len);
    let mut torque = run.truth.torque;
    torque.iter_mut().for_each(|x| x.resize(samples, 0.0));
    Ok((torque, run.tracking_error))
}

/// The identified robot with what was found in it.
fn plant<'m>(model: &'m dyn Model, chi: &[f64], terms: &[EffectTerm]) -> Result<Plant<'m>, SimulationError> {
    let mut effects = SimulatedEffects::new(model, chi, terms);
    effects.torques.push(Box::new(LessFriction::taken_from(model.robot(), &mut effects.chi)));
    let elastic: Vec<(ElasticJoint, f64)> = terms.iter().filter_map(elastic).collect();
    if elastic.is_empty() {
        return Plant::with_torques(model, &effects.chi, effects.torques);
    }
    // Standard parameters that have these base parameters, with the rotors of the elastic joints apart.
    let robot = model.robot();
    let joint_of = robot.joint_of_frame();
    let mut standard = vec![0.0; robot.standard.len()];
    for (joint, rotor) in &elastic {
        let own = robot
            .standard
            .iter()
            .position(|p| p.kind == ParameterKind::Ia && joint_of[p.frame] == Some(joint.joint));
        if let Some(k) = own {
            standard[k] = *rotor;
        }
    }
    let apart = robot.base_from_standard(&standard);
    for ((base, value), apart) in robot.base.iter().zip(&effects.chi).zip(apart) {
        // A rotor that is a base parameter of its own is known from the motion.
        standard[base.standard] += value - apart;
    }
    let joints: Vec<ElasticJoint> = elastic.into_iter().map(|(joint, _)| joint).collect();
    Plant::with_effects(model, &standard, &joints, effects.torques)
}

/// Friction parameters below zero. Beside a law that was found they are part of a friction that is positive all the
/// same, but no plant takes them by themselves.
struct LessFriction {
    viscous: Vec<f64>,
    dry: Vec<f64>,
}

impl LessFriction {
    /// Takes them out of base parameters.
    fn taken_from(robot: &Robot, chi: &mut [f64]) -> Self {
        let joint_of = robot.joint_of_frame();
        let mut less = Self { viscous: vec![0.0; robot.joints()], dry: vec![0.0; robot.joints()] };
        for (base, value) in robot.base.iter().zip(chi) {
            let standard = &robot.standard[base.standard];
            let Some(joint) = joint_of[standard.frame].filter(|_| *value < 0.0) else { continue };
            match standard.kind {
                ParameterKind::Fv => less.viscous[joint] = std::mem::take(value),
                ParameterKind::Fc => less.dry[joint] = std::mem::take(value),
                _ => {}
            }
        }
        less
    }
}

impl ExtraTorque for LessFriction {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        for (out, (f, dq)) in out.iter_mut().zip(self.viscous.iter().zip(at.dq)) {
            *out += f * dq;
        }
    }

    fn dry_friction(&self, _: &Instant<'_>, levels: &mut [[f64; 2]]) {
        for (level, less) in levels.iter_mut().zip(&self.dry) {
            level.iter_mut().for_each(|x| *x += less);
        }
    }

    fn has_dry_friction(&self) -> bool {
        self.dry.iter().any(|x| *x != 0.0)
    }
}

/// A compliant joint that was found, and its rotor.
fn elastic(term: &EffectTerm) -> Option<(ElasticJoint, f64)> {
    match (term.effect.form(), term.place, term.amplitude.as_slice()) {
        (Form::Compliance(_), Place::Joint(joint), &[stiffness, damping, rotor, play]) if rotor > 0.0 => {
            Some((ElasticJoint { joint, stiffness, damping, play }, rotor))
        }
        _ => None,
    }
}

fn left_out(model: &dyn Model, chi: &[f64], terms: &[EffectTerm]) -> Vec<String> {
    let simulated: Vec<_> = terms.iter().filter(|t| elastic(t).is_some()).map(|t| t.effect).collect();
    let all = SimulatedEffects::new(model, chi, terms).left_out;
    all.into_iter().filter(|e| !simulated.contains(e)).map(|e| e.id().to_owned()).collect()
}

/// The recorded torques with the skew to the positions taken out.
fn shifted(motion: &Motion, delay: f64) -> Vec<Vec<f64>> {
    let later = delay * motion.rate;
    let shift = |x: &Vec<f64>| -> Vec<f64> {
        let last = x.len().saturating_sub(1);
        (0..x.len())
            .map(|k| {
                let at = (k as f64 + later).clamp(0.0, last as f64);
                let low = at as usize;
                x[low] + (at - low as f64) * (x[(low + 1).min(last)] - x[low])
            })
            .collect()
    };
    if delay == 0.0 { motion.torque.clone() } else { motion.torque.iter().map(shift).collect() }
}

fn smooth(torques: &[Vec<f64>], rate: f64, band: f64) -> Result<Vec<Vec<f64>>, SignalError> {
    let filter = Butterworth::low_pass(4, band, rate)?;
    torques.iter().map(|x| filter.zero_phase(x)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models;
    use dynid_runtime::effects::{EffectKind, TermScale};

    /// Two seconds of a smooth motion of all joints.
    fn motion(joints: usize) -> Motion {
        let rate = 500.0;
        let signal = |derivative: i32| -> Vec<Vec<f64>> {
            (0..joints)
                .map(|j| {
                    let w = 3.0 + j as f64;
                    let phase = std::f64::consts::FRAC_PI_2 * f64::from(derivative);
                    (0..1000)
                        .map(|t| 0.05 * w.powi(derivative) * (w * t as f64 / rate + phase).sin())
                        .collect()
                })
                .collect()
        };
        Motion {
            name: "a".to_owned(),
            rate,
            start: 0.0,
            q: signal(0),
            dq: signal(1),
            ddq: signal(2),
            torque: vec![vec![0.0; 1000]; joints],
            fixed: Vec::new(),
            spoiled: 0,
        }
    }

    fn inverse(model: &dyn Model, chi: &[f64], motion: &Motion, t: usize) -> Vec<f64> {
        let at = |signal: &[Vec<f64>]| signal.iter().map(|x| x[t]).collect::<Vec<f64>>();
        let pattern = model.pattern();
        let mut entries = vec![0.0; pattern.columns.len()];
        model.idm(&at(&motion.q), &at(&motion.dq), &at(&motion.ddq), &mut entries);
        (0..motion.q.len())
            .map(|j| {
                let row = pattern.rows[j]..pattern.rows[j + 1];
                row.map(|e| entries[e] * chi[pattern.columns[e]]).sum()
            })
            .collect()
    }

    fn place(model: &dyn Model, name: &str) -> usize {
        model.robot().base.iter().position(|b| b.name == name).expect("the robot has the parameter")
    }

    #[test]
    fn viscous_friction_below_zero_is_simulated_as_it_was_identified() {
        let model = models::find("scara4").expect("robots/ has it");
        let nominal = model.robot().nominal.as_ref().expect("it has nominal values");
        let mut chi = model.robot().base_from_standard(&nominal.standard);
        chi[place(model, "Fv1")] = -0.5;
        let motion = motion(4);
        let (torque, off) = follow(model, &motion, &chi, &chi, &[]).expect("it can be simulated");
        assert!(off.iter().all(|x| *x < 2e-3), "{off:?}");
        // Away from the reversals of the joint, where dry friction jumps.
        let fast = (200..900).filter(|&t| motion.dq[0][t].abs() > 0.08);
        let worst =
            fast.map(|t| (torque[0][t] - inverse(model, &chi, &motion, t)[0]).abs()).fold(0.0, f64::max);
        assert!(worst < 0.1, "{worst} N.m");
    }

    #[test]
    fn a_compliant_joint_that_was_found_swings_in_the_simulation() {
        let model = models::find("scara4").expect("robots/ has it");
        let nominal = model.robot().nominal.as_ref().expect("it has nominal values");
        let chi = model.robot().base_from_standard(&nominal.standard);
        let term = |stiffness: f64| EffectTerm {
            effect: EffectKind::JointElasticity,
            place: Place::Joint(1),
            joints: vec![2],
            shape: vec![10.0, 0.05, 0.5, 0.0],
            amplitude: vec![stiffness, 0.5, 0.12, 0.0],
            sigma: vec![0.0; 4],
            scale: Some(TermScale::UNIT),
            wrenches: Vec::new(),
        };
        let motion = motion(4);
        let run = |terms: &[EffectTerm]| follow(model, &motion, &chi, &chi, terms).expect("it runs").0;
        let (rigid, stiff, soft) = (run(&[]), run(&[term(1e4)]), run(&[term(10.0)]));
        let apart = |a: &[Vec<f64>]| (200..900).map(|t| (a[1][t] - rigid[1][t]).powi(2)).sum::<f64>().sqrt();
        assert!(apart(&soft) > 10.0 * apart(&stiff), "{} {}", apart(&soft), apart(&stiff));
        assert_eq!(left_out(model, &chi, &[term(10.0)]), Vec::<String>::new());
    }
}
