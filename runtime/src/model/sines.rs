//! Sines and cosines of four angles at a time.
//!
//! Both ways reduce an angle to [-pi/4, pi/4] by three parts of pi/2 (Cody and Waite 1980) and take the polynomials of the
//! Cephes library (Moshier 1989). They differ in how these are summed.

use wide::{f64x4, u64x4};

/// Angles up to here, rad, are reduced to a quarter turn with full accuracy by three parts of pi/2.
pub(super) const REDUCIBLE: f64 = 1e5;

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

/// Sines and cosines below [`REDUCIBLE`] with an error below 2 units in the last place of 1: for batches, where the fewest
/// operations count.
#[inline(always)]
pub(super) fn fast_sin_cos(x: f64x4) -> (f64x4, f64x4) {
    let c = f64x4::splat;
    let shifted = x.mul_add(c(std::f64::consts::FRAC_2_PI), c(SHIFT));
    let turns = shifted - c(SHIFT);
    let r = turns.mul_neg_add(c(1.5707963267341256), x);
    let r = turns.mul_neg_add(c(6.077100506303966e-11), r);
    let r = turns.mul_neg_add(c(2.0222662487959506e-21), r);
    let rr = r * r;
    let r4 = rr * rr;
    // Estrin's scheme: short chains, so that several angles overlap.
    let polynomial = |k: [f64; 6]| {
        let (k01, k23) = (rr.mul_add(c(k[1]), c(k[0])), rr.mul_add(c(k[3]), c(k[2])));
        r4.mul_add(r4.mul_add(rr.mul_add(c(k[5]), c(k[4])), k23), k01)
    };
    in_their_quarter(shifted, r, rr, r4, polynomial)
}

/// Sines and cosines below [`REDUCIBLE`] with an error of a unit in the last place of 1: for one state, whose angles stand
/// side by side. The digits are those of `wide`'s own `sin_cos`, whose conversion to integers takes half of its time.
#[inline(always)]
pub(super) fn sin_cos(x: f64x4) -> (f64x4, f64x4) {
    let c = f64x4::splat;
    let turns = (x * c(std::f64::consts::FRAC_2_PI)).round_ties_even();
    let r = turns.mul_neg_add(c(1.570_796_310_901_641_8), x);
    let r = turns.mul_neg_add(c(1.589_325_471_229_585_7e-8), r);
    let r = turns.mul_neg_add(c(6.123_233_995_736_766e-17), r);
    let rr = r * r;
    let r4 = rr * rr;
    let r8 = r4 * r4;
    // The largest terms last.
    let polynomial = |k: [f64; 6]| {
        let (k01, k23) = (rr.mul_add(c(k[1]), c(k[0])), rr.mul_add(c(k[3]), c(k[2])));
        k23.mul_add(r4, rr.mul_add(c(k[5]), c(k[4])).mul_add(r8, k01))
    };
    in_their_quarter(turns + c(SHIFT), r, rr, r4, polynomial)
}

/// Sine and cosine from the reduced angle r, its powers and the quarter turns in the low bits of `shifted`: odd ones swap
/// both, the second bit turns the sign.
#[inline(always)]
fn in_their_quarter(
    shifted: f64x4,
    r: f64x4,
    rr: f64x4,
    r4: f64x4,
    polynomial: impl Fn([f64; 6]) -> f64x4,
) -> (f64x4, f64x4) {
    let sine = (r * rr).mul_add(polynomial(SINE), r);
    let cosine = r4.mul_add(polynomial(COSINE), rr.mul_neg_add(f64x4::splat(0.5), f64x4::splat(1.0)));
    let (bits, one, two) = (shifted.to_bits(), u64x4::splat(1), u64x4::splat(2));
    let odd = f64x4::from_bits(u64x4::splat(0) - (bits & one));
    let sine_sign = f64x4::from_bits((bits & two) << 62);
    let cosine_sign = f64x4::from_bits(((bits + one) & two) << 62);
    (odd.select(cosine, sine) ^ sine_sign, odd.select(sine, cosine) ^ cosine_sign)
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
    fn the_digits_of_one_state_are_those_of_wide() {
        for x in angles().filter(|&x| x != 0.0) {
            let found = sin_cos(f64x4::splat(x));
            let expected = f64x4::splat(x).sin_cos();
            assert_eq!(found.0.to_bits(), expected.0.to_bits(), "sine of {x}");
            assert_eq!(found.1.to_bits(), expected.1.to_bits(), "cosine of {x}");
        }
    }

    #[test]
    fn errors_are_a_unit_for_one_state_and_two_for_batches() {
        let mut worst = [0.0_f64; 2];
        for x in angles() {
            for (worst, (s, c)) in
                worst.iter_mut().zip([sin_cos(f64x4::splat(x)), fast_sin_cos(f64x4::splat(x))])
            {
                *worst = worst.max((s.to_array()[0] - x.sin()).abs()).max((c.to_array()[3] - x.cos()).abs());
            }
        }
        assert!(worst[0] <= f64::EPSILON && worst[1] < 2.0 * f64::EPSILON, "{worst:?}");
    }

    #[test]
    fn a_sine_turns_its_sign_with_the_angle_and_a_cosine_does_not() {
        for x in angles().filter(|&x| x != 0.0) {
            for way in [sin_cos, fast_sin_cos] {
                let ((s, c), (minus, same)) = (way(f64x4::splat(x)), way(f64x4::splat(-x)));
                assert_eq!((s.to_array(), c.to_array()), ((-minus).to_array(), same.to_array()), "{x}");
            }
        }
    }
}
