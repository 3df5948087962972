//! Where a recording comes from: its files, and when it was made.

use std::path::PathBuf;

use super::formats;
use super::manifest::{Manifest, Time};

/// 2015-01-01, s since 1970. ROS 2, whose messages are read, is from that year: what is stamped earlier has the time of a
/// simulation, or of a clock that nobody had set.
const EARLIEST: i64 = 1_420_070_400;

impl Manifest {
    /// The data files that are read, each once, as the manifest calls them and where they are. Of a log that is a folder
    /// those in it.
    pub fn data_files(&self) -> Vec<(String, PathBuf)> {
        let of_time = match &self.time {
            Time::Column { file, .. } => file.as_ref(),
            Time::Rate(_) => None,
        };
        let channels = [Some(&self.position), self.velocity.as_ref(), Some(&self.torque)];
        let of_channels = || channels.into_iter().flatten().filter_map(|channel| channel.file.as_ref());
        let mut names: Vec<&String> = self.trajectories.iter().filter_map(|t| t.file.as_ref()).collect();
        let conditions = [&self.temperature, &self.load].into_iter().flatten();
        let of_conditions = conditions.filter_map(|condition| condition.file.as_ref());
        names.extend(of_channels().chain(of_time).chain(of_conditions));
        let mut files: Vec<(String, PathBuf)> = Vec::new();
        for name in names {
            let path = self.folder.join(name);
            let parts =
                if path.is_dir() { formats::files_of(&path, name).unwrap_or_default() } else { Vec::new() };
            let within = |part: &PathBuf| {
                let inside = part.strip_prefix(&path).unwrap_or(part).display().to_string();
                (format!("{name}/{inside}"), part.clone())
            };
            let all =
                if path.is_dir() { parts.iter().map(within).collect() } else { vec![(name.clone(), path)] };
            all.into_iter().for_each(|file| {
                if !files.contains(&file) {
                    files.push(file)
                }
            });
        }
        files
    }

    /// When the recording was made: the earliest header stamp with which its logs begin, s since 1970. `None` where no
    /// file says so.
    pub fn begun(&self) -> Option<i64> {
        let of_window = |window: &super::Window| {
            let name = window.file.as_ref().or(self.position.file.as_ref())?;
            let path = self.folder.join(name);
            let stamp =
                formats::is_log(&path).then(|| formats::begun(&path, name, window.topic.as_deref()))??;
            Some(stamp.div_euclid(1_000_000_000)).filter(|seconds| *seconds >= EARLIEST)
        };
        self.trajectories.iter().filter_map(of_window).min()
    }
}
