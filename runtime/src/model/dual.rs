//! Dual numbers: a value and its derivative with respect to one quantity.

use super::number::Number;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// v + d·ε with ε² = 0 (Clifford 1873): evaluating a model in it gives the model and one exact derivative, of one
/// sample, or of as many as there are lanes in `T`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dual<T = f64> {
    /// The value.
    pub value: T,
    /// The derivative.
    pub slope: T,
}

impl<T> Dual<T> {
    /// A value with a derivative.
    pub fn new(value: T, slope: T) -> Self {
        Self { value, slope }
    }
}

impl<T: Number> Add for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.value + o.value, self.slope + o.slope)
    }
}

impl<T: Number> Sub for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.value - o.value, self.slope - o.slope)
    }
}

impl<T: Number> Mul for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self::new(self.value * o.value, self.value * o.slope + self.slope * o.value)
    }
}

impl<T: Number> Div for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        Self::new(value, (self.slope - value * o.slope) / o.value)
    }
}

impl<T: Number> Neg for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value, -self.slope)
    }
}

impl<T: Number> AddAssign for Dual<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<T: Number> SubAssign for Dual<T> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl<T: Number> Number for Dual<T> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::new(T::constant(value), T::constant(0.0))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (Self::new(s, c * self.slope), Self::new(c, -s * self.slope))
    }

    #[inline(always)]
    fn sign(self) -> Self {
        Self::new(self.value.sign(), T::constant(0.0))
    }

    #[inline(always)]
    fn inverse_root(self) -> Self {
        let root = self.value.inverse_root();
        Self::new(root, -T::constant(0.5) * root * root * root * self.slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_compound_expressions_agree_with_central_differences() {
        fn f<T: Number>(x: T) -> T {
            let (s, c) = (x * x).sin_cos();
            s * c / (x + T::constant(2.0)) - -x + (x * x + T::constant(0.3)).inverse_root()
        }
        let h = 1e-6;
        for x in [-1.3, 0.0, 0.4, 2.2] {
            let exact = f(Dual::new(x, 1.0));
            assert!((exact.value - f(x)).abs() < 1e-15);
            assert!((exact.slope - (f(x + h) - f(x - h)) / (2.0 * h)).abs() < 1e-8);
        }
    }

    #[test]
    fn the_sign_has_no_slope() {
        assert_eq!(Number::sign(Dual::new(-2.0, 5.0)), Dual::new(-1.0, 0.0));
    }
}
