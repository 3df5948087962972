//! A torque of a joint as smooth curves over one or two variables: a law that nobody wrote down.
//!
//! It is an additive model of cubic splines (Hastie and Tibshirani 1986; Eilers and Marx 1996), for two variables with
//! the products of a few bends of each. A speed comes with its direction, at whose change a torque may jump.

use super::spline::{BENDS, FINE_SPLINES, SPLINES, bends, steps};
use super::variable::Variable;

/// How the variables come together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Together {
    /// One variable alone.
    One,
    /// A curve over each, added.
    Added,
    /// Products only: what one does is scaled by the other.
    Multiplied,
    /// Both.
    Full,
    /// One variable alone, by a curve with narrow bends.
    Fine,
}

impl Together {
    const ALL: [Self; 5] = [Self::One, Self::Added, Self::Multiplied, Self::Full, Self::Fine];

    fn code(self) -> f64 {
        Self::ALL.iter().position(|t| *t == self).unwrap_or(0) as f64
    }

    /// Whether there is one variable, and no other that comes to it.
    fn is_alone(self) -> bool {
        matches!(self, Self::One | Self::Fine)
    }

    fn has_curves(self) -> bool {
        self != Self::Multiplied
    }

    fn has_products(self) -> bool {
        matches!(self, Self::Multiplied | Self::Full)
    }
}

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

/// Speeds below this part of the interval count as no direction of another joint: its sign is noise there.
const STANDSTILL: f64 = 0.02;

impl Axis {
    /// Its position in the interval, -1 to 1 within it.
    fn place(&self, value: f64) -> f64 {
        (value - self.centre) / self.half.max(f64::MIN_POSITIVE)
    }

    /// A value with its direction; that of the joint that the torque acts on is `own`, and certain.
    pub fn seen(&self, value: f64, own: Option<f64>) -> Seen {
        let smooth =
            || (value / (STANDSTILL * (self.half + self.centre.abs())).max(f64::MIN_POSITIVE)).tanh();
        Seen { value, direction: own.unwrap_or_else(smooth) }
    }

    /// Number of functions of a curve over it.
    fn curve(&self, together: Together) -> usize {
        let steps = if together == Together::Fine { FINE_SPLINES } else { SPLINES };
        steps + usize::from(self.variable.has_direction())
    }

    fn fill(&self, together: Together, at: Seen, out: &mut Vec<f64>) {
        let place = self.place(at.value);
        match together {
            Together::Fine => out.extend(steps::<FINE_SPLINES>(place)),
            _ => out.extend(steps::<SPLINES>(place)),
        }
        if self.variable.has_direction() {
            out.push(at.direction);
        }
    }
}

/// A law over one or two variables.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeLaw {
    /// How they come together.
    pub together: Together,
    /// The variables, one or two different ones.
    pub axes: Vec<Axis>,
}

impl FreeLaw {
    /// Over one variable.
    pub fn one(axis: Axis) -> Self {
        Self { together: Together::One, axes: vec![axis] }
    }

    /// Over one variable, with narrow bends.
    pub fn fine(axis: Axis) -> Self {
        Self { together: Together::Fine, axes: vec![axis] }
    }

    /// Over two, in each way.
    pub fn two(a: Axis, b: Axis) -> [Self; 3] {
        [Together::Multiplied, Together::Added, Together::Full]
            .map(|together| Self { together, axes: vec![a, b] })
    }

    /// The law as the shape of a term: how the variables come together, then four numbers for each.
    pub fn shape(&self) -> Vec<f64> {
        let axis = |a: &Axis| {
            let [kind, joint] = a.variable.code();
            [kind, joint, a.centre, a.half]
        };
        std::iter::once(self.together.code()).chain(self.axes.iter().flat_map(axis)).collect()
    }

    /// Whether one of its variables is the torque of a drive.
    pub fn looks_at_torque(&self) -> bool {
        self.axes.iter().any(|axis| matches!(axis.variable, Variable::Torque(_)))
    }

    /// The law that a shape means in a robot of so many joints; `None` where it means none.
    pub fn from_shape(shape: &[f64], joints: usize) -> Option<Self> {
        let (code, rest) = shape.split_first()?;
        let together = Together::ALL.into_iter().find(|t| t.code() == *code)?;
        let wanted = if together.is_alone() { 4 } else { 8 };
        let axis = |a: &[f64]| {
            let variable = Variable::from_code([a[0], a[1]], joints)?;
            let sound = a[2].is_finite() && a[3].is_finite() && a[3] > 0.0;
            sound.then_some(Axis { variable, centre: a[2], half: a[3] })
        };
        let axes: Vec<Axis> = rest.chunks_exact(4).map(axis).collect::<Option<_>>()?;
        let same = axes.windows(2).any(|w| w[0].variable == w[1].variable);
        (rest.len() == wanted && !same).then_some(Self { together, axes })
    }

