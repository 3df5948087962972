use proptest::prelude::*;

use super::{Piece, Reach, Verdict, out_of_order, screen};
use crate::model::JointNumber;
use crate::recording::Reason;

fn reach(joints: usize) -> Reach {
    Reach {
        joint: (1..=joints).map(JointNumber).collect(),
        position: vec![[-10.0, 10.0]; joints],
        velocity: vec![40.0; joints],
        torque: vec![1e3; joints],
    }
}

/// A slow motion of two joints at 1 kHz.
fn motion(rows: usize) -> Piece {
    let time: Vec<f64> = (0..rows).map(|k| k as f64 * 1e-3).collect();
    let of = |w: f64| time.iter().map(|t| (w * t).sin()).collect::<Vec<_>>();
    Piece {
        position: vec![of(3.0), of(5.0)],
        velocity: vec![],
        torque: vec![of(7.0), of(2.0)],
        lines: (2..rows as u64 + 2).collect(),
        faults: vec![],
        time,
    }
}

fn reasons(verdict: &Verdict) -> Vec<(usize, Reason)> {
    verdict.faults.iter().map(|f| (f.row, f.reason)).collect()
}

#[test]
fn a_clean_motion_stays_whole() {
    let verdict = screen(&motion(500), &reach(2), false);
    assert!(verdict.faults.is_empty() && verdict.cuts.is_empty());
    assert_eq!(verdict.motions.as_slice(), std::slice::from_ref(&(0..500)));
}

#[test]
fn joints_are_called_by_their_numbers_in_the_table() {
    let mut piece = motion(500);
    piece.position[1][100] = 253.0;
    let reach = Reach { joint: vec![JointNumber(1), JointNumber(3)], ..reach(2) };
    assert_eq!(screen(&piece, &reach, false).faults[0].what, "position 253.0000 of joint 3");
}

#[test]
fn speeds_in_another_unit_cost_no_rows_and_a_spike_of_one_costs_its_own() {
    let mut piece = motion(500);
    piece.velocity = piece.position.iter().map(|q| q.iter().map(|x| 100.0 * x).collect()).collect();
    assert!(screen(&piece, &reach(2), false).faults.is_empty());
    piece.velocity.iter_mut().flatten().for_each(|v| *v /= 100.0);
    piece.velocity[1][70] = 1e9;
    assert_eq!(reasons(&screen(&piece, &reach(2), false)), [(70, Reason::OutOfReach)]);
}

#[test]
fn values_no_joint_can_have_are_left_out_and_named() {
    let mut piece = motion(500);
    piece.position[0][100] = 253.0;
    piece.torque[1][200] = -1e130;
    piece.torque[0][201] = f64::NAN;
    let verdict = screen(&piece, &reach(2), false);
    assert_eq!(reasons(&verdict), [100, 200, 201].map(|r| (r, Reason::OutOfReach)));
    assert!(verdict.faults[0].what.contains("position 253") && verdict.faults[0].what.contains("joint 1"));
    assert_eq!(verdict.motions.as_slice(), std::slice::from_ref(&(0..497)));
}

#[test]
fn spikes_within_reach_are_left_out_as_jumps() {
    let mut piece = motion(500);
    piece.position[1][0] = 2.0;
    piece.position[0][100] = -1.0;
    for row in 300..304 {
        piece.position[1][row] = 0.0;
    }
    piece.position[0][499] += 0.5;
    let verdict = screen(&piece, &reach(2), false);
    let rows: Vec<usize> = verdict.faults.iter().map(|f| f.row).collect();
    assert_eq!(rows, [0, 100, 300, 301, 302, 303, 499]);
    assert!(verdict.faults.iter().all(|f| f.reason == Reason::Jump));
    assert_eq!(verdict.motions.len(), 1);
}

#[test]
fn jittery_stamps_of_a_fast_motion_are_no_jumps() {
    // 2 rad/s sampled at 1 kHz, stamps late by up to 8 ms, and a speed limit of 2.2 rad/s.
    let mut piece = motion(4000);
    piece.position[0] = (0..4000).map(|k| 2e-3 * k as f64 - 4.0).collect();
    for block in piece.time.chunks_exact_mut(100) {
        let end = block[9];
        for (k, t) in block[..9].iter_mut().enumerate() {
            *t = end - 1e-4 * (9 - k) as f64;
        }
    }
    let slow = Reach { velocity: vec![6.6, 30.0], ..reach(2) };
    let verdict = screen(&piece, &slow, true);
    assert!(verdict.faults.is_empty() && verdict.cuts.is_empty(), "{:?} {:?}", verdict.faults, verdict.cuts);
}

