//! A case: what is drawn for it, and its recordings.

use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::{JointIndex, Model};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::excitation::ExcitingMotion;
use dynid_runtime::simulation::{Reference, World};
use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::failure::Failure;
use crate::hiding::{hide, of, plain};
use crate::motions::{Noise, planned, recorded};
use crate::outside::{Described, Outside};
use crate::put::Number;
use crate::random::Random;
use crate::secret::{Secret, is_change};
use crate::size::VISIBLE;
use crate::visible::{Plain, Seen, visible};

/// What a robot with a reference has before anything is hidden in it.
const STANDING: [EffectKind; 2] = [EffectKind::LoadDependentFriction, EffectKind::Spring];

/// An effect as it was hidden.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Hidden {
    /// Which.
    pub effect: EffectKind,
    /// Number of the joint that it must be named on; `None` for the whole robot's.
    pub joint: Option<usize>,
    /// Its magnitude, see [`crate::hiding::Hiding::counts`].
    pub magnitude: f64,
    /// Its torque relative to the noise, on the joint where it shows most.
    pub visible: f64,
    /// What it is, where no law of the catalogue describes it.
    #[serde(default)]
    pub outside: Option<Described>,
    /// What a person would call it by.
    #[serde(skip)]
    pub numbers: Vec<Number>,
}

/// Recordings of a case.
pub struct Recordings {
    /// What was hidden.
    pub hidden: Vec<Hidden>,
    /// What is diagnosed.
    pub motions: Vec<Trajectory>,
    /// The robot before the change, where one of the effects is a change.
    pub baseline: Vec<Trajectory>,
    /// A motion that takes no part in the diagnosis.
    pub test: Vec<Trajectory>,
}

/// What is drawn for a case.
pub struct Drawn {
    /// What is hidden.
    pub hidden: Vec<Hidden>,
    secrets: Vec<(Secret, f64)>,
    /// Laws that are there before and after, where there is a reference.
    standing: Vec<(Secret, f64)>,
    /// Motions, their number and length, s.
    motions: Vec<ExcitingMotion>,
    count: usize,
    length: f64,
    noise: u64,
    random: Random,
}

/// Draws motions, joints, shapes and sizes.
pub fn draw(model: &'static dyn Model, case: &Case) -> Result<Drawn, Failure> {
    let ids: Vec<&str> = case.effects.iter().map(|e| e.id()).collect();
    let mut random = Random::of(&[&[&*case.robot, case.size_name()], &ids[..]].concat(), case.seed);
    let drawn = random.below(3);
    let (count, length) = match case.seconds {
        Some(seconds) => (1, seconds),
        None => (1 + drawn, [16.0, 10.0, 8.0][drawn]),
    };
    let motions = planned(model, count, length, &mut random)?;
    let noise = random.bits();
    let number = |joint| model.robot().joint_number(JointIndex(joint)).0;
    let mut secrets: Vec<(Secret, f64)> = Vec::new();
    let mut hidden = Vec::new();
    for &effect in &case.effects {
        let taken: Vec<usize> = secrets.iter().filter_map(|(s, _)| s.joint).collect();
        let mut secret = Secret::draw(effect, model, &taken, &mut random)
            .ok_or_else(|| format!("{} has no joint that can hide {}", case.robot, effect.id()))?;
        if effect == EffectKind::Contact {
            secret.push(model, case.push, motions.first().map_or(0.0, |m| m.duration()));
        }
        if let (EffectKind::TorqueSaturation | EffectKind::FreeForm, Some(joint)) = (effect, secret.joint) {
            secret.most_torque =
                most_torque(&recorded(&plain(model)?, &motions, &[], Noise::Nominal(noise))?, joint);
        }
        let (size, seen) = sized(model, &secret, VISIBLE[case.size], &motions[..1], noise)?;
        hidden.push(Hidden {
            effect,
            // A payload is the robot's: it has one place.
            joint: secret.joint.filter(|_| effect != EffectKind::Payload).map(number),
            magnitude: size,
            visible: seen,
            outside: (effect == EffectKind::FreeForm).then(|| Outside::of(&secret).described(&secret)),
            numbers: hide(&mut plain(model)?, model, &secret, size)?,
        });
        secrets.push((secret, size));
    }
    let mut standing: Vec<(Secret, f64)> = Vec::new();
    for effect in STANDING.into_iter().filter(|_| case.reference.is_some()) {
        let taken: Vec<usize> = secrets.iter().chain(&standing).filter_map(|(s, _)| s.joint).collect();
        if let Some(secret) = Secret::draw(effect, model, &taken, &mut random) {
            let (size, _) = sized(model, &secret, VISIBLE[VISIBLE.len() - 1], &motions[..1], noise)?;
            standing.push((secret, size));
        }
    }
    Ok(Drawn { hidden, secrets, standing, motions, count, length, noise, random })
}

