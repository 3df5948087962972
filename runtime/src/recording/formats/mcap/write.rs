//! Signals of joints as an MCAP file: a topic each, `sensor_msgs/msg/JointState` or an own message for accelerations.

use std::io::{self, Write};

use super::container::{MAGIC, op};
use crate::recording::{JointFields, JointLog};

const HEADER: u8 = 1;
const SUMMARY_OFFSETS: u64 = 0;
/// Stamps begin here, s: a stamp of 0 means that there is none.
const EPOCH: u64 = 1_000_000_000;

/// Numbers of the two types.
const STATES: u16 = 1;
const ACCELERATIONS: u16 = 2;

const JOINT_STATE: &str = "float64[] position\nfloat64[] velocity\nfloat64[] effort\n";
const HEADER_TYPES: &str = "================================================================================\n\
    MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// The file, with the number of bytes written so far.
struct Out<'a> {
    out: &'a mut dyn Write,
    at: u64,
}

impl Out<'_> {
    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.at += bytes.len() as u64;
        self.out.write_all(bytes)
    }

    fn record(&mut self, op: u8, body: &[u8]) -> io::Result<()> {
        self.bytes(&[op])?;
        self.bytes(&(body.len() as u64).to_le_bytes())?;
        self.bytes(body)
    }
}

fn text(body: &mut Vec<u8>, text: &str) {
    body.extend((text.len() as u32).to_le_bytes());
    body.extend(text.bytes());
}

/// Writes topics, their messages in the order of time; `joints` are the names of the joints. Stamps are rounded to
/// nanoseconds.
pub(in crate::recording) fn write(
    logs: &[JointLog<'_>],
    joints: &[String],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut out = Out { out, at: 0 };
    out.bytes(MAGIC)?;
    let mut header = Vec::new();
    text(&mut header, "ros2");
    text(&mut header, "dynid");
    out.record(HEADER, &header)?;
    describe(&mut out, logs)?;
    let mut messages: Vec<(u64, usize, usize)> = Vec::new();
    for (channel, log) in logs.iter().enumerate() {
        messages.extend(log.time.iter().enumerate().map(|(k, t)| (stamp(*t), channel, k)));
    }
    messages.sort_by_key(|message| message.0);
    let mut body = Vec::new();
    for &(stamp, channel, k) in &messages {
        message(&mut body, (channel as u16 + 1, &logs[channel].fields), joints, (k, stamp));
        out.record(op::MESSAGE, &body)?;
    }
    // Without a checksum of the data.
    out.record(op::DATA_END, &[0; 4])?;
    let summary = out.at;
    describe(&mut out, logs)?;
    out.record(op::STATISTICS, &statistics(logs, &messages))?;
    let mut footer = Vec::new();
    footer.extend(summary.to_le_bytes());
    footer.extend(SUMMARY_OFFSETS.to_le_bytes());
    footer.extend([0; 4]);
    out.record(op::FOOTER, &footer)?;
    out.bytes(MAGIC)
}

/// Writes the types that occur and the topics.
fn describe(out: &mut Out<'_>, logs: &[JointLog<'_>]) -> io::Result<()> {
    for kind in kinds(logs) {
        let (name, of_type) = match kind {
            STATES => ("sensor_msgs/msg/JointState", JOINT_STATE),
            _ => ("dynid_msgs/msg/JointAcceleration", "float64[] acceleration\n"),
        };
        let mut body = kind.to_le_bytes().to_vec();
        text(&mut body, name);
        text(&mut body, "ros2msg");
        text(&mut body, &format!("std_msgs/Header header\nstring[] name\n{of_type}{HEADER_TYPES}"));
        out.record(op::SCHEMA, &body)?;
    }
    for (channel, log) in logs.iter().enumerate() {
        let mut body = [(channel as u16 + 1).to_le_bytes(), kind(&log.fields).to_le_bytes()].concat();
        text(&mut body, &log.topic);
        text(&mut body, "cdr");
        // No metadata.
        body.extend([0; 4]);
        out.record(op::CHANNEL, &body)?;
    }
    Ok(())
}

/// The number of the type of some signals.
fn kind(fields: &JointFields<'_>) -> u16 {
    match fields {
        JointFields::States(_) => STATES,
        JointFields::Accelerations(_) => ACCELERATIONS,
    }
}

/// The types that occur.
fn kinds(logs: &[JointLog<'_>]) -> Vec<u16> {
    let used = |wanted: &u16| logs.iter().any(|log| kind(&log.fields) == *wanted);
    [STATES, ACCELERATIONS].into_iter().filter(used).collect()
}

/// Nanoseconds of a time in s.
fn stamp(time: f64) -> u64 {
    EPOCH * 1_000_000_000 + (time.max(0.0) * 1e9).round() as u64
}

fn statistics(logs: &[JointLog<'_>], messages: &[(u64, usize, usize)]) -> Vec<u8> {
    let mut body = (messages.len() as u64).to_le_bytes().to_vec();
    body.extend((kinds(logs).len() as u16).to_le_bytes());
    // Channels, attachments, metadata, chunks.
    [logs.len() as u32, 0, 0, 0].iter().for_each(|number| body.extend(number.to_le_bytes()));
    let [first, last] = [messages.first(), messages.last()].map(|m| m.map_or(stamp(0.0), |m| m.0));
    body.extend(first.to_le_bytes());
    body.extend(last.to_le_bytes());
    body.extend((10 * logs.len() as u32).to_le_bytes());
    for (channel, log) in logs.iter().enumerate() {
        body.extend((channel as u16 + 1).to_le_bytes());
        body.extend((log.time.len() as u64).to_le_bytes());
    }
    body
}

/// The body of the record of message `k` of a channel.
fn message(
    body: &mut Vec<u8>,
    (channel, fields): (u16, &JointFields<'_>),
    joints: &[String],
    (k, stamp): (usize, u64),
) {
    body.clear();
    body.extend(channel.to_le_bytes());
    body.extend((k as u32).to_le_bytes());
    body.extend(stamp.to_le_bytes());
    body.extend(stamp.to_le_bytes());
    body.extend([0, 1, 0, 0]);
    let start = body.len();
    let align =
        |body: &mut Vec<u8>, to: usize| body.resize(start + (body.len() - start).next_multiple_of(to), 0);
    let string = |body: &mut Vec<u8>, text: &str| {
        align(body, 4);
        body.extend((text.len() as u32 + 1).to_le_bytes());
        body.extend(text.bytes());
        body.push(0);
    };
    body.extend(((stamp / 1_000_000_000) as u32).to_le_bytes());
    body.extend(((stamp % 1_000_000_000) as u32).to_le_bytes());
    string(body, "");
    align(body, 4);
    body.extend((joints.len() as u32).to_le_bytes());
    joints.iter().for_each(|joint| string(body, joint));
    let lists: &[&[Vec<f64>]] = match fields {
        JointFields::States(lists) => lists,
        JointFields::Accelerations(list) => &[list],
    };
    for channel in lists {
        align(body, 4);
        body.extend((channel.len() as u32).to_le_bytes());
        if !channel.is_empty() {
            align(body, 8);
            channel.iter().for_each(|values| body.extend(values[k].to_le_bytes()));
        }
    }
}
