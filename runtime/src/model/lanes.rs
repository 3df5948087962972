//! Four samples at a time.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::number::Number;
use wide::{f64x4, u64x4};

/// Samples in a [`Lanes`].
pub const LANES: usize = 4;

/// Angles up to here, rad, are reduced to a quarter turn with full accuracy by three parts of pi/2.
const REDUCIBLE: f64 = 1e5;

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
            reduced_sin_cos(self.0)
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
                (sines[k].0, cosines[k].0) = reduced_sin_cos(angles[k].0);
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

/// Sine and cosine by reduction to [-pi/4, pi/4] (Cody and Waite 1980) and the polynomials of the Cephes library
/// (Moshier 1989). The quarter turn is read from the low bits of a float, which no conversion to integers has to
/// make. Error below 2 units in the last place of 1.
#[inline(always)]
fn reduced_sin_cos(x: f64x4) -> (f64x4, f64x4) {
    let c = f64x4::splat;
    // Adding 1.5 * 2^52 leaves the nearest integer in the low bits of the mantissa.
    let shifted = x.mul_add(c(std::f64::consts::FRAC_2_PI), c(6755399441055744.0));
    let turns = shifted - c(6755399441055744.0);
    let bits = shifted.to_bits();
    let r = turns.mul_neg_add(c(1.5707963267341256), x);
    let r = turns.mul_neg_add(c(6.077100506303966e-11), r);
    let r = turns.mul_neg_add(c(2.0222662487959506e-21), r);
    let rr = r * r;
    let r4 = rr * rr;
    // Estrin's scheme: short chains, so that several angles overlap.
    let s01 = rr.mul_add(c(8.333_333_333_322_118e-3), c(-1.666_666_666_666_663e-1));
    let s23 = rr.mul_add(c(2.755_731_362_138_572e-6), c(-1.984_126_982_958_954e-4));
    let s45 = rr.mul_add(c(1.589_623_015_765_465_6e-10), c(-2.505_074_776_285_780_7e-8));
    let sine = r4.mul_add(r4.mul_add(s45, s23), s01);
    let sine = (r * rr).mul_add(sine, r);
    let c01 = rr.mul_add(c(-1.388_888_888_887_305_6e-3), c(4.166_666_666_666_659_3e-2));
    let c23 = rr.mul_add(c(-2.755_731_429_177_397e-7), c(2.480_158_728_885_171_8e-5));
    let c45 = rr.mul_add(c(-1.135_853_652_138_768_2e-11), c(2.087_570_084_197_473e-9));
    let cosine = r4.mul_add(r4.mul_add(c45, c23), c01);
    let cosine = r4.mul_add(cosine, rr.mul_neg_add(c(0.5), c(1.0)));
    // Odd quarters swap, the second bit turns the sign.
    let (one, two) = (u64x4::splat(1), u64x4::splat(2));
    let odd = f64x4::from_bits(u64x4::splat(0) - (bits & one));
    let sine_sign = f64x4::from_bits((bits & two) << 62);
    let cosine_sign = f64x4::from_bits(((bits + one) & two) << 62);
    (odd.select(cosine, sine) ^ sine_sign, odd.select(sine, cosine) ^ cosine_sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_are_those_of_the_standard_library() {
        let mut worst = 0.0_f64;
        for k in 0..400_000 {
            let x = f64::from(k - 200_000) * 0.000_371_3 * if k % 7 == 0 { 1000.0 } else { 1.0 };
            let (s, c) = Lanes::splat(x).sin_cos();
            worst = worst.max((s.to_array()[0] - x.sin()).abs()).max((c.to_array()[3] - x.cos()).abs());
        }
        assert!(worst < 2.0 * f64::EPSILON, "{worst}");
    }

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
