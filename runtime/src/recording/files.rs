//! The files of a window: which columns are wanted of each, and where time comes from.

use super::format::{Format, Stamps};
use super::formats;
use super::manifest::STAMP;
use super::manifest::{Channel, Manifest, Time, Window};
use super::unit::Unit;
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
    /// The same of whole numbers whose unit nobody says.
    Unsaid { source: usize, slot: usize, origin: Option<f64> },
}

/// Rows a second from which on whole numbers are taken for seconds: nobody records so slowly.
const SLOWEST: f64 = 2.0;

/// Seconds per unit of whole numbers, by their steps: the unit in which they are 2 to 50,000 rows a second; and what it is
/// called.
fn unit_of_steps(stamps: &[f64]) -> (f64, &'static str) {
    let mut steps: Vec<f64> =
        stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let Some(&step) = steps.get(steps.len() / 2) else { return (1.0, "s") };
    let units = [(1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")];
    // The largest unit in which rows are not too far apart.
    units.into_iter().find(|(factor, _)| step * factor * SLOWEST <= 1.0).unwrap_or((1e-9, "ns"))
}

impl Clock {
    /// The clock of files that were opened: stamps whose unit is not said have that of their type. What a person is to know
    /// of it is added to `notes`.
    ///
    /// # Errors
    /// A unit that contradicts the type of the stamps.
    pub(super) fn of_types(
        self,
        manifest: &Manifest,
        sources: &[Source],
        notes: &mut Vec<String>,
    ) -> Result<Self, RecordingError> {
        let Self::Stamps { source, slot, origin, .. } = self else { return Ok(self) };
        let Time::Column { unit: said, column, .. } = &manifest.time else { return Ok(self) };
        let file = sources[source].0.file();
        match (sources[source].0.stamps(slot), said) {
            (Stamps::In(unit), Some(said))
                if Unit::named(unit).is_some_and(|unit| unit.factor != said.factor) =>
            {
                let message = format!(
                    "the stamps of {file} are in {unit}, by the type of column {column}: `unit: {unit}`"
                );
                Err(manifest.error(&["time", "unit"], &message))
            }
            (Stamps::In(unit), None) => {
                let factor = Unit::named(unit).map_or(1.0, |unit| unit.factor);
                notes.push(format!("{file}: the stamps are in {unit}, by the type of column {column}"));
                Ok(Self::Stamps { source, slot, factor, origin })
            }
            (Stamps::Whole, None) => Ok(Self::Unsaid { source, slot, origin }),
            _ => Ok(self),
        }
    }

    /// Settles the unit of whole numbers by the first rows, and tells which one was taken.
    pub(super) fn settle(&mut self, sources: &[Source], notes: &mut Vec<String>) {
        let Self::Unsaid { source, slot, origin } = *self else { return };
        let (factor, unit) = unit_of_steps(&sources[source].1.columns[slot]);
        let file = sources[source].0.file();
        notes.push(format!(
            "{file}: the stamps are whole numbers without a unit; by their steps they are taken as {unit} (`time: {{unit: {unit}}}` \
             says so)"
        ));
        *self = Self::Stamps { source, slot, factor, origin };
    }

    /// Times of the `count` rows that `sources` hold, the first of which is row `first` of the files, s.
    pub(super) fn times(&mut self, sources: &[Source], first: u64, count: usize) -> Vec<f64> {
        match self {
            Self::Step(step) => (0..count as u64).map(|k| (first + k) as f64 * *step).collect(),
            // Settled before any times are asked for.
            Self::Unsaid { .. } => vec![f64::NAN; count],
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
            let manifest = self.manifest;
            let path = match &manifest.fields {
                None => None,
                Some(fields) => Some(fields.path(quantity).ok_or_else(|| {
                    manifest.error(
                        &["fields"],
                        &format!("there is a `{quantity}`, but no path to it: `{quantity}: ...`"),
                    )
                })?),
            };
            let name = |joint: &String| match path {
                None => format!("{joint}.{field}"),
                Some(path) => format!("{path}[{joint}]"),
            };
            return manifest.joints.iter().map(|joint| self.find(None, &Column::Name(name(joint)))).collect();
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

    /// Where columns of a file are, the trajectory's where none is named.
    pub(super) fn columns(
        &mut self,
        file: Option<&String>,
        columns: &[Column],
    ) -> Result<Vec<Slot>, RecordingError> {
        columns.iter().map(|column| self.find(file, column)).collect()
    }

    /// Where time comes from.
    pub(super) fn clock(&mut self) -> Result<Clock, RecordingError> {
        self.clock_in(None)
    }

    /// Where the time of the rows of a file comes from; `None`: of those of the motion.
    pub(super) fn clock_in(&mut self, own: Option<&String>) -> Result<Clock, RecordingError> {
        let stamps = |source, slot, factor, origin| Clock::Stamps { source, slot, factor, origin };
        Ok(match &self.manifest.time {
            Time::Rate(rate) => Clock::Step(1.0 / rate),
            Time::Column { column: Column::Name(name), file: None, .. }
                if self.by_joint && own.is_none() && !STAMPS.contains(&name.as_str()) =>
            {
                // The column is that of the tables of the same recording.
                let (source, slot) = self.find(None, &Column::Name(STAMP.into()))?;
                stamps(source, slot, 1.0, Some(0.0))
            }
            Time::Column { column, unit, from_first_row, file } => {
                let (source, slot) = self.find(own.or(file.as_ref()), column)?;
                let factor = unit.as_ref().map_or(1.0, |unit| unit.factor);
                stamps(source, slot, factor, (!from_first_row).then_some(0.0))
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
            let wanted = formats::Wanted {
                columns,
                layout: &manifest.layout,
                topic: window.topic.as_deref(),
                names: manifest.fields.as_ref().and_then(|fields| fields.names.as_deref()),
                partial: false,
            };
            Ok((formats::open(&path, file, &wanted)?, Rows::new(columns.len())))
        };
        files.iter().map(open).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_stamps_have_the_unit_in_which_rows_are_close() {
        let stamps = |step: f64| (0..50).map(|k| 1e6 + step * f64::from(k)).collect::<Vec<f64>>();
        for (step, unit) in
            [(10.0, "ms"), (1.0, "ms"), (500.0, "ms"), (1000.0, "us"), (2e6, "ns"), (1e7, "ns")]
        {
            assert_eq!(unit_of_steps(&stamps(step)).1, unit, "{step}");
        }
        assert_eq!(unit_of_steps(&[1.0, 1.0]), (1.0, "s"));
    }
}
