use super::{Preparation, VelocitySource, prepare, prepare_all};
use crate::recording::Trajectory;
use crate::signal::oracle::{oracle, worst};
use crate::signal::{Stencil, central_difference};

fn sine(rate: f64, n: usize, jitter: f64) -> Trajectory {
    let time: Vec<f64> = (0..n).map(|k| 5.0 + (k as f64 + jitter * (k as f64 * 2.3).sin()) / rate).collect();
    let of = |f: &dyn Fn(f64) -> f64| vec![time.iter().map(|&t| f(t)).collect::<Vec<_>>()];
    Trajectory {
        name: "sine".into(),
        position: of(&|t| (6.0 * t).sin()),
        velocity: Some(of(&|t| 6.0 * (6.0 * t).cos())),
        torque: of(&|t| t),
        fixed: vec![],
        time,
    }
}

#[test]
fn positions_and_derivatives_of_a_slow_sine_are_exact_between_the_edge_samples() {
    for (rate, n, jitter) in
        [(5000.0, 20000, 0.0), (500.0, 2000, 0.0), (100.0, 1000, 0.0), (100.0, 1000, 0.1)]
    {
        for velocity in [VelocitySource::Positions, VelocitySource::Recorded] {
            let settings = Preparation { velocity, ..Preparation::default() };
            let motion = prepare(&sine(rate, n, jitter), &settings).expect("a valid motion");
            assert!(motion.edge_samples > 2 && motion.edge_samples < n / 10);
            for k in motion.edge_samples..motion.q[0].len() - motion.edge_samples {
                let t = motion.start + k as f64 / motion.rate;
                assert!((motion.q[0][k] - (6.0 * t).sin()).abs() < 2e-4);
                assert!((motion.dq[0][k] - 6.0 * (6.0 * t).cos()).abs() < 3e-3);
                assert!((motion.ddq[0][k] + 36.0 * (6.0 * t).sin()).abs() < 5e-2, "{rate} {jitter} {k}");
                assert!((motion.torque[0][k] - t).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn a_motion_has_the_same_digits_for_every_number_of_threads() {
    let one = sine(500.0, 2000, 0.1);
    let several = |channel: &Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        [1.0, 0.3, -2.0].map(|scale| channel[0].iter().map(|x| scale * x).collect()).to_vec()
    };
    let trajectory = Trajectory {
        position: several(&one.position),
        velocity: one.velocity.as_ref().map(several),
        torque: several(&one.torque),
        ..one.clone()
    };
    let with = |threads| prepare(&trajectory, &Preparation { threads, ..Preparation::default() });
    let expected = with(1).expect("a valid motion");
    assert_eq!(expected.q.len(), 3);
    for threads in [2, 3, 0] {
        assert_eq!(with(threads).expect("a valid motion"), expected);
    }
}

#[test]
fn two_point_difference_agrees_with_numpy() {
    for case in oracle().gradient {
        let mut out = vec![0.0; case.input.len()];
        central_difference(&case.input, case.rate, Stencil::Three, &mut out);
        assert!(worst(&out, &case.output) < 1e-12);
    }
}

#[test]
fn wider_stencils_are_exact_for_polynomials_of_their_order() {
    for (stencil, order) in [(Stencil::Three, 2), (Stencil::Five, 4), (Stencil::Seven, 6), (Stencil::Nine, 8)]
    {
        let x: Vec<f64> = (0..40).map(|k| (k as f64 / 20.0 - 1.0).powi(order)).collect();
        let mut out = vec![0.0; 40];
        central_difference(&x, 20.0, stencil, &mut out);
        let inner = stencil.half_width()..40 - stencil.half_width();
        for (k, y) in out.iter().enumerate().filter(|(k, _)| inner.contains(k)) {
            let exact = order as f64 * (k as f64 / 20.0 - 1.0).powi(order - 1);
            assert!((y - exact).abs() < 1e-9, "{stencil:?} at {k}: {y} {exact}");
        }
    }
}

#[test]
fn a_constant_has_no_derivative_whatever_its_length() {
    for n in 0..12 {
        for stencil in [Stencil::Three, Stencil::Five, Stencil::Seven, Stencil::Nine] {
            let mut out = vec![1.0; n];
            central_difference(&vec![4.0; n], 10.0, stencil, &mut out);
            assert!(out.iter().all(|x| x.abs() < 1e-12), "{n} {stencil:?} {out:?}");
        }
    }
}

#[test]
fn a_joint_that_stands_still_is_held_whatever_its_encoder_says() {
    let mut t = sine(500.0, 2000, 0.0);
    let noise = (0..t.time.len()).map(|k| 1.5 + 1e-4 * (k as f64 * 1.7).sin()).collect();
    for channels in [&mut t.position, &mut t.torque] {
        let of_another = channels[0].clone();
        channels.push(of_another);
    }
    t.position[1] = noise;
    t.velocity = None;
    let held = |t: &Trajectory| {
        let motion = prepare(t, &Preparation::default()).expect("a valid motion");
        assert!(motion.dq[0].iter().any(|&v| v > 1.0));
        let still = motion.dq[1].iter().chain(&motion.ddq[1]).all(|&x| x == 0.0);
        still && motion.q[1].iter().all(|&q| q == motion.q[1][0])
    };
    assert!(held(&t), "it hardly moves");
    t.position[1].iter_mut().for_each(|q| *q = 1.5 + 100.0 * (*q - 1.5));
    assert!(!held(&t), "it moves");
    t.fixed = vec![1];
    assert!(held(&t), "it is said to stand still");
}

#[test]
fn what_cannot_be_prepared_is_told() {
    let settings = Preparation::default();
    let short = sine(500.0, 20, 0.0);
    assert!(prepare(&short, &settings).expect_err("too short").to_string().contains("20 samples"));
    let mut nan = sine(500.0, 2000, 0.0);
    nan.torque[0][7] = f64::NAN;
    assert!(prepare(&nan, &settings).is_err());
    let mut uneven = sine(500.0, 2000, 0.0);
    uneven.position[0].pop();
    assert!(prepare(&uneven, &settings).is_err());
    let cutoff = Preparation { cutoff: Some(400.0), ..settings };
    assert!(prepare(&sine(500.0, 2000, 0.0), &cutoff).is_err());
}

/// Positions rounded to 1e-4 rad at 100 Hz, velocities to 1e-4 rad/s: `dq` of the preparation against `wanted`.
fn chosen(velocity: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut t = sine(100.0, 3000, 0.0);
    let round = |x: f64| (x * 1e4).round() / 1e4;
    t.position[0].iter_mut().for_each(|q| *q = round(*q));
    let recorded: Vec<f64> = t.time.iter().map(|&t| round(velocity(t))).collect();
    t.velocity = Some(vec![recorded]);
    let of = |velocity| {
        let settings = Preparation { velocity, cutoff: Some(20.0), ..Preparation::default() };
        prepare(&t, &settings).expect("a valid motion").dq.remove(0)
    };
    let automatic = of(VelocitySource::Automatic);
    let distance = |other: Vec<f64>| worst(&automatic, &other);
    (distance(of(VelocitySource::Positions)), distance(of(VelocitySource::Recorded)))
}

#[test]
fn a_recorded_velocity_is_used_where_it_agrees_with_the_positions_and_is_quieter() {
    let true_one = |t: f64| 6.0 * (6.0 * t).cos();
    assert_eq!(chosen(true_one).1, 0.0);
    // Wrong scale, late by 20 ms, noisy.
    assert_eq!(chosen(|t| 1.1 * true_one(t)).0, 0.0);
    assert_eq!(chosen(|t| true_one(t - 0.02)).0, 0.0);
    assert_eq!(chosen(|t| true_one(t) + 0.2 * (1e5 * t).sin()).0, 0.0);
}

#[test]
fn pieces_too_short_to_filter_are_left_out_and_named() {
    let (long, short) = (sine(500.0, 2000, 0.0), sine(500.0, 40, 0.0));
    let settings = Preparation::default();
    let (motions, too_short) = prepare_all(&[short.clone(), long], &settings).expect("one remains");
    assert_eq!((motions.len(), too_short.len()), (1, 1));
    assert!(prepare_all(&[short], &settings).is_err());
}
