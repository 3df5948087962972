//! Numbers that can be told from zero for certain.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

/// 2^61 - 2065953, the largest prime below 2^61 that is 1 short of a multiple of 36000. Modulo such a prime the circle
/// x^2 + y^2 = 1 has the points of a regular polygon of 36000 corners, one for each hundredth of a degree.
const P: u64 = 2_305_843_009_211_627_999;
/// The polygon's corner at 0.01 degrees: a point of order 36000 whose 9000th power is (0, 1).
const COS_0_01: u64 = 652_776_672_298_035_111;
const SIN_0_01: u64 = 1_099_800_677_151_855_906;
/// Square roots of 2 and 3: twice the cosines of 45 and 30 degrees.
const ROOT_2: u64 = 391_615_380_515_228_145;
const ROOT_3: u64 = 1_648_974_323_752_019_032;

/// An exact number in two shapes: as a residue modulo a prime, which decides what is zero, and in floating point, which
/// says how large it is.
///
/// The residue follows the number through + - * / without rounding: rational numbers, and the sines and cosines of whole
/// hundredths of a degree, have an exact image in the prime field. What is zero has the residue zero. What is not has
/// it with a chance of 1 in 2^61, and the same on every run: the usual bargain of modular computer algebra (von zur
/// Gathen and Gerhard 2013, chapter 4), far below that of a fault in the machine, and fast where big fractions are
/// not. Equality compares residues.
#[derive(Debug, Clone, Copy, Default)]
pub struct Number {
    residue: u64,
    real: f64,
}

impl Number {
    /// 0.
    pub const ZERO: Number = Number { residue: 0, real: 0.0 };
    /// 1.
    pub const ONE: Number = Number { residue: 1, real: 1.0 };

    fn new(residue: u64, real: f64) -> Number {
        // A sum that cancels leaves rounding behind; the residue knows better.
        if residue == 0 { Number::ZERO } else { Number { residue, real } }
    }

    /// Cosine and sine of 0.01 degrees.
    pub(super) fn smallest_rotation() -> (Number, Number) {
        let angle = (0.01_f64).to_radians();
        (Number::new(COS_0_01, angle.cos()), Number::new(SIN_0_01, angle.sin()))
    }

    /// sqrt(2).
    pub fn root_2() -> Number {
        Number::new(ROOT_2, std::f64::consts::SQRT_2)
    }

    /// sqrt(3).
    pub fn root_3() -> Number {
        Number::new(ROOT_3, 3.0_f64.sqrt())
    }

    /// The same number with a better rounded floating point value.
    pub fn with_real(self, real: f64) -> Number {
        Number::new(self.residue, real)
    }

    /// The number in floating point.
    pub fn real(self) -> f64 {
        self.real
    }

    /// Whether it is 0.
    pub fn is_zero(self) -> bool {
        self.residue == 0
    }

    /// 1 / self; `None` for 0.
    pub fn inverse(self) -> Option<Number> {
        // Fermat: a^(P - 2) a = 1.
        (!self.is_zero()).then(|| Number::new(power(self.residue, P - 2), self.real.recip()))
    }

    /// The fraction a / b that it is, if |a| and b are at most `bound`, at most 2^20.
    ///
    /// There is at most one such fraction with this residue (rational reconstruction, Wang 1981).
    pub fn fraction(self, bound: i64) -> Option<(i64, i64)> {
        let bound = i128::from(bound.min(1 << 20));
        let (mut r, mut next_r) = (i128::from(P), i128::from(self.residue));
        let (mut s, mut next_s) = (0_i128, 1_i128);
        while next_r > bound {
            let quotient = r / next_r;
            (r, next_r) = (next_r, r - quotient * next_r);
            (s, next_s) = (next_s, s - quotient * next_s);
        }
        let (a, b) = if next_s < 0 { (-next_r, -next_s) } else { (next_r, next_s) };
        (b > 0 && b <= bound).then_some((a as i64, b as i64))
    }

    /// The same number with its floating point value exact where it is a simple fraction.
    pub fn cleaned(self) -> Number {
        match self.fraction(1000) {
            Some((a, b)) => self.with_real(a as f64 / b as f64),
            None => self,
        }
    }
}

fn multiply(a: u64, b: u64) -> u64 {
    // The remainder is below P, which fits.
    ((u128::from(a) * u128::from(b)) % u128::from(P)) as u64
}

fn power(base: u64, mut exponent: u64) -> u64 {
    let (mut square, mut product) = (base, 1);
    while exponent > 0 {
        if exponent & 1 == 1 {
            product = multiply(product, square);
        }
        square = multiply(square, square);
        exponent >>= 1;
    }
    product
}

impl From<i64> for Number {
    fn from(value: i64) -> Number {
        Number::new(value.rem_euclid(P as i64) as u64, value as f64)
    }
}

