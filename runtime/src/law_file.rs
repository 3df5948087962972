//! A file of laws that a user wrote down, to be tried in a diagnosis.
//!
//! ```
//! use dynid_runtime::law_file::parse;
//! # use dynid_runtime::model::{Drive, Frame, JointKind, Limits, Robot};
//! # let row = Frame::on_base(JointKind::Revolute);
//! # let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
//! # let robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], vec![row], drive, Limits::default());
//!
//! let laws = parse("laws.yaml", b"- {id: magnet, joint: 1, law: 'k1*sin(2*q1) + k2*cos(2*q1)'}", &robot)?;
//! assert_eq!(laws[0].id(), "magnet");
//!
//! let mistake = parse("laws.yaml", b"- {id: magnet, joint: 1, law: sin(k*q1)}", &robot);
//! assert!(mistake.unwrap_err().to_string().starts_with("laws.yaml:1:35: 'k' does not enter linearly"));
//! # Ok::<(), dynid_runtime::law_file::LawFileError>(())
//! ```

use crate::effects::{LawError, UserLaw};
use crate::model::{JointNumber, Robot};
use crate::recording::yaml::{MAX_BYTES, Mistake, Node, Place, read_positions_of};
use crate::regular_file;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Most laws of a file: each is one more thing that is tried, and weighs on the evidence of all.
const MOST_LAWS: usize = 50;
/// What a file is called in messages.
const WHAT: &str = "list of laws";

/// A file of laws that cannot be used, with the place and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LawFileError {
    /// A file that cannot be opened or read.
    #[error("{file}: {message}")]
    File {
        /// The file.
        file: String,
        /// What the system said.
        message: String,
    },
    /// Text that is no list of laws of this robot.
    #[error("{file}:{line}:{column}: {message}")]
    Law {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
}

/// One entry of the list.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    id: String,
    joint: usize,
    law: String,
    unit: Option<String>,
    #[serde(default)]
    shapes: BTreeMap<String, [f64; 2]>,
}

/// Reads a file of laws for a robot.
///
/// # Errors
/// A file that cannot be read; otherwise as [`parse`].
pub fn read(path: &Path, robot: &Robot) -> Result<Vec<UserLaw>, LawFileError> {
    let file = path.display().to_string();
    let bytes = regular_file::read(path, MAX_BYTES as u64)
        .map_err(|e| LawFileError::File { file: file.clone(), message: e.to_string() })?;
    parse(&file, &bytes, robot)
}

/// Parses the text of a file of laws; `file` is its name for messages.
///
/// # Errors
/// [`LawFileError::Law`] with line and column: text that is not YAML or no list of laws; a key that is unknown, missing
/// or there twice; an id that is there twice or in the catalogue; a joint that the robot does not have; a text that is no
/// law.
pub fn parse(file: &str, bytes: &[u8], robot: &Robot) -> Result<Vec<UserLaw>, LawFileError> {
    let fail = |Mistake { place, message }| LawFileError::Law {
        file: file.to_owned(),
        line: place.line,
        column: place.column,
        message,
    };
    let root = read_positions_of(bytes, WHAT).and_then(list).map_err(fail)?;
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let raw: Vec<Raw> = serde_yaml::from_slice(text).map_err(|e| fail(mistake_of(&e, &root)))?;
    let nodes = root.items().unwrap_or_default();
    let mut laws: Vec<UserLaw> = Vec::new();
    for (raw, node) in raw.iter().zip(nodes) {
        let law = law_of(raw, node, robot).map_err(fail)?;
        if laws.iter().any(|other| other.id() == law.id()) {
            let message = format!("'{}' is there twice; every law needs an id of its own", law.id());
            return Err(fail(at_value(node, "id", message)));
        }
        laws.push(law);
    }
    Ok(laws)
}

/// A file that is a list of some laws.
fn list(root: Option<Node>) -> Result<Node, Mistake> {
    const EXAMPLE: &str = "- {id: magnet, joint: 4, law: \"k1*sin(2*q4) + k2*cos(2*q4)\"}";
    let Some(root) = root else {
        return Err(Mistake {
            place: Place::START,
            message: format!("the file is empty; expected {EXAMPLE}"),
        });
    };
    let message = match root.items() {
        None => format!("expected a list of laws, as {EXAMPLE}"),
        Some([]) => format!("the list is empty; expected {EXAMPLE}"),
        Some(items) if items.len() > MOST_LAWS => {
            format!("{} laws; at most {MOST_LAWS} are tried at once", items.len())
        }
        Some(items) => match items.iter().find(|item| !item.is_mapping()) {
            Some(item) => {
                return Err(Mistake { place: item.place, message: format!("expected a law, as {EXAMPLE}") });
            }
            None => return Ok(root),
        },
    };
    Err(Mistake { place: root.place, message })
}

/// A mistake in the value of a key.
fn at_value(node: &Node, key: &str, message: String) -> Mistake {
    Mistake { place: node.value_of(key).map_or(node.place, |value| value.place), message }
}

/// A mistake at a character of the law's text.
fn in_text(node: &Node, offset: usize, message: String) -> Mistake {
    Mistake { place: node.value_of("law").map_or(node.place, |text| text.place_of_text(offset)), message }
}

fn law_of(raw: &Raw, node: &Node, robot: &Robot) -> Result<UserLaw, Mistake> {
    let Some(joint) = robot.joint_index(JointNumber(raw.joint)) else {
        let known: Vec<String> = (0..robot.joints())
            .map(|j| robot.joint_number(crate::model::JointIndex(j)).0.to_string())
            .collect();
        let message =
            format!("{} has no joint {}; its joints are {}", robot.name, raw.joint, known.join(", "));
        return Err(at_value(node, "joint", message));
    };
    let frame = &robot.frames[raw.joint - 1];
    let unit = frame.kind.torque_unit();
    if let Some(given) = raw.unit.as_ref().filter(|given| *given != unit) {
        let message = format!("'{given}': the torque of joint {} is in {unit}", raw.joint);
        return Err(at_value(node, "unit", message));
    }
    let law = UserLaw::new(&raw.id, joint.0, &raw.law, &raw.shapes).map_err(|e| match e {
        LawError { field: "law", offset, message } => in_text(node, offset, message),
        LawError { field, message, .. } => at_value(node, field, message),
    })?;
    law.variables(robot).map_err(|name| {
        let offset = offset_of(&raw.law, &name);
        in_text(node, offset, format!("{name}: {} has no such joint", robot.name))
    })?;
    Ok(law)
}

/// Characters before a name in a text.
fn offset_of(text: &str, name: &str) -> usize {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let alone = |at: &usize| {
        let (before, after) = (&text[..*at], &text[at + name.len()..]);
        !before.ends_with(part) && !after.starts_with(part)
    };
    let found = text.match_indices(name).map(|(at, _)| at).find(alone);
    found.map_or(0, |at| text[..at].chars().count())
}

/// What serde found wrong, with the place told once, in front.
fn mistake_of(error: &serde_yaml::Error, root: &Node) -> Mistake {
    let place = error.location().map_or(root.place, |l| Place { line: l.line(), column: l.column() });
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let short: String = message.chars().take(200).collect();
    Mistake { place, message: format!("{short}; a law has id, joint, law, and where needed unit and shapes") }
}

#[cfg(test)]
#[path = "law_file_tests.rs"]
mod tests;
