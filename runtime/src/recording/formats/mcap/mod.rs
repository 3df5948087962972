//! MCAP files and rosbag2 folders: joints by their names, rows by the stamps of the messages.
//!
//! Columns are called `joint.position`, `joint.velocity`, `joint.effort` (of a DynamicJointState `joint.interface`);
//! `header.stamp`, `log_time` and `publish_time` are seconds since the first message that was used, as an epoch in
//! nanoseconds does not fit a double.

mod bag;
mod begun;
mod cdr;
mod chunk;
mod container;
mod merge;
mod message;
mod topics;
mod write;

use std::collections::{HashMap, VecDeque};
use std::io;
use std::path::{Path, PathBuf};

use super::{Format, Survey, Wanted};
use crate::recording::look::Topic;
use crate::recording::names::{listed, meant};
use crate::recording::{Column, RecordingError, Rows};
pub(in crate::recording) use bag::files_of;
pub(in crate::recording) use begun::begun;
use container::{Fields, Found, Records, op};
use merge::Merge;
use message::{Decoder, FIELDS, Kind, Signal};
use topics::{Channel, schema};
pub(in crate::recording) use write::write;

/// Messages after which a signal that no message had is given up, if no row is complete yet.
const GIVEN_UP: u64 = 5000;

/// Reads the joints of one topic.
pub(super) struct McapReader {
    file: String,
    topic: Topic,
    /// Files that are still to be read, and the one that is read.
    paths: VecDeque<PathBuf>,
    records: Records,
    /// Of the file that is read: names of types, and types of the channels of the topic.
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Kind>,
    decoder: Decoder,
    /// Columns of times.
    times: Vec<(Time, usize)>,
    merge: Merge,
    /// The first times that were used, ns.
    first: Option<[i64; 3]>,
    /// Messages of the topic, and those of them that could not be decoded, with the first reason.
    messages: u64,
    faulty: u64,
    fault: Option<(u64, &'static str)>,
    notes: Vec<String>,
    at_end: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Time {
    Stamp,
    Log,
    Publish,
}

impl McapReader {
    pub fn open(path: &Path, file: &str, wanted: &Wanted<'_>) -> Result<Self, RecordingError> {
        let paths = files_of(path, file)?;
        let topics = topics_of(&paths)?;
        let topic = chosen(file, &topics, wanted.topic)?.clone();
        let (mut signals, mut times) = (Vec::new(), Vec::new());
        for (slot, column) in wanted.columns.iter().enumerate() {
            match signal(column, slot, &topic).map_err(|message| error(file, message))? {
                Ok(signal) => signals.push(signal),
                Err(time) => times.push((time, slot)),
            }
        }
        let mut paths = VecDeque::from(paths);
        let Some(first) = paths.pop_front() else { return Err(error(file, "there is no file in it".into())) };
        let records = Records::open(&first).map_err(|e| RecordingError::io(&first, &e))?;
        Ok(Self {
            file: file.into(),
            topic,
            paths,
            records,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            decoder: Decoder::new(signals),
            times,
            merge: Merge::new(wanted.columns.len()),
            first: None,
            messages: 0,
            faulty: 0,
            fault: None,
            notes: Vec::new(),
            at_end: false,
        })
    }

    /// Hands out rows that lack signals too.
    pub fn partial(mut self) -> Self {
        self.merge.partial = true;
        self
    }

    fn io(&self, error: &io::Error) -> RecordingError {
        RecordingError::File { file: self.file.clone(), message: error.to_string() }
    }

    /// Takes one record. False at the end of the log.
    fn step(&mut self, rows: &mut Rows) -> Result<bool, RecordingError> {
        let Some(found) = self.records.next().map_err(|e| self.io(&e))? else {
            return self.next_file();
        };
        match found.op {
            op::MESSAGE => self.message(&found, rows)?,
            _ => self.describe(&found),
        }
        Ok(true)
    }

    /// Takes a schema or a channel.
    fn describe(&mut self, found: &Found) {
        let body = self.records.body(found);
        if found.op == op::SCHEMA {
            self.schemas.extend(schema(body));
        } else if let Some(channel) = Channel::read(body)
            && channel.topic == self.topic.name
            && let Some(kind) = self.schemas.get(&channel.schema).and_then(|name| Kind::of(name))
        {
            self.channels.insert(channel.id, kind);
        }
    }

    /// Goes on with the next file. False where there is none.
    fn next_file(&mut self) -> Result<bool, RecordingError> {
        self.notes.extend(self.records.notes.drain(..).map(|note| format!("{}: {note}", self.file)));
        let Some(path) = self.paths.pop_front() else { return Ok(false) };
        self.records = Records::open(&path).map_err(|e| RecordingError::io(&path, &e))?;
        self.schemas.clear();
        self.channels.clear();
        Ok(true)
    }

    fn message(&mut self, found: &Found, rows: &mut Rows) -> Result<(), RecordingError> {
        let mut fields = Fields(self.records.body(found));
        let Some(&kind) = fields.u16().and_then(|id| self.channels.get(&id)) else { return Ok(()) };
        let (Some(_sequence), Some(log), Some(publish)) = (fields.u32(), fields.u64(), fields.u64()) else {
            return Ok(());
        };
        self.messages += 1;
        self.merge.begin();
        let merge = &mut self.merge;
        let stamp = match self.decoder.read(kind, fields.0, &mut |slot, value| merge.put(slot, value)) {
            Ok(stamp) => stamp,
            Err(why) => {
                self.faulty += 1;
                self.fault.get_or_insert((self.messages, why));
                return Ok(());
            }
        };
        let now = [stamp, log as i64, publish as i64];
        let first = *self.first.get_or_insert(now);
        let seconds = |time: Time| now[time as usize].wrapping_sub(first[time as usize]) as f64 * 1e-9;
        let mut times = [(0, 0.0); 3];
        let count = self.times.len().min(3);
        for (place, &(time, slot)) in times.iter_mut().zip(&self.times) {
            *place = (slot, seconds(time));
        }
        // Without stamps, messages of one instant of the log belong together.
        let key = if stamp == 0 { now[1] } else { stamp };
        self.merge.end(key, self.messages, &times[..count], rows);
        if self.messages == GIVEN_UP && self.merge.complete == 0 {
            return Err(self.nothing());
        }
        self.no_stamps(stamp)
    }

    /// A driver that does not fill in the stamp is told with what helps.
    fn no_stamps(&self, stamp: i64) -> Result<(), RecordingError> {
        if stamp != 0
            || self.merge.partial
            || self.merge.complete != 2
            || !self.times.iter().any(|(time, _)| *time == Time::Stamp)
        {
            return Ok(());
        }
        Err(error(
            &self.file,
            format!(
                "the header stamps of {} are 0; the time at which messages were received is `time: {{column: log_time}}`",
                self.topic.name
            ),
        ))
    }

    /// Why no row is complete.
    fn nothing(&self) -> RecordingError {
        let topic = &self.topic.name;
        if let (Some((number, why)), true) = (self.fault, self.faulty == self.messages) {
            return error(
                &self.file,
                format!("no message of {topic} can be decoded: {why} (message {number})"),
            );
        }
        let seen = || self.decoder.seen.iter().map(String::as_str);
        let lacks = |signal: &&Signal| self.merge.seen[signal.slot] == 0;
        let Some(signal) = self.decoder.slots().find(lacks) else {
            return error(
                &self.file,
                format!(
                    "no message of {topic} has all signals, and those that lack some have no stamps in common: {}",
                    "its publishers do not tell of the same instants"
                ),
            );
        };
        let Signal { joint, field, .. } = signal;
        if self.decoder.seen.contains(joint) {
            return error(
                &self.file,
                format!(
                    "`{joint}.{field}` is in none of {} messages of {topic} (the list is empty, or not a number); it may be \
                     in another topic or another file",
                    self.messages
                ),
            );
        }
        error(
            &self.file,
            format!(
                "there is no joint `{joint}` in {topic}{}; there are: {}",
                meant(joint, seen()),
                listed(seen())
            ),
        )
    }

    fn finish(&mut self) -> Result<(), RecordingError> {
        self.at_end = true;
        self.merge.finish();
        if self.merge.complete == 0 && self.messages > 0 {
            return Err(self.nothing());
        }
        let Merge { complete, incomplete, .. } = self.merge;
        if incomplete > 0 {
            self.notes.push(format!(
                "{}: {incomplete} messages of {} lack a signal and were passed over; {complete} have all",
                self.file, self.topic.name
            ));
        }
        if let Some((number, why)) = self.fault {
            self.notes.push(format!(
                "{}: {} messages of {} cannot be decoded; message {number}: {why}",
                self.file, self.faulty, self.topic.name
            ));
        }
        Ok(())
    }
}

impl Format for McapReader {
    fn file(&self) -> &str {
        &self.file
    }

    fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        let (before, most) = (rows.len(), rows.len().saturating_add(most));
        while rows.len() < most && !self.at_end {
            if !self.step(rows)? {
                self.finish()?;
            }
        }
        Ok(rows.len() - before)
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

fn error(file: &str, message: String) -> RecordingError {
    RecordingError::File { file: file.into(), message }
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

/// Messages of a log by which its joints are told.
const SURVEYED: u64 = 2000;

/// The topics of a log, and the joints of the one that is named, else of the one with most messages of those that tell of
/// joints.
pub(in crate::recording) fn survey(
    path: &Path,
    file: &str,
    topic: Option<&str>,
) -> Result<Survey, RecordingError> {
    let paths = files_of(path, file)?;
    let topics = topics_of(&paths)?;
    let fits = |t: &&Topic| Kind::of(&t.kind).is_some() && t.encoding == "cdr" && t.count > 0;
    let found: Vec<&Topic> = topics.iter().filter(fits).collect();
    let mut survey =
        Survey { topics: topics.clone(), topic: None, signals: vec![], stamped: false, notes: vec![] };
    let topic = match (topic, &found[..]) {
        (None, []) => {
            survey.notes.push("no topic holds JointState in CDR".into());
            return Ok(survey);
        }
        (None, several) => {
            let one_kind = |kind| several.iter().filter(move |t| Kind::of(&t.kind) == Some(kind));
            let most = one_kind(Kind::JointState).chain(one_kind(Kind::DynamicJointState)).copied();
            // The first of equals: a JointState goes before a DynamicJointState.
            let best = most.reduce(|a, b| if b.count > a.count { b } else { a });
            if several.len() > 1 {
                let names: Vec<&str> = several.iter().map(|t| t.name.as_str()).collect();
                survey
                    .notes
                    .push(format!("several topics tell of joints: {}; see --topic", names.join(", ")));
            }
            best.ok_or_else(|| error(file, "no topic tells of joints".into()))?
        }
        (name, _) => chosen(file, &topics, name)?,
    };
    survey.topic = Some(topic.name.clone());
    let wanted = Wanted { columns: &[], layout: &Default::default(), topic: Some(&topic.name) };
    let mut reader = McapReader::open(path, file, &wanted)?;
    let mut signals = Vec::new();
    while reader.messages < SURVEYED
        && let Some(stamp) = reader.next_signals(&mut signals)?
    {
        survey.stamped |= stamp != 0;
    }
    survey.signals = signals;
    Ok(survey)
}

impl McapReader {
    /// The stamp of the next message that can be decoded; signals that are new in it are added to `signals`.
    fn next_signals(&mut self, signals: &mut Vec<String>) -> Result<Option<i64>, RecordingError> {
        loop {
            let before = self.messages;
            let Some(found) = self.records.next().map_err(|e| self.io(&e))? else {
                if self.next_file()? {
                    continue;
                }
                return Ok(None);
            };
            if found.op != op::MESSAGE {
                self.describe(&found);
                continue;
            }
            let mut fields = Fields(self.records.body(&found));
            let kind = fields.u16().and_then(|id| self.channels.get(&id)).copied();
            if let (Some(kind), Some(_)) = (kind, fields.take(4 + 8 + 8)) {
                self.messages = before + 1;
                if let Ok(stamp) = message::signals(kind, fields.0, signals) {
                    return Ok(Some(stamp));
                }
            }
        }
    }
}

/// The topic that is meant: the one that is named, or the only one that tells of joints.
fn chosen<'a>(file: &str, topics: &'a [Topic], name: Option<&str>) -> Result<&'a Topic, RecordingError> {
    let told = |topic: &Topic| format!("{} ({}, {} messages)", topic.name, topic.kind, topic.count);
    let all = || topics.iter().take(60).map(told).collect::<Vec<_>>().join(", ");
    let fits = |topic: &&Topic| Kind::of(&topic.kind).is_some() && topic.encoding == "cdr";
    if let Some(name) = name {
        let Some(topic) = topics.iter().filter(|t| t.name == name).max_by_key(|t| fits(t)) else {
            let meant = meant(name, topics.iter().map(|t| t.name.as_str()));
            return Err(error(file, format!("there is no topic `{name}`{meant}; there are: {}", all())));
        };
        if !fits(&topic) {
            let message = format!(
                "topic {} holds {} in the encoding `{}`; JointState and DynamicJointState in CDR are read. There are: {}",
                topic.name,
                topic.kind,
                topic.encoding,
                all()
            );
            return Err(error(file, message));
        }
        return Ok(topic);
    }
    // A JointState goes before a DynamicJointState of the same joints.
    let of = |kind: Kind| {
        topics.iter().filter(fits).filter(move |t| t.count > 0 && Kind::of(&t.kind) == Some(kind))
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

/// What a wanted column is of a message: a signal of a joint, or else a time.
fn signal(column: &Column, slot: usize, topic: &Topic) -> Result<Result<Signal, Time>, String> {
    let name = match column {
        Column::Name(name) => name,
        Column::Index(index) => {
            return Err(format!("column {index} is asked for; signals of a log are called `joint.position`"));
        }
    };
    match name.as_str() {
        "header.stamp" => return Ok(Err(Time::Stamp)),
        "log_time" => return Ok(Err(Time::Log)),
        "publish_time" => return Ok(Err(Time::Publish)),
        _ => {}
    }
    let Some((joint, field)) = name.rsplit_once('.') else {
        return Err(format!(
            "column `{name}` is asked for; signals of a log are called `joint.position`, `joint.velocity`, \
             `joint.effort`, times `header.stamp` and `log_time`"
        ));
    };
    if Kind::of(&topic.kind) == Some(Kind::JointState) && !FIELDS.contains(&field) {
        return Err(format!("`{name}`: a JointState has {} of each joint", FIELDS.join(", ")));
    }
    Ok(Ok(Signal { joint: joint.into(), field: field.into(), slot }))
}
