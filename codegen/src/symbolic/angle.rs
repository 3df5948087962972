//! Angles that are sums of joint variables and a constant, with quarter turns kept exact.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Neg};

/// A constant angle: an exact number of quarter turns and a rest, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstantAngle {
    /// 0 to 3.
    pub quarter_turns: u8,
    /// What is left, rad; exactly zero for a multiple of pi/2.
    pub rest: f64,
}

impl ConstantAngle {
    /// The angle of `value` rad; what rounds to a multiple of pi/2 in double precision is that multiple.
    pub fn from_radians(value: f64) -> Self {
        let turns = (value / FRAC_PI_2).round();
        let rest = value - turns * FRAC_PI_2;
        let exact = rest.abs() <= 2.0 * f64::EPSILON * value.abs().max(1.0);
        if exact {
            ConstantAngle { quarter_turns: turns.rem_euclid(4.0) as u8, rest: 0.0 }
        } else {
            ConstantAngle { quarter_turns: 0, rest: value }
        }
    }

    /// Whether the angle is a multiple of pi/2.
    pub fn is_exact(self) -> bool {
        self.rest == 0.0
    }

    /// Sine and cosine; exactly 0 and +-1 for multiples of pi/2. For multiples of pi/4 and pi/6 they are the doubles
    /// nearest to the square roots that they are, so that equal sines and cosines are the same number.
    pub fn sin_cos(self) -> (f64, f64) {
        let (s, c) = if self.rest == 0.0 { (0.0, 1.0) } else { surd(self.rest) };
        match self.quarter_turns {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }
}

/// Sine and cosine of an angle, as square roots of rationals where they are some.
fn surd(angle: f64) -> (f64, f64) {
    let (s, c) = angle.sin_cos();
    let twelfths = (angle / (PI / 12.0)).round();
    if (angle - twelfths * (PI / 12.0)).abs() > 4.0 * f64::EPSILON * angle.abs().max(1.0) {
        return (s, c);
    }
    // The squares of sines and cosines of these angles are quarters; those of the others, pi/12 for one, are left.
    let root = |x: f64| {
        let quarters = (4.0 * x * x).round();
        let nearest = (quarters / 4.0).sqrt().copysign(x);
        if (x - nearest).abs() <= 4.0 * f64::EPSILON { nearest } else { x }
    };
    (root(s), root(c))
}

impl Add for ConstantAngle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        ConstantAngle {
            quarter_turns: (self.quarter_turns + other.quarter_turns) % 4,
            rest: self.rest + other.rest,
        }
    }
}

impl Neg for ConstantAngle {
    type Output = Self;
    fn neg(self) -> Self {
        ConstantAngle { quarter_turns: (4 - self.quarter_turns) % 4, rest: 0.0 - self.rest }
    }
}

/// sum of k_j q_j + constant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Angle {
    /// (joint, k_j), ascending joint, k_j not zero.
    pub terms: Vec<(usize, i32)>,
    /// The constant part.
    pub constant: ConstantAngle,
}

impl Angle {
    /// The variable of joint `joint`.
    pub fn joint(joint: usize) -> Self {
        Angle { terms: vec![(joint, 1)], constant: ConstantAngle::default() }
    }

    /// A constant angle.
    pub fn constant(constant: ConstantAngle) -> Self {
        Angle { terms: Vec::new(), constant }
    }

    /// Whether no joint turns it.
    pub fn is_constant(&self) -> bool {
        self.terms.is_empty()
    }
}

impl Add for &Angle {
    type Output = Angle;
    fn add(self, other: &Angle) -> Angle {
        let mut terms = self.terms.clone();
        for &(joint, k) in &other.terms {
            match terms.binary_search_by_key(&joint, |t| t.0) {
                Ok(at) => terms[at].1 += k,
                Err(at) => terms.insert(at, (joint, k)),
            }
        }
        terms.retain(|t| t.1 != 0);
        Angle { terms, constant: self.constant + other.constant }
    }
}

impl Neg for &Angle {
    type Output = Angle;
    fn neg(self) -> Angle {
        Angle { terms: self.terms.iter().map(|&(j, k)| (j, -k)).collect(), constant: -self.constant }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_of_a_quarter_turn_have_exact_sines_and_cosines() {
        for turns in -9_i32..9 {
            let angle = ConstantAngle::from_radians(f64::from(turns) * FRAC_PI_2);
            let (s, c) = angle.sin_cos();
            let expected = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][turns.rem_euclid(4) as usize];
            assert!(angle.is_exact());
            assert_eq!((s, c), expected);
        }
    }

    #[test]
    fn sines_and_cosines_that_are_equal_are_the_same_number() {
        for (value, sine, cosine) in [
            (PI / 4.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()),
            (-3.0 * PI / 4.0, -0.5_f64.sqrt(), -0.5_f64.sqrt()),
            (PI / 6.0, 0.5, 0.75_f64.sqrt()),
            (2.0 * PI / 3.0, 0.75_f64.sqrt(), -0.5),
        ] {
            assert_eq!(ConstantAngle::from_radians(value).sin_cos(), (sine, cosine), "{value}");
        }
        let other = PI / 12.0;
        assert_eq!(ConstantAngle::from_radians(other).sin_cos(), other.sin_cos());
    }

    #[test]
    fn other_angles_agree_with_the_standard_library() {
        for value in [0.1, -2.0, 3.0, 7.5] {
            let angle = ConstantAngle::from_radians(value) + ConstantAngle::from_radians(FRAC_PI_2);
            let (s, c) = angle.sin_cos();
            assert!((s - (value + FRAC_PI_2).sin()).abs() < 1e-15);
            assert!((c - (value + FRAC_PI_2).cos()).abs() < 1e-15);
        }
    }
}
