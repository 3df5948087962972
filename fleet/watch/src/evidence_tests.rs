//! What evidence promises.

use super::*;
use crate::memory::Memory;
use crate::testing::Noise;

const WHITE: Memory = Memory { share: 0.0, rho: 0.5 };

fn readings(values: &[f64]) -> Vec<Reading> {
    let reading =
        |(day, value): (i64, &f64)| Reading { day, value: *value, covariates: [0.0; 2], extra_variance: 0.0 };
    (0..).zip(values).map(reading).collect()
}

fn watched(values: &[f64], memory: Memory) -> Evidence {
    let readings = readings(values);
    let filter = Filter::new([(0.0, 0.0); 2], memory, (1.0, 20.0));
    let mut evidence = Evidence::new(filter, &readings[..14], 0.02);
    readings[14..].iter().for_each(|r| evidence.observe(r));
    evidence
}

#[test]
fn capital_is_placed_and_never_made() {
    let mut evidence = watched(&[0.0; 14], WHITE);
    assert!(evidence.ln_e_value().abs() < 1e-9, "{}", evidence.ln_e_value());
    // Predictions of both models agree where nothing differs from zero: what is lost is lost to wider changes.
    readings(&[0.0; 400])[14..].iter().for_each(|r| evidence.observe(r));
    assert!(evidence.ln_e_value() < 0.0 && evidence.bets.len() <= 4 * (MOST_STARTS + 1));
}

#[test]
fn evidence_against_what_is_true_is_as_rare_as_it_says() {
    let mut noise = Noise::new(11);
    for rho in [0.0, 0.6] {
        let memory = Memory { share: 1.0, rho };
        let mut reached = [0; 2];
        for _ in 0..400 {
            let readings = readings(&noise.ar1(60, rho));
            let filter = Filter::new([(0.0, 0.0); 2], memory, (1.0, 20.0));
            let mut evidence = Evidence::new(filter, &readings[..14], 0.02);
            let mut most = f64::NEG_INFINITY;
            for reading in &readings[14..] {
                evidence.observe(reading);
                most = most.max(evidence.ln_e_value());
            }
            [10.0_f64, 40.0].iter().zip(&mut reached).for_each(|(e, n)| *n += i32::from(most > e.ln()));
        }
        assert!(reached[0] <= 40 && reached[1] <= 10, "{rho}: {reached:?} of 400");
    }
}

#[test]
fn a_step_and_a_drift_are_told_apart_with_their_days() {
    let mut noise = Noise::new(12);
    let mut values: Vec<f64> = (0..60).map(|_| noise.normal()).collect();
    let mut drifting = values.clone();
    values[40..].iter_mut().for_each(|v| *v += 4.0);
    (25..60).for_each(|k| drifting[k] += 0.25 * (k - 24) as f64);
    let step = watched(&values, WHITE).began().expect("bets were placed");
    assert!(step.kind == Kind::Step && step.start.abs_diff(40) <= 1, "{step:?}");
    assert!((step.change.mean - 4.0).abs() < 3.0 * step.change.sigma + 0.3, "{step:?}");
    let drift = watched(&drifting, WHITE).began().expect("bets were placed");
    assert!(drift.kind == Kind::Drift && drift.start.abs_diff(25) <= 6, "{drift:?}");
    assert!(drift.between.0 <= drift.start && drift.start <= drift.between.1, "{drift:?}");
}

#[test]
fn two_days_of_nonsense_prove_nothing_and_a_jump_out_of_all_proportion_does() {
    let mut noise = Noise::new(13);
    let mut values: Vec<f64> = (0..50).map(|_| noise.normal()).collect();
    values[30] += 25.0;
    values[41] -= 14.0;
    let e = watched(&values, WHITE).ln_e_value();
    assert!(e < 5.0, "{e}");
    values[44..].iter_mut().for_each(|v| *v += 1e7);
    let e = watched(&values, WHITE).ln_e_value();
    assert!(e > 15.0, "{e}");
}
