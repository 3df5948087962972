#![allow(clippy::unwrap_used)]
//! The plant against energy, against the inverse dynamics, and against friction worked out by hand.

use super::excitation::{ExcitationSettings, FourierJoint, FourierMotion, MotionKind, excite};
use super::testing::{arm, pendulum, random_state, tethered_arm, tx40, wrist};
use super::*;
use crate::model::{Coupling, CouplingLaw, JointNumber, Model, ParameterKind, RecursiveModel, torques_at};
use rand::{RngExt, SeedableRng};

fn without_friction(model: &RecursiveModel, chi: &[f64]) -> Vec<f64> {
    let kinds = model.robot().standard.iter().map(|p| p.kind);
    chi.iter().zip(kinds).map(|(&x, kind)| if kind.is_load() { x } else { 0.0 }).collect()
}

fn energy(model: &RecursiveModel, chi: &[f64], state: &State) -> f64 {
    let mut h = vec![0.0; chi.len()];
    let n = model.robot().joints();
    model.energy(&state.q[..n], &state.dq[..n], &mut h);
    h.iter().zip(chi).map(|(a, b)| a * b).sum()
}

#[test]
fn energy_is_kept_over_ten_seconds_without_friction() {
    keeps_its_energy(arm(), 50_000);
}

#[test]
fn springs_give_back_what_they_take() {
    // The springs make the motion faster, and steps of fourth order err by the fourth power.
    keeps_its_energy(tethered_arm(), 100_000);
}

fn keeps_its_energy((model, chi): (RecursiveModel, Vec<f64>), steps: usize) {
    let chi = without_friction(&model, &chi);
    let n = model.robot().joints();
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut state = plant.state(&vec![0.3; n], &vec![0.8; n]);
    let before = energy(&model, &chi, &state);
    // Energy has no absolute zero: the drift is measured against what is exchanged between its two forms.
    let rest = plant.state(&state.q[..n], &vec![0.0; n]);
    let mut kinetic = before - energy(&model, &chi, &rest);
    for _ in 0..steps {
        plant.advance(&mut state, &vec![0.0; n], 10.0 / steps as f64).unwrap();
        let still = State { dq: vec![0.0; n], ..state.clone() };
        kinetic = kinetic.max(energy(&model, &chi, &state) - energy(&model, &chi, &still));
    }
    let drift = (energy(&model, &chi, &state) - before).abs() / kinetic;
    assert!(drift < 1e-8, "relative drift {drift:.2e}");
}

#[test]
fn forward_dynamics_undo_inverse_dynamics() {
    undoes_inverse_dynamics(arm());
    undoes_inverse_dynamics(tethered_arm());
}

fn undoes_inverse_dynamics((model, chi): (RecursiveModel, Vec<f64>)) {
    let n = model.robot().joints();
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut random = rand_pcg::Pcg64::seed_from_u64(3);
    for _ in 0..200 {
        let [q, dq, ddq] = random_state(n, &mut random);
        let torque = torques_at(&model, &chi, &q, &dq, &ddq);
        let mut state = plant.state(&q, &dq);
        let mut back = vec![0.0; n];
        plant.acceleration(&mut state, &torque, &mut back).unwrap();
        for (a, b) in back.iter().zip(&ddq) {
            assert!((a - b).abs() < 1e-10 * (1.0 + b.abs()), "{a} {b}");
        }
    }
}

#[test]
fn coulomb_friction_holds_a_pendulum_below_its_limit_and_lets_it_slip_above() {
    // Gravity torque m·g·l·sin(q) with m·l = 0.5 kg.m; Fc = 3 N.m.
    let (model, chi) = pendulum(0.5, 2.0, 3.0, 0.0);
    let limit = (3.0_f64 / (0.5 * 9.81)).asin();
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut below = plant.state(&[limit - 1e-6], &[0.0]);
    for _ in 0..5000 {
        plant.advance(&mut below, &[0.0], 1e-3).unwrap();
    }
    assert_eq!((below.q[0], below.dq[0]), (limit - 1e-6, 0.0), "it must not creep");
    let mut above = plant.state(&[limit + 1e-3], &[0.0]);
    for _ in 0..3000 {
        plant.advance(&mut above, &[0.0], 1e-3).unwrap();
    }
    // Near the limit the excess of gravity is linear, so it comes to rest as far on the other side.
    let rests = above.q[0] - limit;
    assert!((rests + 1e-3).abs() < 1e-6 && above.dq[0] == 0.0, "it must slip and stop: {rests}");
}

