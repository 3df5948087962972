use proptest::prelude::*;

use super::Butterworth;
use crate::signal::oracle::{oracle, worst};

#[test]
fn zero_phase_filter_agrees_with_scipy() {
    for case in oracle().filtfilt {
        let filter = Butterworth::low_pass(case.order, case.cutoff, case.rate).expect("a valid filter");
        let out = filter.zero_phase(&case.input).expect("long enough");
        let error = worst(&out, &case.output);
        assert!(error < 1e-9, "order {} at {} Hz of {}: {error:e}", case.order, case.cutoff, case.rate);
    }
}

#[test]
fn one_pass_has_half_the_power_at_the_cut_off() {
    for order in 1..=8 {
        let filter = Butterworth::low_pass(order, 40.0, 1000.0).expect("a valid filter");
        let w = 2.0 * std::f64::consts::PI * 40.0 / 1000.0;
        let gain: f64 = filter
            .sections()
            .iter()
            .map(|s| {
                let at = |c: [f64; 3]| {
                    let re = c[0] + c[1] * w.cos() + c[2] * (2.0 * w).cos();
                    let im = c[1] * w.sin() + c[2] * (2.0 * w).sin();
                    re * re + im * im
                };
                at(s.b) / at([1.0, s.a[0], s.a[1]])
            })
            .product();
        assert!((gain - 0.5).abs() < 1e-12, "order {order}: {gain}");
    }
}

#[test]
fn misuse_is_told() {
    assert!(Butterworth::low_pass(4, 300.0, 500.0).is_err());
    assert!(Butterworth::low_pass(4, f64::NAN, 500.0).is_err());
    assert!(Butterworth::low_pass(0, 20.0, 500.0).is_err());
    assert!(Butterworth::low_pass(4, 20.0, -1.0).is_err());
    let filter = Butterworth::low_pass(4, 20.0, 500.0).expect("a valid filter");
    assert!(filter.zero_phase(&[1.0; 15]).is_err());
    assert!(filter.zero_phase(&[]).is_err());
    assert!(filter.zero_phase(&[1.0; 16]).is_ok());
}

proptest! {
    #[test]
    fn a_constant_stays_what_it_is(level in -1e6f64..1e6, order in 1usize..9, ratio in 0.002..0.45, n in 40usize..300) {
        let filter = Butterworth::low_pass(order, ratio * 1000.0, 1000.0).expect("a valid filter");
        for x in filter.zero_phase(&vec![level; n]).expect("long enough") {
            prop_assert!((x - level).abs() <= 1e-8 * level.abs());
        }
    }

    #[test]
    fn a_straight_line_is_not_shifted(slope in -10.0f64..10.0, start in -5.0..5.0, ratio in 0.15..0.4) {
        let line: Vec<f64> = (0..200).map(|k| start + slope * k as f64).collect();
        let filter = Butterworth::low_pass(4, ratio * 1000.0, 1000.0).expect("a valid filter");
        let out = filter.zero_phase(&line).expect("long enough");
        // Odd padding continues the line, but a pass begins at rest: away from the ends it is exact.
        for k in 95..105 {
            prop_assert!((out[k] - line[k]).abs() < 1e-6, "{k}: {} {}", out[k], line[k]);
        }
    }

    #[test]
    fn time_reversed_input_gives_time_reversed_output(seed in proptest::collection::vec(-1.0..1.0, 200)) {
        let filter = Butterworth::low_pass(4, 250.0, 1000.0).expect("a valid filter");
        let forward = filter.zero_phase(&seed).expect("long enough");
        let reversed: Vec<f64> = seed.iter().rev().copied().collect();
        let backward = filter.zero_phase(&reversed).expect("long enough");
        for k in 60..140 {
            prop_assert!((forward[k] - backward[199 - k]).abs() < 1e-9);
        }
    }
}
