//! What is to do: recordings to reduce, days to work out.

use std::collections::BTreeMap;

use super::day::{self, Known};
use super::folder::OutFolder;
use crate::day::Day;
use crate::error::Result;
use crate::stamp::replaced;
use crate::work::Item;

/// What a run does.
#[derive(Debug, Default)]
pub struct Todo<'a> {
    /// Recordings to reduce.
    pub missing: Vec<&'a Item>,
    /// Of these, those that were reduced before and have other files now.
    pub replaced: Vec<&'a Item>,
    /// Days to work out, ascending.
    pub days: Vec<Day>,
}

/// A day that has recordings: what was reduced of them, and whether the day was worked out with all of that.
struct Had {
    known: Known,
    done: bool,
}

/// Compares the recordings of days with what is kept of them. A recording is missing where nothing is kept under its key, or
/// what is kept is of other files than there are now.
///
/// # Errors
/// A table that is none.
pub async fn of<'a>(out: &OutFolder, by_day: &BTreeMap<Day, Vec<&'a Item>>) -> Result<Todo<'a>> {
    let pending = out.all_pending();
    let mut all = BTreeMap::new();
    let mut stamps = BTreeMap::new();
    for (&one, items) in by_day {
        let keys: Vec<String> = items.iter().map(|item| item.key()).collect();
        let mut known = day::done(out, one)?;
        let done = keys.iter().all(|key| known.contains_key(key) && !pending.contains(key));
        if !done {
            known = day::reduced(out, one)?;
            for key in keys.iter().filter(|key| pending.contains(*key)) {
                known.append(&mut day::pending(out, key)?);
            }
        }
        let files = keys.into_iter().filter_map(|key| Some((known.get(&key)?.clone()?, key)));
        stamps.extend(files.map(|(files, key)| (key, files)));
        all.insert(one, Had { known, done });
    }
    let old = replaced(stamps).await;
    let mut todo = Todo::default();
    for (one, items) in by_day {
        let Some(had) = all.get(one) else { continue };
        let is_old = |item: &&&Item| old.contains(&item.key());
        todo.replaced.extend(items.iter().filter(is_old));
        let before = todo.missing.len();
        todo.missing.extend(items.iter().filter(|item| is_old(item) || !had.known.contains_key(&item.key())));
        if !had.done || todo.missing.len() > before {
            todo.days.push(*one);
        }
    }
    Ok(todo)
}
