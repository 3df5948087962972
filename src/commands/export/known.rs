//! What is exported as code: a robot, and of a saved model its parameters and laws.

use std::path::Path;

use dynid_codegen::{Carried, ExportError, Known, Law};
use dynid_runtime::effects::{EffectTerm, Form};
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::Identified;

use super::Arguments;
use crate::failure::Failure;
use crate::output::{self, make_folder, print, warn};
use crate::robots::resolve;
use crate::saved::{is_model, known_parameters, own_dynamics, read_model};

/// A robot, and what is known of it.
pub(super) struct Exported {
    pub robot: Robot,
    pub known: Option<Known>,
}

impl Exported {
    /// By the name of a robot, the path of its YAML, or the path of a model.
    pub fn find(what: &str) -> Result<Self, Failure> {
        let path = Path::new(what);
        if !is_model(path) {
            return Ok(Exported { robot: resolve(what, None)?.model().robot().clone(), known: None });
        }
        let identified = read_model(path)?;
        let robot = own_dynamics(&identified, path)?.model().robot().clone();
        let chi = known_parameters(&identified, &robot, path)?;
        let known = Some(known(&identified, &robot, chi));
        Ok(Exported { robot, known })
    }

    /// Tells what of the model is not in the code.
    pub fn warn_of_left_out(&self) {
        let left_out = self.known.iter().flat_map(|known| &known.left_out);
        left_out.for_each(|what| warn(&format!("not in the code: {what}")));
    }
}

fn known(identified: &Identified, robot: &Robot, chi: Vec<f64>) -> Known {
    let mut known = Known { chi, ..Known::default() };
    for term in &identified.effects {
        let title = title(term);
        if let (Form::Body(_), Some(frame)) = (term.effect.form(), term.place.link()) {
            match robot.base_of_body(frame, &term.amplitude) {
                Some(chi) => known.bodies.push(Carried { title, chi }),
                None => {
                    known.left_out.push(format!("{title}: the table says that parameters of it are 0"));
                }
            }
            continue;
        }
        match term.closed_forms(robot) {
            Ok(forms) => known.laws.extend(forms.into_iter().map(|form| Law {
                joint: form.joint,
                title: title.clone(),
                text: form.text,
            })),
            Err(why) => known.left_out.push(format!("{title}: {why}")),
        }
    }
    if identified.delay != 0.0 {
        let delay = identified.delay * 1e3;
        known.left_out.push(format!("the torque channel is {delay:.3} ms later than the positions"));
    }
    known
}

/// `Stribeck friction on joint 2`.
fn title(term: &EffectTerm) -> String {
    let name = term.place.law().map_or_else(|| term.effect.words().title(), |law| law.id().to_owned());
    let joints: Vec<String> = term.joints.iter().map(ToString::to_string).collect();
    match joints.len() {
        0 => name,
        1 => format!("{name} on joint {}", joints[0]),
        _ => format!("{name} on joints {}", joints.join(", ")),
    }
}

/// Makes the folder and writes a file into it.
pub(super) fn write(arguments: &Arguments, name: &str, text: &str) -> Result<(), Failure> {
    let folder = &arguments.out;
    make_folder(folder)?;
    let path = folder.join(name);
    output::write(&path, text)?;
    print(&format!("wrote {}", path.display()));
    Ok(())
}

/// A robot that has no code.
pub(super) fn failure(what: &str, error: &ExportError) -> Failure {
    Failure::Input(format!("{what}: {error}"))
}
