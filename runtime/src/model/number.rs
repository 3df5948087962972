//! The number types that a model can be evaluated in.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number that closed-form dynamics can be evaluated in: `f64`, four `f64` lanes, or a dual number.
///
/// The generated code is generic over this trait and uses nothing else.
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The number that stands for a constant of the robot's table.
    fn constant(value: f64) -> Self;

    /// Sine and cosine of an angle in rad.
    fn sin_cos(self) -> (Self, Self);

    /// Sines and cosines of several angles in rad; overridden where evaluating them together is faster.
    fn sin_cos_each<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
        let mut sines = [Self::constant(0.0); N];
        let mut cosines = [Self::constant(0.0); N];
        for (k, angle) in angles.into_iter().enumerate() {
            (sines[k], cosines[k]) = angle.sin_cos();
        }
        (sines, cosines)
    }

    /// -1, 0 or 1 with the sign of the number; 0 for 0. Its derivative is 0.
    fn sign(self) -> Self;

    /// 1 / sqrt(self); 0 where the number is not above 0, and so is its derivative.
    fn inverse_root(self) -> Self;

    /// self + a * b, rounded once where the machine has a fused multiply-add.
    #[inline(always)]
    fn add_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }

    /// self - a * b, rounded once where the machine has a fused multiply-add.
    #[inline(always)]
    fn sub_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
}
