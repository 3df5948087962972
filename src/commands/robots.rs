//! `dynid robots`: what there is.

use crate::failure::Failure;
use crate::models;
use crate::output::{print, table};

/// Prints one line a robot.
pub(super) fn run() -> Result<(), Failure> {
    let rows = models::all()
        .iter()
        .map(|model| {
            let robot = model.robot();
            vec![
                robot.name.to_string(),
                robot.joints().to_string(),
                robot.standard.len().to_string(),
                robot.base.len().to_string(),
                robot.description.to_string(),
            ]
        })
        .collect();
    print(&table(&["<robot", "joints", "standard", "base", "<description"], rows));
    Ok(())
}
