//! Everything that is known of an effect, apart from how its torque is computed, which is its [`Form`].

use super::form::Form;
use super::quantity::Quantities;
use crate::model::JointKind;
use crate::report::capital;

/// An effect of the catalogue.
///
/// Nothing has a default: what holds for most effects is wrong for some, and the compiler names what a new one has
/// not answered.
pub trait Effect: Sync {
    /// What a person is told.
    fn words(&self) -> &'static Words;

    /// How it is looked for and drawn.
    fn properties(&self) -> &'static Properties;

    /// How its torque is made.
    fn form(&self) -> Form;

    /// What was found, as the middle of a sentence: `friction grows by 0.06 ± 0.004 of the load torque`.
    fn detail(&self, q: &Quantities) -> String;

    /// Its law with the numbers that were found; empty where no formula of one line says it.
    fn formula(&self, q: &Quantities) -> String;
}

/// What a person is told about an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Words {
    /// Name of the effect in the JSON.
    pub id: &'static str,
    /// What it is called within a sentence.
    pub name: &'static str,
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
    /// What the names of its quantities, and other symbols of its formula, mean; those of the motion (q, dq, ddq) mean
    /// the same in all formulas.
    pub symbols: &'static [(&'static str, &'static str)],
    /// How it is put into a simulated robot or a recording.
    pub put_in: &'static str,
}

impl Words {
    /// Its name with a capital letter first.
    pub fn title(&self) -> String {
        capital(self.name)
    }

    /// What a name of its quantities means; quantities that are counted (`amplitude_2`, `p3`) have the meaning of the
    /// first. Empty where there is none of this name.
    pub fn meaning(&self, name: &str) -> &'static str {
        let plain = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let same = |known: &str| {
            known == name || known.trim_end_matches('1') == plain || known == plain.trim_end_matches('_')
        };
        let exact = self.symbols.iter().find(|(known, _)| *known == name);
        exact
            .or_else(|| self.symbols.iter().find(|(known, _)| same(known)))
            .map_or("", |(_, meaning)| meaning)
    }
}

/// How an effect is looked for and drawn.
#[derive(Clone, Copy)]
pub struct Properties {
    /// The smoothing of the rows that shows it best.
    pub window: SmoothingWindow,
    /// In which recordings the search tries it.
    pub sought: Sought,
    /// Whether its columns are made from the standard parameters (load, model torque, friction of the model), so that
    /// they change when those are refitted.
    pub follows_parameters: bool,
    /// Whether it may be found more than once at the same place, with other shapes.
    pub repeats: bool,
    /// The simpler laws that it must be told from to be named: its nested special case, or what imitates it.
    pub special_case: Option<SpecialCase>,
    /// What it is drawn over.
    pub abscissa: Abscissa,
    /// Whether it is drawn along the motion, torque times the direction. Friction opposes the motion: over anything
    /// but the speed, both directions would hide each other.
    pub along_motion: bool,
    /// Whether any recording of a robot may have it, small as it may be: against a baseline it is then fitted to both,
    /// and only what differs is a change.
    pub may_stand: bool,
    /// Whether it is a factor on a recorded torque and nothing else. Whatever grows with the torque looks like one in a
    /// single motion; only a factor is the same in every other.
    pub is_factor: bool,
}

/// What an effect comes back to where its own number vanishes, or simpler laws that come close to it.
#[derive(Clone, Copy)]
pub struct SpecialCase {
    /// The simpler effects.
    pub effects: &'static [&'static dyn Effect],
    /// What it must do to be named instead of them.
    pub told_by: ToldBy,
}

/// How an effect is told from simpler ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ToldBy {
    /// Each of the simpler ones at its place makes less than this part of its gain.
    Gain(f64),
    /// What it has beyond each of the simpler ones, on all of its joints at once, is as certain as a law must be.
    Certainty,
}

/// How much rows are smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmoothingWindow {
    /// As slow as the motion.
    Slow,
    /// Faster than the motion.
    Fast,
}

/// In which recordings the search tries an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sought {
    /// With and without a baseline.
    Always,
    /// Only against a baseline: it cannot be told from the standard parameters in one recording.
    OnlyAgainstBaseline,
    /// Only without a baseline: it is the same in both recordings.
    NeverAgainstBaseline,
    /// It has a search of its own.
    Separately,
}

impl Sought {
    /// Whether the search tries it, where there is a baseline (`change`) and where there is none.
    pub fn with(self, change: bool) -> bool {
        match self {
            Self::Always => true,
            Self::OnlyAgainstBaseline => change,
            Self::NeverAgainstBaseline => !change,
            Self::Separately => false,
        }
    }
}

/// The variable that an effect is drawn over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Abscissa {
    /// Speed of the joint.
    Speed,
    /// Position of the joint.
    Position,
    /// Acceleration of the joint.
    Acceleration,
    /// Torque that the joint transmits to the links.
    Load,
    /// Torque of the standard model.
    ModelTorque,
    /// The same of the joint that it feels.
    HeardTorque,
    /// Time in the motion.
    Time,
    /// Distance since the joint last reversed.
    SinceReversal,
    /// Angle within one wave: order (the first number of the shape) times position.
    WaveAngle,
}

impl Abscissa {
    /// Its name with its unit on a joint of this kind.
    pub fn label(self, kind: JointKind) -> String {
        let torque = if kind == JointKind::Prismatic { "force" } else { "torque" };
        match self {
            Self::Speed => format!("joint speed, {}", kind.speed_unit()),
            Self::Position => format!("joint position, {}", kind.position_unit()),
            Self::Acceleration => format!("acceleration, {}", kind.acceleration_unit()),
            Self::Load => format!("load {torque}, {}", kind.torque_unit()),
            Self::ModelTorque => format!("model {torque}, {}", kind.torque_unit()),
            Self::HeardTorque => format!("model {torque} of the other joint, {}", kind.torque_unit()),
            Self::Time => "time, s".into(),
            Self::SinceReversal => format!("distance since reversal, {}", kind.position_unit()),
            Self::WaveAngle => "angle within one wave, rad".into(),
        }
    }
}
