//! `dynid init`: a robot YAML and a recording YAML to fill in.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Failure;
use crate::output::{make_folder, print, write};

const ROBOT: &str = include_str!("init/robot.yaml");
const RECORDING: &str = include_str!("init/recording.yaml");

/// Where to write.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The folder
    #[arg(long, default_value = ".")]
    out: PathBuf,
}

/// Writes what is not there yet.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files =
        [("robot.yaml", ROBOT), ("recording.yaml", RECORDING)].map(|(n, t)| (arguments.out.join(n), t));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(Failure::Input(format!("{}: it is there already, and stays as it is", path.display())));
    }
    make_folder(&arguments.out)?;
    for (path, text) in &files {
        write(path, text)?;
        print(&path.display().to_string());
    }
    Ok(())
}
