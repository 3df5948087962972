//! Pages of a column, unpacked. All codecs in Rust: the `parquet` crate's own zstd is C.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use bytes::Bytes;
use parquet::basic::{Compression, Encoding};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ColumnChunkMetaData;

use super::thrift::PageHeader;

/// Longest page, packed and unpacked. Writers make pages of about 1 MB.
const LONGEST: i64 = 1 << 28;

/// Reads the pages of a column of one row group one after another.
pub(super) struct Pages {
    source: io::Take<BufReader<File>>,
    codec: Compression,
    /// The header of the next page, where it was looked at.
    next: Option<PageHeader>,
    packed: Vec<u8>,
    /// Whether the dictionary came, without which its indices say nothing.
    dictionary: bool,
}

impl Pages {
    /// Goes to the first page of a column of a row group.
    ///
    /// # Errors
    /// Places that cannot be in a file, a codec that is not read, what the system says.
    pub fn open(path: &Path, column: &ColumnChunkMetaData) -> std::result::Result<Self, String> {
        let codec = column.compression();
        use Compression::{BROTLI, GZIP, LZ4_RAW, SNAPPY, UNCOMPRESSED, ZSTD};
        if !matches!(codec, UNCOMPRESSED | SNAPPY | LZ4_RAW | ZSTD(_) | GZIP(_) | BROTLI(_)) {
            return Err(format!(
                "its pages are packed with {}; snappy, zstd, lz4 (raw), gzip, brotli or none is read. Write it again: python -c \
                 \"import pyarrow.parquet as p; p.write_table(p.read_table('in.parquet'), 'out.parquet', compression='zstd')\"",
                codec.to_string().split('(').next().unwrap_or_default()
            ));
        }
        // A page of the dictionary comes first.
        let start = match column.dictionary_page_offset() {
            Some(dictionary) if dictionary > 0 => dictionary.min(column.data_page_offset()),
            _ => column.data_page_offset(),
        };
        let (Ok(start), Ok(length)) = (u64::try_from(start), u64::try_from(column.compressed_size())) else {
            return Err("its index is damaged".into());
        };
        let open = || {
            let mut file = File::open(path)?;
            file.seek(SeekFrom::Start(start))?;
            Ok::<_, io::Error>(BufReader::with_capacity(1 << 16, file).take(length))
        };
        let source = open().map_err(|e| e.to_string())?;
        Ok(Self { source, codec, next: None, packed: Vec::new(), dictionary: false })
    }

    /// The header of the next page that holds values; `None` at the end.
    fn header(&mut self) -> Result<Option<PageHeader>> {
        if let Some(header) = self.next.take() {
            return Ok(Some(header));
        }
        while self.source.limit() > 0 {
            let header = PageHeader::read(&mut self.source)?;
            if !(0..=LONGEST).contains(&header.packed)
                || !(0..=LONGEST).contains(&header.unpacked)
                || header.packed as u64 > self.source.limit()
            {
                return Err(damaged("the header of a page is damaged"));
            }
            if matches!(header.kind, 0 | 2 | 3) {
                return Ok(Some(header));
            }
            io::copy(&mut self.source.by_ref().take(header.packed as u64), &mut io::sink())?;
        }
        Ok(None)
    }

    /// The bytes of a page; the first `plain` of them are never packed.
    fn unpacked(&mut self, header: &PageHeader, plain: usize, is_packed: bool) -> Result<Bytes> {
        self.packed.resize(header.packed as usize, 0);
        self.source.read_exact(&mut self.packed)?;
        if !is_packed || self.codec == Compression::UNCOMPRESSED {
            return Ok(Bytes::copy_from_slice(&self.packed));
        }
        let size = header.unpacked as usize;
        let Some((levels, packed)) = self.packed.split_at_checked(plain).filter(|_| plain <= size) else {
            return Err(damaged("the levels of a page are cut off"));
        };
        let mut out = Vec::new();
        out.extend_from_slice(levels);
        match self.codec {
            _ if size == plain => {}
            Compression::SNAPPY => {
                // Asked for first, so that a length that is damaged takes no memory.
                if snap::raw::decompress_len(packed).map_err(other)? != size - plain {
                    return Err(damaged("a page has another length than its header says"));
                }
                out.extend(snap::raw::Decoder::new().decompress_vec(packed).map_err(other)?);
            }
            Compression::LZ4_RAW => {
                out.resize(size, 0);
                let count = lz4_flex::block::decompress_into(packed, &mut out[plain..]).map_err(other)?;
                out.truncate(plain + count);
            }
            Compression::GZIP(_) => {
                let decoder = flate2::read::MultiGzDecoder::new(packed);
                decoder.take((size - plain) as u64 + 1).read_to_end(&mut out)?;
            }
            Compression::BROTLI(_) => {
                let decoder = brotli_decompressor::Decompressor::new(packed, 1 << 12);
                decoder.take((size - plain) as u64 + 1).read_to_end(&mut out)?;
            }
            _ => {
                let decoder = ruzstd::decoding::StreamingDecoder::new(packed).map_err(other)?;
                decoder.take((size - plain) as u64 + 1).read_to_end(&mut out)?;
            }
        }
        if out.len() != size {
            return Err(damaged("a page has another length than its header says"));
        }
        Ok(Bytes::from(out))
    }
}

