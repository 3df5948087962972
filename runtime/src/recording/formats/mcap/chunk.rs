//! Chunks: records packed together.

use std::io::Read;

use super::fields::Fields;

/// Longest chunk, packed and unpacked. Writers make chunks of 0.8 to 4 MB.
pub(super) const LONGEST_CHUNK: u64 = 1 << 27;

/// What stands before the records of a chunk.
pub(super) struct ChunkHeader {
    size: u64,
    checksum: u32,
    compression: String,
    /// Where the records begin in the body of the chunk, and how many bytes they have.
    start: usize,
    packed: u64,
}

impl ChunkHeader {
    pub fn read(body: &[u8]) -> Option<Self> {
        let mut fields = Fields(body);
        // Times of the first and the last message.
        fields.take(16)?;
        let (size, checksum, compression) = (fields.u64()?, fields.u32()?, fields.text()?);
        let packed = fields.u64()?;
        Some(Self { size, checksum, compression, start: body.len() - fields.0.len(), packed })
    }
}

/// Unpacks the records of a chunk into `out`. One that is not `whole` is unpacked as far as it goes.
pub(super) fn unpack(
    header: &ChunkHeader,
    body: &[u8],
    out: &mut Vec<u8>,
    whole: bool,
) -> Result<(), String> {
    out.clear();
    if header.size > LONGEST_CHUNK {
        return Err(format!("its records have {} bytes, more than {LONGEST_CHUNK}", header.size));
    }
    let records = body.get(header.start..).unwrap_or_default();
    let records = match records.get(..header.packed.min(usize::MAX as u64) as usize) {
        Some(records) => records,
        None if whole => return Err("its records are cut off".into()),
        None => records,
    };
    // Room for one byte more shows that there are too many.
    let most = header.size + 1;
    let read = match header.compression.as_str() {
        "" | "none" => {
            out.extend_from_slice(records);
            Ok(out.len())
        }
        "lz4" => lz4_flex::frame::FrameDecoder::new(records).take(most).read_to_end(out),
        "zstd" => match ruzstd::decoding::StreamingDecoder::new(records) {
            Ok(decoder) => decoder.take(most).read_to_end(out),
            Err(error) => return Err(format!("zstd: {error}")),
        },
        other => {
            return Err(format!("packed as `{}`; zstd, lz4 or not at all is read", other.escape_debug()));
        }
    };
    if !whole {
        return Ok(());
    }
    read.map_err(|error| format!("it cannot be unpacked: {error}"))?;
    if out.len() as u64 != header.size {
        return Err(format!("its records have {} bytes, its header says {}", out.len(), header.size));
    }
    if header.checksum != 0 && crc32fast::hash(out) != header.checksum {
        return Err("its checksum is wrong".into());
    }
    Ok(())
}
