//! The topics of a log.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;

use super::container::{Found, Records, op};
use super::definition::Definition;
use super::fields::Fields;
use crate::recording::topic::Topic;

/// A channel as its record says it.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    pub id: u16,
    pub schema: u16,
    pub topic: String,
    pub encoding: String,
}

impl Channel {
    pub fn read(body: &[u8]) -> Option<Self> {
        let mut fields = Fields(body);
        Some(Self {
            id: fields.u16()?,
            schema: fields.u16()?,
            topic: fields.text()?,
            encoding: fields.text()?,
        })
    }
}

/// A schema as its record says it.
#[derive(Debug, Clone)]
pub(super) struct Schema {
    pub name: String,
    /// How the definition is written: `ros2msg` of most ROS 2 packages.
    encoding: String,
    /// The definition; empty where it is not needed.
    text: Vec<u8>,
}

impl Schema {
    /// The schema of a record with its number; its definition only where it is wanted.
    pub fn read(body: &[u8], definition: bool) -> Option<(u16, Self)> {
        let mut fields = Fields(body);
        let (id, name) = (fields.u16()?, fields.text()?);
        let encoding = fields.text().unwrap_or_default();
        let length = fields.u32().unwrap_or(0) as usize;
        let text = if definition { fields.take(length).unwrap_or_default().to_vec() } else { Vec::new() };
        Some((id, Self { name, encoding, text }))
    }

    /// What messages of it hold.
    ///
    /// # Errors
    /// Why that cannot be said.
    pub fn definition(&self) -> Result<Definition, String> {
        if self.encoding != "ros2msg" {
            return Err(format!(
                "its definition is written in `{}`; that of ROS 2 messages, `ros2msg`, is read",
                self.encoding
            ));
        }
        let text = std::str::from_utf8(&self.text).map_err(|_| "its definition is no text".to_owned())?;
        Definition::parse(&self.name, text)
    }
}

/// What is known of a file's channels.
#[derive(Default)]
struct Channels {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    counts: BTreeMap<u16, u64>,
}

impl Channels {
    fn take(&mut self, op: u8, body: &[u8]) {
        match op {
            op::SCHEMA => {
                self.schemas.extend(Schema::read(body, false).map(|(id, schema)| (id, schema.name)));
            }
            op::CHANNEL => self.channels.extend(Channel::read(body).map(|channel| (channel.id, channel))),
            op::MESSAGE => {
                if let Some(id) = Fields(body).u16() {
                    *self.counts.entry(id).or_default() += 1;
                }
            }
            op::STATISTICS => {
                let mut fields = Fields(body);
                // Numbers of messages, schemas, channels and so on, times, and the length of the map.
                fields.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8 + 4);
                while let (Some(id), Some(count)) = (fields.u16(), fields.u64()) {
                    self.counts.insert(id, count);
                }
            }
            _ => {}
        }
    }
}

/// The topics of the files of a log, by name. Files with a summary are not read to their end.
pub(super) fn topics(files: &[PathBuf]) -> io::Result<Vec<Topic>> {
    let mut all: BTreeMap<(String, String, String), u64> = BTreeMap::new();
    for path in files {
        let mut found = Channels::default();
        let summary = Records::summary(path, |op, body| found.take(op, body))?;
        if !summary || found.channels.is_empty() || found.counts.is_empty() {
            found = Channels::default();
            let mut records = Records::open(path)?;
            while let Some(record) = records.next()? {
                let Found { op, .. } = record;
                found.take(op, records.body(&record));
            }
        }
        for channel in found.channels.values() {
            let kind = found.schemas.get(&channel.schema).cloned().unwrap_or_default();
            let key = (channel.topic.clone(), kind, channel.encoding.clone());
            *all.entry(key).or_default() += found.counts.get(&channel.id).copied().unwrap_or(0);
        }
    }
    Ok(all.into_iter().map(|((name, kind, encoding), count)| Topic { name, kind, encoding, count }).collect())
}
