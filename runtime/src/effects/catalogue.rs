//! The list of the effects. Each is one line here and one file in `catalogue/`.

use super::effect::{Effect, Properties, Sought, Words};
use super::form::Form;
use super::place::Place;
use serde::{Deserialize, Serialize};

/// From lines `module: Type`, declares the modules and everything that is known by the name of an effect. The type is
/// a unit struct of the module that implements [`Effect`]; the module is named by the effect's id in the JSON. After a
/// bar what only a user has, which belongs to no list of effects.
macro_rules! catalogue {
    ($($module:ident: $effect:ident,)* | $($own:ident: $of_user:ident,)*) => {
        $(mod $module;)*
        $(mod $own;)*

        /// An effect of the catalogue.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum EffectKind {
            $(
                #[doc = concat!("`", stringify!($module), "`")]
                $effect,
            )*
            $(
                #[doc = concat!("`", stringify!($own), "`: no effect of the catalogue")]
                $of_user,
            )*
        }

        impl EffectKind {
            /// Every effect, in the order of the catalogue.
            pub const ALL: [Self; [$(stringify!($module)),*].len()] = [$(Self::$effect),*];

            /// Everything that is known of it.
            pub fn effect(self) -> &'static dyn Effect {
                match self {
                    $(Self::$effect => &$module::$effect,)*
                    $(Self::$of_user => &$own::$of_user,)*
                }
            }
        }
    };
}

catalogue! {
    stribeck: Stribeck,
    nonlinear_viscous: NonlinearViscous,
    load_dependent_friction: LoadDependentFriction,
    position_dependent_friction: PositionDependentFriction,
    asymmetric_friction: AsymmetricFriction,
    presliding_hysteresis: PreslidingHysteresis,
    friction_drift: FrictionDrift,
    friction_level_change: FrictionLevelChange,
    torque_ripple: TorqueRipple,
    spring: Spring,
    position_dependent_torque: PositionDependentTorque,
    payload: Payload,
    added_mass: AddedMass,
    base_tilt: BaseTilt,
    coupled_transmission: CoupledTransmission,
    drive_efficiency: DriveEfficiency,
    torque_constant_error: TorqueConstantError,
    torque_constant_drift: TorqueConstantDrift,
    torque_crosstalk: TorqueCrosstalk,
    torque_saturation: TorqueSaturation,
    joint_elasticity: JointElasticity,
    backlash: Backlash,
    time_delay: TimeDelay,
    wrong_sample_rate: WrongSampleRate,
    position_offset: PositionOffset,
    geometry_error: GeometryError,
    contact: Contact,
    free_form: FreeForm,
    |
    user_law: UserLaw,
}

impl EffectKind {
    /// The effect with a name of the JSON.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.id() == id)
    }

    /// What the effect with this id is called within a sentence; the id of one that is not in the catalogue.
    pub fn name_of(id: &str) -> &str {
        Self::from_id(id).map_or(id, |kind| kind.words().name)
    }

    /// The same as a title, with a capital letter first; an id stays what it is.
    pub fn title_of(id: &str) -> String {
        Self::from_id(id).map_or_else(|| id.to_owned(), |kind| kind.words().title())
    }

    /// Its name in the JSON.
    pub fn id(self) -> &'static str {
        self.words().id
    }

    /// The same at a place: that of a law of the user is the user's.
    pub fn id_at(self, place: Place) -> &'static str {
        match (self.form(), place) {
            (Form::User, Place::Law(law)) => law.id(),
            _ => self.id(),
        }
    }

    /// Its words.
    pub fn words(self) -> &'static Words {
        self.effect().words()
    }

    /// Its properties.
    pub fn properties(self) -> &'static Properties {
        self.effect().properties()
    }

    /// How its torque is made.
    pub fn form(self) -> Form {
        self.effect().form()
    }

    /// Whether it can only be told against an earlier recording or a reference model.
    pub fn needs_baseline(self) -> bool {
        self.properties().sought == Sought::OnlyAgainstBaseline
    }

    /// Laws that imitate it: the simpler ones that it must be told from, those that must be told from it, and those that
    /// the same variable reveals.
    pub fn imitators(self) -> Vec<Self> {
        let of_robot = |kind: &Self| !matches!(kind.form(), Form::Window | Form::Free);
        let near = |other: &Self| {
            let same = other.words().revealed_by == self.words().revealed_by
                && other.properties().abscissa == self.properties().abscissa;
            same && of_robot(other) && of_robot(&self)
                || self.special_cases().any(|k| k == *other)
                || other.special_cases().any(|k| k == self)
        };
        Self::ALL.into_iter().filter(|other| *other != self && near(other)).collect()
    }

    /// The simpler laws that it must be told from (backlash with zero gap is elasticity).
    pub fn special_cases(self) -> impl Iterator<Item = Self> {
        let effects = self.properties().special_case.map_or(&[][..], |case| case.effects);
        effects.iter().filter_map(|effect| Self::from_id(effect.words().id))
    }
}
