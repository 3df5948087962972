//! A recording of a simulated robot that hides one effect.

use std::f64::consts::PI;

use dynid_runtime::effects::{EffectKind, EffectTerm, Form, Place, TermScale};
use dynid_runtime::model::{Link, Model, ParameterKind, RecursiveModel, Robot};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::excitation::{ExcitationSettings, Identification, MotionKind, excite};
use dynid_runtime::simulation::{
    ElasticJoint, ExtraTorque, LoopSettings, Plant, SimulatedEffects, SimulationError, simulate,
};

use crate::torques::{CoupledRotor, Dahl, Push};
use crate::{Case, Failure};

/// Motions of a recording, their length, s, the control rate, Hz, and control samples for each recorded row.
const MOTIONS: u64 = 3;
const PERIOD: f64 = 8.0;
const RATE: f64 = 2000.0;
const RECORD_EVERY: usize = 4;

/// What the diagnosis gets, and what it does not.
pub struct Hidden {
    /// The recording.
    pub motions: Vec<Trajectory>,
    /// The robot before the change, where the effect is a change.
    pub baseline: Vec<Trajectory>,
    /// Number j of the joint that hides the effect; `None` where it is the whole robot's.
    pub joint: Option<usize>,
}

/// Whether the effect is a change since an earlier recording.
fn is_change(effect: EffectKind) -> bool {
    effect.needs_baseline() || matches!(effect, EffectKind::TorqueConstantError | EffectKind::BaseTilt)
}

/// The three sizes of an effect, and what they are relative to.
pub fn sizes(effect: EffectKind) -> ([f64; 3], &'static str) {
    use EffectKind as E;
    match effect {
        E::Stribeck => {
            ([0.1, 0.25, 0.6], "extra level at rest, of the dry friction; vs 8 % of the top speed")
        }
        E::NonlinearViscous => ([0.15, 0.4, 1.0], "f at top speed with p = 0.5, of the dry friction"),
        E::LoadDependentFriction => ([0.02, 0.05, 0.12], "mu"),
        E::PositionDependentFriction => {
            ([0.1, 0.25, 0.6], "amplitude of one and a half waves over the travel, of the dry friction")
        }
        E::AsymmetricFriction => ([0.1, 0.25, 0.6], "half difference at top speed, of the dry friction"),
        E::PreslidingHysteresis => {
            ([0.25, 0.5, 1.0], "part of the dry friction that builds up over 2 % of the travel")
        }
        E::FrictionDrift => ([0.15, 0.4, 1.0], "fading Coulomb level, of the dry friction; tau 3 s"),
        E::FrictionLevelChange => ([0.05, 0.15, 0.4], "change of viscous and Coulomb friction"),
        E::TorqueRipple => ([0.05, 0.15, 0.4], "amplitude once a motor turn, of the dry friction"),
        E::Spring => ([0.15, 0.5, 1.5], "torque at half of the travel, of the dry friction"),
        E::Payload => ([0.003, 0.01, 0.04], "mass, of the robot's moving mass"),
        E::AddedMass => ([0.005, 0.02, 0.08], "mass, of the robot's moving mass"),
        E::BaseTilt => ([0.0035, 0.0175, 0.07], "tilt, rad"),
        E::CoupledTransmission => ([0.1, 0.25, 0.6], "Coulomb and viscous level, of the joint's; ratio 0.5"),
        E::TorqueConstantError => ([0.02, 0.06, 0.2], "error of the torque constant"),
        E::TorqueSaturation => ([0.02, 0.06, 0.2], "droop at the largest torque, cubic"),
        E::JointElasticity => ([45.0, 25.0, 12.0], "frequency of the link on its spring, Hz"),
        E::Backlash => ([0.0003, 0.001, 0.004], "play, rad"),
        E::TimeDelay => ([0.0015, 0.004, 0.01], "delay of the torque, s"),
        E::WrongSampleRate => ([0.01, 0.03, 0.1], "error of the declared period"),
        E::PositionOffset => ([0.01, 0.035, 0.1], "offset, rad"),
        E::GeometryError => ([0.01, 0.04, 0.15], "error of a length of the table"),
        E::Contact => {
            ([0.3, 1.0, 3.0], "largest joint torque by the force at 0.3 m, of the dry friction; 0.5 s")
        }
    }
}

/// A robot as it is simulated.
struct World<'m> {
    model: &'m dyn Model,
    standard: Vec<f64>,
    elastic: Vec<ElasticJoint>,
    terms: Vec<EffectTerm>,
    dahl: Option<(usize, f64, f64)>,
    coupled: Option<([usize; 2], f64, f64)>,
    push: Option<[f64; 3]>,
}

