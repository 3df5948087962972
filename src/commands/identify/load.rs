//! What `identify` is asked of a payload, and the file that says what is known of one.

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::estimation::{KnownPayload, PayloadBody, Quantity};
use dynid_runtime::regular_file;
use dynid_runtime::report::significant;
use serde::{Deserialize, Serialize};

use crate::failure::{Failure, file_failure};
use crate::output::table;

/// Longest file that is read, bytes.
const LONGEST: u64 = 1 << 16;
/// Names of the ten inertial parameters, with their units.
const INERTIA: [&str; 6] = ["XX", "XY", "XZ", "YY", "YZ", "ZZ"];

/// What a payload is used for.
#[derive(Debug, Args)]
pub(super) struct LoadArguments {
    /// A recording of the same robot with a payload on its last link: gains of the drives, by total least squares
    #[arg(long, conflicts_with_all = ["method", "planned", "physical", "base", "out", "report", "residuals", "payload_only"])]
    pub loaded: Option<PathBuf>,
    /// What is known of that payload: a YAML with some of mass, centre and inertia
    #[arg(long, requires = "loaded")]
    pub payload: Option<PathBuf>,
    /// A model of the robot without payload
    #[arg(long, requires = "payload_only")]
    pub reference: Option<PathBuf>,
    /// Only the payload that the robot of the recording carries: mass, centre and inertia
    #[arg(long, requires = "reference", conflicts_with_all = ["method", "planned", "physical", "base", "out", "report", "residuals"])]
    pub payload_only: bool,
}

/// A payload file: SI, last frame of the table.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct PayloadFile {
    mass: Option<f64>,
    centre: Option<[f64; 3]>,
    inertia: Option<InertiaFile>,
}

/// Inertia about the centre of mass; what is left out is zero.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the names of the file")]
struct InertiaFile {
    XX: f64,
    #[serde(default)]
    XY: f64,
    #[serde(default)]
    XZ: f64,
    YY: f64,
    #[serde(default)]
    YZ: f64,
    ZZ: f64,
}

/// Reads what is known of a payload.
///
/// # Errors
/// [`Failure::Input`] with the file, and what is wrong in it.
pub(super) fn read(path: &Path) -> Result<KnownPayload, Failure> {
    let text = regular_file::read_text(path, LONGEST)
        .map_err(|error| file_failure("read the payload", path, &error))?;
    let file: Option<PayloadFile> = serde_yaml::from_str(&text).map_err(|error| {
        Failure::Input(format!(
            "{}: {error}: a payload is written as `mass: 2.5`, `centre: [x, y, z]` and `inertia: {{XX: .., YY: .., ZZ: ..}}`, \
             each as far as it is known, SI",
            path.display()
        ))
    })?;
    let file = file.unwrap_or_default();
    let inertia = file.inertia.map(|i| [i.XX, i.XY, i.XZ, i.YY, i.YZ, i.ZZ]);
    Ok(KnownPayload { mass: file.mass, centre: file.centre, inertia })
}

/// A number with its standard deviation, for other programs.
#[derive(Debug, Serialize)]
pub(super) struct Number {
    value: Option<f64>,
    sigma: Option<f64>,
}

impl Number {
    fn of(quantity: &Quantity) -> Self {
        Self { value: quantity.sigma.map(|_| quantity.value), sigma: quantity.sigma }
    }
}

/// A payload for other programs; numbers that the data do not determine are null.
#[derive(Debug, Serialize)]
pub(super) struct PayloadJson {
    mass: Number,
    centre: [Number; 3],
    inertia: [Number; 6],
    at_origin: [Number; 10],
}

impl PayloadJson {
    pub fn of(body: &PayloadBody) -> Self {
        let all = &body.parameters;
        Self {
            mass: Number::of(&body.mass),
            centre: std::array::from_fn(|k| Number::of(&body.centre[k])),
            inertia: std::array::from_fn(|k| Number::of(&body.inertia[k])),
            at_origin: std::array::from_fn(|k| Number::of(&all[k])),
        }
    }
}

/// Mass, centre, inertia about the centre, and what a robot feels of them, as a table.
///
/// `frame` is the number of the frame that it is told in.
pub(super) fn payload_table(body: &PayloadBody, frame: usize) -> String {
    let row = |name: &str, quantity: &Quantity, unit: &str| {
        let [value, sigma] = match quantity.sigma {
            None => ["not determined".to_owned(), "-".to_owned()],
            Some(0.0) => [significant(quantity.value, 4), "known".to_owned()],
            Some(sigma) => [significant(quantity.value, 4), significant(sigma, 2)],
        };
        vec![name.to_owned(), value, sigma, unit.to_owned()]
    };
    let mut rows = vec![row("mass", &body.mass, "kg")];
    for (name, quantity) in ["x", "y", "z"].iter().zip(&body.centre) {
        rows.push(row(&format!("centre {name}"), quantity, "m"));
    }
    for (name, quantity) in INERTIA.iter().zip(&body.inertia) {
        rows.push(row(&format!("{name} about the centre"), quantity, "kg.m2"));
    }
    let open =
        body.mass.sigma.is_none() || body.centre.iter().chain(&body.inertia).any(|q| q.sigma.is_none());
    if open {
        let names = INERTIA.iter().map(|name| (*name, "kg.m2"));
        let moments = ["MX", "MY", "MZ"].map(|name| (name, "kg.m"));
        for ((name, unit), quantity) in names.chain(moments).zip(&body.parameters) {
            rows.push(row(&format!("{name} at the origin"), quantity, unit));
        }
    }
    format!("payload, in frame {frame}:\n{}", table(&["<", "value", "sigma", "<unit"], rows))
}
