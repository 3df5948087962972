//! Diagnoses of simulated recordings whose hidden physics is known: two small robots, three random motions of 4.5 s in
//! closed loop, 500 Hz, the robots' nominal noise.
//!
//! Sizes are clearly visible ones by `docs/visible.md`. Each test prints what it took and what was found:
//! `cargo test -p dynid-runtime --test diagnosis -- --nocapture`.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::{LazyLock, OnceLock};
use std::time::Instant;

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, DiagnosisError, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};
use dynid_runtime::model::Robot;
use dynid_runtime::prediction::{Comparison, Predictor, evaluate};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::excitation::ExcitingMotion;
use dynid_runtime::simulation::replay::replay;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Motions of a recording.
const MOTIONS: u64 = 3;
/// Length of each, s.
const LENGTH: f64 = 4.5;
/// Seeds of the motions and the noise of the recording that is diagnosed, and of the baseline.
const SEED: u64 = 1;
const BASELINE_SEED: u64 = 51;

/// A robot with its motions. Tests share them: planning motions takes as long as moving along them.
struct Bench {
    robot: SimulatedRobot,
    motions: Vec<ExcitingMotion>,
    baseline: OnceLock<Vec<Trajectory>>,
}

impl Bench {
    fn of(robot: SimulatedRobot) -> Self {
        let motions = robot.motions(MOTIONS, LENGTH, SEED);
        Self { robot, motions, baseline: OnceLock::new() }
    }

    /// Other motions of the robot before anything was hidden in it.
    fn baseline(&self) -> &[Trajectory] {
        self.baseline.get_or_init(|| self.baseline_with(&Hidden::nothing()))
    }

    /// The same of a robot in which something was hidden already.
    fn baseline_with(&self, hidden: &Hidden) -> Vec<Trajectory> {
        self.robot.record(&self.robot.motions(MOTIONS, LENGTH, BASELINE_SEED), hidden, BASELINE_SEED)
    }
}

fn planar() -> &'static Bench {
    static PLANAR: LazyLock<Bench> = LazyLock::new(|| Bench::of(common::planar()));
    &PLANAR
}

fn scara() -> &'static Bench {
    static SCARA: LazyLock<Bench> = LazyLock::new(|| Bench::of(common::scara()));
    &SCARA
}

/// Diagnoses a robot in which something is hidden.
fn diagnosed(robot: &Bench, hidden: &Hidden) -> Diagnosis {
    run(robot, hidden, &[])
}

/// The same against a baseline.
fn diagnosed_against_baseline(robot: &Bench, hidden: &Hidden) -> Diagnosis {
    run(robot, hidden, robot.baseline())
}

fn run(bench: &Bench, hidden: &Hidden, baseline: &[Trajectory]) -> Diagnosis {
    let robot = &bench.robot;
    let start = Instant::now();
    let motions = robot.record(&bench.motions, hidden, SEED);
    let simulated = start.elapsed().as_secs_f64();
    // The tests themselves are parallel.
    let mut settings = Settings::default();
    settings.threads = 1;
    let diagnosis = diagnose(&robot.model, &motions, baseline, &settings, &Silent).unwrap();
    let took = start.elapsed().as_secs_f64() - simulated;
    eprintln!(
        "{}: simulated in {simulated:.1} s, diagnosed in {took:.1} s",
        std::thread::current().name().unwrap_or("")
    );
    for finding in &diagnosis.findings {
        let quantities: Vec<String> = finding
            .parameters
            .iter()
            .map(|(name, p)| format!("{name} {:.4} +- {:.4} {}", p.value, p.sigma, p.unit))
            .collect();
        eprintln!("  {} {:?}: {}", finding.effect, finding.joints, quantities.join(", "));
    }
    diagnosis
}

/// Asserts that one effect is named, on these joints (numbers j), and nothing else.
fn assert_only(diagnosis: &Diagnosis, effect: EffectKind, joints: &[usize]) {
    let named: Vec<_> = diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect();
    assert_eq!(named, [(effect.id(), joints)]);
}

