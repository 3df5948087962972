//! Every generated robot with nominal parameters, simulated.
#![allow(clippy::unwrap_used)]

use dynid::models;
use dynid_runtime::model::{Model, ParameterKind, torques_at};
use dynid_runtime::simulation::{Plant, check_standard};

/// The generated robots with their nominal standard parameters.
fn robots() -> impl Iterator<Item = (&'static dyn Model, Vec<f64>)> {
    models::all().iter().filter_map(|&model| {
        let nominal = model.robot().nominal.as_ref()?;
        Some((model, nominal.standard.to_vec()))
    })
}

fn without_friction(model: &dyn Model, standard: &[f64]) -> Vec<f64> {
    let kinds = model.robot().standard.iter().map(|p| p.kind);
    standard.iter().zip(kinds).map(|(&x, kind)| if kind > ParameterKind::Ia { 0.0 } else { x }).collect()
}

#[test]
fn every_nominal_robot_can_exist() {
    assert!(robots().count() >= 8);
    for (model, standard) in robots() {
        check_standard(model.robot(), &standard).unwrap();
    }
}

#[test]
fn forward_dynamics_undo_inverse_dynamics_to_1e_10() {
    for (model, standard) in robots() {
        let n = model.robot().joints();
        let chi = model.robot().base_from_standard(&standard);
        let mut plant = Plant::new(model, &chi).unwrap();
        for k in 0..50 {
            let wave = |size: f64, rate: f64| -> Vec<f64> {
                (0..n).map(|j| size * (rate * k as f64 + 1.3 * j as f64 + 0.2).sin()).collect()
            };
            let (q, dq, ddq) = (wave(2.0, 0.7), wave(3.0, 1.1), wave(20.0, 1.7));
            let torque = torques_at(model, &chi, &q, &dq, &ddq);
            let mut back = vec![0.0; n];
            plant.acceleration(&mut plant.state(&q, &dq), &torque, &mut back).unwrap();
            for (a, b) in back.iter().zip(&ddq) {
                assert!((a - b).abs() < 1e-10 * (1.0 + b.abs()), "{}: {a} {b}", model.robot().name);
            }
        }
    }
}

/// Without friction and let go: over ten seconds at 5 kHz the energy stays within 1e-8 of the largest kinetic energy.
#[test]
fn energy_is_kept_to_1e_8_over_ten_seconds() {
    for (model, standard) in robots() {
        let n = model.robot().joints();
        let chi = model.robot().base_from_standard(&without_friction(model, &standard));
        let mut plant = Plant::new(model, &chi).unwrap();
        let mut h = vec![0.0; chi.len()];
        let joint_of = model.robot().joint_of_frame();
        let offset: Vec<(usize, f64)> = (0..chi.len())
            .filter_map(|k| {
                let standard = &model.robot().standard[model.robot().base[k].standard];
                let joint = joint_of[standard.frame].filter(|_| standard.kind == ParameterKind::Off)?;
                Some((joint, chi[k]))
            })
            .collect();
        // The weight of the rotor that is regrouped into a vertical prismatic axis is taken back by its offset, whose
        // work is no part of h.
        let mut energy = |q: &[f64], dq: &[f64]| {
            model.energy(q, dq, &mut h);
            let rigid: f64 = h.iter().zip(&chi).map(|(a, b)| a * b).sum();
            rigid + offset.iter().map(|&(j, torque)| torque * q[j]).sum::<f64>()
        };
        let mut state = plant.state(&vec![0.3; n], &vec![0.8; n]);
        let before = energy(&state.q, &state.dq);
        let (mut kinetic, mut drift) = (0.0_f64, 0.0_f64);
        for _ in 0..50_000 {
            plant.advance(&mut state, &vec![0.0; n], 2e-4).unwrap();
            let now = energy(&state.q, &state.dq);
            kinetic = kinetic.max(now - energy(&state.q, &vec![0.0; n]));
            drift = drift.max((now - before).abs());
        }
        eprintln!("{}: {:.1e}", model.robot().name, drift / kinetic);
        assert!(drift < 1e-8 * kinetic, "{}: {:.2e}", model.robot().name, drift / kinetic);
    }
}
