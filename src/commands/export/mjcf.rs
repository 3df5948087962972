//! `dynid export --to mjcf`: a robot for MuJoCo.

use dynid_urdf::write_mjcf;

use super::bodies::{Fitted, TemplateFile, skeleton};
use super::{Arguments, Target, left_out};
use crate::failure::Failure;
use crate::output::write;

/// Fits bodies, writes the file and what it cannot hold.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let template = TemplateFile::read(arguments)?;
    let fitted = Fitted::new(arguments, template.as_ref())?;
    let skeleton = match &template {
        None => skeleton(&fitted),
        Some(file) => file.of(&fitted.robot, arguments)?.skeleton(&fitted.robot, &fitted.standard),
    };
    write(&arguments.out, &write_mjcf(&skeleton))?;
    left_out::tell(&fitted, Target::Mjcf, &arguments.what, &arguments.out)
}
