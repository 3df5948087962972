//! Where a recording is: a path of this machine, or an address in an object store.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use futures::TryStreamExt;
use object_store::path::Path as StorePath;
use object_store::{ObjectMeta, ObjectStore, ObjectStoreExt};
use tokio::io::AsyncWriteExt;

use crate::error::{FleetError, Result};

/// A place of recordings.
#[derive(Clone)]
pub enum Folder {
    /// Of this machine.
    Local(PathBuf),
    /// Of an object store: its address without the path, the store, and the path within.
    Remote(String, Arc<dyn ObjectStore>, StorePath),
}

impl Folder {
    /// The folder of an address, `http://host/fleet`, `s3://bucket/fleet`, `file:///data/fleet`; or a path.
    ///
    /// # Errors
    /// An address that no store is built in for.
    pub fn of(text: &str) -> Result<Self> {
        if let Some(path) = text.strip_prefix("file://") {
            return Ok(Self::Local(PathBuf::from(path)));
        }
        let Some((scheme, rest)) = text.split_once("://") else {
            return Ok(Self::Local(PathBuf::from(text)));
        };
        let failed = |message: String| FleetError::Store { url: text.to_owned(), message };
        let (host, path) = rest.split_once('/').unwrap_or((rest, ""));
        let base = format!("{scheme}://{host}");
        let store = store(scheme, host, &base).map_err(failed)?;
        let path = StorePath::parse(path.trim_end_matches('/')).map_err(|error| failed(error.to_string()))?;
        Ok(Self::Remote(base, store, path))
    }

    /// What stands at a relative path in it: the address that [`Folder::of`] reads, or the path.
    pub fn at(&self, relative: &str) -> String {
        match self {
            Self::Local(folder) => folder.join(relative).display().to_string(),
            Self::Remote(base, _, path) => {
                let path = [path.as_ref(), relative].into_iter().filter(|p| !p.is_empty());
                format!("{base}/{}", path.collect::<Vec<_>>().join("/"))
            }
        }
    }

    /// Names of what it holds, sorted: folders and files.
    ///
    /// # Errors
    /// A folder or a store that cannot be listed, as a plain web server.
    pub async fn names(&self) -> Result<Vec<String>> {
        let mut names: Vec<String> = match self {
            Self::Local(folder) => {
                let listed = std::fs::read_dir(folder)
                    .map_err(|error| FleetError::io(folder, "list the recordings", &error))?;
                listed.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect()
            }
            Self::Remote(base, store, path) => {
                let listed = store.list_with_delimiter(Some(path)).await.map_err(|error| FleetError::Store {
                    url: format!("{base}/{path}"),
                    message: format!(
                        "it cannot be listed: {error}. A web server that lists nothing needs `recordings:` to be a table"
                    ),
                })?;
                let name = |path: &StorePath| path.filename().map(str::to_owned);
                let folders = listed.common_prefixes.iter().filter_map(name);
                folders.chain(listed.objects.iter().filter_map(|object| name(&object.location))).collect()
            }
        };
        names.sort_unstable();
        Ok(names)
    }

    /// What a store says of the object at a relative path; `None` of a folder of this machine, and where it says nothing.
    pub async fn meta(&self, relative: &str) -> Option<ObjectMeta> {
        let Self::Remote(_, store, path) = self else { return None };
        store.head(&below(path, relative).ok()?).await.ok()
    }

