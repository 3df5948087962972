//! The generated models against the recursive engine, an independent engine, and each other.
#![allow(clippy::unwrap_used)]

use dynid::models;
use dynid_runtime::model::{
    BaseParameter, ForwardDynamics, JointKind, LINE, Lanes, Model, ParameterKind, RecursiveModel, Robot,
    States, energy_at, torques_at,
};
use std::io::Write as _;

/// A small linear congruential generator, so that the states never change.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn values(&mut self, count: usize, scale: f64) -> Vec<f64> {
        (0..count).map(|_| scale * self.unit()).collect()
    }
}

/// q, dq and ddq.
type State = [Vec<f64>; 3];

fn states(model: &dyn Model, count: usize) -> Vec<State> {
    let n = model.robot().joints();
    let mut random = Random(n as u64);
    (0..count).map(|_| [random.values(n, 3.0), random.values(n, 3.0), random.values(n, 8.0)]).collect()
}

fn recursive(model: &dyn Model) -> RecursiveModel {
    RecursiveModel::new(model.robot().clone()).unwrap()
}

/// Row i, column k of IDM, zeros included.
fn dense_idm(model: &dyn Model, state: &State) -> Vec<Vec<f64>> {
    let pattern = model.pattern();
    let mut entries = vec![0.0; pattern.columns.len()];
    model.idm(&state[0], &state[1], &state[2], &mut entries);
    let mut dense = vec![vec![0.0; model.robot().base.len()]; model.robot().joints()];
    for (i, row) in dense.iter_mut().enumerate() {
        for e in pattern.rows[i]..pattern.rows[i + 1] {
            row[pattern.columns[e]] = entries[e];
        }
    }
    dense
}

fn energy(model: &dyn Model, state: &State) -> Vec<f64> {
    let mut h = vec![0.0; model.robot().base.len()];
    model.energy(&state[0], &state[1], &mut h);
    h
}

fn power(model: &dyn Model, state: &State) -> Vec<f64> {
    let mut dh = vec![0.0; model.robot().base.len()];
    model.power(&state[0], &state[1], &state[2], &mut dh);
    dh
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{what}, value {k}: {a} and {b}");
    }
}

#[test]
fn every_function_agrees_with_the_recursive_engine() {
    for &model in models::all() {
        let name = &model.robot().name;
        let (n, nb) = (model.robot().joints(), model.robot().base.len());
        let reference = recursive(model);
        let chi = Random(5).values(nb, 1.0);
        for state in states(model, 20) {
            let (found, expected) = (dense_idm(model, &state), dense_idm(&reference, &state));
            for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert_close(found, expected, 1e-10, &format!("{name} IDM row {i}"));
            }
            assert_close(&energy(model, &state), &energy(&reference, &state), 1e-10, &format!("{name} h"));
            assert_close(&power(model, &state), &power(&reference, &state), 1e-10, &format!("{name} dh"));
            let forward = |model: &dyn Model| {
                let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
                model.mass_and_bias(&chi, &state[0], &state[1], &mut mass, &mut bias);
                (mass, bias)
            };
            let (found, expected) = (forward(model), forward(&reference));
            assert_close(&found.0, &expected.0, 1e-10, &format!("{name} M"));
            assert_close(&found.1, &expected.1, 1e-10, &format!("{name} N"));
        }
    }
}

fn torque(model: &dyn Model, chi: &[f64], state: &State) -> Vec<f64> {
    let mut torque = vec![f64::NAN; model.robot().joints()];
    model.torque(chi, &state[0], &state[1], &state[2], &mut torque);
    torque
}

