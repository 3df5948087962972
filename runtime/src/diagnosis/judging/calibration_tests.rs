use super::*;
use crate::diagnosis::judging::units::{Unit, Units};
use crate::testing::normal;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::ops::Range;

const ROWS: usize = 150;

/// One joint, `files` motions of one unit each of which the last is the target where there is a baseline.
fn units(files: usize, baseline: bool) -> Units {
    Units {
        units: (0..files).map(|f| Unit { file: f, target: !baseline || f + 1 == files }).collect(),
        rows: vec![(0..files).map(|f| f * ROWS..(f + 1) * ROWS).collect()],
        stretches: vec![(0..files).map(|f| f * ROWS..(f + 1) * ROWS).collect()],
        duration: 1.0,
        target_duration: 1.0,
    }
}

fn alone(
    units: &Units,
    regressors: &Regressors<'_>,
    law: &[Vec<f64>],
    residual: &[f64],
    common: bool,
) -> Option<Calibrated> {
    let background = Background::new(units, regressors, residual, 1);
    calibrate(
        units,
        regressors,
        &background,
        &Law { columns: law, residual, common, is_trend: false, trend_of: 0 },
    )
}

fn wave(rng: &mut Pcg64, rows: usize) -> Vec<f64> {
    let mut out = vec![0.0; rows];
    for k in 1..=4 {
        let (amplitude, phase) = (normal(rng), rng.random_range(0.0..6.3_f64));
        // Turned on from row to row instead of evaluated again.
        let (mut sine, mut cosine) = phase.sin_cos();
        let (turn_sine, turn_cosine) = (0.03 * f64::from(k)).sin_cos();
        for x in &mut out {
            *x += amplitude * sine;
            (sine, cosine) =
                (sine * turn_cosine + cosine * turn_sine, cosine * turn_cosine - sine * turn_sine);
        }
    }
    out
}

/// Noise that remembers, quantised, twice as loud in every other stretch of time.
fn noise(rng: &mut Pcg64, rows: usize) -> Vec<f64> {
    let mut x = 0.0;
    (0..rows)
        .map(|t| {
            x = 0.8 * x + 0.6 * normal(rng);
            let loud = if t / 40 % 2 == 0 { 1.0 } else { 2.0 };
            (loud * x / 0.2).round() * 0.2
        })
        .collect()
}

/// Evidence with the measured variation and without it, for a law whose amplitude is `amplitude` in the target (or
/// everywhere, without a baseline) and differs by `spread` from one motion to the next.
fn judged(rng: &mut Pcg64, files: usize, baseline: bool, amplitude: f64, spread: f64) -> [Evidence; 2] {
    let rows = files * ROWS;
    let shared = vec![wave(rng, rows), wave(rng, rows)];
    let law = wave(rng, rows);
    let mut y = noise(rng, rows);
    let free = if baseline { vec![vec![1.0; rows], wave(rng, rows)] } else { vec![] };
    for f in 0..files {
        let level = if !baseline || f + 1 == files { amplitude } else { 0.0 } + spread * normal(rng);
        let friction = 3.0 * normal(rng);
        for t in f * ROWS..(f + 1) * ROWS {
            y[t] += 2.0 * shared[0][t] - shared[1][t] + level * law[t];
            y[t] += free.iter().map(|c| friction * c[t]).sum::<f64>();
        }
    }
    let residual: Vec<f64> = (0..rows)
        .map(|t| {
            let there = if !baseline || t / ROWS + 1 == files { amplitude } else { 0.0 };
            y[t] - 2.0 * shared[0][t] + shared[1][t] - there * law[t]
        })
        .collect();
    let all = 0..rows;
    let regressors = Regressors {
        shared: &shared,
        y: &y,
        free: &[free],
        companions: &[vec![]],
        prior: None,
        between_motions: &[],
        of_joint: std::slice::from_ref(&all),
    };
    let found = alone(&units(files, baseline), &regressors, &[law], &residual, false).expect("determined");
    [
        found.evidence(),
        Calibrated { lambda: 1.0, freedom: f64::INFINITY, of_signs: None, level: 1.0, ..found }.evidence(),
    ]
}

