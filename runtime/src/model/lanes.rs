//! Four samples at a time.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::number::Number;
use super::sines::{REDUCIBLE, sin_cos};
use wide::f64x4;

/// Samples in a [`Lanes`].
pub const LANES: usize = 4;

/// Four `f64` side by side: the number type of batches.
///
/// ```
/// use dynid_runtime::model::{Lanes, Number};
///
/// let angles = Lanes::new([0.0, 0.1, 0.2, 0.3]);
/// let (sines, _) = angles.sin_cos();
/// assert!((sines.to_array()[3] - 0.3_f64.sin()).abs() < 1e-15);
/// assert_eq!((angles + Lanes::splat(1.0)).to_array()[1], 1.1);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(transparent)]
pub struct Lanes(f64x4);

impl Lanes {
    /// One value per lane.
    #[inline(always)]
    pub fn new(values: [f64; LANES]) -> Self {
        Self(f64x4::new(values))
    }

    /// The same value in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self(f64x4::splat(value))
    }

    /// The value of each lane.
    #[inline(always)]
    pub fn to_array(self) -> [f64; LANES] {
        self.0.to_array()
    }

    /// As the vector that the machine computes with.
    #[inline(always)]
    pub(crate) fn simd(self) -> f64x4 {
        self.0
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self(self.0 - o.0)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0)
    }
}

impl Div for Lanes {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        Self(self.0 / o.0)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        self.0 -= o.0;
    }
}

impl Number for Lanes {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = if self.0.abs().simd_lt(f64x4::splat(REDUCIBLE)).all() {
            sin_cos(self.0)
        } else {
            each_sin_cos(self.0)
        };
        (Self(sine), Self(cosine))
    }

    /// All angles are reduced together, with one test for the rare large one.
    #[inline(always)]
    fn sin_cos_each<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
        let largest = angles.iter().fold(f64x4::splat(0.0), |m, a| m.max(a.0.abs()));
        let (mut sines, mut cosines) = ([Self::splat(0.0); N], [Self::splat(0.0); N]);
        if largest.simd_lt(f64x4::splat(REDUCIBLE)).all() {
            for k in 0..N {
                (sines[k].0, cosines[k].0) = sin_cos(angles[k].0);
            }
        } else {
            for k in 0..N {
                (sines[k].0, cosines[k].0) = each_sin_cos(angles[k].0);
            }
        }
        (sines, cosines)
    }

    #[inline(always)]
    fn sign(self) -> Self {
        let zero = f64x4::splat(0.0);
        let positive = self.0.simd_gt(zero).select(f64x4::splat(1.0), zero);
        Self(self.0.simd_lt(zero).select(f64x4::splat(-1.0), positive))
    }

    #[inline(always)]
    fn inverse_root(self) -> Self {
        let zero = f64x4::splat(0.0);
        Self(self.0.simd_gt(zero).select(f64x4::splat(1.0) / self.0.sqrt(), zero))
    }

    #[inline(always)]
    fn add_product(self, a: Self, b: Self) -> Self {
        Self(a.0.mul_add(b.0, self.0))
    }

    #[inline(always)]
    fn sub_product(self, a: Self, b: Self) -> Self {
        Self(a.0.mul_neg_add(b.0, self.0))
    }
}

/// Lane by lane, for angles beyond [`REDUCIBLE`] and what is not finite.
#[cold]
#[inline(never)]
fn each_sin_cos(angles: f64x4) -> (f64x4, f64x4) {
    let pairs = angles.to_array().map(f64::sin_cos);
    (f64x4::new(pairs.map(|p| p.0)), f64x4::new(pairs.map(|p| p.1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_and_undefined_angles_are_as_the_standard_library_has_them() {
        let ([s], [c]) = Lanes::sin_cos_each([Lanes::new([1e9, -3e300, 0.0, 0.5])]);
        for (lane, x) in [1e9_f64, -3e300, 0.0, 0.5].into_iter().enumerate() {
            assert_eq!((s.to_array()[lane], c.to_array()[lane]), x.sin_cos());
        }
        let ([s], [c]) = Lanes::sin_cos_each([Lanes::new([f64::NAN, f64::INFINITY, 1.0, 1.0])]);
        assert!(s.to_array()[0].is_nan() && c.to_array()[1].is_nan());
        let ([s], _) = Lanes::sin_cos_each([Lanes::new([f64::NAN, 1.0, 1.0, 1.0])]);
        assert!(s.to_array()[0].is_nan() && s.to_array()[1].is_finite());
    }

    #[test]
    fn signs_and_fused_products_go_lane_by_lane() {
        let x = Lanes::new([-2.0, 0.0, 3.0, -0.0]);
        assert_eq!(x.sign().to_array(), [-1.0, 0.0, 1.0, 0.0]);
        assert_eq!(Lanes::new([4.0, 0.0, -1.0, 0.25]).inverse_root().to_array(), [0.5, 0.0, 0.0, 2.0]);
        let y = x.add_product(x, x).sub_product(Lanes::splat(2.0), x);
        assert_eq!(y.to_array(), [6.0, 0.0, 6.0, 0.0]);
    }
}