fn damaged(message: &str) -> ParquetError {
    ParquetError::General(message.into())
}

fn other(error: impl std::fmt::Display) -> ParquetError {
    ParquetError::General(format!("a page cannot be unpacked: {error}"))
}

#[allow(deprecated, reason = "old files have levels packed by bits")]
fn encoding(number: Option<u32>) -> Result<Encoding> {
    Ok(match number {
        Some(0) => Encoding::PLAIN,
        Some(2) => Encoding::PLAIN_DICTIONARY,
        Some(3) => Encoding::RLE,
        Some(4) => Encoding::BIT_PACKED,
        Some(5) => Encoding::DELTA_BINARY_PACKED,
        Some(8) => Encoding::RLE_DICTIONARY,
        Some(9) => Encoding::BYTE_STREAM_SPLIT,
        _ => return Err(damaged("a page has an encoding that numbers do not have")),
    })
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let Some(header) = self.header()? else { return Ok(None) };
        let number =
            |field| header.number(field).ok_or_else(|| damaged("the header of a page lacks a number"));
        let num_values = number(1)?;
        // Where a header says the encoding of its values.
        let of_values = encoding(header.number(if header.kind == 3 { 4 } else { 2 }))?;
        let indices = matches!(of_values, Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY);
        if header.kind != 2 && indices && !self.dictionary {
            return Err(damaged("a page lacks its dictionary"));
        }
        self.dictionary |= header.kind == 2;
        Ok(Some(match header.kind {
            0 => Page::DataPage {
                encoding: of_values,
                def_level_encoding: encoding(header.number(3))?,
                rep_level_encoding: encoding(header.number(4))?,
                buf: self.unpacked(&header, 0, true)?,
                num_values,
                statistics: None,
            },
            2 => Page::DictionaryPage {
                encoding: of_values,
                is_sorted: header.number(3) == Some(1),
                buf: self.unpacked(&header, 0, true)?,
                num_values,
            },
            _ => {
                let (def_levels_byte_len, rep_levels_byte_len) = (number(5)?, number(6)?);
                let levels = def_levels_byte_len.saturating_add(rep_levels_byte_len) as usize;
                let is_compressed = header.number(7) != Some(0);
                let buf = self.unpacked(&header, levels, is_compressed)?;
                if levels > buf.len() {
                    return Err(damaged("the levels of a page are cut off"));
                }
                Page::DataPageV2 {
                    buf,
                    num_values,
                    encoding: of_values,
                    num_nulls: number(2)?,
                    num_rows: number(3)?,
                    def_levels_byte_len,
                    rep_levels_byte_len,
                    is_compressed,
                    statistics: None,
                }
            }
        }))
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.next = self.header()?;
        Ok(self.next.as_ref().map(|header| PageMetadata {
            num_rows: (header.kind == 3).then(|| header.number(3)).flatten().map(|n| n as usize),
            num_levels: header.number(1).map(|n| n as usize),
            is_dict: header.kind == 2,
        }))
    }

    fn skip_next_page(&mut self) -> Result<()> {
        if let Some(header) = self.header()? {
            io::copy(&mut self.source.by_ref().take(header.packed as u64), &mut io::sink())?;
        }
        Ok(())
    }
}

impl Iterator for Pages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}
