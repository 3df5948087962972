//! The motions of a case, and how they are recorded.

use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::excitation::{
    ExcitationSettings, ExcitingMotion, MotionKind, Profile, excite,
};
use dynid_runtime::simulation::{LoopSettings, World, simulate};

use crate::failure::Failure;
use crate::hiding::of;
use crate::random::Random;
use crate::secret::Secret;
use dynid_runtime::effects::EffectKind;

/// Share of the limits that the motions use.
pub const SHARE: f64 = 0.8;
/// Control rate, Hz.
pub const RATE: f64 = 2000.0;
/// Control samples for each recorded row.
pub const RECORD_EVERY: usize = 4;

/// Random motions within the robot's limits, about `length` seconds each: Fourier series of 4 to 12 harmonics, or
/// points that are joined by one of two profiles.
pub fn planned(
    model: &dyn Model,
    count: usize,
    length: f64,
    random: &mut Random,
) -> Result<Vec<ExcitingMotion>, Failure> {
    let robot = model.robot();
    let chi = robot.nominal.as_ref().map(|nominal| robot.base_from_standard(&nominal.standard));
    let mut motions = Vec::new();
    for _ in 0..count {
        let kind = match random.below(4) {
            0 | 1 => MotionKind::Fourier { harmonics: 4 + random.below(9), period: length, periods: 1 },
            draw => MotionKind::PointToPoint {
                points: (length * (0.8 + 0.6 * random.share())) as usize,
                profile: if draw == 2 { Profile::Quintic } else { Profile::TrapezoidalAcceleration },
                pause: 0.05,
            },
        };
        let settings =
            ExcitationSettings { kind, share: SHARE, seed: random.bits(), ..ExcitationSettings::default() };
        motions.extend(excite(model, chi.as_deref(), &settings, &|_| {})?.motions);
    }
    Ok(motions)
}

/// What the k-th motion of a recording is called.
pub fn name(k: usize) -> String {
    format!("motion {}", k + 1)
}

/// What the sensors add. The same seed gives the same noise.
#[derive(Clone, Copy)]
pub enum Noise {
    /// The robot's nominal noise.
    Nominal(u64),
    /// Of torques alone.
    OfTorques(u64),
    /// Nothing.
    None,
}

/// Records a world on planned motions.
pub fn recorded(
    world: &World<'_>,
    motions: &[ExcitingMotion],
    secrets: &[(Secret, f64)],
    noise: Noise,
) -> Result<Vec<Trajectory>, Failure> {
    let late = secrets.iter().any(|(s, _)| s.effect == EffectKind::TimeDelay);
    let mut all = Vec::new();
    for (k, motion) in motions.iter().enumerate() {
        let seed = match noise {
            Noise::Nominal(seed) | Noise::OfTorques(seed) => seed.wrapping_add(k as u64),
            Noise::None => 0,
        };
        let mut settings = LoopSettings::nominal(world.model(), &world.chi(), motion, RATE, seed);
        if !matches!(noise, Noise::Nominal(_)) {
            settings.sensors.position_noise.clear();
        }
        if matches!(noise, Noise::None) {
            settings.sensors.torque_noise.clear();
        }
        settings.record_every = if late { 1 } else { RECORD_EVERY };
        settings.name = name(k);
        let mut trajectory = simulate(&mut world.plant(&name(k))?, motion, &settings, &mut |_| {})?.recorded;
        for (secret, magnitude) in secrets {
            if let Some(hiding) = of(secret.effect) {
                (hiding.distort)(&mut trajectory, secret, *magnitude);
            }
        }
        all.push(trajectory);
    }
    Ok(all)
}
