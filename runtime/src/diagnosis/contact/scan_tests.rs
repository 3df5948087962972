use super::*;
use crate::diagnosis::rules::SCAN_LEVEL;
use crate::testing::normal;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::HashSet;

/// Time between rows, s.
const STEP: f64 = 0.02;
/// That of a recording in which nothing else was found.
const LEVEL: f64 = SCAN_LEVEL;
/// Rows of 24 s.
const ROWS: usize = 1200;
const JOINTS: usize = 4;

/// 24 s of noise of unit variance, 30 % of it remembered for 0.1 s; every joint reverses every 2 to 4 s.
fn noise(rng: &mut Pcg64) -> Vec<Track> {
    noise_of(rng, JOINTS, ROWS)
}

/// The same of so many joints and rows.
fn noise_of(rng: &mut Pcg64, joints: usize, rows: usize) -> Vec<Track> {
    let fading = (-STEP / 0.1_f64).exp();
    (0..joints)
        .map(|joint| {
            let mut slow = normal(rng);
            let (period, phase) = (rng.random_range(100..200), rng.random_range(0..100));
            let rows = (0..rows)
                .map(|k| {
                    slow = fading * slow + (1.0 - fading * fading).sqrt() * normal(rng);
                    (k, 0.7_f64.sqrt() * normal(rng) + 0.3_f64.sqrt() * slow)
                })
                .filter(|(k, _)| (k + phase) % period > 4)
                .collect();
            track(joint, rows)
        })
        .collect()
}

/// One motion of a joint, beside nothing.
fn track(joint: usize, rows: Vec<(usize, f64)>) -> Track {
    let motions = vec![(true, rows)];
    Track { joint, motions, beside: vec![], sizes: vec![], columns: vec![], once: HashSet::new() }
}

/// Adds half a sine wave of an rms of `visible` on one joint.
fn push(track: &mut Track, from: f64, lasts: f64, visible: f64) {
    for (place, x) in &mut track.motions[0].1 {
        let at = (*place as f64 * STEP - from) / lasts;
        if (0.0..1.0).contains(&at) {
            *x += visible * 2.0_f64.sqrt() * (std::f64::consts::PI * at).sin();
        }
    }
}

#[test]
fn hardly_one_recording_in_three_hundred_has_a_push_that_is_none() {
    let mut rng = Pcg64::seed_from_u64(11);
    let runs = 600;
    let false_alarms =
        (0..runs).filter(|_| !scan(&noise(&mut rng), (&[], &[]), STEP, LEVEL).pushes.is_empty()).count();
    println!("{false_alarms} of {runs}");
    assert!(false_alarms <= 2, "{false_alarms} of {runs}");
}

#[test]
fn nor_do_recordings_of_a_few_seconds() {
    let mut rng = Pcg64::seed_from_u64(22);
    let runs = 1200;
    let mut once = |_: &i32| !scan(&noise_of(&mut rng, 2, 300), (&[], &[]), STEP, LEVEL).pushes.is_empty();
    let false_alarms = (0..runs).filter(&mut once).count();
    assert!(false_alarms <= 4, "{false_alarms} of {runs}");
}

#[test]
fn a_long_push_in_a_few_seconds_is_found() {
    let mut rng = Pcg64::seed_from_u64(23);
    let mut once = |_: &i32| {
        let mut tracks = noise_of(&mut rng, 3, 400);
        push(&mut tracks[1], 3.0, 1.0, 3.5);
        scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.iter().any(|p| p.joint == 1)
    };
    let found = (0..100).filter(&mut once).count();
    assert!(found >= 70, "{found} of 100");
}

#[test]
fn a_push_that_a_residual_would_remember_as_slow_noise_is_found() {
    let mut rng = Pcg64::seed_from_u64(17);
    let mut once = || {
        let mut tracks = noise_of(&mut rng, 2, 600);
        push(&mut tracks[0], 4.0, 2.4, 2.0);
        let found = scan(&tracks, (&[], &[]), STEP, LEVEL).pushes;
        found.iter().any(|p| p.joint == 0 && p.places[0] < 320 && p.places[1] > 200)
    };
    let hits = (0..60).filter(|_| once()).count();
    println!("{hits} of 60");
    assert!(hits >= 48, "{hits} of 60");
}