impl<'m> World<'m> {
    fn nominal(model: &'m dyn Model, standard: &[f64]) -> Self {
        let standard = standard.to_vec();
        Self {
            model,
            standard,
            elastic: Vec::new(),
            terms: Vec::new(),
            dahl: None,
            coupled: None,
            push: None,
        }
    }
}

/// A joint's own parameter in chi_st.
fn of_joint(robot: &Robot, kind: ParameterKind, joint: usize) -> Option<usize> {
    let joint_of = robot.joint_of_frame();
    (0..robot.standard.len())
        .find(|&k| robot.standard[k].kind == kind && joint_of[robot.standard[k].frame] == Some(joint))
}

/// Simulates a case.
pub fn recorded(model: &'static dyn Model, case: &Case) -> Result<Hidden, Failure> {
    let robot = model.robot();
    let nominal = robot.nominal.as_ref().ok_or("the robot has no nominal values")?;
    let joint = (case.seed as usize + case.size) % 3;
    let plain = World::nominal(model, &nominal.standard);
    let base_seed = case.seed * 1000 + 10 * case.size as u64;
    let Some(effect) = case.effect else {
        return Ok(Hidden {
            motions: simulated(&plain, model, base_seed, RECORD_EVERY)?,
            baseline: Vec::new(),
            joint: None,
        });
    };
    let size = sizes(effect).0[case.size];
    let baseline =
        if is_change(effect) { simulated(&plain, model, base_seed + 500, RECORD_EVERY)? } else { Vec::new() };
    let altered = altered(robot, effect, case, size)?;
    let mut world = match &altered {
        Some((model, _)) => World::nominal(model, &nominal.standard),
        None => plain,
    };
    let mut on = Some(joint);
    match effect.form() {
        Form::Window => {
            // A contact is named by its time, on whatever joints.
            on = None;
            let levels: Vec<f64> = (0..robot.joints())
                .filter_map(|j| of_joint(robot, ParameterKind::Fc, j).map(|k| nominal.standard[k]))
                .collect();
            let force = size * levels.iter().sum::<f64>() / levels.len().max(1) as f64 / 0.3;
            let angle = case.seed as f64;
            world.push = Some([0.7 * force * angle.cos(), 0.7 * force * angle.sin(), 0.7 * force]);
        }
        Form::Coupled => {
            on = Some(2);
            world.coupled = Some(([1, 2], 0.5, size));
        }
        Form::Compliance(_) => {
            // The joint's number is that of a revolute one on all three robots.
            on = Some(joint % 2);
            world.elastic = vec![elastic(model, &nominal.standard, joint % 2, effect, size)?];
        }
        Form::Body(_) => {
            let moving: f64 = sum_of(robot, &nominal.standard, ParameterKind::M);
            let frame = if effect == EffectKind::Payload {
                robot.joint_of_frame().iter().rposition(Option::is_some).unwrap_or(0)
            } else {
                1 + joint % 2
            };
            on = robot.joint_of_frame()[..=frame].iter().flatten().last().copied();
            world.terms = vec![term(robot, effect, Place::Link(frame), &[], &box_on(size * moving))];
        }
        Form::Sensitivity(_) => on = None,
        Form::Joint(_) => hide_law(&mut world, robot, &nominal.standard, effect, joint, size, case),
    }
    if effect == EffectKind::PositionOffset {
        on = Some(1);
    }
    if let Some((_, at)) = &altered {
        on = *at;
    }
    let record_every = if effect == EffectKind::TimeDelay { 1 } else { RECORD_EVERY };
    let mut motions = simulated(&world, model, base_seed, record_every)?;
    let largest: Vec<f64> = (0..robot.joints())
        .map(|j| motions.iter().flat_map(|m| &m.torque[j]).fold(0.0_f64, |a, x| a.max(x.abs())))
        .collect();
    for motion in &mut motions {
        distort(motion, effect, on.unwrap_or(0), size, largest[on.unwrap_or(0)]);
    }
    Ok(Hidden { motions, baseline, joint: on.map(|j| j + 1) })
}

