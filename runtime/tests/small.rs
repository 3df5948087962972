//! A law that is there, beside as much that nothing explains: told as small, with how large it had to be. The same law is
//! named where what is left is noise.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, planar};
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::recording::Trajectory;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const SEED: u64 = 11;
/// Root mean square of a torque that no variable orders, N.m, and how long it lasts, s.
const DISTURBANCE: f64 = 1.7;
const LASTS: f64 = 0.02;
/// Friction that varies along the travel of joint 1, N.m.
const VARIES: f64 = 1.2;

fn diagnosed(hidden: &Hidden) -> Diagnosis {
    let robot = planar();
    let motions = robot.record(&robot.motions(3, 8.0, SEED), hidden, SEED);
    let mut settings = Settings::default();
    settings.threads = 1;
    let diagnosis = diagnose(&robot.model, &motions, &[], &settings, &Silent).unwrap();
    for f in &diagnosis.findings {
        eprintln!("{}", f.sentence);
    }
    for s in &diagnosis.small {
        eprintln!("small: {s:?}");
    }
    diagnosis
}

fn varies_along_the_travel(motion: &mut Trajectory) {
    let q = motion.position[0].clone();
    for t in 0..q.len() {
        let direction = (q[(t + 5).min(q.len() - 1)] - q[t.saturating_sub(5)]).signum();
        motion.torque[0][t] += VARIES * direction * (3.0 * q[t]).sin();
    }
}

fn disturbed(motion: &mut Trajectory) {
    let mut random = Pcg64::seed_from_u64((1e6 * motion.position[0][0].abs()) as u64);
    let keep = (-(motion.time[1] - motion.time[0]) / LASTS).exp();
    let mut torque = 0.0;
    for t in 0..motion.time.len() {
        let fresh: f64 = StandardNormal.sample(&mut random);
        torque = keep * torque + DISTURBANCE * (1.0 - keep * keep).sqrt() * fresh;
        motion.torque[0][t] += torque;
    }
}

fn both(motion: &mut Trajectory) {
    varies_along_the_travel(motion);
    disturbed(motion);
}

#[test]
fn a_law_is_named_where_noise_is_all_that_is_left() {
    let diagnosis = diagnosed(&Hidden::in_recording(varies_along_the_travel));
    assert_eq!(diagnosis.findings.len(), 1);
    assert_eq!(diagnosis.findings[0].effect, "position_dependent_friction");
    assert!(diagnosis.small.is_empty());
}

#[test]
fn the_same_law_is_small_beside_as_much_that_nothing_explains() {
    let diagnosis = diagnosed(&Hidden::in_recording(both));
    assert!(diagnosis.findings.is_empty());
    let small = &diagnosis.small[0];
    assert_eq!(
        (small.effect.as_str(), small.joints.as_slice()),
        ("position_dependent_friction", [1].as_slice())
    );
    assert!(small.torque < small.least, "{small:?}");
}
