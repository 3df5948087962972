//! When a log begins, by the header stamp of its first message.

use std::path::Path;

use super::log::Log;
use super::message::{self, Kind};
use super::{chosen, files_of, topics_of, walk};

/// The header stamp of the first message of a topic, ns since 1970, as it stands; `None` where there is none.
pub(in crate::recording) fn begun(path: &Path, file: &str, topic: Option<&str>) -> Option<i64> {
    let paths = files_of(path, file).ok()?;
    let topics = topics_of(&paths).ok()?;
    let topic = chosen(file, &topics, topic, true).ok()?;
    let mut log = Log::open(file, topic.clone(), paths, Kind::of(&topic.kind).is_none()).ok()?;
    let received = log.next().ok()??;
    let data = log.data(&received);
    let stamp = match received.kind {
        Kind::Defined(k) => walk::signals(&log.definitions[k], data, 0).ok()?.1,
        kind => message::signals(kind, data, &mut Vec::new()).ok()?,
    };
    Some(stamp).filter(|stamp| *stamp != 0)
}
