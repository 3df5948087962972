//! The names of the effects, what kind of thing each is, and its words.

use super::*;
use serde::{Deserialize, Serialize};

/// An effect of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum EffectKind {
    Stribeck,
    NonlinearViscous,
    LoadDependentFriction,
    PositionDependentFriction,
    AsymmetricFriction,
    PreslidingHysteresis,
    FrictionDrift,
    FrictionLevelChange,
    TorqueRipple,
    Spring,
    Payload,
    AddedMass,
    BaseTilt,
    CoupledTransmission,
    TorqueConstantError,
    TorqueSaturation,
    JointElasticity,
    Backlash,
    TimeDelay,
    WrongSampleRate,
    PositionOffset,
    GeometryError,
    Contact,
}

/// What a person is told about an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Words {
    /// Name of the effect in the JSON.
    pub id: &'static str,
    /// A short title.
    pub title: &'static str,
    /// What it is, in one sentence.
    pub what: &'static str,
    /// Where it shows in the residual.
    pub looks_like: &'static str,
    /// The variable that reveals it, with its unit.
    pub revealed_by: &'static str,
    /// The motion that tells it from its imitators.
    pub experiment: &'static str,
    /// Literature.
    pub source: &'static str,
}

/// How an effect's torque is made.
#[derive(Clone, Copy)]
pub enum Form {
    /// A law of one joint.
    Joint(&'static dyn JointLaw),
    /// A derivative of the model with respect to one of its own numbers.
    Sensitivity(&'static dyn Sensitivity),
    /// A compliant or loose transmission.
    Compliance(&'static dyn Compliance),
    /// A rigid body added to a link.
    Body(&'static dyn BodyOnLink),
    /// A motor driven by two joints.
    Coupled,
    /// An outside force in time windows.
    Window,
}

impl EffectKind {
    /// Every effect, in the order of the catalogue.
    pub const ALL: [Self; 23] = [
        Self::Stribeck,
        Self::NonlinearViscous,
        Self::LoadDependentFriction,
        Self::PositionDependentFriction,
        Self::AsymmetricFriction,
        Self::PreslidingHysteresis,
        Self::FrictionDrift,
        Self::FrictionLevelChange,
        Self::TorqueRipple,
        Self::Spring,
        Self::Payload,
        Self::AddedMass,
        Self::BaseTilt,
        Self::CoupledTransmission,
        Self::TorqueConstantError,
        Self::TorqueSaturation,
        Self::JointElasticity,
        Self::Backlash,
        Self::TimeDelay,
        Self::WrongSampleRate,
        Self::PositionOffset,
        Self::GeometryError,
        Self::Contact,
    ];

    /// The effect with a name of the JSON.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.id() == id)
    }

    /// Its name in the JSON.
    pub fn id(self) -> &'static str {
        self.words().id
    }

    /// Its words.
    pub fn words(self) -> &'static Words {
        match self {
            Self::Stribeck => &stribeck::WORDS,
            Self::NonlinearViscous => &nonlinear_viscous::WORDS,
            Self::LoadDependentFriction => &load_dependent_friction::WORDS,
            Self::PositionDependentFriction => &position_dependent_friction::WORDS,
            Self::AsymmetricFriction => &asymmetric_friction::WORDS,
            Self::PreslidingHysteresis => &presliding_hysteresis::WORDS,
            Self::FrictionDrift => &friction_drift::WORDS,
            Self::FrictionLevelChange => &friction_level_change::WORDS,
            Self::TorqueRipple => &torque_ripple::WORDS,
            Self::Spring => &spring::WORDS,
            Self::Payload => &payload::WORDS,
            Self::AddedMass => &added_mass::WORDS,
            Self::BaseTilt => &base_tilt::WORDS,
            Self::CoupledTransmission => &coupled_transmission::WORDS,
            Self::TorqueConstantError => &torque_constant_error::WORDS,
            Self::TorqueSaturation => &torque_saturation::WORDS,
            Self::JointElasticity => &joint_elasticity::WORDS,
            Self::Backlash => &backlash::WORDS,
            Self::TimeDelay => &time_delay::WORDS,
            Self::WrongSampleRate => &wrong_sample_rate::WORDS,
            Self::PositionOffset => &position_offset::WORDS,
            Self::GeometryError => &geometry_error::WORDS,
            Self::Contact => &contact::WORDS,
        }
    }

    /// How its torque is made.
    pub fn form(self) -> Form {
        match self {
            Self::Stribeck => Form::Joint(&stribeck::Stribeck),
            Self::NonlinearViscous => Form::Joint(&nonlinear_viscous::NonlinearViscous),
            Self::LoadDependentFriction => Form::Joint(&load_dependent_friction::LoadDependentFriction),
            Self::PositionDependentFriction => {
                Form::Joint(&position_dependent_friction::PositionDependentFriction)
            }
            Self::AsymmetricFriction => Form::Joint(&asymmetric_friction::AsymmetricFriction),
            Self::PreslidingHysteresis => Form::Joint(&presliding_hysteresis::PreslidingHysteresis),
            Self::FrictionDrift => Form::Joint(&friction_drift::FrictionDrift),
            Self::FrictionLevelChange => Form::Joint(&friction_level_change::FrictionLevelChange),
            Self::TorqueRipple => Form::Joint(&torque_ripple::TorqueRipple),
            Self::Spring => Form::Joint(&spring::Spring),
            Self::TorqueConstantError => Form::Joint(&torque_constant_error::TorqueConstantError),
            Self::TorqueSaturation => Form::Joint(&torque_saturation::TorqueSaturation),
            Self::Payload => Form::Body(&payload::Payload),
            Self::AddedMass => Form::Body(&added_mass::AddedMass),
            Self::BaseTilt => Form::Sensitivity(&base_tilt::BaseTilt),
            Self::TimeDelay => Form::Sensitivity(&time_delay::TimeDelay),
            Self::WrongSampleRate => Form::Sensitivity(&wrong_sample_rate::WrongSampleRate),
            Self::PositionOffset => Form::Sensitivity(&position_offset::PositionOffset),
            Self::GeometryError => Form::Sensitivity(&geometry_error::GeometryError),
            Self::JointElasticity => Form::Compliance(&joint_elasticity::JointElasticity),
            Self::Backlash => Form::Compliance(&backlash::Backlash),
            Self::CoupledTransmission => Form::Coupled,
            Self::Contact => Form::Window,
        }
    }

    /// Whether it can only be told against an earlier recording or a reference model.
    pub fn needs_baseline(self) -> bool {
        matches!(self, Self::FrictionLevelChange | Self::Payload | Self::AddedMass)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_its_own_serde_name_and_finds_its_effect() {
        for kind in EffectKind::ALL {
            let json = serde_json::to_string(&kind).expect("an enum serialises");
            assert_eq!(json, format!("\"{}\"", kind.id()));
            assert_eq!(EffectKind::from_id(kind.id()), Some(kind));
        }
    }

    #[test]
    fn every_effect_has_all_of_its_words() {
        for kind in EffectKind::ALL {
            let w = kind.words();
            for text in [w.title, w.what, w.looks_like, w.revealed_by, w.experiment, w.source] {
                assert!(text.len() > 3, "{}", w.id);
            }
        }
    }
}
