//! `dynid demo`: from nothing to identified parameters, on a robot whose parameters are known.

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::model::Model;
use dynid_runtime::recording::{Trajectory, write as write_recording};
use dynid_runtime::simulation::excitation::{ExcitationSettings, Identification, MotionKind, excite};
use dynid_runtime::simulation::{ControllerSettings, LoopSettings, Plant, SensorSettings, simulate};

use crate::failure::Failure;
use crate::models;
use crate::output::{Bar, print};

/// Where the demo writes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder for the recordings, the model and the report
    #[arg(long, default_value = "dynid-demo")]
    out: PathBuf,
    /// Another seed is another motion and another noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Motions that are recorded: the last one is kept for validation.
const MOTIONS: usize = 4;