#[test]
fn what_was_found_is_judged_again() {
    let mut tracks = noise(&mut Pcg64::seed_from_u64(24));
    push(&mut tracks[1], 10.0, 0.5, 4.0);
    let found = scan(&tracks, (&[], &[]), STEP, LEVEL).pushes;
    assert_eq!(scan(&tracks, (&found, &[]), STEP, LEVEL).pushes, found);
    push(&mut tracks[1], 10.0, 0.5, -4.0);
    assert!(scan(&tracks, (&found, &[]), STEP, LEVEL).pushes.is_empty());
}

#[test]
fn what_else_tells_of_a_push_is_judged_and_others_are_found_beside_it() {
    let mut tracks = noise(&mut Pcg64::seed_from_u64(25));
    push(&mut tracks[1], 20.0, 0.5, 4.0);
    let found = scan(&tracks, (&[], &[]), STEP, LEVEL).pushes;
    let certain = Pushed { motion: 0, places: [100, 130], ..found[0].clone() };
    let scanned = scan(&tracks, (&[], std::slice::from_ref(&certain)), STEP, LEVEL);
    assert_eq!(scanned.pushes.len(), 1);
    assert_eq!((scanned.pushes[0].joint, scanned.pushes[0].places), (found[0].joint, found[0].places));
    let places = |pushes: &[Pushed]| pushes.iter().map(|p| p.places).collect::<Vec<_>>();
    assert_eq!(places(&scanned.accidents), [[100, 130]]);
    assert!(places(&scan(&tracks, (&[], &found), STEP, LEVEL).accidents).is_empty());
}

/// Share of pushes of `lasts` seconds that are found on their joint at their time, and recordings with any other.
fn found(lasts: f64, visible: f64, seed: u64) -> (f64, usize) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let runs = 200;
    let (mut hits, mut others) = (0, 0);
    for _ in 0..runs {
        let mut tracks = noise(&mut rng);
        let joint = rng.random_range(0..JOINTS);
        let from = rng.random_range(1.0..22.0);
        push(&mut tracks[joint], from, lasts, visible);
        let pushed = scan(&tracks, (&[], &[]), STEP, LEVEL).pushes;
        let right = |p: &Pushed| {
            let [a, b] = p.places.map(|k| k as f64 * STEP);
            p.joint == joint && a < from + lasts && b > from
        };
        hits += usize::from(pushed.iter().any(right));
        others += usize::from(pushed.iter().any(|p| !right(p)));
    }
    println!("{lasts} s, {visible}: {hits} of {runs}, others in {others}");
    (hits as f64 / runs as f64, others)
}

#[test]
fn medium_pushes_of_half_a_second_are_found() {
    let (share, others) = found(0.5, 2.5, 12);
    assert!(share >= 0.8, "{share}");
    assert!(others <= 4, "{others}");
}

#[test]
fn more_than_half_of_medium_pushes_of_a_quarter_of_a_second_are_found() {
    let (share, _) = found(0.25, 2.5, 13);
    assert!(share >= 0.5, "{share}");
}

#[test]
fn slow_pushes_are_found_although_they_are_weaker() {
    let (share, _) = found(1.5, 1.5, 14);
    assert!(share >= 0.6, "{share}");
}

#[test]
fn what_stands_out_where_a_load_is_borne_once_is_no_push() {
    let mut tracks = noise(&mut Pcg64::seed_from_u64(21));
    push(&mut tracks[2], 10.0, 0.5, 5.0);
    assert!(scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.iter().any(|p| p.joint == 2));
    // A few of its rows are not most of them.
    tracks[2].once.extend((505..512).map(|place| (0, place)));
    assert!(scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.iter().any(|p| p.joint == 2));
    tracks[2].once.extend((500..530).map(|place| (0, place)));
    assert!(scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.iter().all(|p| p.joint != 2));
}

#[test]
fn a_joint_whose_residual_always_wanders_is_not_pushed() {
    let mut rng = Pcg64::seed_from_u64(15);
    for _ in 0..100 {
        let mut tracks = noise(&mut rng);
        let phase = rng.random_range(0.0..6.0);
        for (place, x) in &mut tracks[1].motions[0].1 {
            *x += 2.0 * (2.0 * *place as f64 * STEP + phase).sin();
        }
        assert!(scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.iter().all(|p| p.joint != 1));
    }
}

