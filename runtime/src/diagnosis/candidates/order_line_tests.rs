use super::*;
use crate::diagnosis::judging::testing::correlated;
use crate::diagnosis::rules::LINE_MULTIPLES;
use crate::testing::normal;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const RATE: f64 = 250.0;
/// Gear of the motor.
const GEAR: f64 = 101.0;

/// Positions, speeds and residual of one motion.
struct Motion {
    q: Vec<f64>,
    dq: Vec<f64>,
    residual: Vec<f64>,
}

/// 12 s over 2 rad at up to `speed` rad/s, with unit noise of which a part is slow, a friction that was not fitted
/// right, and a wave of an amplitude at an order.
fn motion(rng: &mut Pcg64, speed: f64, order: f64, amplitude: f64) -> Motion {
    let angle = rng.random_range(0.0..TAU);
    with_phase(rng, speed, order, amplitude, angle)
}

/// The same with a wave of this phase.
fn with_phase(rng: &mut Pcg64, speed: f64, order: f64, amplitude: f64, angle: f64) -> Motion {
    let phase = rng.random_range(0.0..TAU);
    let slow_share: f64 = rng.random_range(0.0..0.6);
    let mut slow = normal(rng);
    let fading = (-1.0 / (0.05 * RATE)).exp();
    let level = rng.random_range(-0.3..0.3);
    let mut out = Motion { q: vec![], dq: vec![], residual: vec![] };
    for k in 0..(12.0 * RATE) as usize {
        let at = speed * k as f64 / RATE + phase;
        let (q, dq) = (at.sin(), speed * at.cos());
        slow = fading * slow + (1.0 - fading * fading).sqrt() * normal(rng);
        let noise = (1.0 - slow_share).sqrt() * normal(rng) + slow_share.sqrt() * slow;
        out.q.push(q);
        out.dq.push(dq);
        out.residual.push(noise + level * dq.signum() + amplitude * (order * q + angle).sin());
    }
    out
}

fn strokes(motions: &[Motion]) -> Vec<Stroke<'_>> {
    motions
        .iter()
        .map(|m| Stroke { q: &m.q, dq: &m.dq, residual: &m.residual, band: 0.4 * RATE, cutoff: RATE })
        .collect()
}

fn found(motions: &[Motion]) -> Vec<Line> {
    let known: Vec<f64> = LINE_MULTIPLES.iter().map(|k| k * GEAR).collect();
    lines(&strokes(motions), &known, &[], 0.05)
}

/// Amplitude of a wave with this share of unit noise.
fn amplitude(share: f64) -> f64 {
    (2.0 * share).sqrt()
}

#[test]
fn noise_has_no_line() {
    let mut rng = Pcg64::seed_from_u64(21);
    let mut false_lines = 0;
    for _ in 0..300 {
        let motions: Vec<Motion> = (0..rng.random_range(1..4))
            .map(|_| {
                let speed = rng.random_range(0.3..2.0);
                motion(&mut rng, speed, 1.0, 0.0)
            })
            .collect();
        false_lines += found(&motions).len();
    }
    assert_eq!(false_lines, 0);
}

#[test]
fn noise_that_lasts_falls_with_the_order_and_has_no_line_where_it_does() {
    let mut rng = Pcg64::seed_from_u64(29);
    let picked: Vec<f64> = (8..40).map(f64::from).collect();
    let mut false_lines = 0;
    for _ in 0..60 {
        let mut motion = motion(&mut rng, 0.8, 1.0, 0.0);
        let fading = (-1.0 / (rng.random_range(0.02..0.2) * RATE)).exp();
        let lasting = correlated(&mut rng, motion.residual.len(), fading);
        for (residual, slow) in motion.residual.iter_mut().zip(lasting) {
            *residual = 0.2 * *residual + (1.0 - fading * fading).sqrt() * slow;
        }
        false_lines += lines(&strokes(&[motion]), &[], &picked, 0.05).len();
    }
    assert_eq!(false_lines, 0);
}

#[test]
fn a_line_with_four_per_cent_of_the_variance_is_found_at_any_speed() {
    let mut rng = Pcg64::seed_from_u64(22);
    for speed in [0.3, 0.6, 1.0, 1.6] {
        let mut hits = 0;
        for _ in 0..40 {
            let motions = [motion(&mut rng, speed, 2.0 * GEAR, amplitude(0.04))];
            let lines = found(&motions);
            hits += usize::from(lines.iter().any(|l| (l.order - 202.0).abs() < 1.0));
            assert!(lines.iter().all(|l| (l.order - 202.0).abs() < 1.0), "{lines:?}");
        }
        println!("{speed} rad/s: {hits} of 40");
        assert!(hits >= 34, "{speed} rad/s: {hits} of 40");
    }
}