/// Asserts that a quantity of the one finding is within four of its standard deviations of the truth.
fn assert_within_four_sigma(diagnosis: &Diagnosis, quantity: &str, truth: f64) {
    assert_close(diagnosis, quantity, truth, 0.0);
}

/// Asserts that the model that is saved predicts motion of other seeds, and follows it in a simulation, with a third of the error
/// at most.
fn assert_follows(bench: &Bench, hidden: &Hidden, diagnosis: &Diagnosis) {
    let robot = &bench.robot;
    let others = robot.record(&robot.motions(2, LENGTH, SEED + 7), hidden, SEED + 7);
    let terms = diagnosis.terms();
    let prepared = Comparison::default().prepare(&others).unwrap();
    let predictors = Predictor::before_and_after(diagnosis, &terms);
    let predicted = evaluate(&robot.model, &predictors, &prepared.motions, &prepared.settings, &[]).unwrap();
    let forward = replay(&robot.model, "others", &others, diagnosis, &|_| ()).unwrap();
    assert_eq!(forward.left_out, Vec::<String>::new());
    let [before, after] = [0, 1].map(|k| predicted.predictions[k].errors.relative_error.unwrap());
    eprintln!(
        "  others: predicted {before:.4} -> {after:.4}, simulated {:.4} -> {:.4}",
        forward.before, forward.after
    );
    assert!(after < 0.3 * before, "{before} {after}");
    assert!(forward.after < 0.3 * forward.before, "{forward:?}");
}

fn assert_close(diagnosis: &Diagnosis, quantity: &str, truth: f64, more: f64) {
    let found = &diagnosis.findings[0].parameters[quantity];
    let off = (found.value - truth).abs();
    assert!(
        found.sigma > 0.0 && off < 4.0 * found.sigma + more,
        "{quantity}: {} +- {}, truth {truth}",
        found.value,
        found.sigma
    );
    // An estimate with a huge standard deviation would be within four of them, too.
    assert!(found.sigma < 0.2 * truth.abs(), "{quantity}: {} +- {}", found.value, found.sigma);
}

#[test]
fn friction_that_falls_from_rest_is_named_stribeck() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::Stribeck, Place::Joint(1), &[0.3], &[3.0]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::Stribeck, &[2]);
    assert_within_four_sigma(&diagnosis, "fs", 3.0);
    assert_within_four_sigma(&diagnosis, "vs", 0.3);
    // Its picture is the law, not a mean of it over what lies between two points of the residual.
    let finding = &diagnosis.findings[0];
    let [fs, vs] = ["fs", "vs"].map(|name| finding.parameters[name].value);
    let fine = &finding.curve.as_ref().expect("a picture").fine;
    assert!(fine.x.len() > 100, "{}", fine.x.len());
    for (x, torque) in fine.x.iter().zip(&fine.torque).filter(|(x, _)| x.abs() > 0.05) {
        let law = fs * (-(x / vs).powi(2)).exp() * x.signum();
        assert!((torque - law).abs() < 0.01 * fs, "{torque} instead of {law} at {x} rad/s");
    }
}

#[test]
fn a_law_that_is_nearly_all_that_is_open_is_named_whatever_the_motions() {
    // What a shape of the grid leaves of it is loudest near rest, where it acts: that is neither noise nor pushes.
    let robot = &planar().robot;
    let hidden = Hidden::effect(EffectKind::Stribeck, Place::Joint(1), &[0.3], &[3.0]);
    for seed in [15, 16, 24, 31] {
        let recorded = robot.record(&robot.motions(MOTIONS, 6.0, seed), &hidden, seed);
        let diagnosis = diagnose(&robot.model, &recorded, &[], &Settings::default(), &Silent).unwrap();
        assert_only(&diagnosis, EffectKind::Stribeck, &[2]);
    }
}

