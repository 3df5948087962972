//! `--to rust`.

use dynid_codegen::export_rust;

use super::Arguments;
use super::known::{Exported, failure, write};
use crate::failure::Failure;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let exported = Exported::find(&arguments.what)?;
    let module = export_rust(&exported.robot, exported.known.as_ref())
        .map_err(|error| failure(&arguments.what, &error))?;
    exported.warn_of_left_out();
    write(arguments, &format!("{}.rs", module.name), &module.source)
}
