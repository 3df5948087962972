//! Rows and fits beside known values are those of a robot without their columns.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rows::selection::Cut;
use crate::diagnosis::rows::signals::directions;
use crate::model::{RecursiveModel, Robot, StateSlices, torques};
use crate::signal::Motion;
use crate::simulation::testing::{arm, with_numeric_base};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Sines of all joints, and torques of the robot with some noise.
fn motion(model: &dyn Model, chi: &[f64]) -> Motion {
    let wave = |j: usize, order: i32| -> Vec<f64> {
        let at = |t: f64, w: f64| {
            w.powi(order) * (w * t + j as f64 + f64::from(order) * std::f64::consts::FRAC_PI_2).sin()
        };
        let of = |t: usize| {
            at(t as f64 / 200.0, 1.7 + 0.6 * j as f64) + at(t as f64 / 200.0, 4.1 - 0.7 * j as f64)
        };
        (0..3000).map(|t| 0.4 * of(t)).collect()
    };
    let n = model.robot().joints();
    let [q, dq, ddq] = [0, 1, 2].map(|order| (0..n).map(|j| wave(j, order)).collect::<Vec<_>>());
    let mut torque = torques(model, chi, StateSlices::new(&q, &dq, &ddq).states());
    let mut random = Pcg64::seed_from_u64(3);
    torque.iter_mut().flatten().for_each(|x| *x += random.random_range(-0.3..0.3));
    Motion { name: "m".into(), rate: 200.0, start: 0.0, q, dq, ddq, torque, fixed: vec![], edge_samples: 10 }
}

fn design(model: &RecursiveModel, motion: &Motion) -> Design {
    let slowest = vec![0.05; model.robot().joints()];
    let selection = RowSelection {
        half: 0.05,
        slowest: &slowest,
        directions: &directions(model.robot()),
        cut: Cut { segments: 3, ..Cut::NOT },
        excluded: &[vec![]],
    };
    Design::new(model, &[Signals::of_motion(motion)], &selection)
}

#[test]
fn a_fit_beside_known_values_is_that_of_a_robot_without_their_columns() {
    let (whole, standard) = arm();
    let robot = with_numeric_base(whole.robot());
    let chi = robot.base_from_standard(&standard);
    // What a table would say of parameters that are alone in their base parameters.
    let alone = |k: &usize| robot.base[*k].combination.len() == 1;
    let places: Vec<usize> = (0..robot.base.len()).filter(alone).step_by(3).collect();
    let fixed: Vec<(usize, f64)> = places.iter().map(|&k| (robot.base[k].standard, chi[k])).collect();
    assert!(places.len() > 4);
    let without: Vec<_> =
        robot.base.iter().enumerate().filter(|(k, _)| !places.contains(k)).map(|(_, b)| b.clone()).collect();
    let known = RecursiveModel::new(Robot { fixed: fixed.into(), ..robot.clone() }).unwrap();
    assert_eq!(known.robot().fixed_base().len(), places.len());
    let less = RecursiveModel::new(Robot { base: without.into(), ..robot.clone() }).unwrap();

    let recorded = motion(&known, &chi);
    let of_known: Vec<f64> = (0..chi.len()).map(|k| if places.contains(&k) { chi[k] } else { 0.0 }).collect();
    let mut rest = recorded.clone();
    let taken =
        torques(&known, &of_known, StateSlices::new(&recorded.q, &recorded.dq, &recorded.ddq).states());
    for (torque, taken) in rest.torque.iter_mut().flatten().zip(taken.iter().flatten()) {
        *torque -= taken;
    }

    let (held, removed) = (design(&known, &recorded), design(&less, &rest));
    assert!(held.rows.len() > 500);
    let size = held.y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
    assert!(held.y.iter().zip(&removed.y).all(|(a, b)| (a - b).abs() < 1e-10 * size));
    let fits = [(&held, Fit::weighted(&held, &[1.0; 5])), (&removed, Fit::weighted(&removed, &[1.0; 5]))];
    let [(held, a), (removed, b)] = fits.map(|(design, fit)| (design, fit.unwrap()));
    let mut others = b.chi.iter().zip(b.variances().iter().copied().collect::<Vec<_>>());
    let variances = a.variances();
    for k in 0..chi.len() {
        if places.contains(&k) {
            assert_eq!((a.chi[k], variances[k]), (chi[k], 0.0));
        } else {
            let (value, variance) = others.next().unwrap();
            let sigma = variance.sqrt();
            assert!((a.chi[k] - value).abs() < 1e-5 * sigma, "{}: {} {value}", robot.base[k].name, a.chi[k]);
            approx::assert_relative_eq!(variances[k], variance, max_relative = 1e-6);
        }
    }
    let residuals = [a.residual(held), b.residual(removed)];
    assert!(residuals[0].iter().zip(&residuals[1]).all(|(a, b)| (a - b).abs() < 1e-6));
    // Errors are relative to the torques as they were recorded.
    let squares = |design: &Design| (0..3).map(|g| design.torque_squares(1, g)).sum::<f64>();
    let mut free = known.robot().clone();
    free.fixed = Vec::new().into();
    let free = design_of_free(free, &recorded);
    approx::assert_relative_eq!(squares(held), squares(&free), max_relative = 1e-9);
    // A fit that has them free is another one.
    let c = Fit::weighted(&free, &[1.0; 5]).unwrap();
    assert!(places.iter().all(|&k| (c.chi[k] - chi[k]).abs() > 0.0 && c.variances()[k] > 0.0));
}

fn design_of_free(robot: Robot, recorded: &Motion) -> Design {
    design(&RecursiveModel::new(robot).unwrap(), recorded)
}