fn rates(seed: u64, files: usize, baseline: bool, amplitude: f64, spread: f64, level: f64) -> [f64; 2] {
    let mut rng = Pcg64::seed_from_u64(seed);
    let runs = 1000;
    let mut below = [0; 2];
    for _ in 0..runs {
        let evidence = judged(&mut rng, files, baseline, amplitude, spread);
        below.iter_mut().zip(evidence).for_each(|(b, e)| *b += usize::from(e.p_value < level));
    }
    below.map(|b| b as f64 / f64::from(runs))
}

/// One joint with nothing but its torque.
fn plain<'a>(y: &'a [f64], all: &'a Range<usize>) -> Regressors<'a> {
    static NONE: [Vec<Vec<f64>>; 1] = [Vec::new()];
    Regressors {
        shared: &[],
        y,
        free: &NONE,
        companions: &NONE,
        prior: None,
        between_motions: &[],
        of_joint: std::slice::from_ref(all),
    }
}

#[test]
fn a_law_that_varies_anyway_is_no_change_however_well_its_noise_is_known() {
    let [calibrated, naive] = rates(5, 12, true, 0.0, 1.0, 0.01);
    println!("calibrated {calibrated}, without {naive}");
    assert!(calibrated < 0.025, "{calibrated}");
    assert!(naive > 0.2, "{naive}");
}

#[test]
fn coloured_quantised_noise_that_is_louder_at_times_is_no_change() {
    let [calibrated, _] = rates(6, 12, true, 0.0, 0.0, 0.01);
    assert!(calibrated < 0.02, "{calibrated}");
    let [alone, _] = rates(7, 10, false, 0.0, 0.0, 0.01);
    assert!(alone < 0.02, "{alone}");
}

#[test]
fn a_change_that_stands_out_of_the_variation_is_found_at_a_level_over_many_candidates() {
    let [changed, _] = rates(8, 12, true, 5.0, 0.3, 1e-4);
    assert!(changed > 0.7, "{changed}");
    let [alone, _] = rates(9, 10, false, 1.6, 0.05, 1e-4);
    assert!(alone > 0.9, "{alone}");
}

/// Of evidence for a law of an amplitude: how often there is any where there is no law, and where one is.
fn assert_rare_by_accident_and_found(mut evidence: impl FnMut(f64) -> Evidence) {
    let mut share = |amplitude: f64, level: f64| {
        let runs = 400;
        (0..runs).filter(|_| evidence(amplitude).p_value < level).count() as f64 / f64::from(runs)
    };
    let (by_accident, found) = (share(0.0, 0.01), share(5.0, 1e-4));
    println!("{by_accident}, {found}");
    assert!(by_accident < 0.025, "{by_accident}");
    assert!(found > 0.8, "{found}");
}

/// Evidence for a law that acts in the target alone, as one of torques that the baseline does not reach, of `amplitude`, where
/// laws of its kind differ by `spread` from one motion to the next.
fn unreached(rng: &mut Pcg64, amplitude: f64, spread: f64) -> Evidence {
    let (files, rows) = (12, 12 * ROWS);
    let companions: Vec<Vec<f64>> = (0..6).map(|_| wave(rng, rows)).collect();
    let mut law = wave(rng, rows);
    law[..rows - ROWS].fill(0.0);
    let mut y = noise(rng, rows);
    for f in 0..files {
        let levels: Vec<f64> = companions.iter().map(|_| spread * normal(rng)).collect();
        let of_law = amplitude + spread * normal(rng);
        for t in f * ROWS..(f + 1) * ROWS {
            y[t] += of_law * law[t] + levels.iter().zip(&companions).map(|(a, c)| a * c[t]).sum::<f64>();
        }
    }
    let residual: Vec<f64> = y.iter().zip(&law).map(|(y, law)| y - amplitude * law).collect();
    let (all, companions) = (0..rows, [companions]);
    let regressors = Regressors { companions: &companions, ..plain(&y, &all) };
    alone(&units(files, true), &regressors, &[law], &residual, false).expect("determined").evidence()
}

#[test]
fn a_law_that_the_baseline_does_not_reach_is_judged_by_how_laws_of_its_kind_differ() {
    let mut rng = Pcg64::seed_from_u64(12);
    assert_rare_by_accident_and_found(|amplitude| unreached(&mut rng, amplitude, 0.3));
}

