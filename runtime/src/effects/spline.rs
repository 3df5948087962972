//! Smooth curves over an interval, and the few functions that products of two variables are made of.

/// Functions of smooth curves on four equal intervals between the knots: bends as wide as a quarter of the data are followed.
pub(super) const SPLINES: usize = 6;
/// Functions of curves on twelve: bends as narrow as a twelfth of the data are followed.
pub(super) const FINE_SPLINES: usize = 14;
/// Functions of [`bends`].
pub(super) const BENDS: usize = 3;

/// `N` smooth steps from 0 to 1, one after the other over x in -1..=1: sums of the cubic B-splines on N - 2 equal intervals
/// from one of them on (Ramsay 1988; de Boor 1978). With an offset they make every cubic spline, and amplitudes that are kept
/// small keep the differences of its coefficients small (Eilers and Marx 1996): where no data say more, a curve goes on
/// as a constant. Beyond the interval it stays what it is at its end.
pub(super) fn steps<const N: usize>(x: f64) -> [f64; N] {
    let intervals = N - 2;
    let u = 0.5 * (x.clamp(-1.0, 1.0) + 1.0) * intervals as f64;
    let first = (u as usize).min(intervals - 1);
    let t = u - first as f64;
    let r = 1.0 - t;
    let values = [
        r * r * r / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * r * r * r - 6.0 * r * r + 4.0) / 6.0,
        t * t * t / 6.0,
    ];
    let mut out = [0.0; N];
    // Step k is the sum of the splines from k + 1 on; spline 0 is in none of them.
    let mut sum = 0.0;
    for k in (0..N).rev() {
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
        for (k, step) in steps::<SPLINES>(0.3).iter().enumerate() {
            approx::assert_relative_eq!(*step, splines[k + 1..].iter().sum::<f64>(), epsilon = 1e-12);
        }
    }

    #[test]
    fn with_an_offset_they_make_every_cubic() {
        use nalgebra::{DMatrix, DVector};
        let x: Vec<f64> = (0..41).map(|k| f64::from(k) / 20.0 - 1.0).collect();
        let basis = DMatrix::from_fn(x.len(), SPLINES + 1, |r, c| {
            if c == SPLINES { 1.0 } else { steps::<SPLINES>(x[r])[c] }
        });
        let cubic = DVector::from_iterator(x.len(), x.iter().map(|x| 2.0 * x * x * x - x * x + 0.3));
        let fitted = basis.clone().svd(true, true).solve(&cubic, 1e-12).expect("it has both sides");
        assert!((basis * fitted - cubic).amax() < 1e-10);
    }

    #[test]
    fn fine_steps_follow_a_bump_that_coarse_ones_miss() {
        use nalgebra::{DMatrix, DVector};
        fn missed<const N: usize>() -> f64 {
            let x: Vec<f64> = (0..201).map(|k| f64::from(k) / 100.0 - 1.0).collect();
            let column = |r: usize, c: usize| if c == N { 1.0 } else { steps::<N>(x[r])[c] };
            let basis = DMatrix::from_fn(x.len(), N + 1, column);
            let bump = |x: &f64| (-0.5 * ((x - 0.2) / 0.13).powi(2)).exp();
            let bump = DVector::from_iterator(x.len(), x.iter().map(bump));
            let fitted = basis.clone().svd(true, true).solve(&bump, 1e-12).expect("it has both sides");
            (basis * fitted - &bump).norm() / bump.norm()
        }
        assert!(missed::<SPLINES>() > 0.4, "{}", missed::<SPLINES>());
        assert!(missed::<FINE_SPLINES>() < 0.05, "{}", missed::<FINE_SPLINES>());
    }

    #[test]
    fn beyond_the_data_curves_stay_what_they_are_at_the_end() {
        assert_eq!(steps::<SPLINES>(1.0), steps(7.0));
        assert_eq!(steps::<FINE_SPLINES>(-1.0), steps(-1.5));
        assert_eq!(bends(1.0), bends(3.0));
        assert_ne!(steps::<SPLINES>(0.5), steps(1.0));
    }
}
