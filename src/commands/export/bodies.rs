//! Standard parameters for formats that need bodies: nearest to the template's among those that have the identified base
//! parameters.

use std::path::Path;

use dynid_runtime::model::Robot;
use dynid_runtime::model_file::Identified;
use dynid_urdf::{Skeleton, Template, Urdf};

use super::Arguments;
use crate::body_report;
use crate::failure::Failure;
use crate::near_bodies::{NearBodies, Table};
use crate::robots::resolve;
use crate::saved::{is_model, own_dynamics, read_model};
use crate::urdf_files;

/// A robot with standard parameters that bodies can have.
pub(super) struct Fitted {
    /// The table.
    pub robot: Robot,
    /// Its standard parameters.
    pub standard: Vec<f64>,
    /// The model that they come from; `None` where they are a robot's nominal ones.
    pub identified: Option<(Identified, NearBodies)>,
    /// The prior's standard parameters.
    pub prior: Vec<f64>,
}

/// A template that was read.
pub(super) struct TemplateFile {
    /// As it is, byte for byte.
    pub bytes: Vec<u8>,
    /// What it says.
    pub urdf: Urdf,
}

impl TemplateFile {
    /// Reads the template that was asked for.
    pub fn read(arguments: &Arguments) -> Result<Option<Self>, Failure> {
        let Some(path) = &arguments.template else { return Ok(None) };
        let bytes = urdf_files::bytes(path)?;
        let urdf = urdf_files::parsed(path, &bytes, arguments.options.snap)?;
        Ok(Some(Self { bytes, urdf }))
    }

    /// The joints of a robot in it.
    pub fn of<'a>(&'a self, robot: &Robot, arguments: &Arguments) -> Result<Template<'a>, Failure> {
        let path = arguments.template.as_deref().unwrap_or(Path::new(""));
        urdf_files::template(path, &self.urdf, robot, &arguments.options.import()?)
    }
}

impl Fitted {
    /// The robot that was asked for, with the bodies nearest to the prior where it is a model.
    pub fn new(arguments: &Arguments, template: Option<&TemplateFile>) -> Result<Self, Failure> {
        let path = Path::new(&arguments.what);
        if !is_model(path) {
            let robot = resolve(&arguments.what, None)?.model().robot().clone();
            let Some(nominal) = &robot.nominal else {
                return Err(Failure::Input(format!(
                    "{}: it has no nominal parameters to export",
                    arguments.what
                )));
            };
            let standard = nominal.standard.to_vec();
            return Ok(Self { prior: standard.clone(), standard, robot, identified: None });
        }
        let identified = read_model(path)?;
        let robot = own_dynamics(&identified, path)?.model().robot().clone();
        let template = template.map(|file| file.of(&robot, arguments)).transpose()?;
        let path_of_template = arguments.template.as_deref().unwrap_or(Path::new(""));
        let template = template.as_ref().map(|template| (template, path_of_template));
        let nominal =
            identified.table.as_ref().and_then(|table| table.nominal.as_ref()).or(robot.nominal.as_ref());
        let ellipsoids = identified.table.as_ref().map_or(&robot.ellipsoids, |table| &table.ellipsoids);
        let table = Table { nominal: nominal.map(|n| n.standard.as_ref()), ellipsoids };
        let bodies = NearBodies::new(&identified, &robot, table, template)
            .map_err(|error| Failure::Data(format!("{}: {error}", path.display())))?;
        let standard = bodies.near.standard.clone();
        Ok(Self { standard, prior: bodies.prior.clone(), robot, identified: Some((identified, bodies)) })
    }

    /// What the data and what the prior decided, and how near the base parameters are.
    pub fn words(&self) -> String {
        match &self.identified {
            Some((identified, bodies)) => {
                let words = bodies.words(identified, &self.robot);
                let more = body_report::words(&body_report::report(bodies, &self.robot, None, None));
                if more.is_empty() { words } else { format!("{words}\n\n{more}") }
            }
            None => "the robot's nominal parameters, as they are".to_owned(),
        }
    }
}

/// A table without a template, as bodies.
pub(super) fn skeleton(fitted: &Fitted) -> Skeleton {
    Skeleton::of_table(&fitted.robot, &fitted.standard)
}
