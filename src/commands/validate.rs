//! `dynid validate MODEL REC`: does an identified model predict another recording?

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::estimation::observe::{Equations, observe};
use dynid_runtime::estimation::{Identified, Observed, per_equation, relative_error};
use dynid_runtime::report::{percent, significant};

use crate::failure::{Failure, file_failure};
use crate::output::{Bar, print, table, write_json};
use crate::recorded::{RecordingOptions, left_out_words, observe_failure, read};

/// What to predict, with what.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A model saved by `identify --out` or `diagnose --out`
    model: PathBuf,
    #[command(flatten)]
    recording: RecordingOptions,
    /// Write the result for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// What `validate` writes: the errors of the prediction beside the model's parameters.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let identified = read_model(&arguments.model)?;
    let mut options = arguments.recording.clone();
    let recorded_robot = options.robot.take();
    // The model knows its robot; the recording's own name for it must agree.
    options.robot = recorded_robot.or_else(|| Some(identified.robot.clone()));
    options.sampling.band = options.sampling.band.or(Some(identified.band));
    let recorded = read(&options)?;
    let model = recorded.dynamics.model();
    let chi = identified.chi(model.robot()).map_err(|missing| {
        Failure::Input(format!(
            "{}: it has no {missing}, which {} needs: it was identified for another robot",
            arguments.model.display(),
            model.robot().name
        ))
    })?;
    let bar = Bar::new("samples");
    let observation = observe(
        model,
        &recorded.motions,
        Equations::Torque,
        None,
        &recorded.settings,
        Some(&|done, all| bar.at(done, all)),
    )
    .map_err(|error| observe_failure(&options.recording, &error))?;
    drop(bar);
    let overall = relative_error(&observation, &chi);
    let per_joint = per_equation(&observation, &chi);
    if let Some(path) = &arguments.json {
        let result = identified.validated(
            &Observed {
                samples: observation.samples,
                trajectories: &observation.trajectories,
                left_out: &observation.left_out,
                settings: &recorded.settings,
            },
            (overall, per_joint.clone()),
            recorded.rows.left_out,
        );
        write_json(path, &result)?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    print(&format!("{}: {}", model.robot().name, recorded.title));
    for line in left_out_words(&recorded) {
        print(&line);
    }
    let used: usize = observation.left_out.iter().map(|l| l.used).sum();
    let slow: usize = observation.left_out.iter().map(|l| l.standstill).sum();
    print(&format!(
        "{used} equations of {} Hz bandwidth, {slow} left out where the joint hardly moves\n",
        significant(recorded.settings.band, 3)
    ));
    let rows = per_joint.iter().enumerate().map(|(j, e)| vec![(j + 1).to_string(), percent(*e)]).collect();
    print(&table(&["<joint", "relative error"], rows));
    print(&format!("\nrelative error of the torques {}", percent(overall)));
    Ok(())
}

/// Reads a saved model.
///
/// # Errors
/// [`Failure::Input`] with file, line and column.
pub(super) fn read_model(path: &Path) -> Result<Identified, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| file_failure("read the model", path, &error))?;
    serde_json::from_str(&text).map_err(|error| {
        Failure::Input(format!(
            "{}:{}:{}: not a saved model: {error}",
            path.display(),
            error.line(),
            error.column()
        ))
    })
}
