//! The models generated from `robots/` at build time: a module and a [`Model`] for each robot.

use dynid_runtime::model::{Model, Operations};

include!(concat!(env!("OUT_DIR"), "/registry.rs"));

/// The generated models, by name.
pub fn all() -> &'static [&'static dyn Model] {
    MODELS
}

/// The generated model of a robot.
pub fn find(name: &str) -> Option<&'static dyn Model> {
    all().iter().copied().find(|model| model.robot().name == name)
}

/// Operation counts of the generated functions of a robot.
pub fn operations(name: &str) -> Option<&'static [Operations]> {
    let at = all().iter().position(|model| model.robot().name == name)?;
    OPERATIONS.get(at).copied()
}
