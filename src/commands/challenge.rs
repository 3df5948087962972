//! `dynid challenge DIR`: diagnoses recordings with hidden effects, and only then reads what was hidden.

mod words;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use dynid_runtime::diagnosis::scoring::{Hidden, Naming, Scored, TestErrors};
use dynid_runtime::diagnosis::{Diagnosis, Progress, Settings, diagnose, fit_known};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::{JointNumber, Model};
use dynid_runtime::prediction::{Comparison, Predictor, evaluate};
use dynid_runtime::recording::{Manifest, Trajectory, load};

use crate::errors::prediction_failure;
use crate::failure::{Failure, file_failure};
use crate::output::{Bar, can_write, print, write_json};
use crate::recorded::recording_failure;
use crate::robots::{Dynamics, resolve};
use crate::truth::read_truth;
use words::{details, for_programs, summary};

/// Which cases, and where the score goes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of cases: each a folder with recording.yaml, test.yaml, truth.yaml, and baseline.yaml where the robot
    /// was recorded before it changed
    folder: PathBuf,
    /// Only the cases whose names start so
    cases: Vec<String>,
    /// Print what was found in each case, and what was considered
    #[arg(long)]
    details: bool,
    /// Write the score for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// A case as it is known without its truth.
struct Case {
    folder: PathBuf,
    name: String,
    dynamics: Dynamics,
}

/// The diagnosis of a case, or why there is none.
struct Diagnosed {
    outcome: Result<Diagnosis, String>,
    seconds: f64,
}

/// Diagnoses all cases, then keeps score.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    can_write([&arguments.json])?;
    let cases = cases(arguments)?;
    let settings = Settings::default();
    let bar = Bar::new("diagnosis");
    let diagnosed = cases
        .iter()
        .enumerate()
        .map(|(k, case)| {
            let share = Share { bar: &bar, case: &case.name, done: k, all: cases.len() };
            case.diagnosed(&settings, &share)
        })
        .collect::<Result<Vec<_>, _>>()?;
    drop(bar);
    // From here on the truth is known; no diagnosis is left to be made.
    let bar = Bar::new("score");
    let mut scores = Vec::new();
    for (k, (case, diagnosed)) in cases.iter().zip(&diagnosed).enumerate() {
        bar.at(k, cases.len());
        scores.push(case.scored(diagnosed, &settings)?);
    }
    drop(bar);
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&summary(&scores));
        if arguments.details {
            for (case, diagnosed) in cases.iter().zip(&diagnosed) {
                print(&details(&case.name, diagnosed.outcome.as_ref().ok()));
            }
        }
    }
    if let Some(path) = &arguments.json {
        write_json(path, &for_programs(&scores))?;
    }
    Ok(())
}

/// One case's share of the bar.
struct Share<'a> {
    bar: &'a Bar,
    case: &'a str,
    done: usize,
    all: usize,
}

impl Progress for Share<'_> {
    fn at(&self, done: f64, what: &str) {
        self.bar.share((self.done as f64 + done) / self.all as f64, &format!("{}: {what}", self.case));
    }
}

/// The folders that hold a recording, by name.
fn cases(arguments: &Arguments) -> Result<Vec<Case>, Failure> {
    let entries = std::fs::read_dir(&arguments.folder)
        .map_err(|error| file_failure("read the folder of cases", &arguments.folder, &error))?;
    let mut folders: Vec<(String, PathBuf)> = entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.join("recording.yaml").is_file())
        .filter_map(|path| Some((path.file_name()?.to_string_lossy().into_owned(), path)))
        .collect();
    folders.sort();
    if let Some(none) = arguments.cases.iter().find(|w| !folders.iter().any(|(n, _)| n.starts_with(*w))) {
        let known: Vec<&str> = folders.iter().map(|(name, _)| name.as_str()).collect();
        return Err(Failure::Input(format!(
            "no case starts with {none}: {} has {}",
            arguments.folder.display(),
            known.join(", ")
        )));
    }
    folders.retain(|(name, _)| {
        arguments.cases.is_empty() || arguments.cases.iter().any(|w| name.starts_with(w.as_str()))
    });
    if folders.is_empty() {
        return Err(Failure::Input(format!(
            "{}: no folder in it holds a recording.yaml",
            arguments.folder.display()
        )));
    }
    folders
        .into_iter()
        .map(|(name, folder)| {
            let manifest = Manifest::read(&folder.join("recording.yaml")).map_err(recording_failure)?;
            let dynamics = resolve(&manifest.robot, Some(&folder))?;
            Ok(Case { folder, name, dynamics })
        })
        .collect()
}

