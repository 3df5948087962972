//! `dynid import arm.urdf`: the modified-DH table of a URDF.

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_urdf::ImportOptions;

use crate::arguments::UrdfOptions;
use crate::failure::Failure;
use crate::output::{print, write};
use crate::urdf_files::imported_with_geometry;

/// What to import and where to put it.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The URDF, expanded where it is written in xacro
    urdf: PathBuf,
    #[command(flatten)]
    options: UrdfOptions,
    /// Where the robot YAML is written; `-` is standard output
    #[arg(long)]
    out: PathBuf,
}

/// Imports, saves, says what was made.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options: ImportOptions = arguments.options.import()?;
    let (imported, table) = imported_with_geometry(&arguments.urdf, &options)?;
    write(&arguments.out, &imported.yaml)?;
    if arguments.out != Path::new("-") {
        print(&format!(
            "{}: {} frames, joints {}",
            arguments.out.display(),
            table.frames.len(),
            imported.joints.join(", ")
        ));
    }
    Ok(())
}
