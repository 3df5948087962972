//! A motion as an MCAP file with `sensor_msgs/msg/JointState` on `/joint_states`.

use std::io::{self, Write};

use super::container::{MAGIC, op};
use crate::recording::Trajectory;

const HEADER: u8 = 1;
const SUMMARY_OFFSETS: u64 = 0;
/// Stamps begin here, s: a stamp of 0 means that there is none.
const EPOCH: u64 = 1_000_000_000;

const JOINT_STATE: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
    ================================================================================\n\
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

/// Writes the rows of a motion; `joints` are the names of its joints. Stamps are rounded to nanoseconds.
pub(in crate::recording) fn write(
    motion: &Trajectory,
    joints: &[String],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut out = Out { out, at: 0 };
    out.bytes(MAGIC)?;
    let mut header = Vec::new();
    text(&mut header, "ros2");
    text(&mut header, "dynid");
    out.record(HEADER, &header)?;
    let (schema, channel) = (schema(), channel());
    out.record(op::SCHEMA, &schema)?;
    out.record(op::CHANNEL, &channel)?;
    let mut body = Vec::new();
    for (k, t) in motion.time.iter().enumerate() {
        message(&mut body, motion, joints, (k, stamp(*t)));
        out.record(op::MESSAGE, &body)?;
    }
    // Without a checksum of the data.
    out.record(op::DATA_END, &[0; 4])?;
    let summary = out.at;
    out.record(op::SCHEMA, &schema)?;
    out.record(op::CHANNEL, &channel)?;
    out.record(op::STATISTICS, &statistics(motion))?;
    let mut footer = Vec::new();
    footer.extend(summary.to_le_bytes());
    footer.extend(SUMMARY_OFFSETS.to_le_bytes());
    footer.extend([0; 4]);
    out.record(op::FOOTER, &footer)?;
    out.bytes(MAGIC)
}

/// Nanoseconds of a time in s.
fn stamp(time: f64) -> u64 {
    EPOCH * 1_000_000_000 + (time.max(0.0) * 1e9).round() as u64
}

fn schema() -> Vec<u8> {
    let mut body = 1_u16.to_le_bytes().to_vec();
    text(&mut body, "sensor_msgs/msg/JointState");
    text(&mut body, "ros2msg");
    text(&mut body, JOINT_STATE);
    body
}

fn channel() -> Vec<u8> {
    let mut body = [1_u16.to_le_bytes(), 1_u16.to_le_bytes()].concat();
    text(&mut body, "/joint_states");
    text(&mut body, "cdr");
    // No metadata.
    body.extend([0; 4]);
    body
}

fn statistics(motion: &Trajectory) -> Vec<u8> {
    let count = motion.time.len() as u64;
    let mut body = count.to_le_bytes().to_vec();
    body.extend(1_u16.to_le_bytes());
    // Channels, attachments, metadata, chunks.
    [1_u32, 0, 0, 0].iter().for_each(|number| body.extend(number.to_le_bytes()));
    let [first, last] = [motion.time.first(), motion.time.last()].map(|t| stamp(t.copied().unwrap_or(0.0)));
    body.extend(first.to_le_bytes());
    body.extend(last.to_le_bytes());
    body.extend(10_u32.to_le_bytes());
    body.extend(1_u16.to_le_bytes());
    body.extend(count.to_le_bytes());
    body
}

/// The body of the record of row `k`.
fn message(body: &mut Vec<u8>, motion: &Trajectory, joints: &[String], (k, stamp): (usize, u64)) {
    body.clear();
    body.extend(1_u16.to_le_bytes());
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
    let none = Vec::new();
    for channel in [&motion.position, motion.velocity.as_ref().unwrap_or(&none), &motion.torque] {
        align(body, 4);
        body.extend((channel.len() as u32).to_le_bytes());
        if !channel.is_empty() {
            align(body, 8);
            channel.iter().for_each(|values| body.extend(values[k].to_le_bytes()));
        }
    }
}
