//! Mesh files that a URDF names.

use std::path::{Path, PathBuf};

use dynid_runtime::regular_file;
use dynid_urdf::mesh_vertices;

/// Longest mesh that is read, bytes.
const LONGEST: u64 = 1 << 27;

/// The vertices of the mesh that the URDF at `urdf` calls `name`; or why there are none, in words.
///
/// # Errors
/// A file that is not found, too long or of another format.
pub fn vertices(urdf: &Path, name: &str) -> Result<Vec<[f64; 3]>, String> {
    let found = candidates(urdf, name).into_iter().find(|path| path.is_file());
    let Some(path) = found else { return Err("it is not found from the URDF's folder on".to_owned()) };
    let bytes = regular_file::read(&path, LONGEST).map_err(|error| error.to_string())?;
    mesh_vertices(name, &bytes)
}

/// Where the file may be: beside the URDF, or for `package://name/...` in a folder of that name which the URDF is in, or
/// which is beside one that it is in.
fn candidates(urdf: &Path, name: &str) -> Vec<PathBuf> {
    let absolute = std::path::absolute(urdf).unwrap_or_else(|_| urdf.to_owned());
    let folder = absolute.parent().unwrap_or(Path::new("/"));
    if let Some(path) = name.strip_prefix("file://") {
        return vec![folder.join(path)];
    }
    let Some(path) = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://")) else {
        return vec![folder.join(name)];
    };
    let (package, rest) = path.split_once('/').unwrap_or((path, ""));
    let within = |above: &Path| {
        let own = (above.file_name() == Some(package.as_ref())).then(|| above.join(rest));
        own.into_iter().chain([above.join(package).join(rest)]).collect::<Vec<_>>()
    };
    folder.ancestors().flat_map(within).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_looked_for_in_what_the_urdf_is_in() {
        let urdf = Path::new("/ws/src/arm_description/urdf/arm.urdf");
        let found = candidates(urdf, "package://arm_description/meshes/a.stl");
        assert!(found.contains(&PathBuf::from("/ws/src/arm_description/meshes/a.stl")), "{found:?}");
        let beside = candidates(urdf, "package://other/meshes/a.stl");
        assert!(beside.contains(&PathBuf::from("/ws/src/other/meshes/a.stl")), "{beside:?}");
        assert_eq!(candidates(urdf, "a.stl"), [PathBuf::from("/ws/src/arm_description/urdf/a.stl")]);
        assert_eq!(candidates(urdf, "file:///m/a.stl"), [PathBuf::from("/m/a.stl")]);
    }
}
