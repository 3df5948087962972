//! The files of a window: which columns are wanted of each, and where time comes from.

use super::formats::{self, Format};
use super::manifest::{Channel, Manifest, Time, Window};
use super::manifest_reader::STAMP;
use super::{Column, RecordingError, Rows};

/// Where a signal is: which file, and which of the columns that are wanted of it.
pub(super) type Slot = (usize, usize);

/// A file that is being read, and the rows of it that were read last.
pub(super) type Source = (Box<dyn Format>, Rows);

/// Columns of a log that hold times.
const STAMPS: [&str; 3] = [STAMP, "log_time", "publish_time"];

/// Where time comes from.
pub(super) enum Clock {
    /// Seconds a row.
    Step(f64),
    /// A column: seconds per unit, and the stamp that is t = 0 once it is known.
    Stamps { source: usize, slot: usize, factor: f64, origin: Option<f64> },
}

impl Clock {
    /// Times of the `count` rows that `sources` hold, the first of which is row `first` of the files, s.
    pub(super) fn times(&mut self, sources: &[Source], first: u64, count: usize) -> Vec<f64> {
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
    /// The signals of joints that are named are in the trajectory's file by these names.
    by_joint: bool,
}

impl<'a> Files<'a> {
    pub(super) fn new(manifest: &'a Manifest, window: &'a Window) -> Self {
        let log = Self::main(manifest, window).is_some_and(|f| formats::is_log(&manifest.folder.join(f)));
        let by_joint = log && !manifest.joints.is_empty();
        Self { manifest, window, files: Vec::new(), by_joint }
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

    /// Where the columns of a channel are; `quantity` is its key, `field` what logs call it.
    pub(super) fn channel(
        &mut self,
        channel: &Channel,
        quantity: &str,
        field: &str,
    ) -> Result<Vec<Slot>, RecordingError> {
        if self.by_joint && channel.file.is_none() {
            let joints = &self.manifest.joints;
            let column = |joint: &String| self.find(None, &Column::Name(format!("{joint}.{field}")));
            return joints.iter().map(column).collect();
        }
        if channel.columns.is_empty() {
            let file = channel.file.as_ref().or(Self::main(self.manifest, self.window));
            let message = format!(
                "`joints` name what is in MCAP files and rosbag2 folders; {} is another file, whose `columns` are needed",
                file.map_or("", String::as_str)
            );
            return Err(self.manifest.error(&[quantity], &message));
        }
        channel.columns.iter().map(|c| self.find(channel.file.as_ref(), c)).collect()
    }

    pub(super) fn clock(&mut self) -> Result<Clock, RecordingError> {
        let stamps = |source, slot, factor, origin| Clock::Stamps { source, slot, factor, origin };
        Ok(match &self.manifest.time {
            Time::Rate(rate) => Clock::Step(1.0 / rate),
            Time::Column { column: Column::Name(name), file: None, .. }
                if self.by_joint && !STAMPS.contains(&name.as_str()) =>
            {
                // The column is that of the tables of the same recording.
                let (source, slot) = self.find(None, &Column::Name(STAMP.into()))?;
                stamps(source, slot, 1.0, Some(0.0))
            }
            Time::Column { column, unit, from_first_row, file } => {
                let (source, slot) = self.find(file.as_ref(), column)?;
                stamps(source, slot, unit.factor, (!from_first_row).then_some(0.0))
            }
        })
    }

    pub(super) fn open(self) -> Result<Vec<Source>, RecordingError> {
        let Self { manifest, window, files, .. } = self;
        let open = |(file, columns): &(String, Vec<Column>)| {
            let path = manifest.folder.join(file);
            if window.topic.is_some() && !formats::is_log(&path) {
                let message = format!("`topic` is for MCAP files and rosbag2 folders; {file} has none");
                return Err(manifest.error(&["trajectories"], &message));
            }
            let wanted =
                formats::Wanted { columns, layout: &manifest.layout, topic: window.topic.as_deref() };
            Ok((formats::open(&path, file, &wanted)?, Rows::new(columns.len())))
        };
        files.iter().map(open).collect()
    }
}
