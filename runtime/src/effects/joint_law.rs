//! Laws of a single joint: what they are evaluated at, and the trait that they share.

use super::quantity::Parameter;
use super::shape::Step;
use crate::model::JointKind;

/// The scales of a joint in a recording: shapes are searched relative to them, so that no number of a law depends
/// on a robot's size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Speed that 98 % of the samples do not pass, rad/s or m/s.
    pub speed: f64,
    /// Travel between the lowest and the highest position, rad or m.
    pub range: f64,
    /// Middle between them, rad or m.
    pub centre: f64,
    /// Largest torque of the standard model, N.m or N.
    pub torque: f64,
    /// Earliest time in any motion, s.
    pub start: f64,
    /// From there to the latest time in any motion, s.
    pub duration: f64,
    /// Motor turns per joint turn, or rad of the motor per metre.
    pub gear: f64,
    /// What the recorded torque varies by faster than the signals that laws are evaluated on: its standard deviation,
    /// N.m or N. Zero where it is not known.
    pub fast: f64,
    /// Least inertia that the joint moves, kg.m2 or kg, where that of its rotor is a part of it and no parameter of its own;
    /// zero where it is one.
    pub inertia: f64,
    /// Whether the joint turns or slides.
    pub kind: JointKind,
}

impl Scale {
    /// A revolute joint with speed, travel, torque, time and gear of one: shapes are numbers in SI as they stand.
    pub const UNIT: Self = Self {
        speed: 1.0,
        range: 1.0,
        centre: 0.0,
        torque: 1.0,
        start: 0.0,
        duration: 1.0,
        gear: 1.0,
        fast: 0.0,
        inertia: 0.0,
        kind: JointKind::Revolute,
    };

    /// Time since the motions began, s, at a time; none before, where a law of time is what it was at their beginning.
    pub fn age(&self, time: f64) -> f64 {
        (time - self.start).max(0.0)
    }
}

/// One joint at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct At {
    /// Time in the motion, s.
    pub time: f64,
    /// Position, rad or m.
    pub q: f64,
    /// Velocity.
    pub dq: f64,
    /// Acceleration.
    pub ddq: f64,
    /// Direction of motion: -1 or 1; at rest the direction that is asked about.
    pub sign: f64,
    /// Torque of inertia and gravity, that of the joint's own rotor included, no friction.
    pub load: f64,
    /// The same without the rotor, where its inertia is a parameter of its own: what passes through the gear.
    pub link: f64,
    /// What of it gravity asks for: the load of a motion that is infinitely slow.
    pub gravity: f64,
    /// Torque of the joint's drive: that of the standard model, and of the laws beside it that do not look at it.
    pub torque: f64,
    /// Viscous and Coulomb friction of the standard model.
    pub friction: f64,
}

/// What a joint has moved by from one instant to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moved {
    /// rad or m, with its direction.
    pub travel: f64,
    /// s.
    pub step: f64,
}

/// How a law acts where its joint is at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AtRest {
    /// As at any speed: it passes through zero speed without a jump, or does not depend on it.
    Smooth,
    /// It has the sign of the velocity, and holds the joint like dry friction.
    Dry,
    /// Its memory acts like a spring, and takes the place of a part of the joint's dry friction: what has the sign of
    /// the velocity in it holds the joint less.
    BuildsUp,
}

/// A torque law of one joint, linear in its amplitudes for a given shape.
pub trait JointLaw: Sync {
    /// Amplitudes, that is columns.
    fn amplitudes(&self, shape: &[f64]) -> usize;

    /// Shapes to try, coarse: the search refines them. One empty shape where the law has none.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>>;

    /// Shapes to try besides where the residual of the joint has waves of these orders.
    fn shapes_of_orders(&self, orders: &[f64]) -> Vec<Vec<f64>> {
        let _ = orders;
        Vec::new()
    }

    /// Whether a shape may have any number of numbers, each as those of [`Self::shapes`]: several waves are one law.
    fn repeats_its_shape(&self) -> bool {
        false
    }