#[test]
fn friction_that_grows_with_the_load_is_named_with_its_coefficient() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::LoadDependentFriction, Place::Joint(0), &[], &[0.1]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::LoadDependentFriction, &[1]);
    assert_within_four_sigma(&diagnosis, "mu", 0.1);
}

#[test]
fn friction_that_bends_with_speed_is_named_with_its_power() {
    let robot = scara();
    let hidden = Hidden::effect(EffectKind::NonlinearViscous, Place::Joint(1), &[0.5], &[4.0]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::NonlinearViscous, &[2]);
    assert_within_four_sigma(&diagnosis, "p", 0.5);
    // What was hidden is 4 N.m at 1 rad/s; what is found is the torque at v0.
    let v0 = diagnosis.findings[0].parameters["v0"].value;
    assert_within_four_sigma(&diagnosis, "f", 4.0 * v0.sqrt());
}

#[test]
fn friction_that_differs_by_direction_is_named() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::AsymmetricFriction, Place::Joint(0), &[], &[0.5]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::AsymmetricFriction, &[1]);
    assert_within_four_sigma(&diagnosis, "half_difference", 0.5);
}

#[test]
fn friction_that_varies_along_the_travel_is_named_with_its_wave_number() {
    let robot = scara();
    let hidden = Hidden::effect(EffectKind::PositionDependentFriction, Place::Joint(0), &[2.0], &[1.2, 0.9]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::PositionDependentFriction, &[1]);
    assert_within_four_sigma(&diagnosis, "amplitude", 1.5);
    assert_within_four_sigma(&diagnosis, "wave_number", 2.0);
}

#[test]
fn a_spring_on_a_revolute_joint_is_told_from_gravity() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::Spring, Place::Joint(1), &[], &[2.0]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::Spring, &[2]);
    assert_within_four_sigma(&diagnosis, "k", 2.0);
}

#[test]
fn a_transmission_that_rings_from_the_start_is_named_with_its_stiffness() {
    let robot = planar();
    // Stiffness, damping, rotor, no play: some 6 Hz, and 30 mrad under the weight of the arm.
    let transmission = [1500.0, 4.6, 0.12, 0.0];
    let hidden = Hidden::effect(EffectKind::JointElasticity, Place::Joint(0), &[6.0], &transmission);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::JointElasticity, &[1]);
    assert_within_four_sigma(&diagnosis, "k", transmission[0]);
    assert_within_four_sigma(&diagnosis, "d", transmission[1]);
}

#[test]
fn a_torque_that_bends_with_the_position_is_no_spring() {
    let robot = scara();
    // No line and no lever bends as often.
    let curve = [0.0, 0.0, 2.0, 0.0, 2.0];
    let hidden = Hidden::effect(EffectKind::PositionDependentTorque, Place::Joint(0), &[0.0, 2.1], &curve);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::PositionDependentTorque, &[1]);
    // Highest less lowest value of numpy.polynomial.legendre.legval(q / 2.1, [0, 0, 0, 2, 0, 2]) over the travel of the
    // motions, -1.89 to 0.97 rad.
    assert_within_four_sigma(&diagnosis, "swing", 1.962);
}

#[test]
fn a_spring_on_a_slide_is_named_in_newton_per_metre() {
    let robot = scara();
    let hidden = Hidden::effect(EffectKind::Spring, Place::Joint(2), &[], &[100.0]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::Spring, &[3]);
    assert_within_four_sigma(&diagnosis, "k", 100.0);
    assert_eq!(diagnosis.findings[0].parameters["k"].unit, "N/m");
}

#[test]
fn a_ripple_once_a_motor_turn_is_named_with_its_order() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::TorqueRipple, Place::Joint(0), &[50.0], &[0.8, 0.6]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::TorqueRipple, &[1]);
    assert_within_four_sigma(&diagnosis, "amplitude", 1.0);
    assert_within_four_sigma(&diagnosis, "order_per_motor_turn", 1.0);
}

