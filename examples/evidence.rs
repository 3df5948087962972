//! What is concealed in real recordings: diagnosed on one part, judged on a part that the diagnosis never sees.
//!
//! `cargo run --release --example evidence -- ../shared/data [tx40|ur10e|panda]`
//!
//! The TX-40 is diagnosed on 0.05 to 4.5 s and tested on 4.5 to 7.4 s, the UR10e on three motions and tested on two
//! others, the Panda on the first 60 % of its motion and tested on the rest.

use std::path::PathBuf;
use std::time::Instant;

use dynid::robots::resolve;
use dynid_runtime::diagnosis::{Settings, Silent, diagnose, predict_errors, slowest_speeds};
use dynid_runtime::recording::{Manifest, Trajectory, load};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "../shared/data".into()));
    let wanted = arguments.next();
    for robot in ["tx40", "ur10e", "panda"] {
        if wanted.as_deref().is_none_or(|w| w == robot) {
            tell(&folder.join(robot), robot)?;
        }
    }
    Ok(())
}

/// The part of a motion between two times.
fn between(motion: &Trajectory, from: f64, to: f64) -> Trajectory {
    let keep: Vec<usize> = (0..motion.time.len()).filter(|&k| (from..to).contains(&motion.time[k])).collect();
    let pick = |x: &Vec<f64>| keep.iter().map(|&k| x[k]).collect::<Vec<f64>>();
    Trajectory {
        name: format!("{} {from:.2} to {to:.2} s", motion.name),
        time: pick(&motion.time),
        position: motion.position.iter().map(pick).collect(),
        velocity: motion.velocity.as_ref().map(|v| v.iter().map(pick).collect()),
        torque: motion.torque.iter().map(pick).collect(),
        ..motion.clone()
    }
}

fn tell(folder: &std::path::Path, robot: &str) -> Result<(), Failure> {
    let name = if robot == "ur10e" { "train.yaml" } else { "recording.yaml" };
    let manifest = Manifest::read(&folder.join(name))?;
    let dynamics = resolve(&manifest.robot, Some(folder))?;
    let model = dynamics.model();
    let all = load(&manifest, model.robot())?.trajectories;
    let (fit, test) = match robot {
        "ur10e" => (all, load(&Manifest::read(&folder.join("test.yaml"))?, model.robot())?.trajectories),
        _ => {
            let motion = &all[0];
            let (a, b) = (motion.time[0], motion.time[motion.time.len() - 1]);
            let cut = if robot == "tx40" { 4.5 } else { a + 0.6 * (b - a) };
            (vec![between(motion, a, cut)], vec![between(motion, cut, b + 1.0)])
        }
    };
    let settings = Settings::default();
    let start = Instant::now();
    let d = diagnose(model, &fit, &[], &settings, &Silent)?;
    let seconds = start.elapsed().as_secs_f64();
    println!("\n{robot}: diagnosed in {seconds:.1} s");
    for line in &d.verdict {
        println!("  {line}");
    }
    for f in &d.findings {
        println!("  - {} (share {:.2}, confidence {:.3})", f.sentence, f.share, f.confidence);
    }
    for c in &d.cannot_tell {
        println!("  cannot tell {:?} on joint {:?}: {}", c.between, c.joints, c.experiment);
    }
    let slowest = slowest_speeds(model, &fit, &settings)?;
    for (rows, slowest) in [("moving rows", slowest.clone()), ("all rows", vec![0.0; slowest.len()])] {
        let before = predict_errors(model, &d.standard, &[], d.delay, &test, &slowest, &settings)?;
        let after = predict_errors(model, &d.model, &d.terms(), d.delay, &test, &slowest, &settings)?;
        println!(
            "  test, {rows}: {:.2} % -> {:.2} % (ratio {:.2}); joints {:.1?} -> {:.1?} %",
            100.0 * before.relative_error,
            100.0 * after.relative_error,
            after.relative_error / before.relative_error,
            before.per_joint.iter().map(|x| 100.0 * x).collect::<Vec<_>>(),
            after.per_joint.iter().map(|x| 100.0 * x).collect::<Vec<_>>()
        );
    }
    Ok(())
}
