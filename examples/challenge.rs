//! Runs the diagnosis on every recording of a folder and, only then, reads what was hidden and keeps score.
//!
//! `cargo run --release --example challenge -- ../shared/challenge [case ...]`
//!
//! A case counts as solved when every true effect is named on its joint, nothing else is named, and the error on
//! `test.yaml` closes at least 80 % of the gap between the standard model and the model with the true effect.

use std::path::{Path, PathBuf};
use std::time::Instant;

use dynid::robots::resolve;
use dynid_runtime::diagnosis::{
    Diagnosis, Estimated, Settings, Silent, diagnose, fit_known, predict_errors, slowest_speeds,
};
use dynid_runtime::effects::{EffectKind, EffectTerm};
use dynid_runtime::model::Model;
use dynid_runtime::recording::{Manifest, Trajectory, load};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "../shared/challenge".into()));
    let wanted: Vec<String> = arguments.collect();
    let verbose = !wanted.is_empty();
    let mut cases: Vec<PathBuf> = std::fs::read_dir(&folder)?
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.join("recording.yaml").is_file())
        .filter(|path| wanted.is_empty() || wanted.iter().any(|w| name_of(path).starts_with(w.as_str())))
        .collect();
    cases.sort();
    println!(
        "{:18} {:>5}  {:38} {:28} {:28} {:>7} {:>7} {:>7}",
        "case", "s", "named", "missed", "false alarms", "before", "after", "true"
    );
    let mut solved = 0;
    for case in &cases {
        solved += usize::from(score(case, verbose)?);
    }
    println!("{solved} of {} solved", cases.len());
    Ok(())
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

fn trajectories(model: &dyn Model, path: &Path) -> Result<Vec<Trajectory>, Failure> {
    let manifest = Manifest::read(path)?;
    Ok(load(&manifest, model.robot())?.trajectories)
}

/// What was hidden, read after the diagnosis.
fn truth(path: &Path) -> Result<Vec<(EffectKind, Option<usize>)>, Failure> {
    let text = std::fs::read_to_string(path)?;
    let mut effects: Vec<(EffectKind, Option<usize>)> = Vec::new();
    for line in text.lines() {
        let line = line.trim().trim_start_matches("- ");
        if let Some(id) = line.strip_prefix("effect: ") {
            let kind = EffectKind::from_id(id.trim()).ok_or_else(|| format!("unknown effect {id}"))?;
            effects.push((kind, None));
        } else if let (Some(joint), Some(last)) = (line.strip_prefix("joint: "), effects.last_mut()) {
            last.1 = Some(joint.trim().parse()?);
        }
    }
    Ok(effects)
}

fn score(case: &Path, verbose: bool) -> Result<bool, Failure> {
    let manifest = Manifest::read(&case.join("recording.yaml"))?;
    let dynamics = resolve(&manifest.robot, Some(case))?;
    let model = dynamics.model();
    let motions = load(&manifest, model.robot())?.trajectories;
    let baseline = case.join("baseline.yaml");
    let before = if baseline.is_file() { trajectories(model, &baseline)? } else { Vec::new() };
    let test = trajectories(model, &case.join("test.yaml"))?;
    let settings = Settings::default();
    let start = Instant::now();
    let found = diagnose(model, &motions, &before, &settings, &Silent)?;
    let seconds = start.elapsed().as_secs_f64();

    let hidden =
        if case.join("truth.yaml").is_file() { truth(&case.join("truth.yaml"))? } else { Vec::new() };
    let numbered: Vec<(EffectKind, Option<usize>)> =
        hidden.iter().map(|&(kind, joint)| (kind, joint.map(|j| j - 1))).collect();
    let slowest = slowest_speeds(model, &motions, &settings)?;
    let error = |parameters: &Estimated, terms: &[EffectTerm], d: &Diagnosis| -> Result<f64, Failure> {
        Ok(predict_errors(model, parameters, terms, d.delay, &test, &slowest, &settings)?.relative_error)
    };
    let plain = error(&found.standard, &[], &found)?;
    let after = error(&found.model, &found.terms(), &found)?;
    let ideal = if hidden.is_empty() {
        plain
    } else {
        let known = fit_known(model, &motions, &before, &numbered, &settings)?;
        error(&known.model, &known.terms(), &known)?
    };

    let named = |kind: EffectKind, joint: Option<usize>| {
        found.findings.iter().any(|f| f.effect == kind.id() && joint.is_none_or(|j| f.joints.contains(&j)))
    };
    let label = |id: &str, joints: &[usize]| match joints {
        [] => id.to_string(),
        many => format!("{id}@{}", many.iter().map(ToString::to_string).collect::<Vec<_>>().join("+")),
    };
    let missed: Vec<String> = hidden
        .iter()
        .filter(|(k, j)| !named(*k, *j))
        .map(|(k, j)| label(k.id(), &j.iter().copied().collect::<Vec<_>>()))
        .collect();
    let (mut right, mut wrong) = (Vec::new(), Vec::new());
    for f in &found.findings {
        let matches =
            hidden.iter().any(|(k, j)| f.effect == k.id() && j.is_none_or(|j| f.joints.contains(&j)));
        if matches { &mut right } else { &mut wrong }.push(label(&f.effect, &f.joints));
    }
    // Where the effect's torque cannot be predicted from the motion alone there is no gap to close.
    let gap = plain - ideal;
    let closed = gap < 0.02 * plain || plain - after >= 0.8 * gap;
    let solved = missed.is_empty() && wrong.is_empty() && closed;
    println!(
        "{:18} {seconds:5.1}  {:38} {:28} {:28} {plain:7.4} {after:7.4} {ideal:7.4} {}",
        name_of(case),
        right.join(" "),
        missed.join(" "),
        wrong.join(" "),
        if solved { "solved" } else { "" }
    );
    if verbose {
        for line in &found.verdict {
            println!("    {line}");
        }
        for f in &found.findings {
            println!("  {} share {:.2} confidence {:.4}", f.sentence, f.share, f.confidence);
            for (name, p) in &f.parameters {
                println!("      {name} = {:.5} ± {:.5} {}", p.value, p.sigma, p.unit);
            }
            for a in &f.alternatives {
                println!("      not {} {:?}: {}", a.effect, a.joints, a.why_not);
            }
        }
        println!(
            "    held out ({}) {:.4} -> {:.4}; delay {:.2} ms; unexplained {:.2} {:.2?}",
            found.held_out.how,
            found.held_out.before,
            found.held_out.after,
            1e3 * found.delay,
            found.unexplained.share,
            found.unexplained.per_joint
        );
        for m in &found.mismatch {
            println!("    joint {}: {:.2} {}", m.joint, m.share, m.where_);
        }
        for c in &found.cannot_tell {
            println!("    cannot tell {:?} on {:?}", c.between, c.joints);
        }
    }
    Ok(solved)
}
