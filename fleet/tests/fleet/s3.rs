//! Recordings in an object store that speaks S3, of a server that the environment names; `docs/fleet.md` has the command.

use std::path::Path;

use object_store::aws::AmazonS3Builder;
use object_store::path::Path as StorePath;
use object_store::{ObjectStore, ObjectStoreExt};

use crate::common::{Fleet, parquet_files, runtime};

/// The bucket, which must be there.
const BUCKET: &str = "fleet";

/// Puts a folder into the bucket.
fn put(store: &dyn ObjectStore, folder: &Path, prefix: &str) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let name = format!("{prefix}/{}", entry.file_name().to_str().unwrap());
        if entry.path().is_dir() {
            put(store, &entry.path(), &name);
        } else {
            let bytes = std::fs::read(entry.path()).unwrap();
            runtime().block_on(store.put(&StorePath::from(name), bytes.into())).unwrap();
        }
    }
}

#[test]
#[ignore = "needs an S3 server and its address and credentials in the environment"]
fn recordings_in_a_bucket_give_the_same_files_and_are_noticed_when_they_are_replaced() {
    let store = AmazonS3Builder::from_env().with_bucket_name(BUCKET).build().unwrap();
    let fleet = Fleet::new(2, 2);
    let (local, remote) = (fleet.out("local"), fleet.out("remote"));
    fleet.run(&local);
    // A name of its own: what earlier runs put there stays.
    let prefix = fleet.folder.path().file_name().unwrap().to_str().unwrap().replace('.', "");
    put(&store, &fleet.folder.path().join("logs"), &format!("{prefix}/logs"));
    fleet.write(&format!(
        "recordings: logs/{{robot}}/{{day}}/recording.yaml\nstore: s3://{BUCKET}/{prefix}\ndiagnosis: {{enabled: false}}\n"
    ));
    let first = fleet.run(&remote);
    assert_eq!((first.recordings, first.reduced, first.outcomes.used), (4, 4, 4));
    let parameters = |out: &Path| {
        let mut files = parquet_files(out);
        files.retain(|name, _| name.starts_with("parameters/"));
        files
    };
    assert_eq!(parameters(&local).len(), 2);
    assert_eq!(parameters(&local), parameters(&remote));
    assert_eq!(fleet.run(&remote).reduced, 0);
    put(&store, &fleet.recording("r002", 2), &format!("{prefix}/logs/r001/2026-03-02"));
    let again = fleet.run(&remote);
    assert_eq!((again.reduced, again.replaced, again.days), (1, 1, 1));
}
