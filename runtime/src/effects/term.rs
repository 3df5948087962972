//! An accepted effect as part of a model: what it is, where, and its numbers.

use super::axis::Axis;
use super::catalogue::EffectKind;
use super::compliance::Transmission;
use super::contact::ContactForce;
use super::form::Form;
use super::free_law::FreeLaw;
use super::joint_law::Scale;
use super::place::Place;
use super::sensitivity::{Corrected, Distortion, corrected_at};
use super::variable::Variable;
use crate::model::{JointKind, Robot};
use serde::{Deserialize, Serialize};

/// An effect that has become part of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectTerm {
    /// Which.
    pub effect: EffectKind,
    /// Where.
    pub place: Place,
    /// Numbers j of the joints it is named on.
    pub joints: Vec<usize>,
    /// Shape of the law, as the effect defines it.
    pub shape: Vec<f64>,
    /// Amplitude of each column.
    pub amplitude: Vec<f64>,
    /// Standard deviation of each amplitude.
    pub sigma: Vec<f64>,
    /// Scales the law was made with, where it is a law of a joint.
    pub scale: Option<TermScale>,
    /// Forces, where it is a contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wrenches: Vec<ContactForce>,
}

/// What an effect with a shape is called at a place: a curve over nothing but the position of its joint by the effect that says
/// so, every other by itself.
pub(crate) fn named(effect: EffectKind, place: Place, shape: &[f64]) -> EffectKind {
    match (effect.form(), place.joint()) {
        (Form::Free, Some(j)) if FreeLaw::is_over_position_of(shape, j) => {
            EffectKind::PositionDependentTorque
        }
        _ => effect,
    }
}

impl EffectTerm {
    /// The variables of a curve, with the intervals of values that were fitted: of others it says nothing. None for every
    /// other law. `joints`: how many the robot has.
    pub fn intervals(&self, joints: usize) -> Vec<Axis> {
        match (self.effect.form(), self.place.joint(), self.shape.as_slice()) {
            (Form::Free, ..) => {
                FreeLaw::from_shape(&self.shape, joints).map_or_else(Vec::new, |law| law.axes)
            }
            (Form::Joint(law), Some(joint), &[centre, half]) if law.holds_only_where_seen() => {
                vec![Axis { variable: Variable::Position(joint), centre, half }]
            }
            _ => Vec::new(),
        }
    }

    /// Linear forms of dq, besides its own speed, with whose sign its torque on a joint changes, in a robot of so many joints: the
    /// speed of another one, or of a rotor that two of them drive. Where these turn round it is as uncertain as their friction.
    pub fn turns_with(&self, joint: usize, joints: usize) -> Vec<Vec<f64>> {
        let form = |of: &[(usize, f64)]| {
            let mut form = vec![0.0; joints];
            of.iter().filter(|(j, _)| *j < joints).for_each(|&(j, factor)| form[j] = factor);
            form
        };
        if let Some([own, heard]) = self.place.hears() {
            return if own == joint { vec![form(&[(heard, 1.0)])] } else { Vec::new() };
        }
        if let (Form::Coupled, Some(pair @ [a, b]), Some(&ratio)) =
            (self.effect.form(), self.place.pair(), self.shape.first())
        {
            return if pair.contains(&joint) { vec![form(&[(a, ratio), (b, 1.0)])] } else { Vec::new() };
        }
        let is_own = matches!(self.effect.form(), Form::Free) && self.place.joint() == Some(joint);
        let axes = if is_own { self.intervals(joints) } else { Vec::new() };
        let turns = |variable: Variable| variable.has_direction() || matches!(variable, Variable::Torque(_));
        let variables = axes.into_iter().map(|axis| axis.variable).filter(|variable| turns(*variable));
        let others = variables.filter_map(Variable::joint).filter(|other| *other != joint);
        others.map(|other| form(&[(other, 1.0)])).collect()
    }

    /// Its name in the JSON: that of the effect, or of the user's law. A curve over nothing but the position of its joint has
    /// the name of the effect that says so.
    pub fn id(&self) -> &'static str {
        named(self.effect, self.place, &self.shape).id_at(self.place)
    }

    /// Whether it looks at the torque of a drive; `joints`: how many the robot has.
    pub fn looks_at_torque(&self, joints: usize) -> bool {
        self.effect.form().looks_at_torque(&self.shape, joints)
    }

    /// What is wrong with a recording, where the term is that and nothing of the robot.
    pub fn distortion(&self) -> Option<Distortion> {
        self.effect.form().sensitivity()?.in_recording(&self.amplitude)
    }

    /// The robot with the errors of the term in it, where it is one of the robot's own numbers.
    pub fn corrected(&self, robot: &Robot) -> Option<Corrected> {
        corrected_at(robot, self.effect.form().sensitivity()?, self.place.variant()?, &self.amplitude)
    }

    /// The joint and the transmission of a compliant joint; `None` for every other effect.
    pub fn transmission(&self) -> Option<(usize, Transmission)> {
        match self.effect.form() {
            Form::Compliance(_) => {
                let kind = self.scale.map_or(JointKind::Revolute, TermScale::kind);
                let frequency = self.shape.first().copied()?;
                let known = Transmission::from_amplitude(&self.amplitude, frequency, kind)?;
                Some((self.place.joint()?, known))
            }
            Form::Joint(_)
            | Form::Heard(_)
            | Form::Sensitivity(_)
            | Form::Body(_)
            | Form::Coupled
            | Form::Window
            | Form::Free
            | Form::User => None,
        }
    }
}

