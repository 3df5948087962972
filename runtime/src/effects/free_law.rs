//! A torque of a joint as smooth curves over one or two variables: a law that nobody wrote down.
//!
//! It is an additive model of cubic splines (Hastie and Tibshirani 1986; Eilers and Marx 1996), for two variables with
//! the products of a few bends of each. A speed comes with its direction, at whose change a torque may jump.

use super::axis::{Axis, Seen, Sum};
use super::spline::{BENDS, FINE_SPLINES, SPLINES, bends, steps};
use super::together::Together;
use super::variable::Variable;

/// Parts of an interval along which what fades falls to a third: together they make any fall between the first and the last.
const FADES_ALONG: [f64; 3] = [0.025, 0.1, 0.4];

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

    /// In proportion to one.
    pub fn line(axis: Axis) -> Self {
        Self { together: Together::Lines, axes: vec![axis] }
    }

    /// Over two that come together in one way.
    pub fn two(together: Together, [a, b]: [Axis; 2]) -> Self {
        Self { together, axes: vec![a, b] }
    }

    /// The sum of its positions, or their difference, with its interval, where it is one curve over that.
    pub fn sum(&self) -> Option<Sum> {
        let sign = self.together.sign_of_second()?;
        let [a, b] = self.axes.as_slice() else { return None };
        Some(Sum { sign, centre: a.centre + sign * b.centre, half: a.half + b.half })
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
        let together = Together::from_code(*code)?;
        let whole = match together {
            Together::One | Together::Fine => rest.len() == 4,
            Together::Lines => rest.len() == 4 || rest.len() == 8,
            _ => rest.len() == 8,
        };
        let axis = |a: &[f64]| {
            let variable = Variable::from_code([a[0], a[1]], joints)?;
            let sound = a[2].is_finite() && a[3].is_finite() && a[3] > 0.0;
            sound.then_some(Axis { variable, centre: a[2], half: a[3] })
        };
        let axes: Vec<Axis> = rest.chunks_exact(4).map(axis).collect::<Option<_>>()?;
        let same = axes.windows(2).any(|w| w[0].variable == w[1].variable);
        let is_position = |axis: &Axis| matches!(axis.variable, Variable::Position(_));
        let adds = together.sign_of_second().is_none() || axes.iter().all(is_position);
        let law = Self { together, axes };
        let fades = together != Together::Fading || law.fading().is_some();
        (whole && !same && adds && fades).then_some(law)
    }

    /// Whether what two variables do together may be friction that fades: one has the direction of a joint, the other tells how
    /// long ago this joint stood.
    pub fn may_fade([a, b]: [Variable; 2]) -> bool {
        let of_one = |speed: Variable, since: Variable| {
            speed.has_direction() && since.fades() && speed.joint() == since.joint()
        };
        of_one(a, b) || of_one(b, a)
    }

    /// Places of the variable with a direction, and of the one that it fades along; `None` where it is no such law.
    fn fading(&self) -> Option<[usize; 2]> {
        let [a, b] = self.axes.as_slice() else { return None };
        let fades = self.together == Together::Fading && Self::may_fade([a.variable, b.variable]);
        fades.then_some(if a.variable.has_direction() { [0, 1] } else { [1, 0] })
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
        if self.together.sign_of_second().is_some() {
            return FINE_SPLINES;
        }
        if self.together == Together::Fading {
            return FADES_ALONG.len();
        }
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
        if let (Some(sum), [a, b]) = (self.sum(), at) {
            out.extend(steps::<FINE_SPLINES>(sum.place(a.value, b.value)));
            return;
        }
        if let Some([speed, along]) = self.fading() {
            let gone = 0.5 * (self.axes[along].along(at[along].value) + 1.0).max(0.0);
            out.extend(FADES_ALONG.map(|part| at[speed].direction * (-gone / part).exp()));
            return;
        }
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
        let p = axis(Variable::Position(0));
        let alone =
            [FreeLaw::one(q), FreeLaw::fine(q), FreeLaw::fine(dq), FreeLaw::line(q), FreeLaw::line(dq)];
        let of_two = |pair| Together::OF_ANY_TWO.map(|together| FreeLaw::two(together, pair));
        let sums = Together::OF_POSITIONS.map(|together| FreeLaw::two(together, [q, p]));
        let since = [Variable::TravelSinceReversal(0), Variable::TimeSinceReversal(0)].map(axis);
        let fading = since.into_iter().flat_map(|s| [[s, dq], [dq, s]]);
        let fading = fading.map(|pair| FreeLaw::two(Together::Fading, pair));
        let laws =
            alone.into_iter().chain(of_two([q, dq])).chain(of_two([dq, time])).chain(sums).chain(fading);
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
        let mixed = FreeLaw::two(Together::Sum, [axis(Variable::Position(1)), axis(Variable::Time)]);
        assert!(FreeLaw::from_shape(&mixed.shape(), 2).is_none(), "a sum of a position and a time");
        let apart = [Variable::TravelSinceReversal(1), Variable::Speed(0)].map(axis);
        let fading = FreeLaw::two(Together::Fading, apart);
        assert!(FreeLaw::from_shape(&fading.shape(), 2).is_none(), "the rest of another joint");
    }

    #[test]
    fn products_of_a_direction_jump_with_it_and_are_smooth_in_the_other() {
        let law = FreeLaw::two(Together::Multiplied, [axis(Variable::Position(1)), axis(Variable::Speed(0))]);
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

    #[test]
    fn friction_fades_along_the_way_in_the_direction_of_the_joint() {
        let over = |variable| Axis { variable, centre: 1.0, half: 1.0 };
        let law =
            FreeLaw::two(Together::Fading, [Variable::Speed(0), Variable::TravelSinceReversal(0)].map(over));
        let at = |travel: f64, direction: f64| {
            let mut out = Vec::new();
            law.columns(
                &[Seen { value: direction, direction }, Seen { value: travel, direction: 0.0 }],
                &mut out,
            );
            out
        };
        assert_eq!(at(0.0, 1.0), [1.0; 3]);
        assert_eq!(at(0.0, -1.0), [-1.0; 3]);
        assert!(
            at(0.2, 1.0).iter().zip([4.0_f64, 1.0, 0.25]).all(|(x, gone)| (x - (-gone).exp()).abs() < 1e-12)
        );
    }

    #[test]
    fn a_curve_over_what_fades_bends_where_it_is_small_and_a_line_over_it_is_straight() {
        let over = |variable| Axis { variable, centre: 1.0, half: 1.0 };
        let moved = |law: FreeLaw, from: f64| {
            let at = |value: f64| {
                let mut out = Vec::new();
                law.columns(&[Seen { value, direction: 0.0 }], &mut out);
                out
            };
            at(from).iter().zip(at(from + 0.05)).map(|(a, b)| (a - b).abs()).sum::<f64>()
        };
        let [travel, q] = [Variable::TravelSinceReversal(0), Variable::Position(0)].map(over);
        assert!(moved(FreeLaw::one(travel), 0.0) > 2.0 * moved(FreeLaw::one(q), 0.0));
        assert!(moved(FreeLaw::one(travel), 1.5) < moved(FreeLaw::one(q), 1.5));
        assert_eq!(moved(FreeLaw::line(travel), 0.0), moved(FreeLaw::line(q), 0.0));
    }

    #[test]
    fn a_curve_over_a_difference_is_the_same_where_both_positions_went_on_as_far() {
        let pair = [axis(Variable::Position(1)), axis(Variable::Position(0))];
        let at = |together, a: f64, b: f64| {
            let mut out = Vec::new();
            let seen = [a, b].map(|value| Seen { value, direction: 0.0 });
            FreeLaw::two(together, pair).columns(&seen, &mut out);
            out
        };
        let apart = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
        assert!(apart(at(Together::Difference, 0.7, 0.2), at(Together::Difference, 1.2, 0.7)) < 1e-12);
        assert!(apart(at(Together::Sum, 0.7, 0.2), at(Together::Sum, 0.2, 0.7)) < 1e-12);
        assert!(apart(at(Together::Sum, 0.7, 0.2), at(Together::Sum, 1.2, 0.7)) > 0.1);
    }
}
