//! The numbers of one column, group of rows by group of rows.

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};

use super::guard::guarded;
use super::pages::Pages;

/// Which numbers a column holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaf {
    /// Its place among the columns of the file.
    pub index: usize,
    /// What it is called; a list by the name of the list.
    pub name: String,
    /// Whether it holds a list of numbers a row.
    pub list: bool,
    /// Why it cannot be read; `None` for numbers.
    pub refused: Option<String>,
    /// The unit of stamps that say theirs.
    pub unit: Option<&'static str>,
}

impl Leaf {
    pub fn of(index: usize, column: &ColumnDescriptor) -> Self {
        let parts = column.path().parts();
        let list = column.max_rep_level() > 0;
        // A list has two levels of its own: "state.list.element".
        let own = if list && parts.len() > 2 { parts.len() - 2 } else { parts.len() };
        let refused = match column.physical_type() {
            _ if column.max_rep_level() > 1 => Some("lists of lists".to_owned()),
            Type::INT32 | Type::INT64 if column.converted_type() == ConvertedType::DECIMAL => {
                Some("decimal numbers; cast them to double".to_owned())
            }
            Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE => None,
            Type::BOOLEAN => Some("truths".to_owned()),
            _ => Some("texts or bytes".to_owned()),
        };
        Self { index, name: parts[..own].join("."), list, refused, unit: unit(column) }
    }
}

fn unit(column: &ColumnDescriptor) -> Option<&'static str> {
    use parquet::basic::TimeUnit::{MICROS, MILLIS, NANOS};
    match column.logical_type_ref()? {
        LogicalType::Timestamp(stamp) => Some(match stamp.unit {
            MILLIS => "ms",
            MICROS => "us",
            NANOS => "ns",
        }),
        _ => None,
    }
}

/// Reads a column, or some numbers of a column of lists.
pub(super) struct Column {
    pub leaf: Leaf,
    /// Number of a list (0 where it is no list) and the wanted column it goes to.
    pub elements: Vec<(usize, usize)>,
    levels: (i16, i16),
    descriptor: ColumnDescPtr,
    reader: Option<ColumnReader>,
    values: Values,
    /// What whole numbers too large for a double are counted from.
    origin: Option<i64>,
}

#[derive(Default)]
struct Values {
    definition: Vec<i16>,
    repetition: Vec<i16>,
    numbers: Vec<f64>,
}

/// Whole numbers up to here are doubles.
const EXACT: u64 = 1 << 53;

impl Column {
    pub fn new(leaf: Leaf, descriptor: ColumnDescPtr) -> Self {
        let levels = (descriptor.max_def_level(), descriptor.max_rep_level());
        Self {
            leaf,
            elements: Vec::new(),
            levels,
            descriptor,
            reader: None,
            values: Values::default(),
            origin: None,
        }
    }

    /// Goes to the beginning of a group of rows.
    pub fn open(&mut self, path: &Path, chunk: &ColumnChunkMetaData) -> Result<(), String> {
        if chunk.column_type() != self.descriptor.physical_type() {
            return Err("its index is damaged".into());
        }
        self.reader =
            Some(get_column_reader(Arc::clone(&self.descriptor), Box::new(Pages::open(path, chunk)?)));
        Ok(())
    }

    /// Reads `count` rows; row r of the wanted column goes to `put(slot, r, value)`. Nothing is put where there is no
    /// number.
    pub fn read(&mut self, count: usize, mut put: impl FnMut(usize, usize, f64)) -> Result<(), String> {
        // A reader that failed is gone.
        let Some(mut reader) = self.reader.take() else { return Err("a page of it is damaged".into()) };
        let (values, origin) = (&mut self.values, &mut self.origin);
        let rows = guarded(|| records(&mut reader, count, values, origin))?;
        self.reader = Some(reader);
        if rows != count {
            return Err(format!("its pages hold {rows} rows where its index says {count}"));
        }
        self.distribute(count, &mut put)
    }

    /// Numbers to their rows, by the levels.
    fn distribute(&self, count: usize, put: &mut impl FnMut(usize, usize, f64)) -> Result<(), String> {
        let Values { definition, repetition, numbers } = &self.values;
        let (present, repeated) = self.levels;
        let mut numbers = numbers.iter();
        let is_there = |k: usize| present == 0 || definition.get(k).is_some_and(|level| *level == present);
        if repeated == 0 {
            for row in (0..count).filter(|&row| is_there(row)) {
                let Some(&number) = numbers.next() else { return Err("it lacks numbers".into()) };
                self.elements.iter().for_each(|&(_, slot)| put(slot, row, number));
            }
            return Ok(());
        }
        let (mut row, mut index) = (0, 0);
        for (k, level) in repetition.iter().enumerate() {
            match level {
                0 if k > 0 => (row, index) = (row + 1, 0),
                0 => {}
                _ => index += 1,
            }
            if is_there(k) {
                let Some(&number) = numbers.next() else { return Err("it lacks numbers".into()) };
                let wanted = self.elements.iter().filter(|(element, _)| *element == index && row < count);
                wanted.for_each(|&(_, slot)| put(slot, row, number));
            }
        }
        Ok(())
    }

    /// Whether its numbers are whole.
    pub fn is_whole(&self) -> bool {
        matches!(self.descriptor.physical_type(), Type::INT32 | Type::INT64)
    }

    /// Numbers of the longest list of the rows that were read last.
    pub fn longest_list(&self) -> usize {
        let (mut longest, mut index) = (0, 0);
        for (k, level) in self.values.repetition.iter().enumerate() {
            index = if *level == 0 { 0 } else { index + 1 };
            let is_there = self.values.definition.get(k).is_none_or(|level| *level == self.levels.0);
            longest = longest.max(if is_there { index + 1 } else { 0 });
        }
        longest
    }
}

/// Reads rows of any type of numbers; returns how many.
fn records(
    reader: &mut ColumnReader,
    count: usize,
    values: &mut Values,
    origin: &mut Option<i64>,
) -> Result<usize, String> {
    let read = match reader {
        ColumnReader::Int32ColumnReader(reader) => numbers(reader, count, values, |x: &i32| f64::from(*x)),
        ColumnReader::Int64ColumnReader(reader) => numbers(reader, count, values, |x: &i64| {
            let first = *origin.get_or_insert(if x.unsigned_abs() > EXACT { *x } else { 0 });
            x.wrapping_sub(first) as f64
        }),
        ColumnReader::FloatColumnReader(reader) => numbers(reader, count, values, |x: &f32| f64::from(*x)),
        ColumnReader::DoubleColumnReader(reader) => numbers(reader, count, values, |x: &f64| *x),
        _ => return Err("it holds no numbers".into()),
    };
    read.map_err(|error| error.to_string())
}

/// Reads rows as doubles; returns how many.
fn numbers<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    count: usize,
    values: &mut Values,
    mut number: impl FnMut(&T::T) -> f64,
) -> parquet::errors::Result<usize> {
    values.definition.clear();
    values.repetition.clear();
    values.numbers.clear();
    let mut raw = Vec::with_capacity(count);
    let (rows, _, _) =
        reader.read_records(count, Some(&mut values.definition), Some(&mut values.repetition), &mut raw)?;
    values.numbers.extend(raw.iter().map(&mut number));
    Ok(rows)
}