/// Torques that come four samples later, 8 ms.
fn late(motion: &mut Trajectory) {
    for torque in &mut motion.torque {
        torque.rotate_right(4);
    }
}

#[test]
fn an_encoder_whose_zero_is_off_by_a_large_angle_is_told_whole() {
    fn off<const HUNDREDTHS: i32>(motion: &mut Trajectory) {
        motion.position[0].iter_mut().for_each(|q| *q -= f64::from(HUNDREDTHS) / 100.0);
    }
    for (off, angle) in [(off::<-80> as fn(&mut Trajectory), -0.8), (off::<157>, 1.57), (off::<-250>, -2.5)] {
        let off = Hidden::in_recording(off);
        let diagnosis = diagnosed(planar(), &off);
        assert_only(&diagnosis, EffectKind::PositionOffset, &[1]);
        assert_within_four_sigma(&diagnosis, "offset", angle);
        assert_follows(planar(), &off, &diagnosis);
    }
}

#[test]
fn a_drive_that_records_twice_its_torque_is_told_with_its_factor() {
    let twice = Hidden::in_recording(|motion| motion.torque[0].iter_mut().for_each(|x| *x *= 2.0));
    let diagnosis = diagnosed(planar(), &twice);
    assert_eq!(diagnosis.findings.len(), 1);
    // Of two joints, the other may as well record half of its torque.
    let on_first = diagnosis.findings[0].joints == [1];
    assert_within_four_sigma(&diagnosis, "factor", if on_first { 2.0 } else { 0.5 });
    let tied = &diagnosis.cannot_tell[0];
    assert_eq!(
        (&tied.between[..], &tied.joints[..]),
        (&["torque_constant_error"; 2].map(String::from)[..], &[1, 2][..])
    );
    assert_follows(planar(), &twice, &diagnosis);
}

#[test]
fn torques_that_are_late_are_named_a_delay() {
    let robot = planar();
    let diagnosis = diagnosed(robot, &Hidden::in_recording(late));
    assert_only(&diagnosis, EffectKind::TimeDelay, &[]);
    assert_within_four_sigma(&diagnosis, "delay", 0.008);
}

#[test]
fn torques_that_have_become_late_since_the_baseline_are_named_a_delay() {
    let robot = planar();
    let hidden = Hidden::in_recording(late);
    let diagnosis = diagnosed_against_baseline(robot, &hidden);
    assert_only(&diagnosis, EffectKind::TimeDelay, &[]);
    assert_within_four_sigma(&diagnosis, "delay", 0.008);
    // Those that were as late before are no news.
    let diagnosis = run(robot, &hidden, &robot.baseline_with(&hidden));
    assert!(diagnosis.findings.is_empty(), "{:?}", diagnosis.verdict);
}

#[test]
fn times_that_run_at_half_the_rate_since_the_baseline_are_told_by_their_factor() {
    let robot = planar();
    let stretched = |motion: &mut Trajectory| motion.time.iter_mut().for_each(|t| *t *= 2.0);
    let stretched = Hidden::in_recording(stretched);
    let diagnosis = diagnosed_against_baseline(robot, &stretched);
    assert_only(&diagnosis, EffectKind::WrongSampleRate, &[]);
    assert_within_four_sigma(&diagnosis, "rate_error", 1.0);
    assert_follows(robot, &stretched, &diagnosis);
}

