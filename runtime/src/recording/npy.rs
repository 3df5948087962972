//! Binary columns: NumPy's `.npy` format.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::format::Format;
use super::{Column, Reason, RecordingError, Rows};
use crate::regular_file;

/// Reads the wanted columns of a two-dimensional little-endian `.npy` array (`float64` or `float32`) block by block:
/// rows are instants, columns are channels. In Fortran order (`numpy.save(f, numpy.asfortranarray(a))`) only the wanted
/// columns are read from the disk. A one-dimensional array is one column.
///
/// The format is described in the NumPy manual, `numpy.lib.format`.
pub(super) struct NpyReader<R> {
    file: String,
    source: R,
    /// Where the numbers begin.
    start: u64,
    shape: Shape,
    /// Indices of the wanted columns.
    wanted: Vec<usize>,
    row: usize,
    bytes: Vec<u8>,
}

/// Bytes read at a time.
const AT_ONCE: usize = 1 << 22;
/// Most columns of an array.
const MOST_COLUMNS: usize = 1 << 16;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Shape {
    rows: usize,
    columns: usize,
    /// Bytes of a number, 4 or 8.
    width: usize,
    by_column: bool,
}

impl NpyReader<File> {
    pub fn open(path: &Path, file: &str, wanted: &[Column]) -> Result<Self, RecordingError> {
        let source = regular_file::open(path).map_err(|e| RecordingError::io(path, &e))?;
        Self::new(source, file, wanted)
    }
}

impl<R: Read + Seek> NpyReader<R> {
    pub fn new(mut source: R, file: &str, wanted: &[Column]) -> Result<Self, RecordingError> {
        let error = |message: String| RecordingError::Table { file: file.into(), line: 1, message };
        let (start, shape) = header(&mut source).map_err(&error)?;
        let size = (shape.rows as u128 * shape.columns as u128).saturating_mul(shape.width as u128);
        let end = source.seek(SeekFrom::End(0)).map_err(|e| error(e.to_string()))?;
        if u128::from(end) < size.saturating_add(u128::from(start)) {
            return Err(error(format!(
                "the header promises {} rows of {} columns, but the file ends before that",
                shape.rows, shape.columns
            )));
        }
        let index = |column: &Column| match column {
            Column::Index(index) if *index < shape.columns => Ok(*index),
            Column::Index(index) => Err(error(format!(
                "there is no column {index}: the columns go from 0 to {}",
                shape.columns - 1
            ))),
            Column::Name(name) => Err(error(format!(
                "column `{name}` is asked for by name; the columns of a .npy file have indices"
            ))),
        };
        let wanted = wanted.iter().map(index).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { file: file.into(), source, start, shape, wanted, row: 0, bytes: Vec::new() })
    }

    /// Columns of the array.
    pub fn columns(&self) -> usize {
        self.shape.columns
    }

    pub fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        let row = if self.shape.by_column { 1 } else { self.shape.columns };
        let at_once = (AT_ONCE / (row * self.shape.width)).max(1);
        let count = most.min(self.shape.rows - self.row).min(at_once);
        if count == 0 {
            return Ok(0);
        }
        let Shape { rows: all, columns, width, by_column } = self.shape;
        let first = rows.len();
        if by_column {
            for (slot, &column) in self.wanted.iter().enumerate() {
                let at = self.start + ((column * all + self.row) * width) as u64;
                take(&mut self.source, &self.file, at, count * width, &mut self.bytes)?;
                rows.columns[slot].extend(self.bytes.chunks_exact(width).map(number));
            }
        } else {
            let at = self.start + (self.row * columns * width) as u64;
            take(&mut self.source, &self.file, at, count * columns * width, &mut self.bytes)?;
            for (slot, &column) in self.wanted.iter().enumerate() {
                let of_row = |row: &[u8]| number(&row[column * width..(column + 1) * width]);
                rows.columns[slot].extend(self.bytes.chunks_exact(columns * width).map(of_row));
            }
        }
        rows.lines.extend((self.row as u64 + 1)..=(self.row + count) as u64);
        for k in first..first + count {
            if let Some(slot) = rows.columns.iter().position(|c| !c[k].is_finite()) {
                rows.columns.iter_mut().for_each(|c| c[k] = f64::NAN);
                rows.faults.push((k, Reason::NotFinite, Some(self.wanted[slot])));
            }
        }
        self.row += count;
        Ok(count)
    }
}