    /// Whether a shape means a curve over the position of this joint and nothing else.
    pub(super) fn is_over_position_of(shape: &[f64], joint: usize) -> bool {
        let law = Self::from_shape(shape, joint + 1);
        law.is_some_and(
            |law| matches!(law.axes[..], [Axis { variable: Variable::Position(j), .. }] if j == joint),
        )
    }

    /// Amplitudes, that is columns.
    pub fn amplitudes(&self) -> usize {
        let curves: usize = self.axes.iter().map(|axis| axis.curve(self.together)).sum();
        let products = match self.axes.as_slice() {
            [a, b] => match (a.variable.has_direction(), b.variable.has_direction()) {
                (false, false) => BENDS * BENDS,
                (true, true) => 4,
                _ => 1 + SPLINES + BENDS,
            },
            _ => 0,
        };
        let count = |there: bool, n: usize| if there { n } else { 0 };
        count(self.together.has_curves(), curves) + count(self.together.has_products(), products)
    }

    /// Values of the columns, one value with its direction for each variable; `out` is filled anew.
    pub fn columns(&self, at: &[Seen], out: &mut Vec<f64>) {
        out.clear();
        if self.together.has_curves() {
            for (axis, at) in self.axes.iter().zip(at) {
                axis.fill(self.together, *at, out);
            }
        }
        if let ([a, b], [at_a, at_b], true) = (self.axes.as_slice(), at, self.together.has_products()) {
            products([a, b], [*at_a, *at_b], out);
        }
    }

    /// Where its middles are: the value of each variable with no direction.
    pub fn middle(&self) -> Vec<Seen> {
        self.axes.iter().map(|a| Seen { value: a.centre, direction: 0.0 }).collect()
    }
}

fn products(axes: [&Axis; 2], at: [Seen; 2], out: &mut Vec<f64>) {
    let place = |k: usize| axes[k].place(at[k].value).clamp(-1.0, 1.0);
    match axes.map(|a| a.variable.has_direction()) {
        [false, false] => {
            let right = bends(place(1));
            out.extend(bends(place(0)).iter().flat_map(|x| right.map(|y| x * y)));
        }
        [true, true] => {
            let [a, b] = [0, 1].map(|k| [at[k].direction, place(k)]);
            out.extend(a.iter().flat_map(|x| b.map(|y| x * y)));
        }
        [first, _] => {
            let (speed, other) = if first { (0, 1) } else { (1, 0) };
            let direction = at[speed].direction;
            out.push(direction);
            out.extend(steps::<SPLINES>(place(other)).map(|x| direction * x));
            out.extend(bends(place(other)).map(|x| place(speed) * x));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(variable: Variable) -> Axis {
        Axis { variable, centre: 0.5, half: 2.0 }
    }

    #[test]
    fn a_law_is_the_same_after_it_was_saved() {
        let [q, dq, time] = [Variable::Position(1), Variable::Speed(0), Variable::Time].map(axis);
        let laws = [FreeLaw::one(q), FreeLaw::fine(q), FreeLaw::fine(dq)]
            .into_iter()
            .chain(FreeLaw::two(q, dq))
            .chain(FreeLaw::two(dq, time));
        for law in laws {
            assert_eq!(FreeLaw::from_shape(&law.shape(), 2), Some(law.clone()));
            let mut out = Vec::new();
            law.columns(&vec![Seen { value: 1.0, direction: 1.0 }; law.axes.len()], &mut out);
            assert_eq!(out.len(), law.amplitudes(), "{law:?}");
        }
    }

    #[test]
    fn a_shape_that_means_no_law_is_none() {
        let shape = FreeLaw::one(axis(Variable::Position(1))).shape();
        assert!(FreeLaw::from_shape(&shape, 1).is_none(), "no such joint");
        assert!(FreeLaw::from_shape(&shape[..4], 2).is_none());
        assert!(FreeLaw::from_shape(&[], 2).is_none());
        let mut wrong = shape.clone();
        wrong[4] = 0.0;
        assert!(FreeLaw::from_shape(&wrong, 2).is_none(), "no interval");
        let twice: Vec<f64> = [1.0].iter().chain(&shape[1..]).chain(&shape[1..]).copied().collect();
        assert!(FreeLaw::from_shape(&twice, 2).is_none(), "one variable twice");
    }

    #[test]
    fn products_of_a_direction_jump_with_it_and_are_smooth_in_the_other() {
        let law = &FreeLaw::two(axis(Variable::Position(1)), axis(Variable::Speed(0)))[0];
        let at = |q: f64, direction: f64| {
            let mut out = Vec::new();
            let seen = [Seen { value: q, direction: 0.0 }, Seen { value: 0.5, direction }];
            law.columns(&seen, &mut out);
            out
        };
        for (up, down) in at(1.3, 1.0).iter().zip(at(1.3, -1.0)) {
            assert!((up + down).abs() < 1e-12);
        }
        assert_ne!(at(1.3, 1.0), at(0.3, 1.0));
    }
}
