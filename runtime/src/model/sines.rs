//! Sines and cosines of four angles at a time.
//!
//! An angle is reduced to [-pi/4, pi/4] by parts of pi/2 (Cody and Waite 1980), two where products are fused with sums and three
//! elsewhere; the polynomials are those of the Cephes library (Moshier 1989).

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use wide::{f64x4, u64x4};

/// Angles up to here, rad, are reduced to a quarter turn with full accuracy.
pub(super) const REDUCIBLE: f64 = 1e5;

/// Whether [`wide`] rounds a product and its sum once.
const FUSED: bool = cfg!(any(target_feature = "fma", all(target_feature = "neon", target_arch = "aarch64")));

/// Added to a number it leaves the nearest integer in the low bits of the mantissa: 1.5 * 2^52. The quarter turn is read from
/// there, which no conversion to integers has to make.
const SHIFT: f64 = 6755399441055744.0;

/// Coefficients from the third power of the sine's argument on.
const SINE: [f64; 6] = [
    -1.666_666_666_666_663e-1,
    8.333_333_333_322_118e-3,
    -1.984_126_982_958_954e-4,
    2.755_731_362_138_572_5e-6,
    -2.505_074_776_285_780_7e-8,
    1.589_623_015_765_465_6e-10,
];

/// Coefficients from the fourth power of the cosine's argument on.
const COSINE: [f64; 6] = [
    4.166_666_666_666_659_3e-2,
    -1.388_888_888_887_305_6e-3,
    2.480_158_728_885_170_5e-5,
    -2.755_731_417_929_674e-7,
    2.087_570_084_197_473e-9,
    -1.135_853_652_138_768_2e-11,
];

/// Sines and cosines below [`REDUCIBLE`] with an error of a unit in the last place of 1 at most.
#[inline(always)]
pub(super) fn sin_cos(x: f64x4) -> (f64x4, f64x4) {
    let c = f64x4::splat;
    let shifted = x.mul_add(c(FRAC_2_PI), c(SHIFT));
    let r = reduced(x, shifted - c(SHIFT));
    let rr = r * r;
    let r4 = rr * rr;
    // Estrin's scheme: short chains, because one state waits for its sines, and the angles of a batch overlap.
    let polynomial = |k: [f64; 6]| {
        let (k01, k23) = (rr.mul_add(c(k[1]), c(k[0])), rr.mul_add(c(k[3]), c(k[2])));
        r4.mul_add(r4.mul_add(rr.mul_add(c(k[5]), c(k[4])), k23), k01)
    };
    let sine = (r * rr).mul_add(polynomial(SINE), r);
    let cosine = r4.mul_add(polynomial(COSINE), rr.mul_neg_add(c(0.5), c(1.0)));
    // The quarter turns are in the low bits: odd ones swap both, the second bit turns the sign.
    let (bits, one, two) = (shifted.to_bits(), u64x4::splat(1), u64x4::splat(2));
    let odd = f64x4::from_bits(u64x4::splat(0) - (bits & one));
    let sine_sign = f64x4::from_bits((bits & two) << 62);
    let cosine_sign = f64x4::from_bits(((bits + one) & two) << 62);
    (odd.select(cosine, sine) ^ sine_sign, odd.select(sine, cosine) ^ cosine_sign)
}

/// An angle less whole quarter turns.
#[inline(always)]
fn reduced(x: f64x4, turns: f64x4) -> f64x4 {
    let less = |x: f64x4, part: f64| turns.mul_neg_add(f64x4::splat(part), x);
    if FUSED {
        // The first difference is exact: a multiple of 2^-53 below 1.
        less(less(x, FRAC_PI_2), 6.123_233_995_736_766e-17)
    } else {
        // Parts whose products with so few turns are exact.
        let nearly = less(less(x, 1.570_796_310_901_641_8), 1.589_325_471_229_585_7e-8);
        less(nearly, 6.123_233_995_736_766e-17)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angles of every size that is reduced, of both signs, and those about the borders of the quarters.
    fn angles() -> impl Iterator<Item = f64> {
        let any = (0..400_000).map(|k| f64::from(k - 200_000) * [3.713e-4, 0.4999, 1e-9][k as usize % 3]);
        let borders = (-4000..4000).flat_map(|k| {
            let border = f64::from(k) * std::f64::consts::FRAC_PI_4;
            [border.next_down(), border, border.next_up()]
        });
        any.chain(borders)
    }

    #[test]
    fn errors_are_a_unit_in_the_last_place_of_1_at_most() {
        for x in angles() {
            let (s, c) = sin_cos(f64x4::splat(x));
            let error = (s.to_array()[0] - x.sin()).abs().max((c.to_array()[3] - x.cos()).abs());
            assert!(error <= f64::EPSILON, "{x}: {error:e}");
        }
    }

    #[test]
    fn a_sine_turns_its_sign_with_the_angle_and_a_cosine_does_not() {
        for x in angles().filter(|&x| x != 0.0) {
            let ((s, c), (minus, same)) = (sin_cos(f64x4::splat(x)), sin_cos(f64x4::splat(-x)));
            assert_eq!((s.to_array(), c.to_array()), ((-minus).to_array(), same.to_array()), "{x}");
        }
    }
}