impl From<BigRational> for Number {
    fn from(value: BigRational) -> Number {
        let residue = |x: &BigInt| {
            let size = (x.abs() % BigInt::from(P)).to_u64().unwrap_or(0);
            if x.is_negative() && size > 0 { P - size } else { size }
        };
        // Denominators are powers of ten, products of gear ratios or small: none is a multiple of P, and if one were,
        // 0 would stand for a number that is not finite in the field.
        let below = power(residue(value.denom()), P - 2);
        let real = if value.is_zero() { 0.0 } else { value.to_f64().unwrap_or(0.0) };
        Number::new(multiply(residue(value.numer()), below), real)
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Number) -> bool {
        self.residue == other.residue
    }
}

impl Eq for Number {}

impl Add for Number {
    type Output = Number;
    fn add(self, other: Number) -> Number {
        let sum = self.residue + other.residue;
        Number::new(if sum >= P { sum - P } else { sum }, self.real + other.real)
    }
}

impl Neg for Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number::new(if self.residue == 0 { 0 } else { P - self.residue }, -self.real)
    }
}

impl Sub for Number {
    type Output = Number;
    fn sub(self, other: Number) -> Number {
        self + -other
    }
}

impl Mul for Number {
    type Output = Number;
    fn mul(self, other: Number) -> Number {
        Number::new(multiply(self.residue, other.residue), self.real * other.real)
    }
}

impl std::iter::Sum for Number {
    fn sum<I: Iterator<Item = Number>>(numbers: I) -> Number {
        numbers.fold(Number::ZERO, |sum, x| sum + x)
    }
}

/// `3`, `0.225`, `1/3`, `sqrt(3)/2`; what is none of these as a decimal with nine digits.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let roots = [
            (Number::ONE, ""),
            (Number::root_2(), "sqrt(2)"),
            (Number::root_3(), "sqrt(3)"),
            (Number::root_2() * Number::root_3(), "sqrt(6)"),
        ];
        for (root, text) in roots {
            let Some(inverse) = root.inverse() else { continue };
            let Some((a, b)) = (*self * inverse).fraction(1 << 20) else { continue };
            let value = a as f64 / b as f64 * root.real();
            if (value - self.real).abs() > 1e-9 * (1.0 + value.abs()) {
                continue;
            }
            let decimal = format!("{value}");
            if text.is_empty() && (decimal.len() <= 8 || b == 1) {
                return f.write_str(&decimal);
            }
            match (text.is_empty(), a) {
                (true, _) => write!(f, "{a}")?,
                (false, 1) => f.write_str(text)?,
                (false, -1) => write!(f, "-{text}")?,
                (false, _) => write!(f, "{a}*{text}")?,
            }
            return if b == 1 { Ok(()) } else { write!(f, "/{b}") };
        }
        let decimal = format!("{}", self.real);
        match decimal.len() {
            ..=11 => f.write_str(&decimal),
            _ if (1e-3..1e6).contains(&self.real.abs()) => write!(f, "{:.9}", self.real),
            _ => write!(f, "{:.9e}", self.real),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::decimal;

    fn number(x: f64) -> Number {
        decimal(x).into()
    }

    #[test]
    fn decimals_cancel_that_floating_point_does_not() {
        assert!((number(0.1) + number(0.2) - number(0.3)).is_zero());
        assert_eq!((number(0.1) + number(0.2) - number(0.3)).real(), 0.0);
        assert!(!(number(0.1) + number(0.2) - number(0.3 + 1e-16)).is_zero());
    }

    #[test]
    fn roots_square_to_whole_numbers() {
        assert_eq!(Number::root_2() * Number::root_2(), Number::from(2));
        assert_eq!(Number::root_3() * Number::root_3(), Number::from(3));
    }

    #[test]
    fn a_number_times_its_inverse_is_one() {
        let x = number(-12.345) * Number::root_3() + number(0.7);
        let inverse = x.inverse().expect("not zero");
        assert_eq!(x * inverse, Number::ONE);
        assert!((inverse.real() * x.real() - 1.0).abs() < 1e-15);
        assert_eq!(Number::ZERO.inverse(), None);
        assert_eq!(-Number::ZERO, Number::ZERO);
    }

    #[test]
    fn simple_fractions_are_found_again() {
        for (a, b) in [(0, 1), (1, 1), (-1, 1), (2, 3), (-9, 40), (999_983, 1_000_003)] {
            let x = Number::from(a) * Number::from(b).inverse().expect("not zero");
            assert_eq!(x.fraction(1 << 20), Some((a, b)));
        }
        assert_eq!(number(std::f64::consts::PI).fraction(1 << 20), None);
    }

    #[test]
    fn numbers_read_as_a_person_writes_them() {
        let third = Number::from(3).inverse().expect("not zero");
        let texts = [
            (number(0.225), "0.225"),
            (Number::from(-2), "-2"),
            (third, "1/3"),
            (Number::root_3() * number(0.5), "sqrt(3)/2"),
            (-Number::root_2(), "-sqrt(2)"),
            (Number::root_2() * Number::root_3() * third, "sqrt(6)/3"),
            (number(0.123456789123), "0.123456789"),
            (number(1.23456789123e-20), "1.234567891e-20"),
        ];
        for (x, text) in texts {
            assert_eq!(x.to_string(), text);
        }
    }
}
