//! What a curve of a law over any variables is over: a variable, or two positions together, and the interval of its values.

use super::spline::{FINE_SPLINES, SPLINES, steps};
use super::together::Together;
use super::variable::{STANDSTILL, Variable};

/// A variable and the interval of its values that a curve is over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Which.
    pub variable: Variable,
    /// Middle of the interval.
    pub centre: f64,
    /// Half of its length.
    pub half: f64,
}

/// The value of a variable at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seen {
    /// In its unit.
    pub value: f64,
    /// Its direction, -1 to 1, where it has one.
    pub direction: f64,
}

impl Axis {
    /// Its position in the interval, -1 to 1 within it, in proportion to its value.
    pub(super) fn along(&self, value: f64) -> f64 {
        (value - self.centre) / self.half.max(f64::MIN_POSITIVE)
    }

    /// The same as curves see it: where what depends on the variable fades, by the root of the part of the interval before it,
    /// so that the first of four intervals is a sixteenth of it.
    pub(super) fn place(&self, value: f64) -> f64 {
        let along = self.along(value);
        if !self.variable.fades() {
            return along;
        }
        2.0 * (0.5 * (along + 1.0)).max(0.0).sqrt() - 1.0
    }

    /// A value with its direction; that of the joint that the torque acts on is `own`, and certain.
    pub fn seen(&self, value: f64, own: Option<f64>) -> Seen {
        let smooth =
            || (value / (STANDSTILL * (self.half + self.centre.abs())).max(f64::MIN_POSITIVE)).tanh();
        Seen { value, direction: own.unwrap_or_else(smooth) }
    }

    /// A recorded value with its direction, for a torque on `joint`: at standstill its own speed counts as backward.
    pub fn seen_on(&self, joint: usize, value: f64) -> Seen {
        let own = self.variable == Variable::Speed(joint);
        self.seen(value, own.then_some(if value > 0.0 { 1.0 } else { -1.0 }))
    }

    /// Number of functions of a curve over it.
    pub(super) fn curve(&self, together: Together) -> usize {
        let functions = match together {
            Together::Fine => FINE_SPLINES,
            Together::Lines => 1,
            _ => SPLINES,
        };
        functions + usize::from(self.variable.has_direction())
    }

    pub(super) fn fill(&self, together: Together, at: Seen, out: &mut Vec<f64>) {
        let place = self.place(at.value);
        match together {
            Together::Fine => out.extend(steps::<FINE_SPLINES>(place)),
            Together::Lines => out.push(self.along(at.value).clamp(-1.0, 1.0)),
            _ => out.extend(steps::<SPLINES>(place)),
        }
        if self.variable.has_direction() {
            out.push(at.direction);
        }
    }
}

/// The sum of two positions, or the first less the second: what a cable that runs over both joints is bent by, or the direction
/// in space of a link behind parallel axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sum {
    /// Of the second one: 1 or -1.
    pub sign: f64,
    /// Middle of the interval of its values.
    pub centre: f64,
    /// Half of its length.
    pub half: f64,
}

impl Sum {
    /// Its value where the two have these.
    pub fn of(&self, first: f64, second: f64) -> f64 {
        first + self.sign * second
    }

    /// Its position in the interval where the two have these values, -1 to 1 within it.
    pub(super) fn place(&self, first: f64, second: f64) -> f64 {
        (self.of(first, second) - self.centre) / self.half.max(f64::MIN_POSITIVE)
    }
}
