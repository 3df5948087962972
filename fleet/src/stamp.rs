//! Whether the files of a recording are those that were read.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::UNIX_EPOCH;

use futures::StreamExt;
use object_store::ObjectMeta;

use crate::place::Folder;

/// Stamp of a file that could not be read.
const ABSENT: &str = "-";

/// Objects that are asked for at a time.
const ASKED: usize = 32;

/// The files of a recording with what distinguishes a file from another one under the same name: size and time of its last
/// change, in an object store its entity tag where it has one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stamps(BTreeMap<String, String>);

impl Stamps {
    /// Takes in a file of this machine as it is now, before it is read.
    pub fn add_local(&mut self, path: &Path) {
        let stamp = local(path).unwrap_or_else(|| ABSENT.to_owned());
        self.0.insert(path.display().to_string(), stamp);
    }

    /// Takes in an object by its address; `None` where it could not be read.
    pub fn add_remote(&mut self, address: &str, meta: Option<&ObjectMeta>) {
        self.0.insert(address.to_owned(), meta.map_or_else(|| ABSENT.to_owned(), remote));
    }

    /// As it is kept in tables; `None` where no file is known.
    pub fn to_text(&self) -> Option<String> {
        let lines: Vec<String> = self.0.iter().map(|(name, stamp)| format!("{stamp}\t{name}")).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }

    /// From [`Stamps::to_text`]. Lines that are none are passed over.
    pub fn from_text(text: &str) -> Self {
        let pair =
            |line: &str| line.split_once('\t').map(|(stamp, name)| (name.to_owned(), stamp.to_owned()));
        Self(text.lines().filter_map(pair).collect())
    }

    /// Whether one of the files is there and is another one now. What is not there any more, or cannot be asked for, tells
    /// nothing.
    async fn are_old(&self, stores: &Stores) -> bool {
        for (name, stamp) in &self.0 {
            let now = match in_store(name) {
                Some((base, path)) => stores.asked(base, path).await,
                None => local(Path::new(name)),
            };
            if now.is_some_and(|now| now != *stamp) {
                return true;
            }
        }
        false
    }
}

fn local(path: &Path) -> Option<String> {
    let metadata = std::fs::metadata(path).ok()?;
    // Of a folder of a log its entries' files have stamps of their own.
    let size = if metadata.is_dir() { 0 } else { metadata.len() };
    let changed = metadata.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Some(format!("{size} {}", changed.as_nanos()))
}

fn remote(meta: &ObjectMeta) -> String {
    match &meta.e_tag {
        Some(tag) => format!("{} {tag}", meta.size),
        None => format!("{} {}", meta.size, meta.last_modified.timestamp_micros()),
    }
}

/// The address of a store, and the path within it; `None` of a path of this machine.
fn in_store(address: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = address.split_once("://")?;
    let host = rest.split('/').next()?.len();
    let base = scheme.len() + 3 + host;
    Some((&address[..base], address[base..].trim_start_matches('/')))
}

/// Stores by their addresses: a client of one takes much longer to make than to ask.
#[derive(Default)]
struct Stores(BTreeMap<String, Folder>);

impl Stores {
    /// Those of some recordings. One that cannot be had is none, and tells nothing.
    fn of<'a>(recordings: impl Iterator<Item = &'a Stamps>) -> Self {
        let files = recordings.flat_map(|stamps| stamps.0.keys());
        let bases: BTreeSet<&str> = files.filter_map(|name| Some(in_store(name)?.0)).collect();
        Self(bases.into_iter().filter_map(|base| Some((base.to_owned(), Folder::of(base).ok()?))).collect())
    }

    async fn asked(&self, base: &str, path: &str) -> Option<String> {
        self.0.get(base)?.meta(path).await.as_ref().map(remote)
    }
}

/// Of recordings with their stamps as texts those of which a file was replaced.
pub async fn replaced(known: BTreeMap<String, String>) -> BTreeSet<String> {
    let known: BTreeMap<String, Stamps> =
        known.into_iter().map(|(key, text)| (key, Stamps::from_text(&text))).collect();
    let stores = &Stores::of(known.values());
    let one = |(key, stamps): (String, Stamps)| async move { stamps.are_old(stores).await.then_some(key) };
    futures::stream::iter(known)
        .map(one)
        .buffer_unordered(ASKED)
        .filter_map(std::future::ready)
        .collect()
        .await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_store_and_a_path_within() {
        assert_eq!(in_store("s3://bucket/a/b.yaml"), Some(("s3://bucket", "a/b.yaml")));
        assert_eq!(in_store("http://host:80"), Some(("http://host:80", "")));
        assert_eq!(in_store("/data/a.yaml"), None);
    }

    #[tokio::test]
    async fn a_file_with_another_size_or_time_is_another_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let (one, two) = (folder.path().join("one"), folder.path().join("two"));
        std::fs::write(&one, "a").expect("a file");
        let mut stamps = Stamps::default();
        stamps.add_local(&one);
        stamps.add_local(&two);
        let stamps = Stamps::from_text(&stamps.to_text().expect("two lines"));
        assert!(!stamps.are_old(&Stores::default()).await);
        // What was not there has come.
        std::fs::write(&two, "b").expect("a file");
        assert!(stamps.are_old(&Stores::default()).await);
        std::fs::remove_file(&two).expect("removed");
        assert!(!stamps.are_old(&Stores::default()).await);
        let changed = std::fs::metadata(&one).and_then(|m| m.modified()).expect("a time");
        std::fs::write(&one, "ab").expect("a file");
        std::fs::File::options().write(true).open(&one).and_then(|f| f.set_modified(changed)).expect("set");
        assert!(stamps.are_old(&Stores::default()).await, "the same time, another size");
        std::fs::remove_file(&one).expect("removed");
        assert!(!stamps.are_old(&Stores::default()).await, "what is gone tells nothing");
        assert_eq!(Stamps::default().to_text(), None);
    }
}
