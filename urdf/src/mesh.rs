//! Vertices of triangle meshes: STL, binary and ASCII, and OBJ.
//!
//! Only where the vertices are matters: what encloses them encloses the triangles.

/// Bytes before the triangles of a binary STL, of each triangle, and of its normal.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
const NORMAL: usize = 12;

/// The vertices of a mesh whose file has this name.
///
/// ```
/// let stl = b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
/// assert_eq!(dynid_urdf::mesh_vertices("part.STL", stl)?.len(), 3);
/// assert!(dynid_urdf::mesh_vertices("part.dae", b"<COLLADA/>").is_err());
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
/// In words: a format that is not read, a file that is cut or that has no vertices.
pub fn mesh_vertices(file: &str, bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let lower = file.to_ascii_lowercase();
    let vertices = if lower.ends_with(".stl") {
        stl(bytes)?
    } else if lower.ends_with(".obj") {
        lines_of(bytes, "v")?
    } else {
        return Err("only STL and OBJ meshes are read".to_owned());
    };
    if vertices.is_empty() {
        return Err("the mesh has no vertices".to_owned());
    }
    match vertices.iter().flatten().all(|x| x.is_finite()) {
        true => Ok(vertices),
        false => Err("a vertex of the mesh is not finite".to_owned()),
    }
}

fn stl(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    // Binary files may begin with "solid" too; the number of triangles tells.
    let count = bytes.get(80..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let expected = count.and_then(|n| (n as usize).checked_mul(TRIANGLE)?.checked_add(HEADER));
    if expected.is_some_and(|length| length <= bytes.len()) && !is_ascii_stl(bytes)
        || expected == Some(bytes.len())
    {
        let triangles = bytes[HEADER..].chunks_exact(TRIANGLE).take(count.unwrap_or(0) as usize);
        return Ok(triangles
            .flat_map(|triangle| triangle[NORMAL..NORMAL + 36].chunks_exact(12).map(vertex))
            .collect());
    }
    if is_ascii_stl(bytes) {
        return lines_of(bytes, "vertex");
    }
    Err("the mesh is cut, or no STL".to_owned())
}

fn is_ascii_stl(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"solid") && bytes.windows(5).take(4096).any(|w| w == b"facet")
}

/// Three little-endian floats.
fn vertex(bytes: &[u8]) -> [f64; 3] {
    let float = |k: usize| {
        let mut raw = [0; 4];
        raw.copy_from_slice(&bytes[4 * k..4 * k + 4]);
        f64::from(f32::from_le_bytes(raw))
    };
    [float(0), float(1), float(2)]
}

/// The first three numbers of each line that begins with a word.
fn lines_of(bytes: &[u8], word: &str) -> Result<Vec<[f64; 3]>, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut vertices = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        if words.next() != Some(word) {
            continue;
        }
        let numbers: Option<Vec<f64>> = words.take(3).map(|w| w.parse().ok()).collect();
        let vertex = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok());
        vertices.push(vertex.ok_or_else(|| format!("line {} of the mesh is no vertex", at + 1))?);
    }
    Ok(vertices)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary(title: &[u8], triangles: &[[f32; 9]]) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        bytes[..title.len()].copy_from_slice(title);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; NORMAL]);
            triangle.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn binary_files_are_read_whatever_their_title_says() {
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.5];
        for title in [&b"made by hand"[..], b"solid but with facet in its title"] {
            let found = mesh_vertices("a.stl", &binary(title, &[corners, corners]));
            assert_eq!(found.as_ref().map(Vec::len), Ok(6));
            assert_eq!(found.map(|v| v[2]), Ok([0.0, 2.0, 0.5]));
        }
    }

    #[test]
    fn what_is_cut_or_no_mesh_is_told() {
        let whole = binary(b"part", &[[1.0; 9]]);
        for bytes in [&whole[..100], &whole[..10], b"", b"solid facet\nvertex 1 2\n"] {
            assert!(mesh_vertices("a.stl", bytes).is_err());
        }
        assert!(mesh_vertices("a.stl", &binary(b"part", &[[f32::NAN; 9]])).is_err());
        assert_eq!(mesh_vertices("a.obj", b"# o\nv 1 2 3\nvn 0 0 1\nv 4 5 6 1\n").map(|v| v.len()), Ok(2));
    }
}
