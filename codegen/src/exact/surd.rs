//! The numbers a + b sqrt(2) + c sqrt(3) + d sqrt(6) with rational a, b, c, d.
//!
//! They hold every length of a table and the sine and cosine of every multiple of 15 degrees, and they can be told
//! from zero for certain.

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

/// An exact number of the field Q(sqrt 2, sqrt 3).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Surd {
    /// Ascending root, coefficient not zero. Bit 0 of the root stands for sqrt(2), bit 1 for sqrt(3).
    terms: Vec<(u8, BigRational)>,
}

impl Surd {
    /// 0.
    pub fn zero() -> Surd {
        Surd::default()
    }

    /// 1.
    pub fn one() -> Surd {
        BigRational::one().into()
    }

    /// A whole number.
    pub fn integer(value: i64) -> Surd {
        BigRational::from_integer(value.into()).into()
    }

    /// `coefficient` times sqrt(2) (root 1), sqrt(3) (root 2) or sqrt(6) (root 3).
    pub fn root(root: u8, coefficient: BigRational) -> Surd {
        if coefficient.is_zero() { Surd::zero() } else { Surd { terms: vec![(root & 3, coefficient)] } }
    }

    /// Whether it is 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Whether it is 1.
    pub fn is_one(&self) -> bool {
        matches!(self.terms.as_slice(), [(0, a)] if a.is_one())
    }

    /// The rational parts, by root.
    pub(super) fn terms(&self) -> &[(u8, BigRational)] {
        &self.terms
    }

    /// The nearest number in floating point, up to rounding of each of the four parts.
    pub fn to_f64(&self) -> f64 {
        let part = |(root, a): &(u8, BigRational)| a.to_f64().unwrap_or(f64::NAN) * root_value(*root).sqrt();
        self.terms.iter().map(part).sum()
    }

    /// The same number with the sign of one square root changed.
    fn conjugate(&self, bit: u8) -> Surd {
        let flip = |(root, a): &(u8, BigRational)| (*root, if root & bit == 0 { a.clone() } else { -a });
        Surd { terms: self.terms.iter().map(flip).collect() }
    }

    /// 1 / self; `None` for 0.
    pub fn inverse(&self) -> Option<Surd> {
        let without_3 = &self.conjugate(2) * self;
        let norm = &without_3.conjugate(1) * &without_3;
        let (_, norm) = norm.terms.first()?;
        let scale: Surd = norm.recip().into();
        Some(&(&self.conjugate(2) * &without_3.conjugate(1)) * &scale)
    }
}

/// The number under the square root.
fn root_value(root: u8) -> f64 {
    [1.0, 2.0, 3.0, 6.0][usize::from(root & 3)]
}

impl From<BigRational> for Surd {
    fn from(value: BigRational) -> Surd {
        Surd::root(0, value)
    }
}

impl Add for &Surd {
    type Output = Surd;
    fn add(self, other: &Surd) -> Surd {
        let mut terms = self.terms.clone();
        for (root, b) in &other.terms {
            match terms.binary_search_by_key(root, |t| t.0) {
                Err(k) => terms.insert(k, (*root, b.clone())),
                Ok(k) => {
                    terms[k].1 += b;
                    if terms[k].1.is_zero() {
                        terms.remove(k);
                    }
                }
            }
        }
        Surd { terms }
    }
}

impl Neg for &Surd {
    type Output = Surd;
    fn neg(self) -> Surd {
        Surd { terms: self.terms.iter().map(|(root, a)| (*root, -a)).collect() }
    }
}

impl Sub for &Surd {
    type Output = Surd;
    fn sub(self, other: &Surd) -> Surd {
        self + &-other
    }
}

impl Mul for &Surd {
    type Output = Surd;
    fn mul(self, other: &Surd) -> Surd {
        let mut sum = Surd::zero();
        for (r, a) in &self.terms {
            for (s, b) in &other.terms {
                let whole = [1, 2, 3, 6][usize::from(r & s)];
                let product = a * b * BigRational::from_integer(whole.into());
                sum = &sum + &Surd::root(r ^ s, product);
            }
        }
        sum
    }
}

/// One part for a person: `3`, `0.225`, `1/3`, `sqrt(3)/2`; long fractions as decimals.
pub(super) fn write_part(f: &mut fmt::Formatter<'_>, root: u8, a: &BigRational) -> fmt::Result {
    let simple = |x: &num_bigint::BigInt| x.bits() <= 20;
    let root_text = ["", "sqrt(2)", "sqrt(3)", "sqrt(6)"][usize::from(root & 3)];
    if root == 0 {
        let decimal = a.to_f64().unwrap_or(f64::NAN);
        let text = format!("{decimal}");
        return if text.len() <= 8 || !(simple(a.numer()) && simple(a.denom())) {
            if text.len() <= 12 { f.write_str(&text) } else { write!(f, "{decimal:.9}") }
        } else {
            write!(f, "{a}")
        };
    }
    if !(simple(a.numer()) && simple(a.denom())) {
        return write!(f, "{:.9}", a.to_f64().unwrap_or(f64::NAN) * root_value(root).sqrt());
    }
    match (a.numer().abs().is_one(), a.is_negative()) {
        (true, false) => f.write_str(root_text)?,
        (true, true) => write!(f, "-{root_text}")?,
        (false, _) => write!(f, "{}*{root_text}", a.numer())?,
    }
    if a.denom().is_one() { Ok(()) } else { write!(f, "/{}", a.denom()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::decimal;

    fn example() -> Surd {
        let parts = [(0, 0.5), (1, -1.25), (2, 3.0), (3, 0.1)].map(|(root, x)| Surd::root(root, decimal(x)));
        parts.iter().fold(Surd::zero(), |sum, part| &sum + part)
    }

    #[test]
    fn a_number_times_its_inverse_is_one() {
        let x = example();
        assert!((&x * &x.inverse().expect("not zero")).is_one());
        assert_eq!(Surd::zero().inverse(), None);
    }

    #[test]
    fn products_agree_with_floating_point() {
        let x = example();
        let y = Surd::root(3, decimal(2.0));
        assert!(((&x * &y).to_f64() - x.to_f64() * y.to_f64()).abs() < 1e-13);
    }

    #[test]
    fn the_square_of_a_root_is_whole() {
        let six = Surd::root(3, BigRational::one());
        assert_eq!(&six * &six, Surd::integer(6));
        assert!((&(&six * &six) - &Surd::integer(6)).is_zero());
    }
}