/// The variables of the curves on each of so many joints, as [`EffectTerm::intervals`] has them.
pub fn intervals_by_joint(effects: &[EffectTerm], joints: usize) -> Vec<Vec<Axis>> {
    let on = |joint: usize| effects.iter().filter(move |term| term.place.joint() == Some(joint));
    (0..joints).map(|joint| on(joint).flat_map(|term| term.intervals(joints)).collect()).collect()
}

/// How many times faster a robot with these effects moved than the times of its recording say.
pub fn times_faster(effects: &[EffectTerm]) -> f64 {
    let factor = |distortion| match distortion {
        Distortion::Skew => 1.0,
        Distortion::Faster(factor) => factor,
    };
    effects.iter().filter_map(EffectTerm::distortion).map(factor).product()
}

/// [`Scale`], saved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct TermScale {
    pub speed: f64,
    pub range: f64,
    #[serde(default)]
    pub centre: f64,
    pub torque: f64,
    #[serde(default)]
    pub start: f64,
    pub duration: f64,
    pub gear: f64,
    #[serde(default)]
    pub fast: f64,
    pub prismatic: bool,
}

impl TermScale {
    /// A revolute joint with speed, travel, torque, time and gear of one: shapes are numbers in SI as they stand.
    pub const UNIT: Self = Self::of(Scale::UNIT);

    const fn of(s: Scale) -> Self {
        Self {
            speed: s.speed,
            range: s.range,
            centre: s.centre,
            torque: s.torque,
            start: s.start,
            duration: s.duration,
            gear: s.gear,
            fast: s.fast,
            prismatic: matches!(s.kind, JointKind::Prismatic),
        }
    }

    /// Whether the joint turns or slides.
    pub fn kind(self) -> JointKind {
        if self.prismatic { JointKind::Prismatic } else { JointKind::Revolute }
    }
}

impl From<Scale> for TermScale {
    fn from(s: Scale) -> Self {
        Self::of(s)
    }
}

impl From<TermScale> for Scale {
    fn from(s: TermScale) -> Self {
        Self {
            speed: s.speed,
            range: s.range,
            centre: s.centre,
            torque: s.torque,
            start: s.start,
            duration: s.duration,
            gear: s.gear,
            fast: s.fast,
            // Shapes are found with it, and need it no more.
            inertia: 0.0,
            kind: s.kind(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Together;

    fn term(effect: EffectKind, place: Place, shape: Vec<f64>) -> EffectTerm {
        let (joints, wrenches) = (Vec::new(), Vec::new());
        EffectTerm { effect, place, joints, shape, amplitude: vec![], sigma: vec![], scale: None, wrenches }
    }

    #[test]
    fn what_hears_a_joint_or_depends_on_its_direction_turns_with_it() {
        let crosstalk = term(EffectKind::TorqueCrosstalk, Place::Hears(1, 2), vec![]);
        assert_eq!(crosstalk.turns_with(1, 3), [[0.0, 0.0, 1.0]]);
        assert!(crosstalk.turns_with(2, 3).is_empty());
        let axis = |variable| Axis { variable, centre: 0.0, half: 1.0 };
        let over = |axes: [Variable; 2]| FreeLaw::two(Together::Lines, axes.map(axis)).shape();
        let free = |axes| term(EffectKind::FreeForm, Place::Joint(0), over(axes));
        let speeds = free([Variable::Speed(0), Variable::Speed(2)]);
        assert_eq!(speeds.turns_with(0, 3), [[0.0, 0.0, 1.0]]);
        assert!(speeds.turns_with(1, 3).is_empty());
        assert!(free([Variable::Position(1), Variable::Load(0)]).turns_with(0, 3).is_empty());
        assert!(term(EffectKind::Spring, Place::Joint(0), vec![]).turns_with(0, 3).is_empty());
    }

    #[test]
    fn a_rotor_that_two_joints_drive_turns_round_where_their_speeds_cancel() {
        let rotor = term(EffectKind::CoupledTransmission, Place::Pair(0, 2), vec![-0.5]);
        assert_eq!(rotor.turns_with(0, 3), [[-0.5, 0.0, 1.0]]);
        assert_eq!(rotor.turns_with(2, 3), rotor.turns_with(0, 3));
        assert!(rotor.turns_with(1, 3).is_empty());
    }
}