#[test]
fn pushes_of_several_joints_at_a_time_are_one() {
    let mut tracks = noise(&mut Pcg64::seed_from_u64(16));
    push(&mut tracks[0], 10.0, 0.6, 4.0);
    push(&mut tracks[2], 10.05, 0.6, 4.0);
    push(&mut tracks[3], 17.0, 0.6, 4.0);
    let mut pushes = scan(&tracks, (&[], &[]), STEP, LEVEL).pushes;
    pushes.sort_by_key(|p| p.places[0]);
    assert!(matches!(&pushes[..], [a, b] if [0, 2].contains(&a.joint) && b.joint == 3), "{pushes:?}");
}

#[test]
fn what_joints_feel_at_a_time_adds_up() {
    let found = |shared: bool| {
        let mut rng = Pcg64::seed_from_u64(18);
        let once = |_| {
            let mut tracks = noise(&mut rng);
            for (joint, track) in tracks.iter_mut().enumerate().filter(|(joint, _)| shared || *joint == 0) {
                push(track, 10.0 + if shared { 0.0 } else { joint as f64 }, 0.5, 1.7);
            }
            usize::from(!scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.is_empty())
        };
        (0..60).map(once).sum::<usize>()
    };
    let (alone, together) = (found(false), found(true));
    assert!(together >= 50 && alone <= 35, "{together} and {alone} of 60");
}

#[test]
fn what_no_joint_tells_alone_all_joints_may() {
    let mut rng = Pcg64::seed_from_u64(25);
    let once = |_| {
        let mut tracks = noise(&mut rng);
        tracks.iter_mut().for_each(|track| push(track, 10.0, 0.5, 1.4));
        usize::from(!scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.is_empty())
    };
    let found = (0..60).map(once).sum::<usize>();
    println!("{found} of 60");
    assert!(found >= 40, "{found} of 60");
}

#[test]
fn what_a_model_takes_over_of_a_push_is_counted() {
    // A column of the model that is half of every push at its time.
    let mut rng = Pcg64::seed_from_u64(19);
    let mut found = [0; 2];
    for _ in 0..60 {
        let mut tracks = noise(&mut rng);
        push(&mut tracks[0], 10.0, 0.5, 3.0);
        let rows = tracks[0].motions[0].1.clone();
        let mut column: Vec<f64> = rows.iter().map(|_| 0.3 * normal(&mut rng)).collect();
        for ((place, _), x) in rows.iter().zip(&mut column) {
            *x += if (500..525).contains(place) { 1.0 } else { 0.0 };
        }
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let y: Vec<f64> = rows.iter().map(|r| r.1).collect();
        let fit = product(&column, &y) / product(&column, &column);
        tracks[0].motions[0].1.iter_mut().zip(&column).for_each(|((_, y), x)| *y -= fit * x);
        found[0] += usize::from(!scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.is_empty());
        tracks[0].columns = vec![column];
        for track in &mut tracks[1..] {
            track.columns = vec![Vec::new()];
        }
        found[1] += usize::from(!scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.is_empty());
    }
    println!("{found:?}");
    assert!(found[1] >= 40 && found[0] < found[1], "{found:?} of 60");
}

/// Noise that grows with the fourth power of a torque, and whether that torque is told.
fn uneven_noise(told: bool, rng: &mut Pcg64) -> Vec<Track> {
    let mut tracks = noise(rng);
    for track in &mut tracks {
        let (period, phase) = (rng.random_range(2.0..6.0), rng.random_range(0.0..6.0));
        let torque = |place: usize| (place as f64 * STEP / period + phase).sin();
        let rows = &mut track.motions[0].1;
        track.sizes = if told { vec![rows.iter().map(|r| torque(r.0)).collect()] } else { vec![] };
        rows.iter_mut().for_each(|(place, x)| *x *= 0.3 + 2.0 * torque(*place).powi(4));
    }
    tracks
}

