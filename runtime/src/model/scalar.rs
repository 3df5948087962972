//! One sample at a time.

use super::lanes::{LANES, Lanes};
use super::number::Number;

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
    fn inverse_root(self) -> f64 {
        if self > 0.0 { self.sqrt().recip() } else { 0.0 }
    }

    #[inline(always)]
    fn sin_cos_each<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
        let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
        for first in (0..N).step_by(LANES) {
            let four = Lanes::new(std::array::from_fn(|k| angles[(first + k).min(N - 1)]));
            // Half an ulp better than the polynomials of the lanes, which are made for speed.
            let (s, c) = four.simd().sin_cos();
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
