//! Sines and cosines of constant angles as exact numbers.

use super::Surd;
use num_bigint::BigInt;
use num_rational::{BigRational, Ratio};
use num_traits::{One, Zero};
use std::f64::consts::PI;

/// A step of 15 degrees: its sine and cosine are in Q(sqrt 2, sqrt 3).
const STEP: f64 = PI / 12.0;
/// Angles closer than this are one angle, rad. Well above the rounding of an expression, far below any drawing.
const SAME: f64 = 1e-12;
/// Two angles share a unit when both are whole multiples of it, up to this one.
const MOST: f64 = 64.0;

/// The constant angles of one robot.
///
/// A multiple of 15 degrees is exact. What another angle is beyond such a multiple is a whole multiple of a unit; a
/// unit's sine and cosine are those of the rational rotation 2 atan(t), t the simplest fraction within rounding of
/// tan(unit / 2). Angles that are commensurable with each other share a unit, so that 20 and 70 degrees, or 0.3 and
/// -0.1 rad, still add up exactly; units that are not are as independent as the angles are.
#[derive(Debug, Clone, Default)]
pub struct Angles {
    units: Vec<f64>,
}

/// Cosine and sine.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Cosine.
    pub cos: Surd,
    /// Sine.
    pub sin: Surd,
}

impl Rotation {
    fn none() -> Rotation {
        Rotation { cos: Surd::one(), sin: Surd::zero() }
    }

    fn then(&self, next: &Rotation) -> Rotation {
        Rotation {
            cos: &(&self.cos * &next.cos) - &(&self.sin * &next.sin),
            sin: &(&self.sin * &next.cos) + &(&self.cos * &next.sin),
        }
    }

    fn times(&self, count: i64) -> Rotation {
        let one = if count < 0 { Rotation { cos: self.cos.clone(), sin: -&self.sin } } else { self.clone() };
        (0..count.unsigned_abs()).fold(Rotation::none(), |turned, _| turned.then(&one))
    }
}

/// Whole steps of 15 degrees, and the rest in (-7.5, 7.5] degrees.
fn split(angle: f64) -> (i64, f64) {
    let steps = (angle / STEP).round();
    let rest = angle - steps * STEP;
    ((steps % 24.0) as i64, if rest.abs() < SAME { 0.0 } else { rest })
}

/// The largest angle that both are whole multiples of, if there is a sensible one (Euclid's algorithm).
fn common_unit(a: f64, b: f64) -> Option<f64> {
    let (mut x, mut y) = (a.abs().max(b.abs()), a.abs().min(b.abs()));
    let smallest = x / MOST;
    while y > SAME {
        if y < smallest {
            return None;
        }
        (x, y) = (y, (x - (x / y).round() * y).abs());
    }
    Some(x)
}

impl Angles {
    /// Finds the units of a set of angles, rad.
    pub fn of(angles: impl IntoIterator<Item = f64>) -> Angles {
        let mut units: Vec<f64> = Vec::new();
        for angle in angles {
            let mut unit = split(angle).1.abs();
            if unit == 0.0 {
                continue;
            }
            units.retain(|&other| match common_unit(unit, other) {
                Some(common) => {
                    unit = common;
                    false
                }
                None => true,
            });
            units.push(unit);
        }
        Angles { units }
    }

    /// Cosine and sine of an angle, rad.
    pub fn rotation(&self, angle: f64) -> Rotation {
        let (steps, rest) = split(angle);
        let quarter = BigRational::new(BigInt::one(), BigInt::from(4));
        let two = Surd::root(1, quarter.clone());
        let six = Surd::root(3, quarter);
        let step = Rotation { cos: &six + &two, sin: &six - &two };
        let whole = step.times(steps);
        if rest == 0.0 {
            return whole;
        }
        let fits = |unit: &&f64| {
            let count = rest / **unit;
            (count - count.round()).abs() * **unit < SAME * MOST && count.abs() < 2.0 * MOST
        };
        let (unit, count) = match self.units.iter().find(fits) {
            Some(&unit) => (unit, (rest / unit).round() as i64),
            None => (rest, 1),
        };
        whole.then(&rational_rotation(unit).times(count))
    }

    /// Whether the angle is a multiple of 15 degrees.
    pub fn is_special(angle: f64) -> bool {
        split(angle).1 == 0.0
    }
}

fn rational_rotation(angle: f64) -> Rotation {
    let t = Ratio::<i64>::approximate_float((angle / 2.0).tan()).unwrap_or_else(Ratio::zero);
    let t = BigRational::new(BigInt::from(*t.numer()), BigInt::from(*t.denom()));
    let square = &t * &t;
    let below = (BigRational::one() + &square).recip();
    let two = BigRational::from_integer(BigInt::from(2));
    Rotation { cos: ((BigRational::one() - square) * &below).into(), sin: (two * t * below).into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_of_15_degrees_are_exact() {
        let angles = Angles::default();
        for k in -30..=30_i64 {
            let angle = k as f64 * STEP;
            let rotation = angles.rotation(angle);
            assert!((rotation.cos.to_f64() - angle.cos()).abs() < 1e-14, "{k}");
            assert!((rotation.sin.to_f64() - angle.sin()).abs() < 1e-14, "{k}");
            assert!((&(&rotation.cos * &rotation.cos) + &(&rotation.sin * &rotation.sin)).is_one());
        }
        assert!(angles.rotation(PI / 2.0).cos.is_zero());
    }

    #[test]
    fn a_general_angle_is_a_true_rotation_within_rounding() {
        for angle in [0.3, -1.1, 2.0_f64.sqrt(), 3.0, 1e-5] {
            let rotation = Angles::of([angle]).rotation(angle);
            assert!((rotation.cos.to_f64() - angle.cos()).abs() < 3e-16);
            assert!((rotation.sin.to_f64() - angle.sin()).abs() < 3e-16);
            assert!((&(&rotation.cos * &rotation.cos) + &(&rotation.sin * &rotation.sin)).is_one());
        }
    }

    #[test]
    fn commensurable_angles_add_up_exactly() {
        for sum in
            [[0.3, 0.2, -0.5], [PI / 9.0, 7.0 * PI / 18.0, -PI / 2.0], [0.1, PI / 6.0 - 0.1, -PI / 6.0]]
        {
            let angles = Angles::of(sum);
            let all =
                sum.iter().fold(Rotation::none(), |turned, &angle| turned.then(&angles.rotation(angle)));
            assert_eq!(all, Rotation::none(), "{sum:?}");
        }
    }
}
