//! How large a hidden effect is: by what is seen of it, within what a robot may have.

use dynid_runtime::effects::EffectKind;

/// Sizes: barely visible, clear, obvious.
pub const SIZES: [&str; 3] = ["small", "medium", "large"];

/// What each size aims at: torque of the effect that the standard parameters cannot take over, relative to the noise.
pub const VISIBLE: [f64; 3] = [1.0, 2.5, 6.0];

/// What a magnitude counts, where a search for the right one begins, and the most that a robot may have of it. The
/// torque is about proportional to it.
pub fn magnitude(effect: EffectKind) -> (&'static str, f64, f64) {
    use EffectKind as E;
    match effect {
        E::Stribeck => ("extra level at rest, of the dry friction", 0.3, 2.0),
        E::NonlinearViscous => ("torque at top speed, of the dry friction", 0.5, 4.0),
        E::LoadDependentFriction => ("mu", 0.05, 0.3),
        E::PositionDependentFriction => ("amplitude, of the dry friction", 0.2, 0.9),
        E::AsymmetricFriction => ("half difference at top speed, of the dry friction", 0.3, 2.0),
        E::PreslidingHysteresis => ("part of the dry friction that builds up late", 0.5, 1.0),
        E::FrictionDrift => ("fading Coulomb level, of the dry friction", 0.3, 2.0),
        E::FrictionLevelChange => ("change of viscous and Coulomb friction", 0.1, 1.0),
        E::TorqueRipple => ("amplitude, of the dry friction", 0.1, 1.0),
        E::Spring => ("torque at half of the travel, of the dry friction", 0.4, 5.0),
        E::Payload => ("mass, of the robot's moving mass", 0.01, 0.3),
        E::AddedMass => ("mass, of the robot's moving mass", 0.02, 0.3),
        E::BaseTilt => ("tilt, rad", 0.02, 0.2),
        E::CoupledTransmission => ("Coulomb and viscous level, of the joint's", 0.2, 1.5),
        E::TorqueConstantError => ("error of the torque constant", 0.04, 0.4),
        E::TorqueSaturation => ("droop at the largest torque", 0.06, 0.4),
        E::JointElasticity => ("compliance, in units of a link at 10 Hz", 1.0, 11.0),
        E::Backlash => ("play, rad", 0.001, 0.02),
        E::TimeDelay => ("delay of the torque, s", 0.004, 0.03),
        E::WrongSampleRate => ("error of the declared period", 0.02, 0.2),
        E::PositionOffset => ("offset, rad", 0.03, 0.3),
        E::GeometryError => ("error of the length, of the length", 0.05, 0.4),
        E::Contact => ("joint torque by the force at 0.3 m, of the dry friction; 0.5 s", 1.0, 8.0),
    }
}
