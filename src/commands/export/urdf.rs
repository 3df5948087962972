//! `dynid export --to urdf`: identified values in a user's own URDF, or a URDF of the table.

use dynid_runtime::model::ParameterKind;
use dynid_urdf::{JointFriction, value, write_urdf};

use super::bodies::{Fitted, TemplateFile, skeleton};
use super::{Arguments, Target, left_out};
use crate::failure::Failure;
use crate::output::write;
use crate::urdf_files::refused;

/// Fits bodies, writes the file and what it cannot hold.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let template = TemplateFile::read(arguments)?;
    let fitted = Fitted::new(arguments, template.as_ref())?;
    let text = match &template {
        None => write_urdf(&skeleton(&fitted)),
        Some(file) => {
            let found = file.of(&fitted.robot, arguments)?;
            found.patched(&file.bytes, &fitted.robot, &fitted.standard, &frictions(&fitted)).map_err(
                |mistake| refused(arguments.template.as_deref().unwrap_or(&arguments.out), &[mistake]),
            )?
        }
    };
    write(&arguments.out, &text)?;
    left_out::tell(&fitted, Target::Urdf, &arguments.what, &arguments.out)
}

/// Friction of each joint as the format has it.
fn frictions(fitted: &Fitted) -> Vec<JointFriction> {
    let frames = fitted.robot.joint_of_frame();
    let of = |frame: usize, kind| value(&fitted.robot, &fitted.standard, frame, kind).max(0.0);
    let joints = (0..frames.len()).filter(|&frame| frames[frame].is_some());
    joints
        .map(|f| JointFriction { damping: of(f, ParameterKind::Fv), friction: of(f, ParameterKind::Fc) })
        .collect()
}