    /// The waves of a law of these numbers, each with its order and its size: half of the swing.
    fn waves(&self, shape: &[f64], amplitude: &[f64]) -> Vec<(f64, f64)> {
        let _ = (shape, amplitude);
        Vec::new()
    }

    /// Whether all joints may have it together with the same numbers: what it is about is the robot's, as the temperature
    /// of its drives.
    fn may_be_common(&self) -> bool {
        false
    }

    /// Whether a law of this shape looks at [`At::gravity`], which a simulation works out only where it is needed.
    fn needs_gravity(&self, _shape: &[f64]) -> bool {
        false
    }

    /// Whether it looks at [`At::torque`], and so follows what the other laws of the joint are.
    fn looks_at_torque(&self) -> bool {
        false
    }

    /// How each number of the shape is varied between the values of the grid; empty where it is not.
    fn steps(&self, scale: &Scale) -> Vec<Step>;

    /// The shape of the same law with the viscous friction whose place it takes as an amplitude of its own, the last one; `None`
    /// where it takes the place of none, or has it.
    fn in_place_of_viscous(&self, _shape: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// One shape of every kind that a model may have, and all of those that are tried.
    fn all_shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let mut shapes = self.shapes(scale);
        let with_viscous: Vec<Vec<f64>> = shapes.iter().filter_map(|s| self.in_place_of_viscous(s)).collect();
        shapes.extend(with_viscous);
        shapes
    }

    /// Whether only a positive amplitude is this effect: a negative one is something else.
    fn only_positive(&self) -> bool;

    /// Whether with this shape it is one of many forms, which says more than that the torque follows a curve.
    fn is_form_of_many(&self, _shape: &[f64]) -> bool {
        false
    }

    /// Whether it is a curve that says nothing of positions that no motion has passed; its shape is the middle of those that one
    /// has, and half of their range.
    fn holds_only_where_seen(&self) -> bool {
        false
    }

    /// Values of the columns at an instant.
    fn law(&self, scale: &Scale, shape: &[f64], at: &At, memory: f64, out: &mut [f64]);

    /// Whether these amplitudes are mostly those of the effect's special case; `None` where amplitudes do not tell.
    fn is_mostly_special(&self, _amplitude: &[f64]) -> Option<bool> {
        None
    }

    /// The law with these numbers as a formula in the language of a user's law, over the variables of the joint with
    /// number `j`; `None` where it is none of position, speed, acceleration and load.
    fn closed_form(&self, _scale: &Scale, _shape: &[f64], _amplitude: &[f64], _j: usize) -> Option<String> {
        None
    }

    /// Inner state where a motion begins at a speed: what it most likely is, since what happened before is not recorded.
    fn memory_at_start(&self, _scale: &Scale, _dq: f64) -> f64 {
        0.0
    }

    /// New inner state after a step of the motion; laws without memory keep 0.
    fn advance(&self, _scale: &Scale, _shape: &[f64], memory: f64, _moved: Moved) -> f64 {
        memory
    }

    /// Whether it has an inner state that [`Self::advance`] changes.
    fn has_memory(&self) -> bool {
        false
    }

    /// How it acts in a simulated robot whose joint comes to rest.
    fn at_rest(&self, shape: &[f64], amplitude: &[f64]) -> AtRest;

    /// Amplitudes and shape as the quantities a person knows: value, standard deviation (0 where unknown), unit.
    fn parameters(&self, scale: &Scale, shape: &[f64], amplitude: &[f64], sigma: &[f64]) -> Vec<Parameter>;
}

/// The quantity that says which joint another one feels, by its number.
pub const HEARD_JOINT: &str = "heard_joint";

/// `count` values from `low` to `high`, each a constant factor from the next.
pub(in crate::effects) fn geometric(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = (high / low).ln() / (count.max(2) - 1) as f64;
    (0..count).map(|k| low * (step * k as f64).exp()).collect()
}
