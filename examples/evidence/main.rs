//! What is concealed in real recordings: diagnosed on one part, judged on a part that the diagnosis never sees.
//!
//! `cargo run --release --example evidence -- ../shared/data --out docs` writes `docs/evidence.md` with its figures;
//! `--robot tx40` prints one story.
//!
//! The TX-40 is diagnosed on 0.05 to 4.5 s and tested on 4.5 to 7.4 s, the UR10e on three motions and tested on two
//! others, the Panda on the first 60 % of its motion and tested on the rest.

mod figures;
mod stories;
mod story;
mod tested;

use std::path::{Path, PathBuf};

use clap::Parser;
use dynid::robots::resolve;
use dynid_runtime::diagnosis::{Settings, Silent, diagnose};
use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
use dynid_runtime::estimation::{EstimateSettings, choose_bandwidth, estimate};
use dynid_runtime::model::Model;
use dynid_runtime::recording::{Manifest, Trajectory, load};
use dynid_runtime::signal::{Preparation, prepare_all};

use stories::{STORIES, Story};
use story::{Part, Told};

/// Anything that ends a run.
pub type Failure = Box<dyn std::error::Error>;

/// Which recordings, and where the page goes.
#[derive(Debug, Parser)]
struct Options {
    /// Folder of the recordings
    #[arg(default_value = "../shared/data")]
    folder: PathBuf,
    /// Only these robots
    #[arg(long, value_delimiter = ',')]
    robot: Vec<String>,
    /// Folder for evidence.md and its figures [default: the stories on standard output, no figures]
    #[arg(long)]
    out: Option<PathBuf>,
}

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    if let Some(folder) = &options.out {
        std::fs::create_dir_all(folder)?;
    }
    let mut stories = Vec::new();
    for story in &STORIES {
        let wanted = options.robot.is_empty() || options.robot.iter().any(|r| r == story.robot);
        if wanted {
            stories.push(tell(&options.folder.join(story.robot), story, options.out.as_deref())?);
        }
    }
    match &options.out {
        Some(folder) => std::fs::write(folder.join("evidence.md"), story::page(&stories))?,
        None => println!("{}", stories.concat()),
    }
    Ok(())
}

fn motions(model: &dyn Model, path: &Path) -> Result<Vec<Trajectory>, Failure> {
    Ok(load(&Manifest::read(path)?, model.robot())?.trajectories)
}

/// Base parameters as `dynid identify` finds them: the chosen band, weighted.
fn identified(model: &dyn Model, motions: &[Trajectory]) -> Result<Vec<f64>, Failure> {
    let chosen = choose_bandwidth(motions)?;
    let preparation = Preparation { cutoff: Some(chosen.cutoff), ..Preparation::default() };
    let (motions, _) = prepare_all(motions, &preparation)?;
    let settings = ObserveSettings { band: chosen.band, ..ObserveSettings::default() };
    let observation = observe(model, &motions, Equations::Torque, None, &settings, None)?;
    Ok(estimate(&observation, &EstimateSettings::default()).chi())
}

/// The part of a motion within a window.
fn within(motion: &Trajectory, window: [f64; 2]) -> Result<Trajectory, Failure> {
    Ok(motion.within(window).ok_or("no row lies in the window")?)
}

/// Diagnoses one part of a recording and judges on the other.
fn tell(folder: &Path, story: &Story, out: Option<&Path>) -> Result<String, Failure> {
    let path = folder.join(story.recording);
    let dynamics = resolve(&Manifest::read(&path)?.robot, Some(folder))?;
    let model = dynamics.model();
    let all = motions(model, &path)?;
    let (fitted, test) = match story.test {
        Some(test) => (all, motions(model, &folder.join(test))?),
        None => {
            let motion = all.first().ok_or("the recording has no motion")?;
            let (from, to) = (motion.time[0], motion.time[motion.time.len() - 1]);
            let cut = story.cut.unwrap_or(from + 0.6 * (to - from));
            (vec![within(motion, [from, cut])?], vec![within(motion, [cut, to])?])
        }
    };
    let found = diagnose(model, &fitted, &[], &Settings::default(), &Silent)?;
    let standard = identified(model, &fitted)?;
    let compared = tested::compared(model, &standard, &found, &test)?;
    let mut pictures = Vec::new();
    if let Some(out) = out {
        for (name, svg) in [
            ("findings", figures::findings(story.title, &found)),
            ("held_out", (!found.findings.is_empty()).then(|| figures::held_out(story.title, &compared))),
        ] {
            if let Some(svg) = svg {
                let file = format!("evidence_{}_{name}.svg", story.robot);
                std::fs::write(out.join(&file), svg)?;
                pictures.push((name, file));
            }
        }
    }
    let parts: Vec<Part> =
        story.parts.iter().map(|&span| part(model, &path, span)).collect::<Result<_, _>>()?;
    Ok(story::told(&Told { story, found: &found, compared: &compared, pictures: &pictures, parts: &parts }))
}

/// Diagnoses one part of a single motion and judges on what comes before and after it.
fn part(model: &dyn Model, path: &Path, span: (f64, f64)) -> Result<Part, Failure> {
    let all = motions(model, path)?;
    let motion = all.first().ok_or("the recording has no motion")?;
    let fitted = [within(motion, [span.0, span.1])?];
    let found = diagnose(model, &fitted, &[], &Settings::default(), &Silent)?;
    let (first, last) = (motion.time[0], motion.time[motion.time.len() - 1]);
    let rest: Vec<Trajectory> = [(first, span.0), (span.1, last)]
        .into_iter()
        .filter(|(from, to)| to - from > SHORTEST_REST)
        .filter_map(|(from, to)| motion.within([from, to]))
        .collect();
    let errors =
        if rest.is_empty() {
            None
        } else {
            let standard = identified(model, &fitted)?;
            let compared = tested::compared(model, &standard, &found, &rest)?;
            compared.predictions.first().zip(compared.predictions.last()).and_then(|(before, after)| {
                Some([before.errors.relative_error?, after.errors.relative_error?])
            })
        };
    let named = found.findings.iter().map(|f| {
        let on: Vec<String> = f.joints.iter().map(ToString::to_string).collect();
        format!("{}@{}", f.effect, on.join("+"))
    });
    Ok(Part { span, named: named.collect(), rest: errors })
}

/// Shortest rest that is worth a prediction, s.
const SHORTEST_REST: f64 = 1.0;
