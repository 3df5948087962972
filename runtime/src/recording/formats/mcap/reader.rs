//! Rows of one topic: signals of its messages, put together by their stamps.

use std::path::Path;

use super::decoder::{Decoder, Lacking};
use super::log::{Log, Received};
use super::merge::Merge;
use super::message::{FIELDS, Kind};
use super::{bag, chosen, error, topics_of};
use crate::recording::format::Format;
use crate::recording::formats::Wanted;
use crate::recording::topic::Topic;
use crate::recording::{Column, RecordingError, Rows};

/// Messages after which a signal that no message had is given up, if no row is complete yet.
const GIVEN_UP: u64 = 5000;

/// Reads the joints of one topic.
pub(in crate::recording) struct McapReader {
    log: Log,
    decoder: Decoder,
    /// Columns of times.
    times: Vec<(Time, usize)>,
    merge: Merge,
    /// The first times that were used, ns.
    first: Option<[i64; 3]>,
    /// Messages that could not be decoded, with the first of them and the reason.
    faulty: u64,
    fault: Option<(u64, &'static str)>,
    notes: Vec<String>,
    at_end: bool,
}

/// A time of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Time {
    Stamp,
    Log,
    Publish,
}

/// The time that a column is called; `None` for a signal.
fn time_called(name: &str) -> Option<Time> {
    match name {
        "header.stamp" => Some(Time::Stamp),
        "log_time" => Some(Time::Log),
        "publish_time" => Some(Time::Publish),
        _ => None,
    }
}

impl McapReader {
    pub fn open(path: &Path, file: &str, wanted: &Wanted<'_>) -> Result<Self, RecordingError> {
        let paths = bag::files_of(path, file)?;
        let topics = topics_of(&paths)?;
        let topic = chosen(file, &topics, wanted.topic, by_fields(wanted.columns))?.clone();
        let (mut signals, mut times) = (Vec::new(), Vec::new());
        for (slot, column) in wanted.columns.iter().enumerate() {
            let name = named(column).map_err(|message| error(file, message))?;
            match time_called(name) {
                Some(time) => times.push((time, slot)),
                None => signals.push((name, slot)),
            }
        }
        let decoder = Decoder::new(&topic, &signals, wanted.names).map_err(|message| error(file, message))?;
        Ok(Self {
            log: Log::open(file, topic, paths, decoder.is_by_definition())?,
            decoder,
            times,
            merge: Merge::new(wanted.columns.len(), wanted.partial),
            first: None,
            faulty: 0,
            fault: None,
            notes: Vec::new(),
            at_end: false,
        })
    }

    fn topic(&self) -> &Topic {
        &self.log.topic
    }

    fn error(&self, message: String) -> RecordingError {
        error(&self.log.file, message)
    }

    fn take(&mut self, received: &Received, rows: &mut Rows) -> Result<(), RecordingError> {
        if let Kind::Defined(k) = received.kind {
            let (log, decoder) = (&self.log, &mut self.decoder);
            decoder.define(k, &log.definitions).map_err(|why| {
                error(&log.file, format!("topic {} ({}): {why}", log.topic.name, log.topic.kind))
            })?;
        }
        self.merge.begin();
        let (merge, data) = (&mut self.merge, self.log.data(received));
        let stamp = match self.decoder.read(received.kind, data, &mut |slot, value| merge.put(slot, value)) {
            Ok(stamp) => stamp,
            Err(why) => {
                self.faulty += 1;
                self.fault.get_or_insert((self.log.messages, why));
                return Ok(());
            }
        };
        let now = [stamp, received.log, received.publish];
        let first = *self.first.get_or_insert(now);
        let seconds = |time: Time| now[time as usize].wrapping_sub(first[time as usize]) as f64 * 1e-9;
        let mut times = [(0, 0.0); 3];
        let count = self.times.len().min(3);
        for (place, &(time, slot)) in times.iter_mut().zip(&self.times) {
            *place = (slot, seconds(time));
        }
        // Without stamps, messages of one instant of the log belong together.
        let key = if stamp == 0 { now[1] } else { stamp };
        self.merge.end(key, self.log.messages, &times[..count], rows);
        if self.log.messages == GIVEN_UP && self.merge.complete == 0 {
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
        Err(self.error(format!(
            "the header stamps of {} are 0; the time at which messages were received is `time: {{column: log_time}}`",
            self.topic().name
        )))
    }

    /// Why no row is complete.
    fn nothing(&self) -> RecordingError {
        let topic = &self.topic().name;
        if let (Some((number, why)), true) = (self.fault, self.faulty == self.log.messages) {
            return self.error(format!("no message of {topic} can be decoded: {why} (message {number})"));
        }
        let lacks = |slot: usize| self.merge.seen[slot] == 0;
        match self.decoder.lacking(lacks) {
            None => self.error(format!(
                "no message of {topic} has all signals, and those that lack some have no stamps in common: {}",
                "its publishers do not tell of the same instants"
            )),
            Some(Lacking::Signal(name)) => self.error(format!(
                "`{name}` is in none of {} messages of {topic} (the list is empty, or not a number); it may be \
                 in another topic or another file",
                self.log.messages
            )),
            Some(Lacking::Joint { joint, meant, there }) => {
                self.error(format!("there is no joint `{joint}` in {topic}{meant}; there are: {there}"))
            }
        }
    }

    fn finish(&mut self) -> Result<(), RecordingError> {
        self.at_end = true;
        self.notes.append(&mut self.log.notes);
        self.merge.finish();
        if self.merge.complete == 0 && self.log.messages > 0 {
            return Err(self.nothing());
        }
        let (file, topic) = (&self.log.file, &self.log.topic.name);
        let Merge { complete, incomplete, .. } = self.merge;
        if incomplete > 0 {
            self.notes.push(format!(
                "{file}: {incomplete} messages of {topic} lack a signal and were passed over; {complete} have all"
            ));
        }
        if let Some((number, why)) = self.fault {
            self.notes.push(format!(
                "{file}: {} messages of {topic} cannot be decoded; message {number}: {why}",
                self.faulty
            ));
        }
        Ok(())
    }
}

impl Format for McapReader {
    fn file(&self) -> &str {
        &self.log.file
    }

    fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        let (before, most) = (rows.len(), rows.len().saturating_add(most));
        while rows.len() < most && !self.at_end {
            match self.log.next()? {
                Some(received) => self.take(&received, rows)?,
                None => self.finish()?,
            }
        }
        Ok(rows.len() - before)
    }

    fn notes(&self) -> Vec<String> {
        self.notes.iter().chain(&self.log.notes).cloned().collect()
    }
}

/// Whether columns are wanted that no message that tells of joints has.
fn by_fields(columns: &[Column]) -> bool {
    let of_joint = |name: &str| name.rsplit_once('.').is_some_and(|(_, field)| FIELDS.contains(&field));
    columns
        .iter()
        .any(|column| matches!(column, Column::Name(name) if time_called(name).is_none() && !of_joint(name)))
}

/// What a wanted column is called.
fn named(column: &Column) -> Result<&str, String> {
    match column {
        Column::Name(name) => Ok(name),
        Column::Index(index) => {
            Err(format!("column {index} is asked for; signals of a log are called `joint.position`"))
        }
    }
}
