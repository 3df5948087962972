//! When a log begins, by the header stamp of its first message.

use std::path::Path;

use super::McapReader;
use crate::recording::formats::Wanted;

/// The header stamp of the first message of a topic, ns since 1970, as it stands; `None` where there is none.
pub(in crate::recording) fn begun(path: &Path, file: &str, topic: Option<&str>) -> Option<i64> {
    let wanted = Wanted { columns: &[], layout: &Default::default(), topic };
    let mut reader = McapReader::open(path, file, &wanted).ok()?;
    reader.next_signals(&mut Vec::new()).ok()?.filter(|stamp| *stamp != 0)
}