#[test]
fn a_sliding_mass_stops_where_friction_says_and_stays() {
    // No gravity torque at all: ZZ·ddq = -Fc, so the way to rest is ZZ·v0² / (2·Fc).
    let (model, chi) = pendulum(0.0, 2.0, 3.0, 0.0);
    let mut plant = Plant::new(&model, &chi).unwrap();
    for step in [1e-3, 2e-4, 0.05] {
        let mut state = plant.state(&[0.1], &[1.7]);
        for _ in 0..(3.0 / step) as usize {
            plant.advance(&mut state, &[0.0], step).unwrap();
        }
        let expected = 0.1 + 2.0 * 1.7 * 1.7 / (2.0 * 3.0);
        assert!((state.q[0] - expected).abs() < 1e-9, "step {step}: {}", state.q[0] - expected);
        assert_eq!(state.dq[0], 0.0);
    }
}

#[test]
fn friction_takes_from_the_energy_exactly_what_it_does_as_work() {
    // Swinging down with Coulomb friction: energy lost = Fc times the way, through every reversal.
    let (model, chi) = pendulum(0.5, 0.4, 0.3, 0.0);
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut state = plant.state(&[2.0], &[0.0]);
    let rigid = without_friction(&model, &chi);
    let (start, mut way, mut reversals) = (energy(&model, &rigid, &state), 0.0, 0);
    for _ in 0..40_000 {
        let (q, hold) = (state.q[0], state.hold[0]);
        plant.advance(&mut state, &[0.0], 1e-4).unwrap();
        way += (state.q[0] - q).abs();
        reversals += usize::from(hold != state.hold[0]);
    }
    let lost = start - energy(&model, &rigid, &state);
    assert!(reversals >= 4, "{reversals}");
    assert!((lost - 0.3 * way).abs() < 1e-5 * lost, "{lost} {}", 0.3 * way);
}

/// Friction that rises from rest with the root of the speed: steeper there than any step can follow.
struct Steep;

impl ExtraTorque for Steep {
    fn dry_friction(&self, at: &Instant<'_>, levels: &mut [[f64; 2]]) {
        let more = 6.0 * at.dq[0].abs().powf(0.35);
        levels[0].iter_mut().for_each(|level| *level += more);
    }

    fn has_dry_friction(&self) -> bool {
        true
    }
}

#[test]
fn friction_that_rises_steeply_from_rest_never_pushes_the_way_it_moves() {
    let (model, chi) = pendulum(0.5, 0.2, 1.0, 0.5);
    for step in [1e-4, 2e-4, 1e-3] {
        let mut plant = Plant::with_torques(&model, &chi, vec![Box::new(Steep)]).unwrap();
        let mut state = plant.state(&[0.1], &[0.0]);
        let (mut reversals, mut last) = (0, 0.0_f64);
        for k in 0..(6.0 / step) as usize {
            let time = k as f64 * step;
            // Slow and fast, large and just above what friction holds.
            let torque = 12.0 * (3.0 * time).sin() + 4.0 * (41.0 * time).sin();
            plant.advance(&mut state, &[torque], step).unwrap();
            let (dq, hold) = (state.dq[0], state.hold[0]);
            match hold {
                Hold::Sticking => assert_eq!(dq, 0.0),
                Hold::Forward => assert!(dq >= -1e-9, "{dq} at {time} s in steps of {step} s"),
                Hold::Backward => assert!(dq <= 1e-9, "{dq} at {time} s in steps of {step} s"),
            }
            reversals += usize::from(dq * last < 0.0 || (dq == 0.0) != (last == 0.0));
            last = dq;
        }
        assert!(reversals > 10, "{reversals}");
    }
}

#[test]
fn two_joints_and_their_shared_motor_hold_together() {
    // Fc1 = 1, Fc2 = 1 and 2 at the motor that turns with dq1 + dq2: (2.9, 2.9) can be held, (2.9, 0) cannot.
    let (model, chi) = wrist(1.0, 1.0, 2.0);
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut held = plant.state(&[0.2, 0.4], &[0.0; 2]);
    for _ in 0..100 {
        plant.advance(&mut held, &[2.9, 2.9], 1e-3).unwrap();
    }
    assert_eq!((held.q.as_slice(), held.dq.as_slice()), (&[0.2, 0.4][..], &[0.0, 0.0][..]));
    let mut moves = plant.state(&[0.2, 0.4], &[0.0; 2]);
    for _ in 0..100 {
        plant.advance(&mut moves, &[2.9, 0.0], 1e-3).unwrap();
    }
    assert!(moves.dq[0] > 0.1);
}

