//! How often the interval of an effect's quantity contains the truth, over simulated recordings: `docs/coverage.md`.
//!
//! ```text
//! cargo test --release -p dynid-runtime --test effect_coverage -- --ignored --nocapture
//! ```
//!
//! Environment: `COVERAGE_SEEDS` (40), `COVERAGE_EFFECTS`, a list separated by commas.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, Loop, SimulatedRobot, planar, scara};
use dynid_runtime::diagnosis::{Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};

/// Motions of a recording, and length of each, s.
const MOTIONS: u64 = 3;
const LENGTH: f64 = 6.0;
/// Half the width of an interval of 95 %, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

/// A hidden effect and what its quantities truly are.
struct Case {
    effect: EffectKind,
    robot: fn() -> SimulatedRobot,
    place: Place,
    shape: &'static [f64],
    amplitude: &'static [f64],
    truth: &'static [(&'static str, f64)],
}

const CASES: [Case; 9] = [
    Case {
        effect: EffectKind::Stribeck,
        robot: planar,
        place: Place::Joint(1),
        shape: &[0.3],
        amplitude: &[3.0],
        truth: &[("fs", 3.0), ("vs", 0.3)],
    },
    Case {
        effect: EffectKind::LoadDependentFriction,
        robot: planar,
        place: Place::Joint(0),
        shape: &[],
        amplitude: &[0.1],
        truth: &[("mu", 0.1)],
    },
    Case {
        effect: EffectKind::NonlinearViscous,
        robot: planar,
        place: Place::Joint(1),
        shape: &[0.5],
        amplitude: &[4.0],
        truth: &[("p", 0.5)],
    },
    Case {
        effect: EffectKind::AsymmetricFriction,
        robot: planar,
        place: Place::Joint(0),
        shape: &[],
        amplitude: &[0.5],
        truth: &[("half_difference", 0.5)],
    },
    Case {
        effect: EffectKind::PositionDependentFriction,
        robot: planar,
        place: Place::Joint(0),
        shape: &[2.0],
        amplitude: &[1.2, 0.9],
        truth: &[("amplitude", 1.5), ("wave_number", 2.0)],
    },
    Case {
        effect: EffectKind::Spring,
        robot: scara,
        place: Place::Joint(1),
        shape: &[],
        amplitude: &[2.0],
        truth: &[("k", 2.0)],
    },
    Case {
        effect: EffectKind::TorqueRipple,
        robot: planar,
        place: Place::Joint(0),
        shape: &[50.0],
        amplitude: &[0.8, 0.6],
        truth: &[("amplitude", 1.0), ("order_per_motor_turn", 1.0)],
    },
    Case {
        effect: EffectKind::DriveEfficiency,
        robot: planar,
        place: Place::Joint(0),
        shape: &[1.0],
        amplitude: &[0.2, 0.05],
        truth: &[("efficiency_driving", 1.0 / 1.2), ("efficiency_driven", 0.95)],
    },
    Case {
        effect: EffectKind::TorqueCrosstalk,
        robot: planar,
        place: Place::Hears(1, 0),
        shape: &[],
        amplitude: &[0.1],
        truth: &[("k", 0.1)],
    },
];

#[test]
#[ignore = "a measurement of minutes: its command is above"]
fn intervals_of_effects_contain_the_truth_as_often_as_they_say() {
    let seeds: u64 = std::env::var("COVERAGE_SEEDS").ok().and_then(|s| s.parse().ok()).unwrap_or(40);
    let wanted = std::env::var("COVERAGE_EFFECTS").ok();
    println!("| effect | quantity | named | coverage, % | bias / sigma | spread / sigma |");
    println!("| --- | --- | ---: | ---: | ---: | ---: |");
    for case in &CASES {
        if wanted.as_ref().is_some_and(|w| !w.split(',').any(|name| name == case.effect.id())) {
            continue;
        }
        // Errors in units of their own sigmas, for each quantity.
        let mut errors: Vec<Vec<f64>> = vec![Vec::new(); case.truth.len()];
        let robot = (case.robot)();
        let hidden = Hidden::effect(case.effect, case.place, case.shape, case.amplitude);
        for seed in 1..=seeds {
            let recorded = robot.record_in(&Loop::FINE, &robot.motions(MOTIONS, LENGTH, seed), &hidden, seed);
            let diagnosis = diagnose(&robot.model, &recorded, &[], &Settings::default(), &Silent).unwrap();
            let mut findings = diagnosis.findings.iter();
            let own = findings.find(|f| f.term.effect == case.effect && f.term.place == case.place);
            let Some(found) = own else { continue };
            for ((quantity, truth), errors) in case.truth.iter().zip(&mut errors) {
                if let Some(q) = found.parameters.get(*quantity).filter(|q| q.sigma > 0.0) {
                    errors.push((q.value - truth) / q.sigma);
                }
            }
        }
        for ((quantity, _), errors) in case.truth.iter().zip(errors) {
            let n = errors.len().max(1) as f64;
            let inside = errors.iter().filter(|e| e.abs() <= NORMAL_95).count() as f64;
            let bias = errors.iter().sum::<f64>() / n;
            let spread = (errors.iter().map(|e| (e - bias).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
            println!(
                "| {} | {quantity} | {} of {seeds} | {:.1} | {bias:.2} | {spread:.2} |",
                case.effect.id(),
                errors.len(),
                100.0 * inside / n
            );
        }
    }
}
