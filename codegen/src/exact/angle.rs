//! Sines and cosines of constant angles as exact numbers.

use super::number::Number;
use num_rational::Ratio;
use std::f64::consts::PI;

/// A hundredth of a degree: its multiples are exact.
const STEP: f64 = PI / 18000.0;
/// Steps in a full turn.
const TURN: i64 = 36000;
/// Steps in 15 degrees, the angles whose sine and cosine are written with square roots.
const FIFTEEN: i64 = 1500;
/// Angles closer than this are one angle, rad. Well above the rounding of an expression, far below any drawing.
const SAME: f64 = 1e-12;
/// Two angles share a unit when both are whole multiples of it, up to this one.
const MOST: f64 = 64.0;

/// The constant angles of one robot.
///
/// A whole number of hundredths of a degree is exact. Any other angle is a multiple of 15 degrees plus a whole multiple
/// of a unit; a unit's sine and cosine are those of the rational rotation 2 atan(t), t the simplest fraction within
/// rounding of tan(unit / 2). Angles share a unit where they can, so that 0.3, 0.2 and -0.5 rad, or 0.1 and pi/6 - 0.1,
/// still add up exactly; units that angles do not share are as independent as the angles are.
#[derive(Debug, Clone, Default)]
pub struct Angles {
    units: Vec<f64>,
}

/// Cosine and sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Cosine.
    pub cos: Number,
    /// Sine.
    pub sin: Number,
}

impl Rotation {
    /// The rotation by 2 atan(t).
    pub fn of_half_tangent(t: Number) -> Rotation {
        let square = t * t;
        // The sum of two squares is 0 modulo P only if both are: P is 3 modulo 4.
        let scale = (Number::ONE + square).inverse().unwrap_or(Number::ZERO);
        Rotation { cos: (Number::ONE - square) * scale, sin: (t + t) * scale }
    }

    const NONE: Rotation = Rotation { cos: Number::ONE, sin: Number::ZERO };

    /// One turn after the other.
    pub fn then(self, next: Rotation) -> Rotation {
        Rotation {
            cos: self.cos * next.cos - self.sin * next.sin,
            sin: self.sin * next.cos + self.cos * next.sin,
        }
    }

    /// The turn so many times.
    pub fn times(self, count: i64) -> Rotation {
        let mut square = if count < 0 { Rotation { sin: -self.sin, ..self } } else { self };
        let mut left = count.unsigned_abs();
        let mut turned = Rotation::NONE;
        while left > 0 {
            if left & 1 == 1 {
                turned = turned.then(square);
            }
            square = square.then(square);
            left >>= 1;
        }
        turned
    }
}

/// How many hundredths of a degree the angle is, if a whole number.
fn whole_steps(angle: f64) -> Option<i64> {
    let steps = (angle / STEP).round();
    ((angle - steps * STEP).abs() < SAME).then_some((steps % TURN as f64) as i64)
}

/// The angle less each multiple of 15 degrees, in steps, small multiples first.
fn shifted(angle: f64) -> impl Iterator<Item = (i64, f64)> {
    (0..=24).flat_map(|k| [k * FIFTEEN, -k * FIFTEEN]).map(move |steps| (steps, angle - steps as f64 * STEP))
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
        for angle in angles.into_iter().filter(|&angle| whole_steps(angle).is_none()) {
            let shared = |unit: f64| shifted(angle).find_map(|(_, rest)| common_unit(rest, unit));
            match units.iter().position(|&unit| shared(unit).is_some()) {
                Some(k) => units[k] = shared(units[k]).unwrap_or(units[k]),
                None => units.push(angle),
            }
        }
        Angles { units }
    }

    /// Cosine and sine of an angle, rad.
    pub fn rotation(&self, angle: f64) -> Rotation {
        let (cos, sin) = Number::smallest_rotation();
        let step = Rotation { cos, sin };
        let exact = match whole_steps(angle) {
            Some(steps) => step.times(steps),
            None => match self.in_units(angle) {
                Some((steps, unit, count)) => step.times(steps).then(rational_rotation(unit).times(count)),
                None => rational_rotation(angle),
            },
        };
        Rotation { cos: exact.cos.with_real(angle.cos()), sin: exact.sin.with_real(angle.sin()) }
    }

    /// The angle as steps and a count of one unit.
    fn in_units(&self, angle: f64) -> Option<(i64, f64, i64)> {
        self.units.iter().find_map(|&unit| {
            shifted(angle).find_map(|(steps, rest)| {
                let count = (rest / unit).round();
                let fits = count.abs() <= MOST * MOST && (rest - count * unit).abs() < MOST * SAME;
                fits.then_some((steps, unit, count as i64))
            })
        })
    }

    /// Whether the angle is a multiple of 15 degrees.
    pub fn is_special(angle: f64) -> bool {
        whole_steps(angle).is_some_and(|steps| steps % FIFTEEN == 0)
    }
}

fn rational_rotation(angle: f64) -> Rotation {
    let t = Ratio::<i64>::approximate_float((angle / 2.0).tan()).unwrap_or_else(|| Ratio::from_integer(0));
    let (above, below) = (Number::from(*t.numer()), Number::from(*t.denom()));
    let (aa, bb) = (above * above, below * below);
    // The sum of two squares of whole numbers below P is 0 modulo P only if both are: P is 3 modulo 4.
    let scale = (aa + bb).inverse().unwrap_or(Number::ZERO);
    Rotation { cos: (bb - aa) * scale, sin: (above * below + above * below) * scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half(x: Number) -> Number {
        x * Number::from(2).inverse().expect("not zero")
    }

    #[test]
    fn well_known_angles_have_their_well_known_values() {
        let angle = |degrees: f64| Angles::default().rotation(degrees.to_radians());
        assert_eq!(angle(90.0), Rotation { cos: Number::ZERO, sin: Number::ONE });
        assert_eq!(angle(-180.0), Rotation { cos: -Number::ONE, sin: Number::ZERO });
        assert_eq!(angle(45.0), Rotation { cos: half(Number::root_2()), sin: half(Number::root_2()) });
        assert_eq!(angle(-30.0), Rotation { cos: half(Number::root_3()), sin: -half(Number::ONE) });
        // cos 36 - cos 72 = 1/2
        assert_eq!(angle(36.0).cos - angle(72.0).cos, half(Number::ONE));
        assert_eq!(angle(90.0).cos.real(), 0.0);
        assert_eq!(angle(36.0).cos.real(), 36.0_f64.to_radians().cos());
    }

    #[test]
    fn a_general_angle_is_a_true_rotation_within_rounding() {
        for angle in [0.3, -1.1, 2.0_f64.sqrt(), 3.0, 1e-5] {
            let rotation = rational_rotation(angle);
            assert!((rotation.cos.real() - angle.cos()).abs() < 1e-15);
            assert!((rotation.sin.real() - angle.sin()).abs() < 1e-15);
            assert_eq!(rotation.cos * rotation.cos + rotation.sin * rotation.sin, Number::ONE);
        }
    }

    #[test]
    fn commensurable_angles_add_up_exactly() {
        for sum in
            [[0.3, 0.2, -0.5], [PI / 9.0, 7.0 * PI / 18.0, -PI / 2.0], [0.1, PI / 6.0 - 0.1, -PI / 6.0]]
        {
            let angles = Angles::of(sum);
            let all = sum.iter().fold(Rotation::NONE, |turned, &angle| turned.then(angles.rotation(angle)));
            assert_eq!(all, Rotation::NONE, "{sum:?}");
        }
    }
}
