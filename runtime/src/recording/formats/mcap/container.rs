//! The container of MCAP (<https://mcap.dev/spec>): records of an opcode, a length and a body; some of them are chunks,
//! which hold records.
//!
//! Files are read from the beginning on, with or without an index. Of a file that was cut off or damaged, what is whole is
//! handed out and the rest is told. One chunk is in memory at a time, after its checksum was found right.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use super::chunk::{ChunkHeader, LONGEST_CHUNK, unpack};
use crate::regular_file;

pub(super) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Kinds of records.
pub(super) mod op {
    pub const FOOTER: u8 = 2;
    pub const SCHEMA: u8 = 3;
    pub const CHANNEL: u8 = 4;
    pub const MESSAGE: u8 = 5;
    pub const CHUNK: u8 = 6;
    pub const STATISTICS: u8 = 0x0b;
    pub const DATA_END: u8 = 0x0f;
}

/// Longest record outside of a chunk that is read; a longer one is passed over. Pictures are shorter.
const LONGEST: u64 = 1 << 26;

/// The records of one file.
pub(super) struct Records {
    source: BufReader<File>,
    /// Bytes of the file, and where the next record begins.
    size: u64,
    at: u64,
    /// The body of a record, or a packed chunk.
    record: Vec<u8>,
    /// The records of the chunk that is being read, and where the next of them begins.
    chunk: Vec<u8>,
    inside: usize,
    /// What was passed over.
    pub notes: Vec<String>,
    ended: bool,
}

/// A record that was read: its kind, and where its body is.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub op: u8,
    in_chunk: bool,
    range: Range<usize>,
}

