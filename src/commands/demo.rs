//! `dynid demo`: a simulated TX-40 hides an effect; dynid identifies the robot, and finds what is missing.

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::effects::{EffectKind, EffectTerm, Place, TermScale};
use dynid_runtime::model::{JointIndex, Model, ParameterKind, Robot};
use dynid_runtime::recording::{DataFormat, Trajectory};
use dynid_runtime::report::significant;
use dynid_runtime::simulation::excitation::{ExcitationSettings, MotionKind, excite};
use dynid_runtime::simulation::{LoopSettings, SimulationError, World, simulate};

use super::execute_words;
use crate::failure::Failure;
use crate::models;
use crate::output::{Bar, print};
use crate::recording_files::{RobotReference, write_recording};

/// Where the demo writes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder for the recordings, the models and the report
    #[arg(long, default_value = "dynid-demo")]
    out: PathBuf,
    /// Another seed hides something else, and has other motions and another noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Motions that are recorded; the last one is the test recording.
const MOTIONS: u64 = 4;
/// Control rate, Hz, and control samples for each recorded row.
const RATE: f64 = 2000.0;
const RECORD_EVERY: usize = 4;

/// Simulates, identifies, diagnoses; then says what was hidden.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let model = models::find("tx40").ok_or_else(|| {
        Failure::Input("this build has no tx40 in robots/, which the demo needs".to_owned())
    })?;
    let nominal = model.robot().nominal.as_ref().ok_or_else(|| {
        Failure::Input("robots/tx40.yaml has no nominal values, which the demo needs".to_owned())
    })?;
    let chi = model.robot().base_from_standard(&nominal.standard);
    let hidden = hidden_effect(model.robot(), &nominal.standard, arguments.seed);
    print(&format!(
        "A Staubli TX-40 is simulated in closed loop: {MOTIONS} motions of 8 s. Its joints hide some physics that the\n\
         standard model does not have. The last motion is the test recording.\n"
    ));
    let motions = simulated(model, &chi, &hidden, arguments.seed)?;
    let (fit, test) = motions.split_at(motions.len() - 1);
    let folder = |name: &str| arguments.out.join(name);
    save(&folder("fit"), model.robot(), "simulated TX-40", fit)?;
    save(&folder("test"), model.robot(), "simulated TX-40, a test motion", test)?;

    let text = |path: PathBuf| path.display().to_string();
    let recording = text(folder("fit").join("recording.yaml"));
    let test_recording = text(folder("test").join("recording.yaml"));
    let standard = text(folder("standard.json"));
    let improved = text(folder("improved.json"));
    let report = text(folder("report.html"));
    step(&["identify", &recording, "--out", &standard])?;
    step(&["validate", &standard, &test_recording])?;
    step(&["diagnose", &recording, "--test", &test_recording, "--out", &improved, "--report", &report])?;
    step(&["validate", &improved, &test_recording])?;

    let amplitude = significant(hidden.amplitude[0], 3);
    let shape: Vec<String> = hidden.shape.iter().map(|x| significant(*x, 3)).collect();
    print(&format!(
        "\nWhat the simulation had hidden: {} on joint {}, amplitude {amplitude}{}{}.\nOpen {report} in a browser.",
        hidden.effect.id(),
        hidden.joints[0],
        if shape.is_empty() { "" } else { ", shape " },
        shape.join(" ")
    ));
    Ok(())
}

/// Prints a command and runs it.
fn step(words: &[&str]) -> Result<(), Failure> {
    print(&format!("\n$ dynid {}", words.join(" ")));
    execute_words(words)
}

/// An effect on one of the four main joints, of the size of a good part of its dry friction.
fn hidden_effect(robot: &Robot, standard: &[f64], seed: u64) -> EffectTerm {
    let joint = (seed.wrapping_mul(7).wrapping_add(1) % 4) as usize;
    let joint_of = robot.joint_of_frame();
    let dry = (0..standard.len())
        .find(|&k| {
            robot.standard[k].kind == ParameterKind::Fc && joint_of[robot.standard[k].frame] == Some(joint)
        })
        .map_or(1.0, |k| standard[k]);
    let (effect, shape, amplitude) = if seed % 2 == 1 {
        (EffectKind::Stribeck, vec![0.15], 0.5 * dry)
    } else {
        (EffectKind::LoadDependentFriction, Vec::new(), 0.12)
    };
    EffectTerm {
        effect,
        place: Place::Joint(joint),
        joints: vec![robot.joint_number(JointIndex(joint)).0],
        shape,
        amplitude: vec![amplitude],
        sigma: vec![0.0],
        scale: Some(TermScale::UNIT),
        wrenches: Vec::new(),
    }
}

/// The motions, recorded in closed loop.
fn simulated(
    model: &dyn Model,
    chi: &[f64],
    hidden: &EffectTerm,
    seed: u64,
) -> Result<Vec<Trajectory>, Failure> {
    let failed = |error: SimulationError| Failure::Data(error.to_string());
    let bar = Bar::new("simulating");
    let mut recorded = Vec::new();
    for k in 0..MOTIONS {
        let own_seed = seed.wrapping_mul(1000).wrapping_add(k);
        let settings = ExcitationSettings {
            kind: MotionKind::Fourier { harmonics: 5, period: 8.0, periods: 1 },
            share: 0.8,
            seed: own_seed,
            ..ExcitationSettings::default()
        };
        let plan = excite(model, Some(chi), &settings, &|_| {}).map_err(failed)?;
        for motion in &plan.motions {
            let world = World::from_base(model, chi).with(std::slice::from_ref(hidden));
            let mut plant = world.plant("").map_err(failed)?;
            let mut settings = LoopSettings::nominal(model, chi, motion, RATE, own_seed);
            settings.record_every = RECORD_EVERY;
            settings.name = format!("motion {}", k + 1);
            let share = |done: f64| bar.share((k as f64 + done) / MOTIONS as f64, "simulating");
            recorded.push(simulate(&mut plant, motion, &settings, &mut { share }).map_err(failed)?.recorded);
        }
    }
    Ok(recorded)
}

fn save(folder: &Path, robot: &Robot, title: &str, motions: &[Trajectory]) -> Result<(), Failure> {
    let reference = RobotReference::Name(&robot.name);
    write_recording(
        (folder, "recording.yaml", "traj"),
        robot,
        reference,
        (title, (DataFormat::Csv, &[])),
        motions,
    )
    .map(|_| ())
}