    /// Brings the object at a relative path into a file, block by block; what its store says of it.
    ///
    /// # Errors
    /// What the store or the file system says.
    pub async fn download(&self, relative: &str, to: &Path) -> Result<Option<ObjectMeta>> {
        let Self::Remote(base, store, path) = self else {
            let from = PathBuf::from(self.at(relative));
            return match tokio::fs::copy(&from, to).await {
                Ok(_) => Ok(None),
                Err(error) => Err(FleetError::io(&from, "read it", &error)),
            };
        };
        let url = self.at(relative);
        let failed = |message: String| FleetError::Store { url: url.clone(), message };
        let whole = below(path, relative).map_err(|error| failed(error.to_string()))?;
        let answer = store.get(&whole).await.map_err(|error| failed(said(base, &error)))?;
        let write = |error: std::io::Error| FleetError::io(to, "write it", &error);
        let mut file = tokio::fs::File::create(to).await.map_err(write)?;
        let meta = answer.meta.clone();
        let mut blocks = answer.into_stream();
        while let Some(block) = blocks.try_next().await.map_err(|error| failed(said(base, &error)))? {
            file.write_all(&block).await.map_err(write)?;
        }
        file.flush().await.map_err(write)?;
        Ok(Some(meta))
    }
}

/// A relative path beneath one of a store.
fn below(path: &StorePath, relative: &str) -> std::result::Result<StorePath, object_store::path::Error> {
    let parts = [path.as_ref(), relative].into_iter().filter(|p| !p.is_empty());
    StorePath::parse(parts.collect::<Vec<_>>().join("/"))
}

fn said(base: &str, error: &object_store::Error) -> String {
    match error {
        object_store::Error::NotFound { .. } => format!("there is no such object at {base}"),
        other => other.to_string(),
    }
}

// What a feature adds stands before what is said without it.
#[allow(unused_variables, unreachable_patterns)]
fn store(scheme: &str, host: &str, base: &str) -> std::result::Result<Arc<dyn ObjectStore>, String> {
    match scheme {
        #[cfg(feature = "http")]
        "http" | "https" => {
            let options = object_store::ClientOptions::new().with_allow_http(true);
            let built =
                object_store::http::HttpBuilder::new().with_url(base).with_client_options(options).build();
            built.map(|store| Arc::new(store) as Arc<dyn ObjectStore>).map_err(|error| error.to_string())
        }
        #[cfg(feature = "s3")]
        "s3" => {
            let built = object_store::aws::AmazonS3Builder::from_env().with_bucket_name(host).build();
            built.map(|store| Arc::new(store) as Arc<dyn ObjectStore>).map_err(|error| error.to_string())
        }
        #[cfg(feature = "gs")]
        "gs" => {
            let built =
                object_store::gcp::GoogleCloudStorageBuilder::from_env().with_bucket_name(host).build();
            built.map(|store| Arc::new(store) as Arc<dyn ObjectStore>).map_err(|error| error.to_string())
        }
        #[cfg(feature = "az")]
        "az" => {
            let built =
                object_store::azure::MicrosoftAzureBuilder::from_env().with_container_name(host).build();
            built.map(|store| Arc::new(store) as Arc<dyn ObjectStore>).map_err(|error| error.to_string())
        }
        #[cfg(not(all(feature = "http", feature = "s3", feature = "gs", feature = "az")))]
        known @ ("http" | "https" | "s3" | "gs" | "az") => {
            let feature = if known == "https" { "http" } else { known };
            Err(format!("this dynid-fleet was built without {known}: build it with --features {feature}"))
        }
        other => Err(format!("`{other}` is no kind of store; known are file, http, https, s3, gs and az")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_paths_keep_their_kind() {
        let at = |folder: &str| Folder::of(folder).map(|folder| folder.at("a/b.yaml"));
        assert_eq!(at("/data").ok().as_deref(), Some("/data/a/b.yaml"));
        assert_eq!(at("file:///data").ok().as_deref(), Some("/data/a/b.yaml"));
        assert_eq!(at("http://host:80/x/").ok().as_deref(), Some("http://host:80/x/a/b.yaml"));
        assert_eq!(at("http://host").ok().as_deref(), Some("http://host/a/b.yaml"));
        let said = at("ftp://host/x").err().map(|error| error.to_string());
        assert!(said.is_some_and(|said| said.contains("known are file, http")));
    }
}