/// Evidence for a law that only one of two motions of the baseline shows, in units whose amplitudes differ by `spread`, and that is
/// larger by `amplitude` in the target.
fn in_one_motion(rng: &mut Pcg64, amplitude: f64, spread: f64) -> Evidence {
    let (of_motion, count) = (6, 18);
    let rows = count * ROWS;
    let mut law = wave(rng, rows);
    law[of_motion * ROWS..2 * of_motion * ROWS].fill(0.0);
    let mut y = noise(rng, rows);
    for u in 0..count {
        let is_target = u / of_motion == 2;
        let level = if is_target { amplitude } else { 0.0 } + spread * normal(rng);
        (u * ROWS..(u + 1) * ROWS).for_each(|t| y[t] += level * law[t]);
    }
    let there = |t: usize| if t / (of_motion * ROWS) == 2 { amplitude } else { 0.0 };
    let residual: Vec<f64> = (0..rows).map(|t| y[t] - there(t) * law[t]).collect();
    let units = Units {
        units: (0..count).map(|u| Unit { file: u / of_motion, target: u / of_motion == 2 }).collect(),
        duration: 2.0,
        ..units(count, true)
    };
    let all = 0..rows;
    let regressors = plain(&y, &all);
    alone(&units, &regressors, &[law], &residual, true).expect("determined").evidence()
}

#[test]
fn a_law_that_one_motion_of_the_baseline_shows_is_judged_by_the_units_of_that_motion() {
    let mut rng = Pcg64::seed_from_u64(13);
    assert_rare_by_accident_and_found(|amplitude| in_one_motion(&mut rng, amplitude, 0.2));
}

#[test]
fn a_law_that_is_in_both_recordings_is_no_change() {
    let mut rng = Pcg64::seed_from_u64(10);
    let (files, rows) = (12, 12 * ROWS);
    let law = wave(&mut rng, rows);
    let y: Vec<f64> = noise(&mut rng, rows).iter().zip(&law).map(|(n, l)| n + 5.0 * l).collect();
    let residual: Vec<f64> = y.iter().zip(&law).map(|(y, l)| y - 5.0 * l).collect();
    let all = 0..rows;
    let regressors = plain(&y, &all);
    let tail = |common| {
        let law = std::slice::from_ref(&law);
        let found = alone(&units(files, true), &regressors, law, &residual, common).expect("determined");
        found.evidence().p_value
    };
    assert!(tail(true) > 1e-3, "{}", tail(true));
}

#[test]
fn a_column_that_the_model_makes_itself_has_no_evidence() {
    let mut rng = Pcg64::seed_from_u64(11);
    let rows = 10 * ROWS;
    let (y, column) = (noise(&mut rng, rows), wave(&mut rng, rows));
    let all = 0..rows;
    let shared = [column.clone()];
    let regressors = Regressors { shared: &shared, ..plain(&y, &all) };
    assert_eq!(alone(&units(10, false), &regressors, &[column], &y, false), None);
}

#[test]
fn of_two_laws_the_true_one_is_told_apart_only_where_it_is_well_ahead() {
    let mut rng = Pcg64::seed_from_u64(12);
    let rows = 10 * ROWS;
    let units = units(10, false);
    let all = 0..rows;
    // A rival that has half of its squares in common with the law is behind by half of what the law explains, S,
    // with a deviation of 2 sqrt(lambda S): told apart at 5 % from S = 43 lambda on. Waves drawn at random may have more in
    // common, and then stay tied however strong they are.
    let mut told = |amplitude: f64| -> [usize; 2] {
        let (mut right, mut wrong) = (0, 0);
        for _ in 0..200 {
            let law = wave(&mut rng, rows);
            let other = wave(&mut rng, rows);
            let rival: Vec<f64> = law.iter().zip(&other).map(|(a, b)| a + b).collect();
            let noise = noise(&mut rng, rows);
            let y: Vec<f64> = noise.iter().zip(&law).map(|(n, l)| n + amplitude * l).collect();
            let regressors = plain(&y, &all);
            let judged = |law: &[f64]| alone(&units, &regressors, &[law.to_vec()], &y, false);
            let (Some(a), Some(b)) = (judged(&law), judged(&rival)) else { continue };
            right += usize::from(rival_p_value(&a, &b, a.squares - b.squares) < 0.05);
            wrong += usize::from(rival_p_value(&b, &a, b.squares - a.squares) < 0.05);
        }
        [right, wrong]
    };
    let (weak, strong) = (told(0.4), told(3.0));
    println!("[right, wrong] of 200: weak {weak:?}, strong {strong:?}");
    assert!(weak[1] <= 4 && strong[1] <= 4, "{weak:?} {strong:?}");
    assert!(weak[0] < 50 && strong[0] > 100, "{weak:?} {strong:?}");
}