impl Records {
    /// Opens a file.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = regular_file::open(path)?;
        let size = file.metadata()?.len();
        let mut source = BufReader::with_capacity(1 << 18, file);
        let mut magic = [0; 8];
        let read = source.read_exact(&mut magic);
        if read.is_err() || &magic != MAGIC {
            let message = "this is no MCAP file (it does not begin with \\x89MCAP0)";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        let (record, chunk, notes) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { source, size, at: 8, record, chunk, inside: 0, notes, ended: false })
    }

    /// Goes to a place of the file.
    fn go_to(&mut self, at: u64) -> io::Result<()> {
        self.source.seek(SeekFrom::Start(at))?;
        self.at = at;
        self.chunk.clear();
        self.inside = 0;
        Ok(())
    }

    /// The body of a record that was found last.
    pub fn body(&self, found: &Found) -> &[u8] {
        let buffer = if found.in_chunk { &self.chunk } else { &self.record };
        buffer.get(found.range.clone()).unwrap_or_default()
    }

    /// The next schema, channel or message; `None` at the end of the data.
    pub fn next(&mut self) -> io::Result<Option<Found>> {
        loop {
            if let Some(found) = self.next_of_chunk() {
                return Ok(Some(found));
            }
            if self.ended {
                return Ok(None);
            }
            let Some((op, length)) = self.head()? else { continue };
            match op {
                op::FOOTER | op::DATA_END => self.ended = true,
                op::CHUNK => self.take_chunk(length)?,
                op::SCHEMA | op::CHANNEL | op::MESSAGE if length <= LONGEST => {
                    if self.take(length)? {
                        let range = 0..self.record.len();
                        return Ok(Some(Found { op, in_chunk: false, range }));
                    }
                }
                _ => self.pass_over(length)?,
            }
        }
    }

    /// Opcode and length of the next record outside of a chunk; `None` where the file ends before one.
    fn head(&mut self) -> io::Result<Option<(u8, u64)>> {
        let mut head = [0; 9];
        if self.size.saturating_sub(self.at) < 9 {
            self.cut_off("");
            return Ok(None);
        }
        self.source.read_exact(&mut head)?;
        self.at += 9;
        let mut length = [0; 8];
        length.copy_from_slice(&head[1..]);
        Ok(Some((head[0], u64::from_le_bytes(length))))
    }

    fn cut_off(&mut self, what: &str) {
        self.ended = true;
        self.notes.push(format!(
            "the file was cut off or damaged at byte {} of {}{what}: what is whole before it was read",
            self.at, self.size
        ));
    }

    fn left(&self) -> u64 {
        self.size.saturating_sub(self.at)
    }

    /// Reads a body; false where the file ends before it does.
    fn take(&mut self, length: u64) -> io::Result<bool> {
        if length > self.left() {
            self.cut_off("");
            return Ok(false);
        }
        self.record.resize(length as usize, 0);
        self.source.read_exact(&mut self.record)?;
        self.at += length;
        Ok(true)
    }

    fn pass_over(&mut self, length: u64) -> io::Result<()> {
        if length > self.left() {
            self.cut_off("");
            return Ok(());
        }
        // At most the size of a file, which is less.
        self.source.seek_relative(length as i64)?;
        self.at += length;
        Ok(())
    }

    /// Reads and unpacks a chunk. The last one of a file that was cut off is unpacked as far as it goes.
    fn take_chunk(&mut self, length: u64) -> io::Result<()> {
        let begin = self.at;
        let whole = length <= self.left();
        if whole && length > LONGEST_CHUNK {
            self.notes
                .push(format!("the chunk at byte {begin} of {length} bytes is too long and was passed over"));
            return self.pass_over(length);
        }
        let there = length.min(self.left()).min(LONGEST_CHUNK);
        self.record.resize(there as usize, 0);
        self.source.read_exact(&mut self.record)?;
        self.at += there;
        self.inside = 0;
        let unpacked = match ChunkHeader::read(&self.record) {
            Some(header) => unpack(&header, &self.record, &mut self.chunk, whole),
            None => Err("its header is cut off".to_owned()),
        };
        if !whole {
            self.at = begin;
            self.cut_off(" in a chunk");
            // Without its end a chunk has no checksum, but what could be unpacked of it is what was written.
            return Ok(());
        }
        if let Err(why) = unpacked {
            self.chunk.clear();
            self.notes.push(format!("the chunk at byte {begin} was passed over: {why}"));
        }
        Ok(())
    }

    fn next_of_chunk(&mut self) -> Option<Found> {
        loop {
            let rest = self.chunk.get(self.inside..)?;
            let (head, body) = rest.split_at_checked(9)?;
            let length = u64::from_le_bytes(head[1..].try_into().ok()?);
            if length > body.len() as u64 {
                self.inside = self.chunk.len();
                return None;
            }
            let begin = self.inside + 9;
            self.inside = begin + length as usize;
            if matches!(head[0], op::SCHEMA | op::CHANNEL | op::MESSAGE) {
                return Some(Found { op: head[0], in_chunk: true, range: begin..self.inside });
            }
        }
    }

    /// The records of the summary at the end of the file, one by one; nothing where there is none.
    pub fn summary(path: &Path, mut each: impl FnMut(u8, &[u8])) -> io::Result<bool> {
        /// Footer with its head, and the magic behind it.
        const END: u64 = 9 + 20 + 8;
        let mut records = Self::open(path)?;
        if records.size < END + 8 {
            return Ok(false);
        }
        let footer = records.size - END;
        records.go_to(footer)?;
        if records.head()? != Some((op::FOOTER, 20)) || !records.take(20)? {
            return Ok(false);
        }
        let start = u64::from_le_bytes(records.record[..8].try_into().unwrap_or_default());
        if start == 0 || start >= footer {
            return Ok(false);
        }
        records.go_to(start)?;
        while records.at < footer {
            match records.head()? {
                Some((op, length)) if length <= LONGEST && length <= footer.saturating_sub(records.at) => {
                    if !records.take(length)? {
                        return Ok(false);
                    }
                    each(op, &records.record);
                }
                _ => return Ok(false),
            }
        }
        Ok(true)
    }
}
