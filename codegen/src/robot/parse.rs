//! A robot from its YAML.

use super::couplings::read_couplings;
use super::diagnostic::Diagnostic;
use super::document::{Node, Place, START, Value, read_document};
use super::drive::read_drive;
use super::drive_table::DriveTable;
use super::ellipsoids::read_ellipsoids;
use super::formula::joint_variable;
use super::identifier::check_identifier;
use super::known::{Known, read_known};
use super::magnitudes::within;
use super::reader::Reader;
use super::rows::read_frames;
use super::simulation_values::{read_limits, read_nominal};
use super::table::{NominalValues, RobotTable, standard_parameters};
use dynid_description::bounds::HEAVIEST;
use dynid_description::{JointKind, Limits, StandardParameter};
use std::collections::HashSet;

const KEYS: [&str; 13] = [
    "name",
    "description",
    "gravity",
    "constants",
    "frames",
    "drive",
    "friction",
    "springs",
    "massless",
    "known",
    "ellipsoids",
    "limits",
    "nominal",
];

/// Reads a robot from the bytes of its YAML and checks it.
///
/// `path` is how the messages name the file. All mistakes are reported at once, in the order of the file; a file
/// that is not UTF-8, not YAML, or empty gives just one.
///
/// # Errors
/// Every mistake of the file.
pub fn parse(path: &str, bytes: &[u8]) -> Result<RobotTable, Vec<Diagnostic>> {
    parse_with_warnings(path, bytes).map(|(robot, _)| robot)
}

/// [`parse`], with what is allowed in the file but probably not meant.
///
/// # Errors
/// As [`parse`].
pub fn parse_with_warnings(
    path: &str,
    bytes: &[u8],
) -> Result<(RobotTable, Vec<Diagnostic>), Vec<Diagnostic>> {
    let root = read_document(path, bytes).map_err(|diagnostic| vec![diagnostic])?;
    let mut reader = Reader::new(path);
    let robot = read_robot(&mut reader, &root);
    let mut diagnostics = reader.diagnostics;
    diagnostics.sort_by_key(|d| (d.line, d.column));
    match robot {
        Some(robot) if diagnostics.is_empty() => Ok((robot, reader.warnings)),
        _ => Err(diagnostics),
    }
}

/// A mistake at the name of a robot.
pub(crate) fn at_name(path: &str, bytes: &[u8], message: String) -> Diagnostic {
    let place = match read_document(path, bytes) {
        Ok(Node { value: Value::Mapping(pairs), .. }) => pairs
            .iter()
            .find(|(key, _)| matches!(&key.value, Value::Scalar { text, .. } if text == "name"))
            .map(|(key, _)| key.place),
        _ => None,
    };
    let Place { line, column } = place.unwrap_or(START);
    Diagnostic { path: path.to_owned(), line, column, message }
}

fn read_robot(reader: &mut Reader, root: &Node) -> Option<RobotTable> {
    let fields = reader.fields(root, "a robot", &KEYS)?;
    let name = reader.required(&fields, "name").and_then(|node| {
        let name = reader.text(node, "the robot's name")?;
        if let Err(why) = check_identifier(name) {
            reader.report(node.place, format!("name {} {why}", node.describe()));
        }
        Some(name.to_owned())
    });
    let description = match fields.get("description") {
        Some(node) => reader.text(node, "description as a line of text").unwrap_or_default().to_owned(),
        None => String::new(),
    };
    let constants = fields.get("constants").map(|node| read_constants(reader, node)).unwrap_or_default();
    let gravity = match fields.get("gravity") {
        Some(node) => reader.numbers(node, "gravity", 3, &constants).map(|g| {
            g.iter().for_each(|&x| within(reader, node, "gravity", x, [0.0, HEAVIEST]));
            [g[0], g[1], g[2]]
        }),
        None => Some([0.0, 0.0, -9.81]),
    };
    let (frames, dependent) =
        reader.required(&fields, "frames").and_then(|node| read_frames(reader, node, &constants))?;
    let joints = frames.iter().filter(|f| f.kind != JointKind::Fixed).count();
    let drive = match fields.get("drive") {
        Some(node) => read_drive(reader, node, &frames, &constants),
        None => DriveTable::direct(joints),
    };
    let zero = (fields.get("massless"), fields.get("known"));
    let acting = (fields.get("friction"), fields.get("springs"));
    let couplings = read_couplings(reader, acting, (&frames, &dependent, &drive), &constants);
    let standard = standard_parameters(&frames, &drive, &couplings);
    let known = read_known(reader, zero, &standard, &constants);
    let ellipsoids =
        fields.get("ellipsoids").map(|node| read_ellipsoids(reader, node, (&standard, &known), &constants));
    let limits = match fields.get("limits") {
        Some(node) => read_limits(reader, node, joints, &constants),
        None => Limits::default(),
    };
    let mut nominal =
        fields.get("nominal").and_then(|node| read_nominal(reader, node, joints, &standard, &constants));
    check_nominal(reader, fields.get("nominal"), nominal.as_mut(), (&standard, &known));
    Some(RobotTable {
        name: name?,
        description,
        gravity: gravity?,
        constants,
        frames,
        dependent,
        drive,
        couplings,
        known: known.zero,
        fixed: known.fixed,
        ellipsoids: ellipsoids.unwrap_or_default(),
        limits,
        nominal,
    })
}

/// What is known has no other nominal value.
fn check_nominal(
    reader: &mut Reader,
    node: Option<&Node>,
    nominal: Option<&mut NominalValues>,
    (standard, known): (&[StandardParameter], &Known),
) {
    let (Some(node), Some(nominal)) = (node, nominal) else { return };
    let all = known.zero.iter().map(|&k| (k, 0.0)).chain(known.fixed.iter().copied());
    for (k, expected) in all {
        let name = &standard[k].name;
        match nominal.standard.iter().find(|(named, _)| named == name) {
            Some((_, value)) if *value != expected => {
                reader.report(
                    node.place,
                    format!("nominal has {name}: {value}, which is known to be {expected}"),
                );
            }
            None if expected != 0.0 => nominal.standard.push((name.to_string(), expected)),
            _ => {}
        }
    }
}

fn read_constants(reader: &mut Reader, node: &Node) -> Vec<(String, f64)> {
    let mut constants: Vec<(String, f64)> = Vec::new();
    let Value::Mapping(pairs) = &node.value else {
        let found = node.describe();
        reader.report(node.place, format!("expected constants by name ({{d3: 0.225}}), found {found}"));
        return constants;
    };
    let mut seen = HashSet::new();
    for (key, value) in pairs {
        let Some(name) = reader.text(key, "the name of a constant") else { continue };
        let shown = key.describe();
        if !seen.insert(name) {
            let first = reader.first_of(pairs, name, key.place).map_or(0, |place| place.line);
            reader.report(key.place, format!("constant {shown} is there twice; first at line {first}"));
            continue;
        }
        if name == "pi" || joint_variable(name).is_some() {
            reader.report(
                key.place,
                format!("constant {shown} would hide pi or a joint variable: choose another name"),
            );
        } else if let Err(why) = check_identifier(name) {
            reader.report(key.place, format!("constant {shown} {why}"));
        }
        // A constant whose value is wrong still counts as known, so that its uses are not reported too.
        let number = reader.number(value, &format!("constant {shown}"), &constants).unwrap_or(1.0);
        constants.push((name.to_owned(), number));
    }
    constants
}
