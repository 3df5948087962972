//! The messages of one topic, over all files of a log.

use std::collections::{HashMap, VecDeque};
use std::path::PathBuf;

use super::container::{Found, Records, op};
use super::definition::Definition;
use super::fields::Fields;
use super::message::Kind;
use super::topics::{Channel, Schema};
use super::{error, says};
use crate::recording::RecordingError;
use crate::recording::topic::Topic;

/// The messages of one topic.
pub(super) struct Log {
    pub file: String,
    pub topic: Topic,
    /// Whether messages are read by the definitions of their types.
    by_definition: bool,
    /// Files that are still to be read, and the one that is read.
    paths: VecDeque<PathBuf>,
    records: Records,
    /// Of the file that is read: its schemas, and types of the channels of the topic.
    schemas: HashMap<u16, Schema>,
    channels: HashMap<u16, Kind>,
    /// Definitions of messages that were met.
    pub definitions: Vec<Definition>,
    /// Messages of the topic so far.
    pub messages: u64,
    pub notes: Vec<String>,
}

/// A message that was found: its type, when it was received and published, ns, and where its bytes are.
pub(super) struct Received {
    pub kind: Kind,
    pub log: i64,
    pub publish: i64,
    found: Found,
}

/// Bytes of a message before its data: channel, sequence, two times.
const HEAD: usize = 2 + 4 + 8 + 8;

impl Log {
    pub fn open(
        file: &str,
        topic: Topic,
        paths: Vec<PathBuf>,
        by_definition: bool,
    ) -> Result<Self, RecordingError> {
        let mut paths = VecDeque::from(paths);
        let Some(first) = paths.pop_front() else { return Err(error(file, "there is no file in it".into())) };
        let records = Records::open(&first).map_err(|e| RecordingError::io(&first, &e))?;
        Ok(Self {
            file: file.into(),
            topic,
            by_definition,
            paths,
            records,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            definitions: Vec::new(),
            messages: 0,
            notes: Vec::new(),
        })
    }

    /// The next message of the topic; `None` at the end of the last file.
    pub fn next(&mut self) -> Result<Option<Received>, RecordingError> {
        loop {
            let Some(found) = self.records.next().map_err(|e| says(&self.file, &e))? else {
                if self.next_file()? {
                    continue;
                }
                return Ok(None);
            };
            if found.op != op::MESSAGE {
                self.describe(&found)?;
                continue;
            }
            let mut fields = Fields(self.records.body(&found));
            let Some(&kind) = fields.u16().and_then(|id| self.channels.get(&id)) else { continue };
            let (Some(_sequence), Some(log), Some(publish)) = (fields.u32(), fields.u64(), fields.u64())
            else {
                continue;
            };
            self.messages += 1;
            return Ok(Some(Received { kind, log: log as i64, publish: publish as i64, found }));
        }
    }

    /// The bytes of the message that was received last.
    pub fn data(&self, received: &Received) -> &[u8] {
        self.records.body(&received.found).get(HEAD..).unwrap_or_default()
    }

    /// Takes a schema or a channel.
    fn describe(&mut self, found: &Found) -> Result<(), RecordingError> {
        let body = self.records.body(found);
        if found.op == op::SCHEMA {
            self.schemas.extend(Schema::read(body, self.by_definition));
            return Ok(());
        }
        let Some(channel) = Channel::read(body).filter(|channel| channel.topic == self.topic.name) else {
            return Ok(());
        };
        let Some(schema) = self.schemas.get(&channel.schema) else { return Ok(()) };
        let kind = if self.by_definition {
            let definition = schema.definition().map_err(|why| {
                error(&self.file, format!("topic {}: {} cannot be read: {why}", channel.topic, schema.name))
            })?;
            let known = self.definitions.iter().position(|known| *known == definition);
            Some(Kind::Defined(known.unwrap_or_else(|| {
                self.definitions.push(definition);
                self.definitions.len() - 1
            })))
        } else {
            Kind::of(&schema.name)
        };
        self.channels.extend(kind.map(|kind| (channel.id, kind)));
        Ok(())
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
}
