use super::*;
use crate::testing::normal;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const RATE: f64 = 100.0;

/// Two joints with a Coulomb friction of 10 and 4 that stand for 12 s somewhere within 0.9 of it, with noise.
fn standing(rng: &mut Pcg64) -> Vec<Vec<f64>> {
    [10.0, 4.0]
        .iter()
        .map(|coulomb| {
            let level = 0.9 * coulomb * rng.random_range(-1.0..1.0);
            (0..1200).map(|_| level + 0.1 * coulomb * rng.random_range(-1.0..1.0)).collect()
        })
        .collect()
}

fn seen(beyond: &[Vec<f64>]) -> Seen {
    seen_once_of(1, beyond)
}

/// The same of one of so many times that the robot stands.
fn seen_once_of(times: usize, beyond: &[Vec<f64>]) -> Seen {
    look(&Standing { times, ..standing_still(beyond, &vec![true; beyond[0].len()]) })
}

/// The two joints at rest where they are `still`, for the only time; nothing is uneven along the path.
fn standing_still<'a>(beyond: &'a [Vec<f64>], still: &'a [bool]) -> Standing<'a> {
    let coulomb = &[Some(10.0), Some(4.0)];
    Standing { rate: RATE, start: 0.0, beyond, still, coulomb, uneven: &[0.0, 0.0], times: 1 }
}

/// Half a sine wave from `from` on for `lasts` seconds.
fn pushed(series: &mut [f64], from: f64, lasts: f64, height: f64) {
    for (t, x) in series.iter_mut().enumerate() {
        let at = (t as f64 / RATE - from) / lasts;
        if (0.0..1.0).contains(&at) {
            *x += height * (std::f64::consts::PI * at).sin();
        }
    }
}

#[test]
fn a_robot_that_stands_within_its_friction_is_not_pushed() {
    let mut rng = Pcg64::seed_from_u64(1);
    for _ in 0..300 {
        let seen = seen(&standing(&mut rng));
        assert_eq!((seen.pushes, seen.loads), (vec![], vec![]));
        assert!((seen.time - 12.0).abs() < 1e-9);
    }
}

#[test]
fn pushes_of_three_times_the_friction_are_found_where_they_are() {
    let mut rng = Pcg64::seed_from_u64(2);
    for k in 0..200 {
        let mut beyond = standing(&mut rng);
        let (from, sign) = (rng.random_range(1.0..5.0), if k % 2 == 0 { 1.0 } else { -1.0 });
        pushed(&mut beyond[0], from, 1.0, 30.0 * sign);
        pushed(&mut beyond[1], from + 5.0, 0.8, 12.0 * sign);
        let seen = seen(&beyond);
        assert_eq!(seen.pushes.len(), 2, "run {k}: {seen:?}");
        for (push, (joint, window)) in
            seen.pushes.iter().zip([(0, [from, from + 1.0]), (1, [from + 5.0, from + 5.8])])
        {
            assert_eq!(push.joints.iter().map(|p| p.joint).collect::<Vec<_>>(), vec![joint]);
            for (edge, truth, sigma) in [(0, window[0], push.edges[0]), (1, window[1], push.edges[1])] {
                assert!((push.window[edge] - truth).abs() < 0.05 + 4.0 * sigma, "{push:?} {window:?}");
            }
            let height = [30.0, 12.0][joint] * sign;
            assert!((push.joints[0].largest - height).abs() < 3.0 * push.joints[0].sigma);
            assert!(push.doubt < 1e-6);
        }
    }
}

#[test]
fn friction_that_holds_a_little_more_now_and_then_is_hardly_ever_a_push() {
    let mut rng = Pcg64::seed_from_u64(7);
    let times = 30;
    // Static friction is 1.25 times that of sliding in one of a hundred.
    let mut holds = |coulomb: f64| coulomb * (1.0 + 0.25 / 2.326 * normal(&mut rng));
    let mut is_pushed = || {
        (0..times).any(|_| {
            let beyond = [10.0, 4.0].map(|coulomb| {
                let mut series = vec![0.0; 300];
                pushed(&mut series, 0.5, 2.0, holds(coulomb));
                series
            });
            !seen_once_of(times, &beyond).pushes.is_empty()
        })
    };
    let recordings = (0..400).filter(|_| is_pushed()).count();
    assert!(recordings <= 2, "{recordings} of 400");
}

#[test]
fn what_is_uneven_along_the_path_holds_a_joint_too() {
    let mut beyond = vec![vec![0.0; 600]; 2];
    pushed(&mut beyond[0], 1.0, 2.0, 20.0);
    let still = vec![true; 600];
    let pushes = |uneven: f64| {
        look(&Standing { uneven: &[uneven, 0.0], ..standing_still(&beyond, &still) }).pushes.len()
    };
    assert_eq!([0.0, 1.0, 4.0].map(pushes), [1, 1, 0]);
}

#[test]
fn joints_that_are_pushed_together_are_one_push() {
    let mut beyond = standing(&mut Pcg64::seed_from_u64(3));
    pushed(&mut beyond[0], 4.0, 1.0, 40.0);
    pushed(&mut beyond[1], 4.1, 1.0, -16.0);
    let seen = seen(&beyond);
    assert_eq!(seen.pushes.len(), 1);
    assert_eq!(seen.pushes[0].joints.iter().map(|p| p.joint).collect::<Vec<_>>(), vec![0, 1]);
}

#[test]
fn a_torque_without_beginning_and_end_is_a_load_and_no_push() {
    let mut beyond = standing(&mut Pcg64::seed_from_u64(4));
    beyond[0].iter_mut().for_each(|x| *x += 25.0);
    let seen = seen(&beyond);
    assert!(seen.pushes.is_empty());
    assert_eq!(seen.loads.len(), 1);
    assert_eq!(seen.loads[0].joint, 0);
}

#[test]
fn an_impact_and_motion_are_no_push_at_rest() {
    let mut beyond = standing(&mut Pcg64::seed_from_u64(5));
    pushed(&mut beyond[0], 4.0, 0.15, 60.0);
    assert!(seen(&beyond).pushes.is_empty());
    pushed(&mut beyond[0], 8.0, 1.0, 60.0);
    let still: Vec<bool> = (0..1200).map(|t| !(750..950).contains(&t)).collect();
    assert!(look(&standing_still(&beyond, &still)).pushes.is_empty());
}

#[test]
fn a_joint_without_known_friction_is_not_judged() {
    let mut beyond = standing(&mut Pcg64::seed_from_u64(6));
    pushed(&mut beyond[0], 4.0, 1.0, 60.0);
    let still = vec![true; 1200];
    let unknown = Standing { coulomb: &[None, Some(4.0)], ..standing_still(&beyond, &still) };
    assert_eq!(look(&unknown).pushes, vec![]);
}