#[test]
fn a_body_at_the_flange_is_weighed_against_the_baseline() {
    let robot = planar();
    let (mass, x) = (0.15, 0.4);
    // XX XY XZ YY YZ ZZ MX MY MZ M of a point on x of the last link.
    let about = mass * x * x;
    let inertial = [0.0, 0.0, 0.0, about, 0.0, about, mass * x, 0.0, 0.0, mass];
    let hidden = Hidden::effect(EffectKind::Payload, Place::Link(1), &[], &inertial);
    let diagnosis = diagnosed_against_baseline(robot, &hidden);
    assert_only(&diagnosis, EffectKind::Payload, &[]);
    assert_within_four_sigma(&diagnosis, "mass", mass);
    // The standard deviation of the centre is that for a known mass.
    let parameters = &diagnosis.findings[0].parameters;
    let (of_mass, of_x) = (&parameters["mass"], &parameters["x"]);
    let sigma = of_x.sigma.hypot(of_x.value * of_mass.sigma / of_mass.value);
    assert!((of_x.value - x).abs() < 4.0 * sigma, "x: {} +- {sigma}, truth {x}", of_x.value);
}

#[test]
fn a_base_that_was_tilted_is_named_with_both_angles() {
    let robot = scara();
    let (about_x, about_y) = (0.03_f64, 0.015_f64);
    let tilt = move |robot: &mut Robot| {
        let [_, _, g] = robot.gravity;
        // Turned about y, then about x.
        robot.gravity =
            [g * about_y.sin(), -g * about_y.cos() * about_x.sin(), g * about_y.cos() * about_x.cos()];
    };
    let hidden = Hidden::in_robot(move |world| world.change_table(tilt).unwrap());
    let diagnosis = diagnosed_against_baseline(robot, &hidden);
    assert_only(&diagnosis, EffectKind::BaseTilt, &[]);
    assert_within_four_sigma(&diagnosis, "tilt_1", about_x);
    assert_within_four_sigma(&diagnosis, "tilt_2", about_y);
    assert_follows(robot, &hidden, &diagnosis);
}

#[test]
fn friction_that_grew_since_the_baseline_is_a_level_change() {
    let robot = scara();
    let grown = 0.25;
    let hidden = Hidden::in_robot(move |world| world.scale_friction(1, 1.0 + grown));
    let diagnosis = diagnosed_against_baseline(robot, &hidden);
    assert_only(&diagnosis, EffectKind::FrictionLevelChange, &[2]);
    assert_within_four_sigma(&diagnosis, "factor", 1.0 + grown);
}

#[test]
fn what_was_missing_before_is_listed_once_and_is_no_change() {
    let robot = planar();
    let friction = || common::term(EffectKind::LoadDependentFriction, Place::Joint(0), &[], &[0.15]);
    let before = Hidden::in_robot(move |world| world.put(&friction()));
    let baseline = robot.baseline_with(&before);
    let spring = || common::term(EffectKind::Spring, Place::Joint(1), &[], &[3.0]);
    let now = Hidden::in_robot(move |world| {
        world.put(&friction());
        world.put(&spring());
    });
    let diagnosis = run(robot, &now, &baseline);
    assert_only(&diagnosis, EffectKind::Spring, &[2]);
    let standing: Vec<_> =
        diagnosis.standing.iter().map(|s| (s.effect.as_str(), s.joints.as_slice())).collect();
    assert_eq!(standing, [("load_dependent_friction", &[1][..])]);
    assert!(diagnosis.verdict.iter().any(|v| v.contains("from before")), "{:?}", diagnosis.verdict);
}

#[test]
fn a_torque_constant_that_is_wrong_since_the_baseline_is_named() {
    let robot = planar();
    let wrong = |motion: &mut Trajectory| motion.torque[0].iter_mut().for_each(|x| *x *= 1.1);
    let diagnosis = diagnosed_against_baseline(robot, &Hidden::in_recording(wrong));
    assert_only(&diagnosis, EffectKind::TorqueConstantError, &[1]);
    assert_within_four_sigma(&diagnosis, "factor", 1.1);
}

#[test]
fn friction_that_grows_with_the_weight_alone_is_told_as_that() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::LoadDependentFriction, Place::Joint(0), &[0.0], &[0.15]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::LoadDependentFriction, &[1]);
    assert_within_four_sigma(&diagnosis, "mu", 0.15);
    assert!(diagnosis.findings[0].parameters.contains_key("load_of_gravity_alone"));
}