/// How sure a trend is, and how sure whichever unit is left out, of which so much is there in the first unit and in the others.
fn trend(rng: &mut Pcg64, first: f64, others: f64) -> [f64; 2] {
    let (files, rows) = (12, 12 * ROWS);
    let units = units(files, false);
    let shared = vec![wave(rng, rows), wave(rng, rows)];
    let column = wave(rng, rows);
    let there = |t: usize| if t < ROWS { first } else { others };
    let law = vec![(0..rows).map(|t| there(t) * column[t]).collect::<Vec<f64>>()];
    let residual = noise(rng, rows);
    let y: Vec<f64> = (0..rows).map(|t| residual[t] + shared[0][t] + law[0][t]).collect();
    let all = 0..rows;
    let regressors = Regressors { shared: &shared, ..plain(&y, &all) };
    let background = Background::new(&units, &regressors, &residual, 1);
    let law = Law { columns: &law, residual: &residual, common: false, is_trend: true, trend_of: 0 };
    let calibrated = calibrate(&units, &regressors, &background, &law).expect("a law");
    [calibrated.evidence(), calibrated.evidence_without_any()].map(|evidence| evidence.confidence(1))
}

#[test]
fn a_trend_that_a_single_unit_shows_is_sure_only_with_it() {
    let mut rng = Pcg64::seed_from_u64(41);
    for _ in 0..20 {
        let [sure, without] = trend(&mut rng, 4.0, 0.0);
        assert!(sure > 0.8 && without < 0.5, "{sure} {without}");
        let [sure, without] = trend(&mut rng, 2.0, 2.0);
        assert!(sure > 0.99 && without > 0.99, "{sure} {without}");
    }
}

/// Evidence of a law that grows as the fifth power of a torque, whose noise grows with that torque as far as `share`; other
/// laws of the joint do not grow so.
fn fifth_power(rng: &mut Pcg64, share: f64, amplitude: f64) -> Calibrated {
    let (files, rows) = (10, 10 * ROWS);
    let torque: Vec<f64> = (0..files).flat_map(|_| wave(rng, ROWS)).collect();
    let largest = torque.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let law: Vec<f64> = torque.iter().map(|x| (x / largest).powi(5)).collect();
    let residual: Vec<f64> =
        torque.iter().map(|x| (1.0 - share + share * 2.0 * (x / largest).abs()) * normal(rng)).collect();
    let y: Vec<f64> = (0..rows).map(|t| 3.0 * torque[t] + amplitude * law[t] + residual[t]).collect();
    let companions: Vec<Vec<f64>> = (0..20).map(|_| wave(rng, rows)).collect();
    let (all, shared, companions) = (0..rows, [torque], [companions]);
    let regressors = Regressors { shared: &shared, companions: &companions, ..plain(&y, &all) };
    alone(&units(files, false), &regressors, &[law], &residual, false).expect("determined")
}

#[test]
fn a_law_that_is_large_where_the_noise_is_has_the_variance_of_that_noise() {
    let mut rng = Pcg64::seed_from_u64(43);
    let (runs, level) = (1000, 0.01);
    let mut share_of = |share: f64, amplitude: f64, test: &dyn Fn(&Calibrated) -> bool| {
        let found = (0..runs).filter(|_| test(&fifth_power(&mut rng, share, amplitude))).count();
        found as f64 / f64::from(runs)
    };
    let sure = |found: &Calibrated| found.evidence().p_value < level;
    let with_one_variance = |found: &Calibrated| {
        Calibrated { lambda: 1.0, of_signs: None, level: 1.0, ..*found }.evidence().p_value < level
    };
    let naive = share_of(1.0, 0.0, &with_one_variance);
    assert!(naive > 0.04, "{naive}");
    let size = share_of(1.0, 0.0, &sure);
    assert!(size < 0.02, "{size}");
    // Noise of one size costs hardly any power.
    let [one, any] = [share_of(0.0, 0.5, &with_one_variance), share_of(0.0, 0.5, &sure)];
    assert!(any > one - 0.1, "{any} of {one}");
    println!("size {size} (one variance {naive}), power {any} (one variance {one})");
}

