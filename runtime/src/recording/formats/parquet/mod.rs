//! Parquet files: columns by name or index, a number of a list as `name[k]`.
//!
//! Groups of rows are read one after another, a page of each column at a time. Whole numbers too large for a double
//! (stamps in nanoseconds) are counted from the first of them.

mod column;
mod guard;
mod pages;
mod thrift;
mod write;

use std::path::{Path, PathBuf};

use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};

use crate::recording::format::{Format, Stamps};
use crate::recording::names::{listed, meant};
use crate::recording::{self, Reason, RecordingError, Rows};
use crate::regular_file;
use column::{Column, Leaf};
use guard::guarded;
pub(in crate::recording) use write::write;

/// Rows read at a time.
const AT_ONCE: usize = 4096;
/// Most numbers of a list that are named.
const LONGEST_LIST: usize = 1 << 16;

/// Numbers of a list that a look names.
const MOST_NAMED: usize = 64;

/// Reads the wanted columns of a file.
pub(super) struct ParquetReader {
    file: String,
    path: PathBuf,
    metadata: ParquetMetaData,
    columns: Vec<Column>,
    /// The group of rows that comes next, and rows left of the one that is read.
    group: usize,
    left: usize,
    row: u64,
    /// Whether rows that lack numbers are rows too.
    partial: bool,
}

impl ParquetReader {
    /// Opens a file; with `partial` rows that lack numbers are handed out too.
    pub fn open(
        path: &Path,
        file: &str,
        wanted: &[recording::Column],
        partial: bool,
    ) -> Result<Self, RecordingError> {
        let error = |message: String| RecordingError::File { file: file.into(), message };
        let metadata = metadata(path, file)?;
        let leaves = leaves(&metadata);
        let mut columns: Vec<Column> = Vec::new();
        for (slot, column) in wanted.iter().enumerate() {
            let (index, element) = find(column, &leaves).map_err(&error)?;
            let leaf = &leaves[index];
            if let Some(what) = &leaf.refused {
                return Err(error(format!("column `{}` holds {what}, where numbers are wanted", leaf.name)));
            }
            let at = match columns.iter().position(|c| c.leaf.index == index) {
                Some(at) => at,
                None => {
                    let descriptor = metadata.file_metadata().schema_descr().column(index);
                    columns.push(Column::new(leaf.clone(), descriptor));
                    columns.len() - 1
                }
            };
            columns[at].elements.push((element, slot));
        }
        let path = path.to_path_buf();
        let mut reader =
            Self { file: file.into(), path, metadata, columns, group: 0, left: 0, row: 0, partial };
        reader.check_lists()?;
        Ok(reader)
    }

    fn error(&self, leaf: &Leaf, message: &str) -> RecordingError {
        let message = format!("column `{}`: {message}", leaf.name);
        RecordingError::File { file: self.file.clone(), message }
    }

    /// That the lists of the first rows are as long as they must be.
    fn check_lists(&mut self) -> Result<(), RecordingError> {
        if !self.columns.iter().any(|c| c.leaf.list) {
            return Ok(());
        }
        let width =
            self.columns.iter().flat_map(|c| &c.elements).map(|(_, slot)| slot + 1).max().unwrap_or(0);
        self.read(&mut Rows::new(width), AT_ONCE)?;
        for column in self.columns.iter().filter(|c| c.leaf.list) {
            let longest = column.longest_list();
            if let Some((element, _)) = column.elements.iter().find(|(element, _)| *element >= longest) {
                let message = format!("there is no number {element}: its lists have {longest}, from 0 on");
                return Err(self.error(&column.leaf, &message));
            }
        }
        (self.group, self.left, self.row) = (0, 0, 0);
        Ok(())
    }

    /// Goes on with the next group of rows that has some. False at the end.
    fn next_group(&mut self) -> Result<bool, RecordingError> {
        while self.left == 0 {
            if self.group >= self.metadata.num_row_groups() {
                return Ok(false);
            }
            let group = self.metadata.row_group(self.group);
            self.group += 1;
            let rows = usize::try_from(group.num_rows()).unwrap_or(0);
            for k in 0..self.columns.len() {
                let opened = match group.columns().get(self.columns[k].leaf.index) {
                    Some(chunk) => self.columns[k].open(&self.path, chunk),
                    None => Err("its index is damaged".into()),
                };
                opened.map_err(|message| self.error(&self.columns[k].leaf, &message))?;
            }
            self.left = rows;
        }
        Ok(true)
    }
}

impl Format for ParquetReader {
    fn file(&self) -> &str {
        &self.file
    }

    fn stamps(&self, slot: usize) -> Stamps {
        let holds = |column: &&Column| column.elements.iter().any(|(_, of)| *of == slot);
        let Some(column) = self.columns.iter().find(holds) else { return Stamps::Numbers };
        match column.leaf.unit {
            Some(unit) => Stamps::In(unit),
            None if column.is_whole() => Stamps::Whole,
            None => Stamps::Numbers,
        }
    }

    fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        let mut done = 0;
        while done < most && self.next_group()? {
            let count = self.left.min(most - done).min(AT_ONCE);
            let first = rows.len();
            rows.columns.iter_mut().for_each(|column| column.resize(first + count, f64::NAN));
            for k in 0..self.columns.len() {
                let read =
                    self.columns[k].read(count, |slot, row, value| rows.columns[slot][first + row] = value);
                read.map_err(|message| self.error(&self.columns[k].leaf, &message))?;
            }
            rows.lines.extend((self.row + 1)..=(self.row + count as u64));
            for k in (first..first + count).filter(|_| !self.partial) {
                if rows.columns.iter().any(|column| !column[k].is_finite()) {
                    rows.columns.iter_mut().for_each(|column| column[k] = f64::NAN);
                    rows.faults.push((k, Reason::NotFinite, None));
                }
            }
            self.row += count as u64;
            self.left -= count;
            done += count;
        }
        Ok(done)
    }
}

fn metadata(path: &Path, file: &str) -> Result<ParquetMetaData, RecordingError> {
    let source = regular_file::open(path).map_err(|e| RecordingError::io(path, &e))?;
    let read = || ParquetMetaDataReader::new().parse_and_finish(&source).map_err(|e| e.to_string());
    guarded(read).map_err(|e| {
        let message = format!("this is no Parquet file, or its index is damaged: {e}");
        RecordingError::File { file: file.into(), message }
    })
}

/// Names of the columns that hold numbers, the numbers of lists among them, and the seconds per unit of a column of
/// stamps.
pub(in crate::recording) fn parquet_columns(
    path: &Path,
    file: &str,
) -> Result<(Vec<String>, Option<f64>), RecordingError> {
    let leaves = leaves(&metadata(path, file)?);
    let (mut names, mut unit) = (Vec::new(), None);
    for leaf in leaves.iter().filter(|leaf| leaf.refused.is_none()) {
        unit = unit.or(leaf.unit.and_then(recording::Unit::named).map(|unit| unit.factor));
        if !leaf.list {
            names.push(leaf.name.clone());
            continue;
        }
        let first = [recording::Column::Name(format!("{}[0]", leaf.name))];
        // A list without numbers has none to name.
        let Ok(mut reader) = ParquetReader::open(path, file, &first, false) else { continue };
        reader.read(&mut Rows::new(1), AT_ONCE)?;
        let longest = reader.columns.first().map_or(0, Column::longest_list);
        names.extend((0..longest.min(MOST_NAMED)).map(|k| format!("{}[{k}]", leaf.name)));
    }
    Ok((names, unit))
}

fn leaves(metadata: &ParquetMetaData) -> Vec<Leaf> {
    let schema = metadata.file_metadata().schema_descr();
    schema.columns().iter().enumerate().map(|(index, column)| Leaf::of(index, column)).collect()
}

/// Place of a wanted column among those of the file, and the number of its list.
fn find(column: &recording::Column, leaves: &[Leaf]) -> Result<(usize, usize), String> {
    let names = || leaves.iter().map(|leaf| leaf.name.as_str());
    let in_list = |leaf: &Leaf| {
        format!(
            "column `{0}` holds a list: name a number of it by its index, as \"{0}[0]\" (in quotation marks)",
            leaf.name
        )
    };
    let name = match column {
        recording::Column::Index(index) => {
            return match leaves.get(*index) {
                Some(leaf) if leaf.list => Err(in_list(leaf)),
                Some(_) => Ok((*index, 0)),
                None => Err(format!(
                    "there is no column {index}: there are {}: {}",
                    leaves.len(),
                    listed(names())
                )),
            };
        }
        recording::Column::Name(name) => name,
    };
    let of_name = |name: &str| {
        let mut found = leaves.iter().filter(|leaf| leaf.name == name);
        match (found.next(), found.next()) {
            (Some(_), Some(_)) => Err(format!("two columns are called `{name}`; name them by index")),
            (found, _) => Ok(found),
        }
    };
    match of_name(name)? {
        Some(leaf) if leaf.list => return Err(in_list(leaf)),
        Some(leaf) => return Ok((leaf.index, 0)),
        None => {}
    }
    let element = name.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    if let Some((list, Ok(element))) = element.map(|(list, number)| (list, number.parse::<usize>()))
        && element < LONGEST_LIST
        && let Some(leaf) = of_name(list)?
    {
        return match leaf.list {
            true => Ok((leaf.index, element)),
            false => Err(format!("column `{list}` holds one number a row, not a list")),
        };
    }
    let plain = name.split('[').next().unwrap_or_default();
    Err(format!("there is no column `{name}`{}; there are: {}", meant(plain, names()), listed(names())))
}