#[test]
fn friction_that_grows_with_what_the_gear_transmits_is_told_with_the_rotor_in_front_of_it() {
    let robot = planar();
    // The inertia of this rotor is a part of ZZ1R: no parameter tells it from that of the link.
    let hidden =
        Hidden::effect(EffectKind::LoadDependentFriction, Place::Joint(0), &[4.0, 0.0, 0.4], &[0.15]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::LoadDependentFriction, &[1]);
    assert_within_four_sigma(&diagnosis, "mu", 0.15);
    let rotor = diagnosis.findings[0].parameters["rotor_inertia"].value;
    assert!((rotor - 0.4).abs() < 0.05, "{rotor}");
}

#[test]
fn losses_that_differ_by_direction_are_an_efficiency_and_equal_ones_are_friction() {
    let robot = planar();
    let hidden =
        |losses: &[f64]| Hidden::effect(EffectKind::DriveEfficiency, Place::Joint(0), &[1.0], losses);
    let diagnosis = diagnosed(robot, &hidden(&[0.3, 0.05]));
    assert_only(&diagnosis, EffectKind::DriveEfficiency, &[1]);
    assert_within_four_sigma(&diagnosis, "efficiency_driving", 1.0 / 1.3);
    assert_within_four_sigma(&diagnosis, "efficiency_driven", 0.95);
    let diagnosis = diagnosed(robot, &hidden(&[0.15, 0.15]));
    assert_only(&diagnosis, EffectKind::LoadDependentFriction, &[1]);
}

#[test]
fn a_drive_that_loses_only_where_it_drives_is_no_friction_beside_a_wrong_torque_constant() {
    // The other loss is zero, and as often as not its estimate is a little less.
    for loss in [0.1, 0.15] {
        let hidden = Hidden::effect(EffectKind::DriveEfficiency, Place::Joint(0), &[1.0], &[loss, 0.0]);
        let diagnosis = diagnosed(planar(), &hidden);
        assert_only(&diagnosis, EffectKind::DriveEfficiency, &[1]);
        assert_within_four_sigma(&diagnosis, "efficiency_driving", 1.0 / (1.0 + loss));
        assert_within_four_sigma(&diagnosis, "efficiency_driven", 1.0);
    }
}

#[test]
fn motors_that_warm_up_together_are_one_drift_of_the_whole_robot() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::TorqueConstantDrift, Place::Robot, &[3.0, LENGTH], &[0.15]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::TorqueConstantDrift, &[]);
    assert_within_four_sigma(&diagnosis, "factor_at_end", 1.15);
}

#[test]
fn a_torque_channel_that_hears_a_neighbour_is_named_with_it() {
    let robot = planar();
    let hidden = Hidden::effect(EffectKind::TorqueCrosstalk, Place::Hears(1, 0), &[], &[0.1]);
    let diagnosis = diagnosed(robot, &hidden);
    assert_only(&diagnosis, EffectKind::TorqueCrosstalk, &[2]);
    assert_within_four_sigma(&diagnosis, "k", 0.1);
    assert_eq!(diagnosis.findings[0].parameters["heard_joint"].value, 1.0);
}

#[test]
fn a_motor_that_droops_beyond_a_knee_is_named_with_the_knee() {
    let robot = planar();
    // Half of the torque that the joint needs at most, beyond which the motor gives less than its current says.
    const KNEE: f64 = 24.0;
    let clipped = |motion: &mut Trajectory| {
        for x in &mut motion.torque[0] {
            *x *= 1.0 + 0.1 * (x.abs() - KNEE).max(0.0) / KNEE;
        }
    };
    let diagnosis = diagnosed(robot, &Hidden::in_recording(clipped));
    assert_only(&diagnosis, EffectKind::TorqueSaturation, &[1]);
    let found = &diagnosis.findings[0].parameters;
    let knee = found["knee"].value * found["most_torque"].value;
    assert!((knee / KNEE - 1.0).abs() < 0.15, "{knee}");
}

