#![allow(clippy::unwrap_used)]
//! Simulated, recorded with noise, identified: do the parameters come back?

use super::excitation::{ExcitationSettings, excite};
use super::testing::tx40;
use super::{DidimSettings, Experiment, LoopSettings, Plant, Reference, Simulation, didim, simulate};
use crate::estimation::observe::{Equations, ObserveSettings, observe};
use crate::estimation::{EstimateSettings, estimate};
use crate::model::{Model, RecursiveModel};
use crate::signal::{Motion, Preparation, prepare};

fn motion(model: &RecursiveModel, chi: &[f64], seed: u64) -> impl Reference + use<> {
    let settings = ExcitationSettings { evaluations: 100, seed, ..ExcitationSettings::default() };
    excite(model, Some(chi), &settings, &|_| {}).unwrap().motions.swap_remove(0)
}

fn run(model: &RecursiveModel, chi: &[f64], motion: &dyn Reference, seed: u64) -> (Simulation, LoopSettings) {
    let settings = LoopSettings::nominal(model, chi, motion, 1000.0, seed);
    let mut plant = Plant::new(model, chi).unwrap();
    (simulate(&mut plant, motion, &settings, &mut |_| {}).unwrap(), settings)
}

/// The honest Monte Carlo: 30 seeds of noise on the same motion, 60 parameters each.
#[test]
fn parameters_come_back_within_three_sigma() {
    let (model, standard) = tx40();
    let chi = model.robot().base_from_standard(&standard);
    let motion = motion(&model, &chi, 1);
    let (clean, mut settings) = run(&model, &chi, &motion, 0);
    let (mut within, mut all) = (0, 0);
    for seed in 0..30 {
        // The noise of a seed on the recording of a clean run: the loop itself hardly feels the encoders' noise.
        settings.sensors.seed = seed;
        let recorded = super::sensors::measured(&settings.sensors, &clean.truth, &clean.recorded);
        let prepared = prepare(&recorded, &Preparation::default()).unwrap();
        let observed =
            observe(&model, &[prepared], Equations::Torque, None, &ObserveSettings::default(), None).unwrap();
        let found =
            estimate(&observed, &EstimateSettings { block_sigmas: false, ..EstimateSettings::default() });
        for (parameter, truth) in found.parameters.iter().zip(&chi) {
            let sigma = parameter.sigma.unwrap();
            within += usize::from((parameter.value - truth).abs() <= 3.0 * sigma);
            all += 1;
        }
    }
    let rate = within as f64 / all as f64;
    println!("{within} of {all} parameters within 3 sigma: {:.2} %", 100.0 * rate);
    assert!(rate >= 0.95, "{rate}");
}

#[test]
fn simulated_states_take_away_what_noise_in_the_states_does() {
    let (model, standard) = tx40();
    let chi = model.robot().base_from_standard(&standard);
    let motion = motion(&model, &chi, 2);
    let mut settings = LoopSettings::nominal(&model, &chi, &motion, 1000.0, 1);
    settings.sensors.position_noise.iter_mut().for_each(|sigma| *sigma *= 100.0);
    let mut plant = Plant::new(&model, &chi).unwrap();
    let recorded = simulate(&mut plant, &motion, &settings, &mut |_| {}).unwrap().recorded;
    let clean = run(&model, &chi, &motion, 1).0.truth;
    let error = |found: &[f64]| {
        let torques = |motions: &[Motion]| {
            observe(&model, motions, Equations::Torque, None, &ObserveSettings::default(), None).unwrap()
        };
        crate::estimation::relative_error(&torques(std::slice::from_ref(&clean)), found).unwrap()
    };
    let prepared = prepare(&recorded, &Preparation::default()).unwrap();
    let observed =
        observe(&model, &[prepared], Equations::Torque, None, &ObserveSettings::default(), None).unwrap();
    let weighted = estimate(&observed, &EstimateSettings::default());
    // A robot that is known to 20 %.
    let start: Vec<f64> = chi.iter().map(|x| 0.8 * x).collect();
    let experiment = Experiment { reference: &motion, settings: &settings, recorded: &recorded };
    let found = didim(&model, &[experiment], &start, &DidimSettings::default()).unwrap();
    assert!(found.converged, "{:?} {:?}", found.changes, found.stopped);
    let (with, without) = (error(&found.estimate.chi()), error(&weighted.chi()));
    assert!(with < 0.5 * without, "{with} {without}");
}
