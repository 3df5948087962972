//! `--to c`.

use dynid_codegen::{Real, export_c, export_casadi};

use super::known::{Exported, failure, write};
use super::{Arguments, Real as Asked};
use crate::failure::Failure;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let exported = Exported::find(&arguments.what)?;
    let real = match arguments.real {
        Some(Asked::F32) => Real::Single,
        Some(Asked::F64) | None => Real::Double,
    };
    if arguments.casadi && real == Real::Single {
        return Err(Failure::Input(
            "--casadi: CasADi calls functions of double, not of --real f32".to_owned(),
        ));
    }
    let files = export_c(&exported.robot, exported.known.as_ref(), real)
        .map_err(|error| failure(&arguments.what, &error))?;
    exported.warn_of_left_out();
    write(arguments, &format!("{}.h", files.name), &files.header)?;
    write(arguments, &format!("{}.c", files.name), &files.source)?;
    if arguments.casadi {
        let file = export_casadi(&exported.robot, exported.known.as_ref())
            .map_err(|error| failure(&arguments.what, &error))?;
        write(arguments, &format!("{}.c", file.name), &file.source)?;
    }
    Ok(())
}