/// A motor's torque follows a ripple as far as its controller does: a loop of 10 Hz, of first order. The joint is slow at
/// first, and fast for twice as long.
#[test]
fn a_wave_that_is_mostly_faster_than_the_controller_is_found_where_the_joint_is_slow() {
    let mut rng = Pcg64::seed_from_u64(24);
    let order = 4.0 * GEAR;
    let (mut hits, mut in_whole_band) = (0, 0);
    for _ in 0..40 {
        let [mut whole, fast, faster] = [0.25, 1.6, 1.7].map(|speed| motion(&mut rng, speed, order, 0.0));
        for part in [fast, faster] {
            whole.q.extend(part.q);
            whole.dq.extend(part.dq);
            whole.residual.extend(part.residual);
        }
        for k in 0..whole.q.len() {
            let lag = whole.dq[k] * order / TAU / 10.0;
            whole.residual[k] += 0.85 * (order * whole.q[k] - lag.atan()).sin() / lag.hypot(1.0);
        }
        let motions = [whole];
        let is_there = |line: &Line| (line.order - order).abs() < 1.0 && line.p_value < 1e-4;
        hits += usize::from(found(&motions).iter().any(is_there));
        let strokes = strokes(&motions);
        let one = line(&strokes, (order, LINE_ABOVE, true), (1.0, 0.05), resolution(&strokes));
        in_whole_band += usize::from(one.as_ref().is_some_and(is_there));
    }
    println!("{hits} of 40, {in_whole_band} in the whole band");
    assert!(hits >= 20, "{hits} of 40");
    assert!(in_whole_band <= 4, "{in_whole_band} of 40");
}

/// The model has what a controller leaves of a ripple in the acceleration, as far as the positions hold it: up to 40 Hz.
#[test]
fn the_amplitude_of_a_wave_is_that_where_the_model_follows_what_the_controller_leaves_of_it() {
    let mut rng = Pcg64::seed_from_u64(30);
    let (order, cutoff, height) = (2.0 * GEAR, 40.0, 1.2);
    let (mut within, mut tried, mut too_small) = (0, 0, 0);
    for _ in 0..40 {
        let mut all = motion(&mut rng, 2.0, order, 0.0);
        for ((r, q), dq) in all.residual.iter_mut().zip(&all.q).zip(&all.dq) {
            let frequency = dq * order / TAU;
            let held = 1.0 / (1.0 + (frequency / cutoff).powi(8));
            let lag = frequency / 10.0;
            let answered = (order * q - lag.atan()).sin() / lag.hypot(1.0);
            *r += height * (held * (order * q).sin() + (1.0 - held) * answered);
        }
        let motions = [all];
        let near = |lines: Vec<Line>| lines.into_iter().find(|l| (l.order - order).abs() < 1.0);
        let known: Vec<f64> = LINE_MULTIPLES.iter().map(|k| k * GEAR).collect();
        let told = |cutoff: f64| {
            let strokes: Vec<Stroke<'_>> =
                strokes(&motions).into_iter().map(|s| Stroke { cutoff, ..s }).collect();
            near(lines(&strokes, &known, &[], 0.05))
        };
        let Some([line, of_all]) = told(cutoff).zip(told(RATE)).map(|(a, b)| [a, b]) else { continue };
        tried += 1;
        within += usize::from((line.amplitude() - height).abs() < 2.5 * line.sigma);
        too_small += usize::from(of_all.amplitude() < height - 2.5 * of_all.sigma);
    }
    println!("{within} of {tried} hold it, {too_small} too small were every wave believed");
    assert!(tried >= 30 && within * 10 >= tried * 9, "{within} of {tried}");
    assert!(too_small * 2 > tried, "{too_small} of {tried}");
}