#[test]
fn a_motor_can_hold_the_sum_of_two_joints_while_each_moves() {
    // Only the motor has friction: with opposite torques both joints move and their sum stays exactly.
    let (model, chi) = wrist(0.0, 0.0, 5.0);
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut state = plant.state(&[0.2, 0.4], &[0.0; 2]);
    for _ in 0..2000 {
        plant.advance(&mut state, &[1.0, -1.0], 1e-3).unwrap();
    }
    assert!(state.dq[0].abs() > 0.1);
    assert!((state.q[0] + state.q[1] - 0.6).abs() < 1e-12);
}

#[test]
fn friction_between_links_is_that_of_a_motor_that_turns_with_both() {
    let (model, chi) = wrist(0.3, 0.2, 5.0);
    let terms = vec![(0, 2.0), (1, 2.0)].into();
    let belt = Coupling { name: "_belt".into(), terms, law: CouplingLaw::Friction };
    let other = RecursiveModel::new(model.robot().clone().with_couplings(vec![belt])).unwrap();
    let mut on_belt = chi.clone();
    let motor = model.robot().standard.iter().position(|p| p.name == "Fcm2").unwrap();
    // The combination of the belt is twice the motor's.
    on_belt[motor] = 0.0;
    on_belt.extend([0.0, 2.5]);
    let run = |model: &RecursiveModel, chi: &[f64]| {
        let mut plant = Plant::new(model, chi).unwrap();
        let mut state = plant.state(&[0.2, 0.4], &[0.0; 2]);
        for torque in [[3.0, -3.0], [9.0, 7.0], [-9.0, 2.0]] {
            (0..500).for_each(|_| plant.advance(&mut state, &torque, 1e-3).unwrap());
        }
        state.q
    };
    for (a, b) in run(&model, &chi).iter().zip(run(&other, &on_belt)) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn an_elastic_joint_rings_at_its_own_frequency() {
    // Rotor Ia on a spring k to a link ZZ, no gravity: w² = k (1/Ia + 1/ZZ).
    let (model, mut chi) = pendulum(0.0, 2.0, 0.0, 0.0);
    let ia = model.robot().standard.iter().position(|p| p.kind == ParameterKind::Ia).unwrap();
    chi[ia] = 0.5;
    let elastic = ElasticJoint { joint: 0, stiffness: 400.0, damping: 0.0, play: 0.0 };
    let mut plant = Plant::with_effects(&model, &chi, &[elastic], Vec::new()).unwrap();
    let mut state = plant.state(&[0.0], &[0.0]);
    state.q[1] = 0.01;
    let period = std::f64::consts::TAU / (400.0_f64 * (1.0 / 0.5 + 1.0 / 2.0)).sqrt();
    for _ in 0..1000 {
        plant.advance(&mut state, &[0.0], period / 100.0).unwrap();
    }
    let twist = state.q[1] - state.q[0];
    assert!((twist - 0.01).abs() < 1e-6, "after ten periods: {twist}");
}

#[test]
fn play_lets_the_motor_move_before_the_link_does() {
    let (model, mut chi) = pendulum(0.0, 2.0, 0.0, 0.0);
    let ia = model.robot().standard.iter().position(|p| p.kind == ParameterKind::Ia).unwrap();
    chi[ia] = 0.5;
    let elastic = ElasticJoint { joint: 0, stiffness: 4000.0, damping: 1.0, play: 0.02 };
    let mut plant = Plant::with_effects(&model, &chi, &[elastic], Vec::new()).unwrap();
    let mut state = plant.state(&[0.0], &[0.0]);
    while state.q[1] < 0.0099 {
        plant.advance(&mut state, &[1.0], 1e-4).unwrap();
        assert_eq!(state.q[0], 0.0);
    }
    for _ in 0..2000 {
        plant.advance(&mut state, &[1.0], 1e-4).unwrap();
    }
    assert!(state.q[0] > 1e-3);
}

#[test]
fn every_joint_of_a_random_arm_comes_to_rest_under_friction() {
    let (model, mut chi) = arm();
    for (x, p) in chi.iter_mut().zip(model.robot().standard.iter()) {
        if p.kind == ParameterKind::Fc {
            *x += 60.0;
        }
    }
    let n = model.robot().joints();
    let mut plant = Plant::new(&model, &chi).unwrap();
    let mut random = rand_pcg::Pcg64::seed_from_u64(5);
    for _ in 0..5 {
        let q: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
        let dq: Vec<f64> = (0..n).map(|_| random.random_range(-3.0..3.0)).collect();
        let mut state = plant.state(&q, &dq);
        let free = vec![0.0; n];
        for _ in 0..20_000 {
            plant.advance(&mut state, &free, 5e-4).unwrap();
            if state.dq.iter().all(|&v| v == 0.0) {
                break;
            }
        }
        assert!(state.dq.iter().all(|&v| v == 0.0), "{:?}", state.dq);
        let stands = state.q.clone();
        for _ in 0..2000 {
            plant.advance(&mut state, &free, 5e-4).unwrap();
        }
        assert_eq!(state.q, stands);
    }
}

#[test]
fn parameters_that_no_robot_has_are_refused_by_name() {
    let (model, mut chi) = pendulum(0.5, 2.0, 3.0, 0.1);
    let fc = model.robot().standard.iter().position(|p| p.kind == ParameterKind::Fc).unwrap();
    chi[fc] = -1.0;
    let refused = Plant::new(&model, &chi).err().unwrap();
    assert_eq!(refused, SimulationError::NegativeParameter { name: "Fc1".into(), value: -1.0 });
    let (model, mut standard) = arm();
    check_standard(model.robot(), &standard).unwrap();
    let zz3 = model.robot().standard.iter().position(|p| p.name == "ZZ3").unwrap();
    standard[zz3] = 5.0;
    let refused = check_standard(model.robot(), &standard).unwrap_err();
    assert!(matches!(refused, SimulationError::InconsistentLink { link: 3, .. }), "{refused}");
    let (model, mut standard) = arm();
    let ia5 = model.robot().standard.iter().position(|p| p.name == "Ia5").unwrap();
    standard[ia5] = 0.0;
    let refused = check_standard(model.robot(), &standard).unwrap_err();
    assert!(matches!(refused, SimulationError::NegativeRotor { motor: JointNumber(5), .. }), "{refused}");
}

/// A slow wave of every joint about `middle`, as Fourier series that start at rest.
fn wave(middle: &[f64], size: f64) -> FourierMotion {
    let joint = |(j, &center): (usize, &f64)| {
        FourierJoint::at_rest_at_start(center, &[size, 0.2 * j as f64 * size], &[0.3 * size, -0.5 * size])
    };
    FourierMotion { period: 2.0, periods: 1, joints: middle.iter().enumerate().map(joint).collect() }
}

fn loop_settings(model: &RecursiveModel, chi: &[f64], q: &[f64]) -> LoopSettings {
    let n = model.robot().joints();
    let mut mass = vec![0.0; n * n];
    model.mass_and_bias(chi, q, &vec![0.0; n], &mut mass, &mut vec![0.0; n]);
    LoopSettings {
        controller: ControllerSettings::nominal(model.robot(), chi, &mass, 2000.0),
        sensors: SensorSettings::default(),
        record_every: 1,
        longest_step: 5e-4,
        name: "test".to_string(),
    }
}

fn residual(model: &RecursiveModel, chi: &[f64], run: &Simulation, t: usize) -> Vec<f64> {
    let at = |signal: &[Vec<f64>]| signal.iter().map(|x| x[t]).collect::<Vec<f64>>();
    let modelled = torques_at(model, chi, &at(&run.truth.q), &at(&run.truth.dq), &at(&run.truth.ddq));
    run.truth.torque.iter().zip(modelled).map(|(torque, modelled)| torque[t] - modelled).collect()
}

#[test]
fn what_the_loop_records_obeys_the_inverse_dynamics_while_it_moves() {
    let (model, chi) = arm();
    let n = model.robot().joints();
    let mut plant = Plant::new(&model, &chi).unwrap();
    let settings = loop_settings(&model, &chi, &[0.2; 5]);
    let run = simulate(&mut plant, &wave(&[0.2; 5], 0.8), &settings, &mut |_| {}).unwrap();
    assert_eq!(run.recorded.time.len(), 4001);
    let mut moving = 0;
    for t in 0..4001 {
        if (0..n).all(|j| run.truth.dq[j][t].abs() > 1e-3) && run.truth.dq[3][t] + run.truth.dq[4][t] != 0.0 {
            moving += 1;
            for r in residual(&model, &chi, &run, t) {
                assert!(r.abs() < 1e-9, "row {t}: {r}");
            }
        }
    }
    assert!(moving > 2000);
    assert!(run.tracking_error.iter().all(|&e| e < 0.02), "{:?}", run.tracking_error);
}

#[test]
fn noise_and_quantisation_have_their_size_and_the_seed_repeats_them() {
    let (model, chi) = pendulum(0.5, 2.0, 3.0, 1.0);
    let mut settings = loop_settings(&model, &chi, &[0.0]);
    settings.sensors.position_noise = vec![1e-4];
    settings.sensors.torque_noise = vec![0.3];
    settings.sensors.seed = 9;
    let motion = wave(&[0.2], 1.0);
    let run = |settings: &LoopSettings| {
        let mut plant = Plant::new(&model, &chi).unwrap();
        simulate(&mut plant, &motion, settings, &mut |_| {}).unwrap()
    };
    let noisy = run(&settings);
    let spread = |a: &[f64], b: &[f64]| {
        (a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>() / a.len() as f64).sqrt()
    };
    let position = spread(&noisy.recorded.position[0], &noisy.truth.q[0]);
    let torque = spread(&noisy.recorded.torque[0], &noisy.truth.torque[0]);
    assert!((position / 1e-4 - 1.0).abs() < 0.05 && (torque / 0.3 - 1.0).abs() < 0.05, "{position} {torque}");
    assert_eq!(noisy, run(&settings));
    settings.sensors.seed = 10;
    assert_ne!(noisy.recorded, run(&settings).recorded);
    settings.sensors = SensorSettings { position_quantum: vec![1e-3], ..SensorSettings::default() };
    for q in &run(&settings).recorded.position[0] {
        assert!(((q / 1e-3).round() * 1e-3 - q).abs() < 1e-12);
    }
}

#[test]
fn torque_limits_hold_and_are_counted() {
    let (model, chi) = pendulum(0.5, 2.0, 3.0, 1.0);
    let mut settings = loop_settings(&model, &chi, &[0.0]);
    settings.controller.torque_limits = vec![[-4.0, 5.0]];
    let mut plant = Plant::new(&model, &chi).unwrap();
    let run = simulate(&mut plant, &wave(&[0.0], 2.0), &settings, &mut |_| {}).unwrap();
    assert!(run.limited[0] > 100);
    assert!(run.recorded.torque[0].iter().all(|&x| (-4.0..=5.0).contains(&x)));
}

#[test]
fn settings_that_do_not_fit_are_refused() {
    let (model, chi) = pendulum(0.5, 2.0, 3.0, 1.0);
    let good = loop_settings(&model, &chi, &[0.0]);
    let mut bad = vec![good.clone(); 5];
    bad[0].record_every = 0;
    bad[1].longest_step = f64::NAN;
    bad[2].controller.kp.push(1.0);
    bad[3].controller.rate = -1.0;
    bad[4].sensors.torque_noise = vec![-1.0];
    for settings in bad {
        let mut plant = Plant::new(&model, &chi).unwrap();
        assert!(simulate(&mut plant, &wave(&[0.0], 1.0), &settings, &mut |_| {}).is_err());
    }
    let mut plant = Plant::new(&model, &chi).unwrap();
    assert!(simulate(&mut plant, &wave(&[0.0, 0.0], 1.0), &good, &mut |_| {}).is_err());
}

#[test]
fn the_tx40_follows_an_exciting_motion_under_control() {
    let (model, standard) = tx40();
    check_standard(model.robot(), &standard).unwrap();
    assert_eq!(model.robot().base.len(), 60);
    let chi = model.robot().base_from_standard(&standard);
    let settings = ExcitationSettings {
        kind: MotionKind::Fourier { harmonics: 5, period: 4.0, periods: 1 },
        evaluations: 60,
        ..ExcitationSettings::default()
    };
    let plan = excite(&model, Some(&chi), &settings, &|_| {}).unwrap();
    let residue = Residue::typical(model.robot(), &standard, 1.0).boxed();
    let mut plant = Plant::with_effects(&model, &standard, &[], vec![residue]).unwrap();
    let settings = LoopSettings::nominal(&model, &chi, &plan.motions[0], 5000.0, 1);
    let run = simulate(&mut plant, &plan.motions[0], &settings, &mut |_| {}).unwrap();
    assert!(run.tracking_error.iter().all(|&e| e < 0.02), "{:?}", run.tracking_error);
    assert!(run.limited.iter().all(|&k| k == 0), "{:?}", run.limited);
}