impl Case {
    fn model(&self) -> &dyn Model {
        self.dynamics.model()
    }

    /// The motions of one of its recordings.
    fn motions(&self, file: &str) -> Result<Vec<Trajectory>, Failure> {
        let manifest = Manifest::read(&self.folder.join(file)).map_err(recording_failure)?;
        Ok(load(&manifest, self.model().robot()).map_err(recording_failure)?.trajectories)
    }

    fn baseline(&self) -> Result<Vec<Trajectory>, Failure> {
        let there = self.folder.join("baseline.yaml").is_file();
        if there { self.motions("baseline.yaml") } else { Ok(Vec::new()) }
    }

    fn diagnosed(&self, settings: &Settings, progress: &dyn Progress) -> Result<Diagnosed, Failure> {
        let (motions, baseline) = (self.motions("recording.yaml")?, self.baseline()?);
        let start = Instant::now();
        let outcome = diagnose(self.model(), &motions, &baseline, settings, progress);
        let seconds = start.elapsed().as_secs_f64();
        Ok(Diagnosed { outcome: outcome.map_err(|error| error.to_string()), seconds })
    }

    /// Reads the truth, and compares.
    fn scored(&self, diagnosed: &Diagnosed, settings: &Settings) -> Result<Scored, Failure> {
        let truth = self.folder.join("truth.yaml");
        let hidden = if truth.is_file() { Some(read_truth(&truth, self.model().robot())?) } else { None };
        let known = hidden.as_deref().unwrap_or(&[]);
        let mut score = Scored {
            case: self.name.clone(),
            robot: self.model().robot().name.to_string(),
            seconds: diagnosed.seconds,
            naming: Naming::of(known, &[]),
            test: None,
            gap_closed: None,
            refused: None,
            solved: None,
        };
        match &diagnosed.outcome {
            Err(reason) => score.refused = Some(reason.clone()),
            Ok(found) => {
                score.naming = Naming::of(known, &found.findings);
                if self.folder.join("test.yaml").is_file() {
                    score.test = Some(self.errors(found, known, settings)?);
                }
            }
        }
        Ok(score.judge(hidden.is_some()))
    }

    /// Errors on the test recording, of all models on the same rows.
    fn errors(
        &self,
        found: &Diagnosis,
        hidden: &[Hidden],
        settings: &Settings,
    ) -> Result<TestErrors, Failure> {
        let model = self.model();
        let file = self.folder.join("test.yaml");
        let comparison = Comparison { threads: settings.threads, ..Comparison::default() };
        let test = comparison
            .prepare(&self.motions("test.yaml")?)
            .map_err(|error| prediction_failure(&file, &error))?;
        let known = self.with_known(hidden, settings)?;
        let (terms, true_terms) = (found.terms(), known.as_ref().map(Diagnosis::terms).unwrap_or_default());
        let mut models = Predictor::before_and_after(found, &terms).to_vec();
        if let Some(known) = &known {
            models.push(Predictor { chi: &known.model.chi, effects: &true_terms, delay: known.delay });
        }
        let evaluation = evaluate(model, &models, &test.motions, &test.settings, &[])
            .map_err(|error| prediction_failure(&file, &error))?;
        let error = |k: usize| evaluation.predictions.get(k).and_then(|p| p.errors.relative_error);
        Ok(TestErrors {
            before: error(0).unwrap_or_default(),
            after: error(1).unwrap_or_default(),
            true_effect: error(2),
        })
    }

    /// The true effects, fitted. Effects that cannot be fitted leave the case to be judged by naming.
    fn with_known(&self, hidden: &[Hidden], settings: &Settings) -> Result<Option<Diagnosis>, Failure> {
        if hidden.is_empty() {
            return Ok(None);
        }
        let (motions, baseline) = (self.motions("recording.yaml")?, self.baseline()?);
        let robot = self.model().robot();
        let joint = |h: &Hidden| Some(robot.joint_index(JointNumber(*h.joints.first()?))?.0);
        let effects: Vec<(EffectKind, Option<usize>)> = hidden.iter().map(|h| (h.effect, joint(h))).collect();
        Ok(fit_known(self.model(), &motions, &baseline, &effects, settings).ok())
    }
}