#[test]
fn a_wave_that_is_too_fast_everywhere_is_told_as_the_torque_shows_it_and_its_rest_as_unknown() {
    let mut rng = Pcg64::seed_from_u64(31);
    let order = 4.0 * GEAR;
    let motions = [motion(&mut rng, 0.5, order, 0.8)];
    let told = |cutoff: f64| {
        let strokes: Vec<Stroke<'_>> =
            strokes(&motions).into_iter().map(|s| Stroke { cutoff, ..s }).collect();
        lines(&strokes, &[order], &[], 0.05)
    };
    let [line] = &told(4.0)[..] else { panic!("no line") };
    assert!((line.amplitude() - 0.8).abs() < 0.2 && line.sigma >= line.amplitude(), "{line:?}");
}

#[test]
fn a_line_with_three_per_cent_is_mostly_found_where_several_motions_show_it() {
    let mut rng = Pcg64::seed_from_u64(23);
    let mut hits = 0;
    for _ in 0..60 {
        let angle = rng.random_range(0.0..TAU);
        let motions: Vec<Motion> =
            [0.4, 0.8, 1.2].iter().map(|&v| with_phase(&mut rng, v, 202.0, amplitude(0.03), angle)).collect();
        hits += usize::from(!found(&motions).is_empty());
    }
    println!("{hits} of 60");
    assert!(hits >= 42, "{hits} of 60");
}

#[test]
fn waves_of_one_order_that_begin_elsewhere_in_every_motion_are_no_line_of_the_joint() {
    let mut rng = Pcg64::seed_from_u64(28);
    for turn in [0.0, TAU / 3.0] {
        let motions: Vec<Motion> =
            (0..3).map(|k| with_phase(&mut rng, 0.8, 202.0, amplitude(0.06), f64::from(k) * turn)).collect();
        let lines = found(&motions);
        assert_eq!(lines.len(), usize::from(turn == 0.0), "{turn}: {lines:?}");
    }
}

#[test]
fn several_lines_of_a_motor_are_told_apart_and_measured() {
    let mut rng = Pcg64::seed_from_u64(24);
    let mut m = motion(&mut rng, 0.8, 202.0, 0.6);
    for (r, q) in m.residual.iter_mut().zip(&m.q) {
        *r += 0.4 * (101.0 * q).cos();
    }
    let lines = found(&[m]);
    assert_eq!(lines.len(), 2, "{lines:?}");
    for (line, (order, height)) in lines.iter().zip([(202.0, 0.6), (101.0, 0.4)]) {
        assert!((line.order - order).abs() < 0.5, "{lines:?}");
        assert!((line.amplitude() - height).abs() < 4.0 * line.sigma, "{lines:?}");
    }
}

#[test]
fn the_foot_of_a_strong_line_is_no_line() {
    let mut rng = Pcg64::seed_from_u64(25);
    for _ in 0..40 {
        // A wave that is no multiple of a motor turn, thirty times as strong as the noise.
        let order = 101.0 * rng.random_range(1.15..1.85);
        let lines = found(&[motion(&mut rng, 0.7, order, 30.0)]);
        assert!(lines.is_empty(), "{order}: {lines:?}");
    }
}

#[test]
fn friction_that_was_not_fitted_has_no_line() {
    let mut rng = Pcg64::seed_from_u64(26);
    for _ in 0..40 {
        let mut m = motion(&mut rng, 0.8, 1.0, 0.0);
        for (r, v) in m.residual.iter_mut().zip(&m.dq) {
            *r += 8.0 * (v / 0.1).tanh() + 5.0 * v * v * v;
        }
        assert!(found(&[m]).is_empty());
    }
}

#[test]
fn an_order_that_nobody_knew_is_found_among_picked_ones() {
    let mut rng = Pcg64::seed_from_u64(27);
    let m = motion(&mut rng, 0.8, 77.7, amplitude(0.05));
    let stroke = Stroke { q: &m.q, dq: &m.dq, residual: &m.residual, band: 0.4 * RATE, cutoff: RATE };
    let lines = lines(&[stroke], &[], &[30.0, 78.0, 140.0], 0.05);
    assert_eq!(lines.len(), 1);
    assert!((lines[0].order - 77.7).abs() < 1.0);
}

#[test]
fn a_joint_that_hardly_moves_shows_nothing() {
    let still = vec![0.0; 1000];
    let stroke = Stroke { q: &still, dq: &still, residual: &still, band: 100.0, cutoff: 100.0 };
    assert!(lines(&[stroke], &[202.0], &[100.0], 0.05).is_empty());
    assert!(lines(&[], &[202.0], &[], 0.05).is_empty());
}