#[test]
fn a_lasting_jump_cuts_the_motion_in_two() {
    let mut piece = motion(500);
    for row in 250..500 {
        piece.position[0][row] += 2.0 * std::f64::consts::PI;
    }
    let verdict = screen(&piece, &reach(2), false);
    assert!(verdict.faults.is_empty());
    assert_eq!(verdict.motions, [0..250, 250..500]);
    assert!(verdict.cuts[0].contains("joint 1 jumps by 6.28"), "{:?}", verdict.cuts);
}

#[test]
fn a_gap_in_time_cuts_and_a_few_missing_rows_do_not() {
    let mut piece = motion(500);
    for t in &mut piece.time[250..] {
        *t += 0.1;
    }
    let verdict = screen(&piece, &reach(2), false);
    assert_eq!(verdict.motions, [0..250, 250..500]);
    assert!(verdict.cuts[0].contains("0.1"), "{:?}", verdict.cuts);
    let mut piece = motion(500);
    for t in &mut piece.time[250..] {
        *t += 0.003;
    }
    assert_eq!(screen(&piece, &reach(2), false).motions.as_slice(), std::slice::from_ref(&(0..500)));
}

#[test]
fn a_clock_that_stumbles_loses_only_the_rows_that_stumble() {
    let mut piece = motion(500);
    piece.time[100] = 90.0;
    piece.time[200] = piece.time[199];
    piece.time[300] = 0.001;
    let verdict = screen(&piece, &reach(2), false);
    assert_eq!(reasons(&verdict), [100, 200, 300].map(|r| (r, Reason::TimeOrder)));
    assert_eq!(verdict.motions.as_slice(), std::slice::from_ref(&(0..497)));
}

#[test]
fn rows_alone_between_gaps_are_left_out() {
    let mut piece = motion(500);
    for (row, t) in piece.time.iter_mut().enumerate() {
        *t += if row >= 200 { 0.5 } else { 0.0 } + if row >= 220 { 0.5 } else { 0.0 };
    }
    let verdict = screen(&piece, &reach(2), false);
    assert_eq!(verdict.faults.len(), 20);
    assert!(verdict.faults.iter().all(|f| f.reason == Reason::Isolated));
    assert_eq!(verdict.motions, [0..200, 200..480]);
    assert_eq!(verdict.cuts.len(), 1);
}

#[test]
fn nothing_to_screen_is_no_error() {
    let verdict = screen(&motion(0), &reach(2), false);
    assert!(verdict.kept.is_empty() && verdict.faults.is_empty());
    let verdict = screen(&motion(3), &reach(2), false);
    assert_eq!(verdict.kept.len(), 3);
}

proptest! {
    #[test]
    fn what_stays_goes_forward_in_time_and_nothing_is_counted_twice(
        stamps in proptest::collection::vec(0u8..60, 0..120),
        jumps in proptest::collection::vec((0usize..120, -3.0f64..3.0), 0..12),
    ) {
        let mut piece = motion(stamps.len());
        piece.time = stamps.iter().map(|s| f64::from(*s) * 0.01).collect();
        for (row, jump) in jumps {
            if let Some(q) = piece.position[0].get_mut(row) {
                *q += jump;
            }
        }
        let verdict = screen(&piece, &reach(2), false);
        for motion in &verdict.motions {
            let kept = &verdict.kept[motion.clone()];
            prop_assert!(kept.windows(2).all(|w| piece.time[w[0]] < piece.time[w[1]]));
        }
        let mut seen = vec![0; stamps.len()];
        verdict.faults.iter().for_each(|f| seen[f.row] += 1);
        verdict.kept.iter().for_each(|k| seen[*k] += 1);
        prop_assert!(seen.iter().all(|s| *s == 1), "{:?}", seen);
        let covered: usize = verdict.motions.iter().map(|m| m.len()).sum();
        prop_assert_eq!(covered, verdict.kept.len());
        prop_assert_eq!(verdict.cuts.len() + 1, verdict.motions.len().max(1));
    }

    #[test]
    fn as_few_rows_as_possible_are_out_of_order(stamps in proptest::collection::vec(0u8..12, 0..10)) {
        let time: Vec<f64> = stamps.iter().map(|s| f64::from(*s)).collect();
        let out = out_of_order(&time, &vec![true; time.len()]);
        let rest: Vec<f64> = (0..time.len()).filter(|r| !out.contains(r)).map(|r| time[r]).collect();
        prop_assert!(rest.windows(2).all(|w| w[0] < w[1]));
        // Against every subset.
        let best = (0u32..1 << time.len()).filter(|set| {
            let chosen: Vec<f64> = (0..time.len()).filter(|r| set >> r & 1 == 1).map(|r| time[r]).collect();
            chosen.windows(2).all(|w| w[0] < w[1])
        }).map(u32::count_ones).max().unwrap_or(0);
        prop_assert_eq!(rest.len() as u32, best);
    }
}
