//! What a log holds, by its first messages.

use std::path::Path;

use super::message::{self, Kind};
use super::{bag, chosen, error, fits, log::Log, topics_of, walk};
use crate::recording::RecordingError;
use crate::recording::formats::Survey;
use crate::recording::topic::Topic;

/// Messages of a log by which its joints are told, and those of a type that is read by its definition.
const SURVEYED: u64 = 2000;
const DEFINED: u64 = 20;
/// Most signals of a message that are told.
const MOST_SIGNALS: usize = 600;

/// The topics of a log, and the joints of the one that is named, else of the one with most messages of those that tell of
/// joints.
pub(in crate::recording) fn survey(
    path: &Path,
    file: &str,
    topic: Option<&str>,
) -> Result<Survey, RecordingError> {
    let paths = bag::files_of(path, file)?;
    let topics = topics_of(&paths)?;
    let mut survey =
        Survey { topics: topics.clone(), topic: None, signals: vec![], stamped: false, notes: vec![] };
    let Some(topic) = looked_at(file, &topics, topic, &mut survey.notes)? else { return Ok(survey) };
    survey.topic = Some(topic.name.clone());
    let by_definition = Kind::of(&topic.kind).is_none();
    let mut log = Log::open(file, topic.clone(), paths, by_definition)?;
    let mut signals = Vec::new();
    while log.messages < if by_definition { DEFINED } else { SURVEYED }
        && let Some(received) = log.next()?
    {
        let data = log.data(&received);
        let stamp = match received.kind {
            Kind::Defined(k) => defined(&log, k, data, &mut signals),
            kind => message::signals(kind, data, &mut signals),
        };
        survey.stamped |= stamp.is_ok_and(|stamp| stamp != 0);
    }
    survey.signals = signals;
    Ok(survey)
}

/// Adds the signals of a message of a definition that are new; its stamp.
fn defined(log: &Log, k: usize, data: &[u8], all: &mut Vec<String>) -> Result<i64, super::cdr::Fault> {
    let (signals, stamp) = walk::signals(&log.definitions[k], data, MOST_SIGNALS)?;
    for signal in signals {
        if all.len() < MOST_SIGNALS && !all.contains(&signal) {
            all.push(signal);
        }
    }
    Ok(stamp)
}

/// The topic that is looked at; `None` where none tells of joints.
fn looked_at<'a>(
    file: &str,
    topics: &'a [Topic],
    name: Option<&str>,
    notes: &mut Vec<String>,
) -> Result<Option<&'a Topic>, RecordingError> {
    if name.is_some() {
        return chosen(file, topics, name, true).map(Some);
    }
    let found: Vec<&Topic> = topics.iter().filter(|topic| fits(topic) && topic.count > 0).collect();
    if found.is_empty() {
        notes.push("no topic holds JointState in CDR; --topic looks at another one".into());
        return Ok(None);
    }
    if found.len() > 1 {
        let names: Vec<&str> = found.iter().map(|topic| topic.name.as_str()).collect();
        notes.push(format!("several topics tell of joints: {}; see --topic", names.join(", ")));
    }
    let one_kind = |kind| found.iter().filter(move |topic| Kind::of(&topic.kind) == Some(kind));
    let most = one_kind(Kind::JointState).chain(one_kind(Kind::DynamicJointState)).copied();
    // The first of equals: a JointState goes before a DynamicJointState.
    let best = most.reduce(|a, b| if b.count > a.count { b } else { a });
    best.map(Some).ok_or_else(|| error(file, "no topic tells of joints".into()))
}
