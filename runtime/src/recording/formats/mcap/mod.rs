//! MCAP files and rosbag2 folders: joints by their names, rows by the stamps of the messages.
//!
//! Columns are called `joint.position`, `joint.velocity`, `joint.effort` (of a DynamicJointState `joint.interface`);
//! of messages of any other type whose definition is in the file, by fields: `wrench.force.x`, `actual.positions[0]`,
//! `actual.positions[elbow]`. `header.stamp`, `log_time` and `publish_time` are seconds since the first message that was
//! used, as an epoch in nanoseconds does not fit a double.

mod bag;
mod begun;
mod cdr;
mod chunk;
mod container;
mod decoder;
mod definition;
mod fields;
mod log;
mod merge;
mod message;
mod path;
mod plan;
mod reader;
mod survey;
mod topics;
mod walk;
mod write;

use std::io;
use std::path::PathBuf;

use crate::recording::RecordingError;
use crate::recording::names::meant;
use crate::recording::topic::Topic;
pub(in crate::recording) use bag::files_of;
pub(in crate::recording) use begun::begun;
use container::Records;
use message::Kind;
pub(super) use reader::McapReader;
pub(in crate::recording) use survey::survey;
pub(in crate::recording) use write::write;

fn error(file: &str, message: String) -> RecordingError {
    RecordingError::File { file: file.into(), message }
}

/// What the system, or the container, said.
fn says(file: &str, why: &io::Error) -> RecordingError {
    error(file, why.to_string())
}

fn topics_of(paths: &[PathBuf]) -> Result<Vec<Topic>, RecordingError> {
    // Which of several files it was, says the error of opening it.
    for path in paths {
        Records::open(path).map_err(|e| RecordingError::io(path, &e))?;
    }
    topics::topics(paths).map_err(|e| match paths.first() {
        Some(path) => RecordingError::io(path, &e),
        None => error("", e.to_string()),
    })
}

/// Whether messages of a topic tell of joints.
fn fits(topic: &Topic) -> bool {
    Kind::of(&topic.kind).is_some() && topic.encoding == "cdr"
}

/// The topic that is meant: the one that is named, or the only one that tells of joints. `of_any_type`: one that is named
/// may hold messages of any type, as far as they are in CDR.
fn chosen<'a>(
    file: &str,
    topics: &'a [Topic],
    name: Option<&str>,
    of_any_type: bool,
) -> Result<&'a Topic, RecordingError> {
    let told = |topic: &Topic| format!("{} ({}, {} messages)", topic.name, topic.kind, topic.count);
    let all = || topics.iter().take(60).map(told).collect::<Vec<_>>().join(", ");
    if let Some(name) = name {
        let Some(topic) = topics.iter().filter(|t| t.name == name).max_by_key(|t| fits(t)) else {
            let meant = meant(name, topics.iter().map(|t| t.name.as_str()));
            return Err(error(file, format!("there is no topic `{name}`{meant}; there are: {}", all())));
        };
        if fits(topic) || of_any_type && topic.encoding == "cdr" {
            return Ok(topic);
        }
        return Err(error(file, not_read(topic, &all())));
    }
    // A JointState goes before a DynamicJointState of the same joints.
    let of = |kind: Kind| {
        topics.iter().filter(|t| fits(t)).filter(move |t| t.count > 0 && Kind::of(&t.kind) == Some(kind))
    };
    let mut found: Vec<&Topic> = of(Kind::JointState).collect();
    if found.is_empty() {
        found = of(Kind::DynamicJointState).collect();
    }
    match found[..] {
        [topic] => Ok(topic),
        [] => Err(error(file, format!("no topic holds JointState in CDR; there are: {}", all()))),
        _ => {
            let which = found.iter().map(|t| told(t)).collect::<Vec<_>>().join(", ");
            Err(error(file, format!("several topics tell of joints; say which with `topic`: {which}")))
        }
    }
}

/// Why a topic that was named is not read, and what helps.
fn not_read(topic: &Topic, all: &str) -> String {
    let head = format!("topic {} holds {} in the encoding `{}`; ", topic.name, topic.kind, topic.encoding);
    if topic.encoding == "cdr" {
        return format!(
            "{head}JointState and DynamicJointState in CDR are read by their joints, other messages by their fields: \
             `fields: {{position: actual.positions, torque: actual.effort}}` beside `joints`, or columns such as \
             `actual.positions[0]` (`dynid look FILE --topic {}` lists them). There are: {all}",
            topic.name
        );
    }
    format!(
        "{head}JointState and DynamicJointState in CDR are read, and other messages in CDR by their fields; not JSON, \
         protobuf or others, which ROS 2 does not record: record with ros2 bag, or write the signals as CSV or Parquet. \
         There are: {all}"
    )
}