#[test]
fn noise_that_is_large_where_the_torque_is_makes_no_pushes() {
    let mut rng = Pcg64::seed_from_u64(20);
    let runs = 300;
    let once = |_: &i32| !scan(&uneven_noise(true, &mut rng), (&[], &[]), STEP, LEVEL).pushes.is_empty();
    let false_alarms = (0..runs).filter(once).count();
    println!("{false_alarms} of {runs}");
    assert!(false_alarms <= 2, "{false_alarms} of {runs}");
}

#[test]
fn where_noise_is_known_to_be_small_smaller_pushes_are_found() {
    let mut rng = Pcg64::seed_from_u64(27);
    let runs = 60;
    let mut found = |told: bool| {
        let once = |_: &i32| {
            let mut tracks = uneven_noise(true, &mut rng);
            let torque = std::mem::take(&mut tracks[0].sizes);
            let rows = &tracks[0].motions[0].1;
            let away = |k: &usize| (100..1100).contains(&rows[*k].0) && torque[0][*k].abs() < 0.1;
            let Some(quiet) = (0..rows.len()).find(away) else { return false };
            let at = rows[quiet].0 as f64 * STEP;
            push(&mut tracks[0], at - 0.25, 0.5, 2.2);
            for track in &mut tracks[1..] {
                track.sizes.clear();
            }
            if told {
                tracks[0].sizes = torque;
            }
            scan(&tracks, (&[], &[]), STEP, LEVEL).pushes.iter().any(|p| p.joint == 0)
        };
        (0..runs).filter(once).count()
    };
    let (one_size, uneven) = (found(false), found(true));
    println!("{one_size} and {uneven} of {runs}");
    assert!(uneven >= 40 && one_size < 10, "{one_size} and {uneven} of {runs}");
}

#[test]
fn noise_that_joints_share_makes_no_pushes() {
    let mut rng = Pcg64::seed_from_u64(21);
    let (runs, level) = (300, 1e-3);
    let once = |_| {
        let mut tracks = noise(&mut rng);
        let shared: Vec<f64> = (0..ROWS).map(|_| normal(&mut rng)).collect();
        for track in &mut tracks {
            track.motions[0].1.iter_mut().for_each(|(place, x)| *x = 0.3 * *x + 0.95 * shared[*place]);
        }
        usize::from(!scan(&tracks, (&[], &[]), STEP, level).pushes.is_empty())
    };
    let false_alarms = (0..runs).map(once).sum::<usize>();
    println!("{false_alarms} of {runs}");
    assert!(false_alarms <= 3, "{false_alarms} of {runs}");
}

#[test]
fn edges_are_as_uncertain_as_they_say() {
    let mut rng = Pcg64::seed_from_u64(17);
    let mut outside = 0;
    for _ in 0..100 {
        let mut tracks = noise(&mut rng);
        let from = rng.random_range(4.0..20.0);
        for (place, x) in &mut tracks[0].motions[0].1 {
            if (0.0..0.6).contains(&(*place as f64 * STEP - from)) {
                *x += 3.0;
            }
        }
        let pushed = scan(&tracks, (&[], &[]), STEP, LEVEL).pushes;
        let Some(p) = pushed.iter().find(|p| p.joint == 0) else { continue };
        let error = (p.places[0] as f64 * STEP - from).abs();
        outside += usize::from(error > 2.0 * p.edges[0].max(1.0) * STEP + STEP);
    }
    assert!(outside <= 15, "{outside}");
}

#[test]
fn few_rows_are_not_scanned() {
    let short = track(0, (0..50).map(|k| (k, 1.0)).collect());
    assert!(scan(&[short], (&[], &[]), STEP, LEVEL).pushes.is_empty());
    assert!(scan(&[], (&[], &[]), STEP, LEVEL).pushes.is_empty());
}

#[test]
fn doubts_are_as_seldom_small_as_they_say() {
    let mut rng = Pcg64::seed_from_u64(26);
    let (runs, share) = (300, 0.05);
    let smallest = |tracks: &[Track]| {
        let pushes = scan(tracks, (&[], &[]), STEP, share).pushes;
        pushes.first().map_or(1.0, |push| push.doubt)
    };
    let passed = (0..runs).filter(|_| smallest(&noise(&mut rng)) <= share).count();
    println!("{passed} of {runs}");
    // Fifteen, and three standard deviations of that.
    assert!((4..=26).contains(&passed), "{passed} of {runs}");
}
