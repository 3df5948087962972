//! The files of a window: which columns are wanted of each, and where time comes from.

use super::manifest::{Channel, Manifest, Time, Window};
use super::source::Source;
use super::{Column, RecordingError, Rows};

/// Where a signal is: which file, and which of the columns that are wanted of it.
pub(super) type Slot = (usize, usize);

/// Where time comes from.
pub(super) enum Clock {
    /// Seconds a row.
    Step(f64),
    /// A column: seconds per unit, and the stamp that is t = 0 once it is known.
    Stamps { source: usize, slot: usize, factor: f64, origin: Option<f64> },
}

impl Clock {
    /// Times of the `count` rows that `sources` hold, the first of which is row `first` of the files, s.
    pub(super) fn times(&mut self, sources: &[(Source, Rows)], first: u64, count: usize) -> Vec<f64> {
        match self {
            Self::Step(step) => (0..count as u64).map(|k| (first + k) as f64 * *step).collect(),
            Self::Stamps { source, slot, factor, origin } => {
                let stamps = &sources[*source].1.columns[*slot];
                *origin = origin.or_else(|| stamps.iter().copied().find(|t| t.is_finite()));
                let first = origin.unwrap_or_default();
                stamps.iter().map(|t| (t - first) * *factor).collect()
            }
        }
    }
}

/// The files of a window and what is wanted of them, before they are opened.
pub(super) struct Files<'a> {
    manifest: &'a Manifest,
    window: &'a Window,
    files: Vec<(String, Vec<Column>)>,
}

impl<'a> Files<'a> {
    pub(super) fn new(manifest: &'a Manifest, window: &'a Window) -> Self {
        Self { manifest, window, files: Vec::new() }
    }

    /// The file that signals without one of their own are in.
    pub(super) fn main(manifest: &'a Manifest, window: &'a Window) -> Option<&'a String> {
        window.file.as_ref().or(manifest.position.file.as_ref())
    }

    fn find(&mut self, file: Option<&String>, column: &Column) -> Result<Slot, RecordingError> {
        let Some(file) = file.or(Self::main(self.manifest, self.window)) else {
            return Err(self.manifest.error(&["trajectories"], "a trajectory names no `file`"));
        };
        let files = &mut self.files;
        let source = files.iter().position(|(f, _)| f == file).unwrap_or_else(|| {
            files.push((file.clone(), Vec::new()));
            files.len() - 1
        });
        let columns = &mut files[source].1;
        let slot = columns.iter().position(|c| c == column).unwrap_or_else(|| {
            columns.push(column.clone());
            columns.len() - 1
        });
        Ok((source, slot))
    }

    /// Where the columns of a channel are.
    pub(super) fn channel(&mut self, channel: &Channel) -> Result<Vec<Slot>, RecordingError> {
        channel.columns.iter().map(|c| self.find(channel.file.as_ref(), c)).collect()
    }

    pub(super) fn clock(&mut self) -> Result<Clock, RecordingError> {
        Ok(match &self.manifest.time {
            Time::Rate(rate) => Clock::Step(1.0 / rate),
            Time::Column { column, unit, from_first_row, file } => {
                let (source, slot) = self.find(file.as_ref(), column)?;
                Clock::Stamps { source, slot, factor: unit.factor, origin: (!from_first_row).then_some(0.0) }
            }
        })
    }

    pub(super) fn open(self) -> Result<Vec<(Source, Rows)>, RecordingError> {
        let Self { manifest, files, .. } = self;
        files
            .iter()
            .map(|(file, columns)| {
                let source = Source::open(&manifest.folder.join(file), file, &manifest.layout, columns)?;
                Ok((source, Rows::new(columns.len())))
            })
            .collect()
    }
}