/// Simulates a case. `with_test`: a motion for a test as well.
pub fn recordings(model: &'static dyn Model, case: &Case, with_test: bool) -> Result<Recordings, Failure> {
    let Drawn { hidden, secrets, standing, motions, count, length, noise, mut random } = draw(model, case)?;
    let mut before = plain(model)?;
    for (secret, size) in &standing {
        hide(&mut before, model, secret, *size)?;
    }
    let mut world = plain(model)?;
    for (secret, size) in standing.iter().chain(&secrets) {
        hide(&mut world, model, secret, *size)?;
    }
    let change = case.baseline || case.reference.is_some() || case.effects.iter().any(|&e| is_change(e));
    let baseline = if change {
        recorded(
            &before,
            &planned(model, count, length, &mut random)?,
            &standing,
            Noise::Nominal(noise.wrapping_add(100)),
        )?
    } else {
        Vec::new()
    };
    let mut test = Vec::new();
    if with_test {
        let planned = planned(model, 1, 8.0, &mut random)?;
        // A contact belongs to the motion in which it happened.
        let lasting: Vec<(Secret, f64)> =
            secrets.iter().filter(|(s, _)| s.effect != EffectKind::Contact).cloned().collect();
        let mut world = plain(model)?;
        for (secret, size) in &lasting {
            hide(&mut world, model, secret, *size)?;
        }
        test = recorded(&world, &planned, &lasting, Noise::Nominal(noise.wrapping_add(200)))?;
    }
    let there: Vec<(Secret, f64)> = standing.into_iter().chain(secrets).collect();
    let motions = recorded(&world, &motions, &there, Noise::Nominal(noise))?;
    let mut recordings = Recordings { hidden, motions, baseline, test };
    let parts = [&mut recordings.motions, &mut recordings.baseline, &mut recordings.test];
    for (part, motions) in (0..).zip(parts) {
        for motion in motions {
            case.recorder.alter(model.robot(), motion, (case.seed, part));
        }
    }
    Ok(recordings)
}

/// Largest torque of a joint in recordings, N.m or N.
fn most_torque(motions: &[Trajectory], joint: usize) -> f64 {
    motions.iter().flat_map(|m| &m.torque[joint]).fold(0.0, |most, x| most.max(x.abs()))
}

/// The magnitude at which an effect shows as much as is wanted, as far as a robot may have it, and what is then seen.
fn sized(
    model: &'static dyn Model,
    secret: &Secret,
    wanted: f64,
    motions: &[ExcitingMotion],
    noise: u64,
) -> Result<(f64, f64), Failure> {
    let both = |world: &World<'static>, secrets: &[(Secret, f64)]| -> Result<Seen, Failure> {
        Ok(Seen {
            recorded: recorded(world, motions, secrets, Noise::OfTorques(noise))?,
            without_noise: recorded(world, motions, secrets, Noise::None)?,
        })
    };
    let nominal = recorded(&plain(model)?, motions, &[], Noise::Nominal(noise))?;
    let unhidden = Plain::of(model, &nominal, &both(&plain(model)?, &[])?)?;
    let seen = |size: f64| -> Result<f64, Failure> {
        let mut world = plain(model)?;
        hide(&mut world, model, secret, size)?;
        let with = both(&world, &[(secret.clone(), size)])?;
        let joints = visible(model, &with, &unhidden, is_change(secret.effect))?;
        let most = joints.into_iter().fold(0.0, f64::max);
        // A contact is looked for where it is, not over the whole motion.
        let [from, to] = secret.window;
        let lasts = nominal.first().and_then(|m| Some(m.time.last()? - m.time.first()?)).unwrap_or(0.0);
        Ok(if secret.effect == EffectKind::Contact { most * (lasts / (to - from)).sqrt() } else { most })
    };
    let hiding = of(secret.effect).ok_or("it is not in the table")?;
    let (start, most) = (hiding.start, hiding.most);
    let far = |found: f64| (found.max(0.01) / wanted).ln().abs();
    let mut best = (start, seen(start)?);
    let mut last = best;
    // About proportional: a few corrections come close enough.
    for _ in 0..4 {
        let next = (last.0 * (wanted / last.1.max(0.02)).min(10.0)).min(most);
        if far(best.1) < 0.2 || next == last.0 {
            break;
        }
        last = (next, seen(next)?);
        if far(last.1) < far(best.1) {
            best = last;
        }
    }
    Ok(best)
}