/// A joint's law, in units of the joint's friction, speed and travel.
fn hide_law(
    world: &mut World<'_>,
    robot: &Robot,
    standard: &[f64],
    effect: EffectKind,
    joint: usize,
    size: f64,
    case: &Case,
) {
    use EffectKind as E;
    let friction = of_joint(robot, ParameterKind::Fc, joint).map_or(1.0, |k| standard[k]);
    let speed = SHARE * robot.limits.velocity.get(joint).map_or(1.0, |v| v[1]);
    let range = SHARE * robot.limits.position.get(joint).map_or(1.0, |q| q[1] - q[0]);
    let gear = robot.drive.gear.get(joint * (robot.joints() + 1)).map_or(1.0, |g| g.abs());
    let phase = 2.4 * case.seed as f64;
    let wave = |amplitude: f64| vec![amplitude * phase.cos(), amplitude * phase.sin()];
    let (shape, amplitude) = match effect {
        E::Stribeck => (vec![0.08 * speed], vec![size * friction]),
        E::NonlinearViscous => (vec![0.5], vec![size * friction]),
        E::LoadDependentFriction => (Vec::new(), vec![size]),
        E::PositionDependentFriction => (vec![3.0 * PI / range], wave(size * friction)),
        E::AsymmetricFriction => (Vec::new(), vec![size * friction / speed]),
        E::FrictionDrift => (vec![1.0, 3.0], vec![size * friction]),
        E::TorqueRipple => (vec![gear], wave(size * friction)),
        E::Spring => (Vec::new(), vec![2.0 * size * friction / range]),
        E::PreslidingHysteresis => {
            world.dahl = Some((joint, size * friction, 0.02 * range));
            return;
        }
        E::FrictionLevelChange => {
            for kind in [ParameterKind::Fv, ParameterKind::Fc] {
                if let Some(k) = of_joint(robot, kind, joint) {
                    world.standard[k] *= 1.0 + size;
                }
            }
            return;
        }
        // What the drive reports is altered afterwards.
        _ => return,
    };
    let mut law = term(robot, effect, Place::Joint(joint), &shape, &amplitude);
    law.scale = Some(TermScale { speed, range, torque: 1.0, duration: PERIOD, gear, prismatic: false });
    world.terms = vec![law];
}

fn term(robot: &Robot, effect: EffectKind, place: Place, shape: &[f64], amplitude: &[f64]) -> EffectTerm {
    let joints = if let Place::Joint(j) = place { vec![j + 1] } else { (1..=robot.joints()).collect() };
    EffectTerm {
        effect,
        place,
        joints,
        shape: shape.to_vec(),
        amplitude: amplitude.to_vec(),
        sigma: vec![0.0; amplitude.len()],
        scale: None,
        wrenches: Vec::new(),
    }
}

/// A cube of 6 cm beside the origin of its frame: XX XY XZ YY YZ ZZ MX MY MZ M.
fn box_on(mass: f64) -> [f64; 10] {
    let [x, y, z] = [0.04, 0.02, 0.05];
    let own = 0.06 * 0.06 / 6.0;
    [own + y * y + z * z, -x * y, -x * z, own + x * x + z * z, -y * z, own + x * x + y * y, x, y, z, 1.0]
        .map(|per_kg| mass * per_kg)
}

fn sum_of(robot: &Robot, standard: &[f64], kind: ParameterKind) -> f64 {
    robot.standard.iter().zip(standard).filter(|(p, _)| p.kind == kind).map(|(_, value)| value).sum()
}

/// A spring between motor and link, from the frequency of the link on it, or with play behind a stiff spring.
fn elastic(
    model: &dyn Model,
    standard: &[f64],
    joint: usize,
    effect: EffectKind,
    size: f64,
) -> Result<ElasticJoint, Failure> {
    let robot = model.robot();
    let n = robot.joints();
    let chi = robot.base_from_standard(standard);
    let (rest, mut mass, mut bias) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n]);
    model.mass_and_bias(&chi, &rest, &rest, &mut mass, &mut bias);
    let rotor = of_joint(robot, ParameterKind::Ia, joint).map_or(0.0, |k| standard[k]);
    let link = mass[joint * (n + 1)] - rotor;
    if link <= 0.0 || rotor <= 0.0 {
        return Err("no rotor or no link to put a spring between".into());
    }
    let (frequency, play) = if effect == EffectKind::Backlash { (45.0, size) } else { (size, 0.0) };
    let stiffness = link * (2.0 * PI * frequency).powi(2);
    let damping = 2.0 * 0.05 * (stiffness * link).sqrt();
    Ok(ElasticJoint { joint, stiffness, damping, play })
}

/// The robot with another table or another gravity, with the joint (0-based) that the change is named on.
fn altered(
    robot: &Robot,
    effect: EffectKind,
    case: &Case,
    size: f64,
) -> Result<Option<(RecursiveModel, Option<usize>)>, Failure> {
    let mut changed = robot.clone();
    let mut joint = None;
    match effect {
        EffectKind::BaseTilt => {
            let g = -robot.gravity[2];
            let about = case.seed as f64;
            changed.gravity = [g * size.sin() * about.cos(), g * size.sin() * about.sin(), -g * size.cos()];
        }
        EffectKind::GeometryError => {
            let with_length: Vec<usize> =
                (1..robot.frames.len()).filter(|&k| robot.frames[k].d != 0.0).collect();
            let frame = *with_length.get(case.seed as usize % with_length.len().max(1)).ok_or("no length")?;
            changed.frames.to_mut()[frame].d *= 1.0 + size;
            joint = robot.joint_of_frame()[..=frame].iter().flatten().last().copied();
        }
        _ => return Ok(None),
    }
    // Every standard parameter by itself: the regrouping of the nominal table does not hold for another one.
    let every = Robot::with_standard_as_base(
        &robot.name,
        changed.gravity,
        changed.frames.to_vec(),
        robot.drive.clone(),
        robot.limits.clone(),
    );
    changed.base = every.base;
    changed.standard = every.standard;
    Ok(Some((RecursiveModel::new(changed)?, joint)))
}

