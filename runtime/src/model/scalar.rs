//! One sample at a time.

use super::lanes::LANES;
use super::number::Number;
use super::sines::{REDUCIBLE, sin_cos};
use wide::f64x4;

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
        // The sum of all sizes bounds each of them, and is NaN where one is.
        let near = angles.iter().fold(0.0, |sum, a| sum + a.abs()) < REDUCIBLE;
        if !near {
            return one_by_one(angles);
        }
        let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
        for first in (0..N).step_by(LANES) {
            let (s, c) = sin_cos(f64x4::new(std::array::from_fn(|k| angles[(first + k).min(N - 1)])));
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

/// For angles beyond [`REDUCIBLE`] and what is not finite.
#[cold]
#[inline(never)]
fn one_by_one<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    let pairs = angles.map(f64::sin_cos);
    (pairs.map(|p| p.0), pairs.map(|p| p.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_a_state_are_taken_together() {
        let angles = [0.1, -2.0, 30.0, -0.7, 99.0];
        let (sines, cosines) = f64::sin_cos_each(angles);
        for (k, x) in angles.into_iter().enumerate() {
            assert!(
                (sines[k] - x.sin()).abs() <= f64::EPSILON && (cosines[k] - x.cos()).abs() <= f64::EPSILON
            );
        }
    }

    #[test]
    fn huge_and_undefined_angles_are_as_the_standard_library_has_them() {
        let angles = [1e9, -3e300, 0.0, 0.5, 2e5];
        let (sines, cosines) = f64::sin_cos_each(angles);
        assert_eq!(sines, angles.map(f64::sin));
        assert_eq!(cosines, angles.map(f64::cos));
        for undefined in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let ([s, other], [c, _]) = f64::sin_cos_each([undefined, 0.5]);
            assert!(s.is_nan() && c.is_nan() && other == 0.5_f64.sin());
        }
    }
}
