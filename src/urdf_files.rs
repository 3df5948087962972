//! URDF files as robots.

use std::path::Path;

use dynid_codegen::robot::{RobotTable, parse};
use dynid_runtime::model::Robot;
use dynid_runtime::regular_file;
use dynid_urdf::{ImportOptions, Imported, Mistake, Template, Urdf};

use crate::failure::{Failure, file_failure};
use crate::meshes;
use crate::output::warn;

/// Longest URDF that is read, bytes.
const LONGEST: u64 = 1 << 24;

/// Whether a path is that of a URDF.
pub fn is_urdf(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("urdf"))
}

/// The bytes of a URDF.
///
/// # Errors
/// [`Failure::Input`] naming the file.
pub fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    regular_file::read(path, LONGEST).map_err(|error| file_failure("read the robot", path, &error))
}

/// Reads a URDF; `snap` as of [`ImportOptions`].
///
/// # Errors
/// [`Failure::Input`] with every mistake as `file:line:column: message`, one a line.
pub fn parsed(path: &Path, bytes: &[u8], snap: f64) -> Result<Urdf, Failure> {
    dynid_urdf::read(bytes, snap).map_err(|mistakes| refused(path, &mistakes))
}

/// The joints of a robot in a URDF of it.
///
/// # Errors
/// [`Failure::Input`] where it is a URDF of another robot, or one that cannot be imported.
pub fn template<'a>(
    path: &Path,
    urdf: &'a Urdf,
    robot: &Robot,
    options: &ImportOptions,
) -> Result<Template<'a>, Failure> {
    Template::new(urdf, robot, options).map_err(|error| match error {
        Ok(unlike) => Failure::Input(format!("{}: {unlike}", path.display())),
        Err(mistakes) => refused(path, &mistakes),
    })
}

/// The robot YAML of a URDF, and the table that it is read as. What is allowed in the URDF but probably not meant is told
/// on standard error.
///
/// # Errors
/// [`Failure::Input`] with every mistake, one a line.
pub fn imported(path: &Path, options: &ImportOptions) -> Result<(Imported, RobotTable), Failure> {
    written(path, options, dynid_urdf::import)
}

/// [`imported`], with ellipsoids around the geometry of links, whose meshes are looked for from the URDF on.
///
/// # Errors
/// As [`imported`].
pub fn imported_with_geometry(
    path: &Path,
    options: &ImportOptions,
) -> Result<(Imported, RobotTable), Failure> {
    written(path, options, |urdf, name, options| {
        dynid_urdf::import_with_geometry(urdf, name, options, &|mesh| meshes::vertices(path, mesh))
    })
}

fn written(
    path: &Path,
    options: &ImportOptions,
    import: impl Fn(&Urdf, &str, &ImportOptions) -> Result<Imported, Vec<Mistake>>,
) -> Result<(Imported, RobotTable), Failure> {
    let urdf = parsed(path, &bytes(path)?, options.snap)?;
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let imported = import(&urdf, &name, options).map_err(|mistakes| refused(path, &mistakes))?;
    imported.warnings.iter().for_each(|warning| warn(&located(path, warning)));
    let table =
        parse(&format!("table of {}", path.display()), imported.yaml.as_bytes()).map_err(|mistakes| {
            Failure::Input(mistakes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
        })?;
    Ok((imported, table))
}

/// Mistakes as the end of a command.
pub fn refused(path: &Path, mistakes: &[Mistake]) -> Failure {
    Failure::Input(mistakes.iter().map(|mistake| located(path, mistake)).collect::<Vec<_>>().join("\n"))
}

fn located(path: &Path, mistake: &Mistake) -> String {
    format!("{}:{mistake}", path.display())
}