/// What a recording says wrongly about the motion.
fn distort(motion: &mut Trajectory, effect: EffectKind, joint: usize, size: f64, largest: f64) {
    match effect {
        EffectKind::TorqueConstantError => motion.torque[joint].iter_mut().for_each(|x| *x *= 1.0 + size),
        // The drive reports current times its constant: more than the torque where the constant droops.
        EffectKind::TorqueSaturation => {
            for x in &mut motion.torque[joint] {
                *x += size * largest * (*x / largest).powi(3);
            }
        }
        EffectKind::PositionOffset => motion.position[joint].iter_mut().for_each(|q| *q += size),
        EffectKind::WrongSampleRate => motion.time.iter_mut().for_each(|t| *t *= 1.0 + size),
        EffectKind::TimeDelay => {
            let late = (size * RATE).round() as usize;
            let kept: Vec<usize> = (late..motion.time.len()).step_by(RECORD_EVERY).collect();
            let pick = |signal: &[f64], shift: usize| kept.iter().map(|k| signal[k - shift]).collect();
            motion.torque = motion.torque.iter().map(|signal| pick(signal, late)).collect();
            motion.position = motion.position.iter().map(|signal| pick(signal, 0)).collect();
            motion.time = pick(&motion.time, 0);
        }
        _ => {}
    }
}

/// Share of the limits that the motions use.
const SHARE: f64 = 0.8;

/// The motions of a world, planned for the nominal robot.
fn simulated(
    world: &World<'_>,
    nominal: &dyn Model,
    seed: u64,
    record_every: usize,
) -> Result<Vec<Trajectory>, Failure> {
    let planned = nominal.robot().nominal.as_ref().map(|x| nominal.robot().base_from_standard(&x.standard));
    let robot = world.model.robot();
    let chi = robot.base_from_standard(&world.standard);
    let mut motions = Vec::new();
    for k in 0..MOTIONS {
        let seed = 10 * seed + k;
        let settings = ExcitationSettings {
            kind: MotionKind::Fourier { harmonics: 5, period: PERIOD, periods: 1 },
            identification: Identification::Idim,
            sets: 1,
            starts: 1,
            evaluations: 0,
            share: SHARE,
            seed,
        };
        let plan = excite(nominal, planned.as_deref(), &settings, &|_| {})?;
        for motion in &plan.motions {
            let mut settings = LoopSettings::nominal(world.model, &chi, motion, RATE, seed);
            settings.record_every = record_every;
            settings.name = format!("motion {}", k + 1);
            let window = 2.0 + 0.5 * k as f64;
            let mut plant = plant(world, &chi, [window, window + 0.5])?;
            motions.push(simulate(&mut plant, motion, &settings, &mut |_| {})?.recorded);
        }
    }
    Ok(motions)
}

fn plant<'m>(world: &World<'m>, chi: &[f64], window: [f64; 2]) -> Result<Plant<'m>, SimulationError> {
    let robot = world.model.robot();
    if !world.elastic.is_empty() {
        return Plant::with_effects(world.model, &world.standard, &world.elastic, Vec::new());
    }
    let with_terms = SimulatedEffects::new(world.model, chi, &world.terms);
    let mut torques: Vec<Box<dyn ExtraTorque + 'm>> = Vec::new();
    for torque in with_terms.torques {
        torques.push(torque);
    }
    if let Some((joint, level, distance)) = world.dahl {
        torques.push(Box::new(Dahl { joint, level, distance, state: 0.0, last: None }));
    }
    if let Some((joints, ratio, share)) = world.coupled {
        let own = |kind| of_joint(robot, kind, joints[1]).map_or(0.0, |k| share * world.standard[k]);
        let (viscous, coulomb) = (own(ParameterKind::Fv), own(ParameterKind::Fc));
        torques.push(Box::new(CoupledRotor { joints, ratio, viscous, coulomb }));
    }
    if let Some(force) = world.push {
        let links = robot.frames.iter().map(Link::constant).collect();
        let frame = robot.joint_of_frame().iter().rposition(Option::is_some).unwrap_or(0);
        torques.push(Box::new(Push { robot, links, frame, force, window }));
    }
    Plant::with_torques(world.model, &with_terms.chi, torques)
}
