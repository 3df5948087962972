use super::UniformGrid;
use crate::signal::oracle::{oracle, worst};

#[test]
fn the_spline_agrees_with_scipy() {
    for case in oracle().spline {
        let grid = UniformGrid::of("x", &case.time, Some(case.rate)).expect("valid stamps");
        assert_eq!(grid.len, case.output.len());
        assert!(worst(&grid.resample(&case.input), &case.output) < 1e-9);
    }
}

#[test]
fn uniform_stamps_are_kept_as_they_are() {
    // Stamps as printed with four decimals.
    let time: Vec<f64> = (0..4000).map(|k| (k as f64 * 0.002 * 1e4).round() / 1e4).collect();
    let grid = UniformGrid::of("x", &time, None).expect("valid stamps");
    assert!(grid.is_exact());
    assert_eq!(grid.rate, 500.0);
    let x: Vec<f64> = time.iter().map(|t| t.sin()).collect();
    assert_eq!(grid.resample(&x), x);
}

#[test]
fn a_cubic_is_reproduced_from_jittered_stamps() {
    let time: Vec<f64> = (0..200).map(|k| 0.01 * k as f64 + 0.002 * (k as f64 * 1.7).sin()).collect();
    let cubic = |t: f64| 2.0 - t + 3.0 * t * t - 0.5 * t * t * t;
    let grid = UniformGrid::of("x", &time, None).expect("valid stamps");
    assert!(!grid.is_exact());
    let out = grid.resample(&time.iter().map(|&t| cubic(t)).collect::<Vec<_>>());
    for (k, y) in out.iter().enumerate() {
        let t = grid.start + k as f64 / grid.rate;
        assert!((y - cubic(t)).abs() < 1e-9, "{k}: {y}");
    }
}

#[test]
fn two_readings_of_one_instant_count_as_one() {
    let mut time: Vec<f64> = (0..100).map(|k| 0.01 * k as f64).collect();
    time.insert(50, 0.4902);
    let mut x = vec![1.0; 101];
    (x[49], x[50]) = (1.1, 0.9);
    let grid = UniformGrid::of("x", &time, Some(100.0)).expect("valid stamps");
    for y in grid.resample(&x) {
        assert!((y - 1.0).abs() < 1e-12, "{y}");
    }
}

#[test]
fn misuse_is_told() {
    assert!(UniformGrid::of("x", &[0.0, 1.0, 1.0, 2.0], None).is_err());
    assert!(UniformGrid::of("x", &[0.0, 1.0], None).is_err());
    assert!(UniformGrid::of("x", &[0.0, 1.0, f64::NAN, 2.0], None).is_err());
    assert!(UniformGrid::of("x", &[0.0, 1.0, 2.5, 3.0], Some(0.0)).is_err());
    assert!(UniformGrid::of("x", &[0.0, 1e-9, 2.5e-9, 1e9], None).is_err());
}
