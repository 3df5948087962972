//! Smooth curves over an interval, and the few functions that products of two variables are made of.

/// Equal intervals between the knots: bends as narrow as a quarter of the data are followed.
const INTERVALS: usize = 4;
/// Functions of [`steps`].
pub(super) const SPLINES: usize = INTERVALS + 2;
/// Functions of [`bends`].
pub(super) const BENDS: usize = 3;

/// Smooth steps from 0 to 1, one after the other over x in -1..=1: sums of the cubic B-splines on equal intervals from
/// one of them on (Ramsay 1988; de Boor 1978). With an offset they make every cubic spline, and amplitudes that are kept
/// small keep the differences of its coefficients small (Eilers and Marx 1996): where no data say more, a curve goes on
/// as a constant. Beyond the interval it stays what it is at its end.
pub(super) fn steps(x: f64) -> [f64; SPLINES] {
    let u = 0.5 * (x.clamp(-1.0, 1.0) + 1.0) * INTERVALS as f64;
    let first = (u as usize).min(INTERVALS - 1);
    let t = u - first as f64;
    let r = 1.0 - t;
    let values = [
        r * r * r / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * r * r * r - 6.0 * r * r + 4.0) / 6.0,
        t * t * t / 6.0,
    ];
    let mut out = [0.0; SPLINES];
    // Step k is the sum of the splines from k + 1 on; spline 0 is in none of them.
    let mut sum = 0.0;
    for k in (0..SPLINES).rev() {
        sum += (k + 1).checked_sub(first).and_then(|i| values.get(i)).copied().unwrap_or(0.0);
        out[k] = sum;
    }
    out
}

/// Legendre's polynomials of degree 1 to 3 at x, which is held within -1..=1.
pub(super) fn bends(x: f64) -> [f64; BENDS] {
    let x = x.clamp(-1.0, 1.0);
    [x, 0.5 * (3.0 * x * x - 1.0), 0.5 * (5.0 * x * x - 3.0) * x]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_sums_of_the_splines_of_de_boor() {
        // The recurrence of Cox and de Boor on the knots -2.5, -2, ... 2.5 at 0.3.
        let splines = [0.0, 0.0, 0.064 / 6.0, 2.488 / 6.0, 3.232 / 6.0, 0.036, 0.0];
        for (k, step) in steps(0.3).iter().enumerate() {
            approx::assert_relative_eq!(*step, splines[k + 1..].iter().sum::<f64>(), epsilon = 1e-12);
        }
    }

    #[test]
    fn with_an_offset_they_make_every_cubic() {
        use nalgebra::{DMatrix, DVector};
        let x: Vec<f64> = (0..41).map(|k| f64::from(k) / 20.0 - 1.0).collect();
        let basis =
            DMatrix::from_fn(x.len(), SPLINES + 1, |r, c| if c == SPLINES { 1.0 } else { steps(x[r])[c] });
        let cubic = DVector::from_iterator(x.len(), x.iter().map(|x| 2.0 * x * x * x - x * x + 0.3));
        let fitted = basis.clone().svd(true, true).solve(&cubic, 1e-12).expect("it has both sides");
        assert!((basis * fitted - cubic).amax() < 1e-10);
    }

    #[test]
    fn beyond_the_data_curves_stay_what_they_are_at_the_end() {
        assert_eq!(steps(1.0), steps(7.0));
        assert_eq!(steps(-1.0), steps(-1.5));
        assert_eq!(bends(1.0), bends(3.0));
        assert_ne!(steps(0.5), steps(1.0));
    }
}