/// Newton-Euler with base parameters in the places of standard ones gives the same torques as the regressor, where what
/// is compared is as large as the terms that it is summed of.
#[test]
fn torques_are_the_regressor_times_the_parameters() {
    for &model in models::all() {
        let name = &model.robot().name;
        let reference = recursive(model);
        let mut random = Random(9);
        for state in states(model, 40) {
            let chi = random.values(model.robot().base.len(), 3.0);
            let rows = dense_idm(model, &state);
            for (what, found) in
                [("generated", torque(model, &chi, &state)), ("recursive", torque(&reference, &chi, &state))]
            {
                for (i, (row, found)) in rows.iter().zip(found).enumerate() {
                    let terms: Vec<f64> = row.iter().zip(&chi).map(|(w, x)| w * x).collect();
                    let (expected, size) =
                        (terms.iter().sum::<f64>(), terms.iter().fold(1.0_f64, |most, x| most.max(x.abs())));
                    assert!(
                        (found - expected).abs() < 1e-12 * size,
                        "{name} {what}, joint {i}: {found} {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn accelerations_need_the_torques_that_they_were_worked_out_from() {
    for &model in models::all() {
        let robot = model.robot();
        let Some(nominal) = &robot.nominal else { continue };
        let chi = robot.base_from_standard(&nominal.standard);
        let mut forward = ForwardDynamics::new(model, &chi);
        for [q, dq, ddq] in states(model, 20) {
            let needed = torque(model, &chi, &[q.clone(), dq.clone(), ddq.clone()]);
            let mut found = vec![f64::NAN; q.len()];
            forward.acceleration(&q, &dq, &needed, &mut found).unwrap();
            assert_close(&found, &ddq, 1e-8, &robot.name);
        }
    }
}

#[test]
fn columns_agree_with_an_independent_engine() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/reference/regressors.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
        return;
    };
    let reference: serde_json::Value = serde_json::from_str(&text).unwrap();
    let numbers = |value: &serde_json::Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
    let mut compared = 0;
    for &model in models::all() {
        let robot = model.robot();
        let Some(expected) = reference.get(robot.name.as_ref()) else { continue };
        compared += 1;
        // The reference lists the ten inertial parameters of the joints' links, and knows no payload frames.
        let joints = robot.joint_of_frame();
        let column = |k: usize| {
            let parameter = &robot.standard[robot.base[k].standard];
            let moves = robot.frames[parameter.frame].kind != JointKind::Fixed;
            (parameter.kind <= ParameterKind::M && moves)
                .then(|| 10 * joints[parameter.frame].unwrap() + parameter.kind as usize)
        };
        let inertial: Vec<(usize, usize)> =
            (0..robot.base.len()).filter_map(|k| column(k).map(|c| (k, c))).collect();
        // The reference has no rotors: one that the mass of its link was regrouped into stands for that mass.
        let kind = |k: usize| robot.standard[k].kind;
        let takes_mass = |b: &&BaseParameter| {
            kind(b.standard) == ParameterKind::Ia
                && b.combination.iter().any(|&(k, _)| kind(k) <= ParameterKind::M)
        };
        assert_eq!(
            (inertial.len() + robot.base.iter().filter(takes_mass).count()) as u64,
            expected["inertial_base_count"].as_u64().unwrap(),
            "{}",
            robot.name
        );
        for state in expected["states"].as_array().unwrap() {
            let at = [numbers(&state["q"]), numbers(&state["dq"]), numbers(&state["ddq"])];
            let pick = |row: &[f64], from: fn(&(usize, usize)) -> usize| -> Vec<f64> {
                inertial.iter().map(|pair| row[from(pair)]).collect()
            };
            for (i, row) in dense_idm(model, &at).iter().enumerate() {
                let expected = pick(&numbers(&state["torque"][i]), |p| p.1);
                assert_close(&pick(row, |p| p.0), &expected, 1e-10, &format!("{} row {i}", robot.name));
            }
            let expected = pick(&numbers(&state["energy"]), |p| p.1);
            assert_close(&pick(&energy(model, &at), |p| p.0), &expected, 1e-10, &format!("{} h", robot.name));
        }
    }
    assert_eq!(compared, 7);
}

#[test]
fn power_is_what_the_joint_torques_do() {
    for &model in models::all() {
        for state in states(model, 20) {
            let mut total = vec![0.0; model.robot().base.len()];
            for (row, dq) in dense_idm(model, &state).iter().zip(&state[1]) {
                total.iter_mut().zip(row).for_each(|(t, x)| *t += dq * x);
            }
            assert_close(&power(model, &state), &total, 1e-11, &format!("{} dh", model.robot().name));
        }
    }
}

#[test]
fn power_without_friction_is_the_rate_of_energy() {
    for &model in models::all() {
        let robot = model.robot();
        for [q, dq, ddq] in states(model, 10) {
            let at = |t: f64| {
                let q = q.iter().zip(&dq).zip(&ddq).map(|((q, v), a)| q + v * t + 0.5 * a * t * t).collect();
                let dq = dq.iter().zip(&ddq).map(|(v, a)| v + a * t).collect();
                energy(model, &[q, dq, ddq.clone()])
            };
            // Five points, error of fourth order.
            let step = 1e-4;
            let (a, b, c, d) = (at(-2.0 * step), at(-step), at(step), at(2.0 * step));
            let dh = power(model, &[q.clone(), dq.clone(), ddq.clone()]);
            for (k, parameter) in robot.base.iter().enumerate() {
                if robot.standard[parameter.standard].kind <= ParameterKind::Ia {
                    let rate = (a[k] - 8.0 * b[k] + 8.0 * c[k] - d[k]) / (12.0 * step);
                    assert!(
                        (dh[k] - rate).abs() < 1e-8,
                        "{} {}: {} {rate}",
                        robot.name,
                        parameter.name,
                        dh[k]
                    );
                }
            }
        }
    }
}

/// Standard parameters drawn at random, without friction; and the base parameters that they are.
fn frictionless(robot: &Robot, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let mut standard = random.values(robot.standard.len(), 2.0);
    for (value, parameter) in standard.iter_mut().zip(robot.standard.iter()) {
        if parameter.kind > ParameterKind::Ia && parameter.kind != ParameterKind::Off {
            *value = 0.0;
        }
    }
    let chi = robot.base_from_standard(&standard);
    (standard, chi)
}

/// The complete energy in base parameters differs from that of the bodies, rotors and offsets by a constant, whatever was
/// regrouped: the weight on the vertical slide of the SCARA is in its offset.
#[test]
fn the_complete_energy_is_that_of_the_bodies_but_for_its_zero() {
    for &model in models::all() {
        let (robot, n) = (model.robot(), model.robot().joints());
        let (standard, chi) = frictionless(robot, &mut Random(7));
        let (frames, drive) = (robot.frames.to_vec(), robot.drive.clone());
        let mut plain =
            Robot::with_standard_as_base("plain", robot.gravity, frames, drive, robot.limits.clone());
        plain.dependent = robot.dependent.clone();
        let bodies = RecursiveModel::new(plain).unwrap();
        let of_bodies = |q: &[f64], dq: &[f64]| energy_at(&bodies, &standard, q, dq);
        let zero = vec![0.0; n];
        let of_base = |q: &[f64], dq: &[f64]| energy_at(model, &chi, q, dq);
        for [q, dq, _] in states(model, 10) {
            let expected = of_bodies(&q, &dq) - of_bodies(&zero, &zero);
            let found = of_base(&q, &dq) - of_base(&zero, &zero);
            assert!(
                (found - expected).abs() < 1e-9 * (1.0 + expected.abs()),
                "{}: {found} {expected}",
                robot.name
            );
        }
    }
}

/// dE/dt = dh chi, and the difference of energies is the work of the torques, along a motion without friction.
#[test]
fn energy_differences_are_the_work_of_the_torques() {
    for &model in models::all() {
        let (robot, n) = (model.robot(), model.robot().joints());
        let (_, chi) = frictionless(robot, &mut Random(11));
        let at = |t: f64| -> State {
            let of = |f: &dyn Fn(f64) -> f64| (0..n).map(|j| f(j as f64)).collect();
            let phase = |j: f64| (1.0 + 0.3 * j) * t + j;
            [
                of(&|j| phase(j).sin()),
                of(&|j| (1.0 + 0.3 * j) * phase(j).cos()),
                of(&|j| -(1.0 + 0.3 * j).powi(2) * phase(j).sin()),
            ]
        };
        let energy = |t: f64| energy_at(model, &chi, &at(t)[0], &at(t)[1]);
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
        let delivered = |t: f64| {
            let [q, dq, ddq] = at(t);
            dot(&dq, &torques_at(model, &chi, &q, &dq, &ddq))
        };
        let rate = (energy(0.50001) - energy(0.49999)) / 0.00002;
        let dh = dot(&power(model, &at(0.5)), &chi);
        let size = 1.0 + dh.abs() + energy(0.5).abs();
        assert!((rate - dh).abs() < 1e-7 * size, "{}: {rate} {dh}", robot.name);
        // Simpson's rule.
        let steps = 2000;
        let h = 1.5 / f64::from(steps);
        let weight = |k: i32| if k == 0 || k == steps { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
        let work: f64 = (0..=steps).map(|k| weight(k) * delivered(f64::from(k) * h)).sum::<f64>() * h / 3.0;
        let gained = energy(1.5) - energy(0.0);
        assert!((work - gained).abs() < 1e-8 * size, "{}: {work} {gained}", robot.name);
    }
}

/// Blocks and single samples agree, for any number of samples and any stride; nothing is written past the samples.
#[test]
fn blocks_give_what_single_samples_give() {
    for &model in models::all() {
        let (robot, n, nb) = (model.robot(), model.robot().joints(), model.robot().base.len());
        let entries = model.pattern().columns.len();
        for samples in [0, 1, 3, 4, 5, 8, 13] {
            let states = states(model, samples);
            let signal = |s: usize| -> Vec<Vec<f64>> {
                (0..n).map(|j| states.iter().map(|state| state[s][j]).collect()).collect()
            };
            let signals = [signal(0), signal(1), signal(2)];
            let views = signals.each_ref().map(|s| s.iter().map(Vec::as_slice).collect::<Vec<_>>());
            let block = States { q: &views[0], dq: &views[1], ddq: &views[2] };
            let stride = samples + 2;
            let check = |count: usize,
                         write: &dyn Fn(&mut [f64]),
                         single: &dyn Fn(&State) -> Vec<f64>,
                         what: &str| {
                let mut out = vec![f64::NAN; count * stride];
                write(&mut out);
                for (t, state) in states.iter().enumerate() {
                    let column: Vec<f64> = (0..count).map(|k| out[k * stride + t]).collect();
                    assert_close(
                        &column,
                        &single(state),
                        1e-12,
                        &format!("{} {what} sample {t}", robot.name),
                    );
                }
                assert!(
                    (0..count)
                        .all(|k| out[k * stride + samples..(k + 1) * stride].iter().all(|x| x.is_nan()))
                );
            };
            let single_idm = |state: &State| {
                let mut values = vec![0.0; entries];
                model.idm(&state[0], &state[1], &state[2], &mut values);
                values
            };
            check(entries, &|out| model.idm_block(block, stride, out), &single_idm, "IDM");
            let width = entries + 1;
            let mut lines = vec![[Lanes::splat(0.0); 2]; width * samples.div_ceil(LINE)];
            model.idm_lines(block, width, &mut lines);
            for (t, state) in states.iter().enumerate() {
                let at = |e: usize| lines[t / LINE * width + e][t % LINE / 4].to_array()[t % 4];
                let found: Vec<f64> = (0..entries).map(at).collect();
                assert_close(&found, &single_idm(state), 1e-12, &format!("{} lines, sample {t}", robot.name));
            }
            let chi = Random(3).values(nb, 1.0);
            let run = |out: &mut [f64]| model.torque_block(&chi, block, stride, out);
            check(n, &run, &|state| torque(model, &chi, state), "tau");
            let reference = recursive(model);
            let run = |out: &mut [f64]| reference.torque_block(&chi, block, stride, out);
            check(n, &run, &|state| torque(model, &chi, state), "recursive tau");
            check(nb, &|out| model.power_block(block, stride, out), &|s| power(model, s), "dh");
            check(nb, &|out| model.energy_block(block, stride, out), &|s| energy(model, s), "h");
        }
    }
}

#[test]
fn entries_that_are_said_to_repeat_others_are_their_digits() {
    for &model in models::all() {
        let pattern = model.pattern();
        assert_eq!(pattern.same_as.len(), pattern.columns.len());
        for state in states(model, 10) {
            let mut entries = vec![0.0; pattern.columns.len()];
            model.idm(&state[0], &state[1], &state[2], &mut entries);
            for (e, &first) in pattern.same_as.iter().enumerate() {
                assert!(first <= e && pattern.same_as[first] == first);
                assert_eq!(
                    entries[e].to_bits(),
                    entries[first].to_bits(),
                    "{} entry {e}",
                    model.robot().name
                );
            }
        }
    }
    let tx40 = models::find("tx40").unwrap().pattern();
    // Couples of the links 3 to 6 on the parallel axes 2 and 3, five offsets beside the first, the coupled friction.
    let repeated = (0..tx40.columns.len()).filter(|&e| tx40.same_as[e] != e).count();
    assert_eq!(repeated, 20 + 5 + 2);
}

/// An entry of the pattern that were zero at every state would be computed and stored for nothing.
#[test]
fn every_entry_of_the_pattern_is_needed() {
    for &model in models::all() {
        let pattern = model.pattern();
        let mut largest = vec![0.0_f64; pattern.columns.len()];
        for state in states(model, 10) {
            let mut entries = vec![0.0; pattern.columns.len()];
            model.idm(&state[0], &state[1], &state[2], &mut entries);
            largest.iter_mut().zip(&entries).for_each(|(l, e)| *l = l.max(e.abs()));
        }
        for (e, size) in largest.iter().enumerate() {
            let base = &model.robot().base[pattern.columns[e]];
            assert!(*size > 1e-9, "{} entry {e} ({}) is {size}", model.robot().name, base.name);
        }
    }
}