/// Evidence for a law in a motion of eight units beside a baseline of four, whose amplitude differs by `by_motion` from one motion to
/// the next and by `by_unit` from one unit to the next.
fn of_long_motions(rng: &mut Pcg64, amplitude: f64, [by_motion, by_unit]: [f64; 2]) -> Calibrated {
    const BASELINE: usize = 4;
    const OF_A_MOTION: usize = 8;
    let rows = (BASELINE + 1) * OF_A_MOTION * ROWS;
    let motion = |t: usize| t / (OF_A_MOTION * ROWS);
    let old = BASELINE * OF_A_MOTION;
    let mut cuts: Vec<Range<usize>> = (0..old).map(|u| u * ROWS..(u + 1) * ROWS).collect();
    cuts.push(old * ROWS..rows);
    let units = Units {
        units: (0..=old).map(|u| Unit { file: u / OF_A_MOTION, target: u == old }).collect(),
        rows: vec![cuts.clone()],
        stretches: vec![cuts],
        duration: 1.0,
        target_duration: OF_A_MOTION as f64,
    };
    let column = |rng: &mut Pcg64| -> Vec<f64> { (0..rows).map(|_| normal(rng)).collect() };
    let (shared, law) = (vec![column(rng), column(rng)], column(rng));
    let companions = vec![(0..12).map(|_| column(rng)).collect::<Vec<_>>()];
    let mut there = vec![0.0; rows];
    let laws: Vec<(&Vec<f64>, f64)> =
        std::iter::once((&law, amplitude)).chain(companions[0].iter().map(|c| (c, 0.0))).collect();
    for (column, amplitude) in laws {
        let of_motion: Vec<f64> = (0..=BASELINE).map(|_| by_motion * normal(rng)).collect();
        let of_unit: Vec<f64> = (0..rows / ROWS).map(|_| by_unit * normal(rng)).collect();
        for t in 0..rows {
            let change = if motion(t) == BASELINE { amplitude } else { 0.0 };
            there[t] += (change + of_motion[motion(t)] + of_unit[t / ROWS]) * column[t];
        }
    }
    let residual = column(rng);
    let y: Vec<f64> = (0..rows).map(|t| residual[t] + there[t] + 2.0 * shared[0][t] - shared[1][t]).collect();
    let all = 0..rows;
    let regressors = Regressors {
        shared: &shared,
        y: &y,
        free: &[vec![]],
        companions: &companions,
        prior: None,
        between_motions: &[],
        of_joint: std::slice::from_ref(&all),
    };
    alone(&units, &regressors, &[law], &residual, true).expect("determined")
}

#[test]
fn a_law_that_differs_between_motions_or_units_is_seldom_a_change() {
    let mut rng = Pcg64::seed_from_u64(91);
    for spread in [[0.0, 0.0], [0.1, 0.0], [0.0, 0.2], [0.1, 0.2]] {
        let runs = 400;
        let is_told =
            (0..runs).filter(|_| of_long_motions(&mut rng, 0.0, spread).evidence().p_value < 0.05).count();
        println!("{spread:?}: {is_told} of {runs}");
        assert!(is_told as f64 <= 0.075 * f64::from(runs), "{spread:?}: {is_told} of {runs}");
    }
}

#[test]
fn a_change_is_seen_where_units_are_short_and_other_laws_are_as_before() {
    let mut rng = Pcg64::seed_from_u64(92);
    let runs = 100;
    let is_told = |rng: &mut Pcg64| of_long_motions(rng, 0.7, [0.0, 0.2]).evidence().p_value < 1e-3;
    let told = (0..runs).filter(|_| is_told(&mut rng)).count();
    println!("{told} of {runs}");
    assert!(told >= 95, "{told} of {runs}");
}
