use proptest::prelude::*;

use super::Decimator;
use crate::signal::SignalError;
use crate::signal::oracle::{oracle, worst};

fn decimator(factor: usize) -> Decimator {
    Decimator::new(factor).expect("a positive factor")
}

#[test]
fn taps_and_rows_agree_with_scipy() {
    for case in oracle().decimate {
        let d = decimator(case.factor);
        assert!(worst(d.taps(), &case.taps) < 1e-12);
        assert_eq!(d.support(), 10 * case.factor);
        // scipy keeps the samples 0, factor, 2 factor, ...; the first with its whole support inside is `first`.
        let from = case.first * case.factor - d.support();
        let mut out = vec![0.0; case.output.len()];
        assert_eq!(d.decimate_run(&case.input[from..], &mut out), case.output.len());
        assert!(worst(&out, &case.output) < 1e-9);
    }
}

#[test]
fn the_pass_band_is_flat_and_the_stop_band_is_stopped() {
    for factor in [2, 5, 10, 50] {
        let d = decimator(factor);
        let nyquist = 0.5 / factor as f64;
        for k in 0..=100 {
            let f = k as f64 / 100.0;
            let pass = d.response(0.83 * f * nyquist);
            assert!((pass - 1.0).abs() < 3.5e-3, "factor {factor}: {pass} at {}", 0.83 * f);
            let stop = d.response(1.17 * nyquist + f * (0.5 - 1.17 * nyquist));
            assert!(stop.abs() < 3.2e-3, "factor {factor}: {stop}");
        }
        assert!((d.response(nyquist) - 0.5).abs() < 0.01);
    }
}

#[test]
fn a_narrower_band_keeps_the_shape() {
    let d = Decimator::with_band(10, 0.5).expect("valid");
    assert_eq!(d.factor(), 10);
    assert_eq!(d.support(), 200);
    assert!((d.response(0.8 * 0.025) - 1.0).abs() < 3.5e-3);
    assert!(d.response(1.2 * 0.025).abs() < 3.2e-3);
}

#[test]
fn factor_one_changes_nothing() {
    let d = decimator(1);
    let x = [3.0, -1.0, 2.5];
    let mut out = [0.0; 3];
    assert_eq!(d.decimate_run(&x, &mut out), 3);
    assert_eq!(out, x);
    assert_eq!(d.support(), 0);
}

#[test]
fn columns_together_are_the_columns_one_by_one() {
    let d = decimator(5);
    let (columns, stride) = (11, 230);
    let x: Vec<f64> = (0..columns * stride).map(|k| (k as f64 * 0.37).sin() + (k % 7) as f64).collect();
    let rows = d.kept_rows(0..stride).count;
    let mut together = vec![0.0; columns * rows];
    assert_eq!(d.decimate_columns(&x, stride, &mut together), rows);
    for c in 0..columns {
        let mut one = vec![0.0; rows];
        d.decimate_run(&x[c * stride..(c + 1) * stride], &mut one);
        assert!(worst(&together[c * rows..(c + 1) * rows], &one) < 1e-14, "column {c}");
    }
}

#[test]
fn blocks_with_the_overlap_give_the_rows_of_the_whole() {
    let d = decimator(7);
    let x: Vec<f64> = (0..1000).map(|k| (k as f64 * 0.11).cos()).collect();
    let mut whole = vec![0.0; d.kept_rows(0..1000).count];
    d.decimate_run(&x, &mut whole);
    let mut at = 0;
    let mut pieces = Vec::new();
    while pieces.len() < whole.len() {
        let rows = 10.min(whole.len() - pieces.len());
        let mut out = vec![0.0; rows];
        assert_eq!(d.decimate_run(&x[at..at + d.input_len(rows)], &mut out), rows);
        pieces.extend(out);
        at += rows * d.factor();
    }
    assert_eq!(pieces, whole);
}

#[test]
fn kept_rows_have_their_whole_support_inside_the_valid_samples() {
    let d = decimator(4);
    let kept = d.kept_rows(100..300);
    let centres: Vec<usize> = kept.centres().collect();
    assert_eq!(centres.first(), Some(&140));
    assert!(centres.last().is_some_and(|c| c + d.support() < 300 && c + d.support() + 4 >= 300));
    assert_eq!(d.kept_rows(0..80).count, 0);
    assert_eq!(d.kept_rows(0..81).count, 1);
    assert_eq!(d.kept_rows(5..5).count, 0);
}

#[test]
fn misuse_is_told() {
    assert!(Decimator::new(0).is_err());
    assert!(Decimator::with_band(3, 0.0).is_err());
    assert!(Decimator::with_band(3, f64::NAN).is_err());
    assert_eq!(Decimator::factor_for(5000.0, 100.0), 50);
    assert_eq!(Decimator::factor_for(95.0, 100.0), 1);
    assert_eq!(Decimator::factor_for(1000.0, 0.0), 1);
}

proptest! {
    #[test]
    fn a_constant_passes_unchanged(level in -1e3f64..1e3, factor in 1usize..60) {
        let d = decimator(factor);
        let mut out = [0.0; 3];
        prop_assert_eq!(d.decimate_run(&vec![level; d.input_len(3)], &mut out), 3);
        for x in out {
            prop_assert!((x - level).abs() <= 1e-12 * level.abs());
        }
    }

    #[test]
    fn taps_are_symmetric_so_the_phase_is_linear(factor in 1usize..80, band in 0.2..1.0) {
        let d = Decimator::with_band(factor, band).expect("valid");
        let n = d.taps().len();
        prop_assert_eq!(n % 2, 1);
        for i in 0..n {
            prop_assert_eq!(d.taps()[i].to_bits(), d.taps()[n - 1 - i].to_bits());
        }
    }

    #[test]
    fn a_straight_line_comes_out_where_its_rows_are_centred(slope in -3.0f64..3.0, factor in 2usize..40) {
        let d = decimator(factor);
        let x: Vec<f64> = (0..d.input_len(5)).map(|k| slope * k as f64).collect();
        let mut out = [0.0; 5];
        d.decimate_run(&x, &mut out);
        for (c, y) in d.kept_rows(0..x.len()).centres().zip(out) {
            prop_assert!((y - slope * c as f64).abs() < 1e-9);
        }
    }
}

#[test]
fn a_filter_longer_than_memory_is_refused_before_it_is_made() {
    let longest = Decimator::factor_for(500.0, 1e-9);
    for (factor, band) in [(longest, 1.0), (1, 1e-300), (50_000_000, 1.0)] {
        let refused = Decimator::with_band(factor, band);
        assert!(matches!(refused, Err(SignalError::TooManyTaps(_))), "{factor} {band}");
    }
    assert!(Decimator::with_band(25_000, 1.0).is_ok());
}