/// The two are one on a planar arm: of what is not estimated, only the length between the axes ties inertia to gravity.
#[test]
fn a_rotor_that_turns_as_much_with_one_joint_as_with_the_other_is_one_law() {
    let rotor = [1.0, 2.5, 0.0];
    let hidden = Hidden::effect(EffectKind::CoupledTransmission, Place::Pair(0, 1), &[-1.0], &rotor);
    let diagnosis = diagnosed(planar(), &hidden);
    assert_only(&diagnosis, EffectKind::CoupledTransmission, &[2, 1]);
    assert_within_four_sigma(&diagnosis, "ratio", -1.0);
    assert!(diagnosis.cannot_tell.is_empty(), "{:?}", diagnosis.cannot_tell);
}

#[test]
fn a_wrong_time_base_that_no_motion_tells_from_a_wrong_length_is_named_with_it() {
    let robot = planar();
    let slow = |motion: &mut Trajectory| motion.time.iter_mut().for_each(|t| *t *= 1.1);
    let diagnosis = diagnosed(robot, &Hidden::in_recording(slow));
    let mut named: Vec<&str> = diagnosis.findings.iter().map(|f| f.effect.as_str()).collect();
    named.extend(diagnosis.findings.iter().filter_map(|f| f.alternatives.first()).map(|a| a.effect.as_str()));
    named.extend(diagnosis.cannot_tell.iter().flat_map(|c| &c.between).map(String::as_str));
    named.sort_unstable();
    named.dedup();
    assert_eq!(named, ["geometry_error", "wrong_sample_rate"]);
}

#[test]
fn nothing_is_named_on_a_planar_arm_that_hides_nothing() {
    assert!(diagnosed(planar(), &Hidden::nothing()).findings.is_empty());
}

#[test]
fn nothing_is_named_on_an_arm_with_a_slide_that_hides_nothing() {
    assert!(diagnosed(scara(), &Hidden::nothing()).findings.is_empty());
}

#[test]
fn noise_of_the_positions_whose_torque_nobody_feels_is_no_spring() {
    let wobbling = |trajectory: &mut Trajectory| {
        let mut rng = Pcg64::seed_from_u64((trajectory.position[0][0].abs() * 1e9) as u64);
        for q in &mut trajectory.position {
            // As of a coarse encoder at low speed: slower than white, faster than the motion.
            let mut wave = || (rng.random_range(4.0..16.0), rng.random_range(0.0..std::f64::consts::TAU));
            let waves: Vec<(f64, f64)> = (0..40).map(|_| wave()).collect();
            for (q, t) in q.iter_mut().zip(&trajectory.time) {
                *q += waves
                    .iter()
                    .map(|(f, phase)| 2e-5 * (std::f64::consts::TAU * f * t + phase).sin())
                    .sum::<f64>();
            }
        }
    };
    for bench in [planar(), scara()] {
        assert!(diagnosed(bench, &Hidden::in_recording(wobbling)).findings.is_empty());
    }
}

#[test]
fn nothing_is_named_where_nothing_changed_since_the_baseline() {
    assert!(diagnosed_against_baseline(scara(), &Hidden::nothing()).findings.is_empty());
}

#[test]
fn a_recording_with_too_little_motion_is_refused() {
    let Bench { robot, motions, .. } = scara();
    let mut motions = robot.record(&motions[..1], &Hidden::nothing(), SEED);
    for motion in &mut motions {
        motion.time.truncate(200);
        for signal in motion.position.iter_mut().chain(&mut motion.torque) {
            signal.truncate(200);
        }
    }
    let refused = diagnose(&robot.model, &motions, &[], &Settings::default(), &Silent).unwrap_err();
    let too_little = matches!(refused, DiagnosisError::NothingMoves { .. } | DiagnosisError::TooShort { .. });
    assert!(too_little, "{refused}");
}
