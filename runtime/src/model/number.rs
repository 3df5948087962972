//! The number types that a model can be evaluated in.

use super::lanes::{LANES, Lanes};
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

impl Number for f64 {
    #[inline(always)]
    fn constant(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn sin_cos(self) -> (f64, f64) {
        f64::sin_cos(self)
    }

    #[inline(always)]
    fn sign(self) -> f64 {
        if self > 0.0 {
            1.0
        } else if self < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    #[inline(always)]
    fn sin_cos_each<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
        let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
        for first in (0..N).step_by(LANES) {
            let four = Lanes::new(std::array::from_fn(|k| angles[(first + k).min(N - 1)]));
            let (s, c) = four.sin_cos();
            let (s, c) = (s.to_array(), c.to_array());
            for k in 0..LANES.min(N - first) {
                (sines[first + k], cosines[first + k]) = (s[k], c[k]);
            }
        }
        (sines, cosines)
    }

    #[inline(always)]
    fn add_product(self, a: f64, b: f64) -> f64 {
        // Without the instruction a fused multiply-add is a slow library call.
        if cfg!(target_feature = "fma") { a.mul_add(b, self) } else { self + a * b }
    }

    #[inline(always)]
    fn sub_product(self, a: f64, b: f64) -> f64 {
        if cfg!(target_feature = "fma") { (-a).mul_add(b, self) } else { self - a * b }
    }
}