impl<R: Read + Seek> Format for NpyReader<R> {
    fn file(&self) -> &str {
        &self.file
    }

    fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        NpyReader::read(self, rows, most)
    }
}

fn take<R: Read + Seek>(
    source: &mut R,
    file: &str,
    at: u64,
    length: usize,
    bytes: &mut Vec<u8>,
) -> Result<(), RecordingError> {
    bytes.resize(length, 0);
    let done = source.seek(SeekFrom::Start(at)).and_then(|_| source.read_exact(bytes));
    done.map_err(|e| RecordingError::File { file: file.into(), message: e.to_string() })
}

fn number(bytes: &[u8]) -> f64 {
    match *bytes {
        [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        _ => f64::NAN,
    }
}

/// Where the numbers begin, and what they are.
fn header(source: &mut impl Read) -> Result<(u64, Shape), String> {
    let not_npy = || "this is no .npy file (it does not begin with \\x93NUMPY)".to_string();
    let mut magic = [0; 8];
    source.read_exact(&mut magic).map_err(|_| not_npy())?;
    if &magic[..6] != b"\x93NUMPY" {
        return Err(not_npy());
    }
    let cut = |_| "the file ends within its header".to_string();
    let (length, before) = if magic[6] == 1 {
        let mut two = [0; 2];
        source.read_exact(&mut two).map_err(cut)?;
        (usize::from(u16::from_le_bytes(two)), 10)
    } else {
        let mut four = [0; 4];
        source.read_exact(&mut four).map_err(cut)?;
        (u32::from_le_bytes(four) as usize, 12)
    };
    if length > 1 << 16 {
        return Err("its header is too long to be one".into());
    }
    let mut text = vec![0; length];
    source.read_exact(&mut text).map_err(cut)?;
    let text = String::from_utf8_lossy(&text);
    let width = match value(&text, "descr").map(|v| v.trim_matches(['\'', '"'])) {
        Some("<f8") => 8,
        Some("<f4") => 4,
        Some(other) => {
            return Err(format!(
                "numbers of type {other}: save a plain float64 or float32 array, little-endian"
            ));
        }
        None => return Err("its header names no `descr`".into()),
    };
    let by_column = value(&text, "fortran_order") == Some("True");
    let shape = value(&text, "shape").ok_or("its header names no `shape`")?;
    let sizes: Vec<usize> = shape
        .trim_matches(['(', ')'])
        .split(',')
        .filter(|s| !s.trim().is_empty())
        .map(|s| s.trim().parse().map_err(|_| format!("a shape of {shape}")))
        .collect::<Result<_, _>>()?;
    match sizes[..] {
        [rows] => Ok(((before + length) as u64, Shape { rows, columns: 1, width, by_column: false })),
        [_, columns] if columns > MOST_COLUMNS => Err(format!(
            "an array of shape {shape}: more than {MOST_COLUMNS} columns are no recording; is it transposed?"
        )),
        [rows, columns] if columns > 0 => {
            Ok(((before + length) as u64, Shape { rows, columns, width, by_column }))
        }
        _ => Err(format!("an array of shape {shape}: rows by columns are expected")),
    }
}

/// The value of a key of the header, a Python dictionary of literals.
fn value<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let after = &text[text.find(&format!("'{key}'"))? + key.len() + 2..];
    let after = after.trim_start().strip_prefix(':')?.trim_start();
    let end = if after.starts_with('(') { after.find(')')? + 1 } else { after.find([',', '}'])? };
    Some(after[..end].trim())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use proptest::prelude::*;

    use super::*;

    fn file(descr: &str, order: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
        let mut dict = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
        while (10 + dict.len() + 1) % 64 != 0 {
            dict.push(' ');
        }
        dict.push('\n');
        let mut out = b"\x93NUMPY\x01\x00".to_vec();
        out.extend((dict.len() as u16).to_le_bytes());
        out.extend(dict.bytes());
        out.extend(numbers);
        out
    }

    fn doubles(values: &[f64]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    fn read(bytes: Vec<u8>, wanted: &[usize]) -> Result<Rows, RecordingError> {
        let wanted: Vec<Column> = wanted.iter().map(|w| Column::Index(*w)).collect();
        let mut reader = NpyReader::new(Cursor::new(bytes), "x.npy", &wanted)?;
        let mut rows = Rows::new(wanted.len());
        while reader.read(&mut rows, 2)? > 0 {}
        Ok(rows)
    }

    #[test]
    fn an_array_of_a_hundred_million_columns_takes_no_memory() {
        let error = read(file("'<f8'", "False", "(10, 100000000)", &[]), &[0]).expect_err("too wide");
        assert!(error.to_string().contains("more than 65536 columns"), "{error}");
        // Wide rows are read a few at a time.
        let numbers = doubles(&(0..3 * 60_000).map(f64::from).collect::<Vec<_>>());
        let bytes = file("'<f8'", "False", "(3, 60000)", &numbers);
        let mut reader = NpyReader::new(Cursor::new(bytes), "x.npy", &[Column::Index(1)]).expect("an array");
        let mut rows = Rows::new(1);
        while reader.read(&mut rows, 1 << 16).expect("rows") > 0 {
            assert!(reader.bytes.len() <= AT_ONCE);
        }
        assert_eq!(rows.columns[0], [1.0, 60_001.0, 120_001.0]);
    }

    #[test]
    fn both_orders_and_both_widths_are_read() {
        let by_row = doubles(&[0.0, 1.0, 2.0, 10.0, 11.0, 12.0, 20.0, 21.0, 22.0]);
        let by_column = doubles(&[0.0, 10.0, 20.0, 1.0, 11.0, 21.0, 2.0, 12.0, 22.0]);
        let narrow: Vec<u8> = [0f32, 1.0, 2.0, 10.0, 11.0, 12.0, 20.0, 21.0, 22.0]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        for bytes in [
            file("'<f8'", "False", "(3, 3)", &by_row),
            file("'<f8'", "True", "(3, 3)", &by_column),
            file("'<f4'", "False", "(3, 3)", &narrow),
        ] {
            let rows = read(bytes, &[2, 0]).expect("a table");
            assert_eq!(rows.columns, [[2.0, 12.0, 22.0], [0.0, 10.0, 20.0]]);
            assert_eq!(rows.lines, [1, 2, 3]);
        }
        let one =
            read(file("'<f8'", "False", "(3,)", &doubles(&[1.0, f64::NAN, 3.0])), &[0]).expect("a column");
        assert_eq!(one.faults, [(1, Reason::NotFinite, Some(0))]);
    }

    #[test]
    fn what_cannot_be_read_is_told() {
        let error = |bytes: Vec<u8>, wanted: &[usize]| read(bytes, wanted).expect_err("wrong").to_string();
        assert!(error(b"t,q\n1,2\n".to_vec(), &[0]).contains("no .npy file"));
        assert!(error(file("'>f8'", "False", "(3, 3)", &[]), &[0]).contains(">f8"));
        assert!(error(file("[('t', '<f8')]", "False", "(3,)", &[]), &[0]).contains("plain float64"));
        assert!(error(file("'<f8'", "False", "(3, 3, 3)", &[]), &[0]).contains("(3, 3, 3)"));
        assert!(error(file("'<f8'", "False", "(3, 3)", &doubles(&[1.0])), &[0]).contains("ends before"));
        assert!(error(file("'<f8'", "False", "(1, 2)", &doubles(&[1.0, 2.0])), &[2]).contains("from 0 to 1"));
        let huge = format!("({}, {})", usize::MAX, usize::MAX);
        assert!(error(file("'<f8'", "False", &huge, &[]), &[0]).contains("columns"));
        let long = format!("({}, 5)", usize::MAX);
        assert!(error(file("'<f8'", "False", &long, &[]), &[0]).contains("ends before"));
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200), at in 0usize..200, b in any::<u8>()) {
            let _ = read(bytes, &[0]);
            let mut damaged = file("'<f8'", "True", "(3, 3)", &doubles(&[1.0; 9]));
            let at = at % damaged.len();
            damaged[at] = b;
            let _ = read(damaged, &[0, 1]);
        }
    }
}
