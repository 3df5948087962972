//! What each robot is compared with: the model that the fleet names, or what the robot's first day says, which is kept.

use std::collections::BTreeMap;
use std::sync::Arc;

use datafusion::arrow::array::{BinaryArray, RecordBatch};
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use dynid::saved::read_model;
use dynid_runtime::estimation::Reduced;

use super::folder::OutFolder;
use super::rows::{batch, bytes, day_of, days, text, texts};
use super::tables;
use crate::day::Day;
use crate::error::{FleetError, Result};
use crate::fleet_file::FleetFile;

/// What a robot is compared with.
#[derive(Debug, Clone)]
pub struct RobotReference {
    /// The text of its model, where the fleet names one.
    pub model: Option<String>,
    /// [`Reduced`] of its first day, where the fleet names none.
    pub factor: Option<Vec<u8>>,
    /// Values by the names of parameters.
    pub values: BTreeMap<String, f64>,
}

/// References of the robots of a fleet.
pub struct References<'a> {
    fleet: &'a FleetFile,
    out: &'a OutFolder,
    /// First day and factor of each robot that has no model.
    first: BTreeMap<String, (Day, Vec<u8>)>,
    known: BTreeMap<String, RobotReference>,
}

fn schema() -> SchemaRef {
    Arc::new(Schema::new(vec![
        Field::new("robot", DataType::Utf8, false),
        Field::new("day", DataType::Date32, false),
        Field::new("factor", DataType::Binary, false),
    ]))
}

impl<'a> References<'a> {
    /// Those that were kept.
    ///
    /// # Errors
    /// A table that is none.
    pub fn read(fleet: &'a FleetFile, out: &'a OutFolder) -> Result<Self> {
        let mut first = BTreeMap::new();
        if let Some(kept) = tables::read(&out.file("references.parquet"), &schema())? {
            for k in 0..kept.num_rows() {
                if let (Some(robot), Some(day), Some(factor)) =
                    (text(&kept, "robot", k), day_of(&kept, k), bytes(&kept, "factor", k))
                {
                    first.insert(robot.to_owned(), (day, factor.to_vec()));
                }
            }
        }
        Ok(Self { fleet, out, first, known: BTreeMap::new() })
    }

    /// Forgets what a robot's first day said, of which a recording was replaced.
    pub fn forget(&mut self, robot: &str, day: Day) {
        if self.first.get(robot).is_some_and(|(first, _)| *first == day) {
            self.first.remove(robot);
        }
    }

    /// The reference of a robot, of which a day gave this factor: that becomes its reference where it has none.
    ///
    /// # Errors
    /// A model that cannot be read.
    pub fn of(&mut self, robot: &str, day: Day, factor: &[u8]) -> Result<&RobotReference> {
        if !self.known.contains_key(robot) {
            let reference = match self.fleet.reference_of(robot) {
                Some(path) => {
                    let model = read_model(&path)?;
                    let text = std::fs::read_to_string(&path);
                    let text = text.map_err(|error| FleetError::io(&path, "read the model", &error))?;
                    let values = model.base_parameters.iter().map(|p| (p.name.clone(), p.value)).collect();
                    RobotReference { model: Some(text), factor: None, values }
                }
                None => {
                    let (_, factor) =
                        self.first.entry(robot.to_owned()).or_insert_with(|| (day, factor.to_vec()));
                    let reduced = Reduced::from_bytes(factor);
                    let found =
                        reduced.map_err(|error| FleetError::Engine(format!("{robot}: {error}")))?.solve();
                    let determined = found.parameters.into_iter().filter(|p| p.sigma.is_some());
                    let values = determined.map(|p| (p.name, p.value)).collect();
                    RobotReference { model: None, factor: Some(factor.clone()), values }
                }
            };
            self.known.insert(robot.to_owned(), reference);
        }
        self.known.get(robot).ok_or_else(|| FleetError::Engine(format!("{robot} has no reference")))
    }

    /// Keeps those of robots' first days.
    ///
    /// # Errors
    /// What the file system says.
    pub fn keep(&self) -> Result<()> {
        let rows: RecordBatch = batch(
            &schema(),
            vec![
                texts(self.first.keys().map(|robot| Some(robot.as_str()))),
                days(self.first.values().map(|(day, _)| *day)),
                Arc::new(BinaryArray::from_iter_values(self.first.values().map(|(_, factor)| factor))),
            ],
        )?;
        tables::write(&self.out.file("references.parquet"), &rows)
    }
}
