//! Files of triangles, one a line as nine numbers: three coordinates for each corner.
//!
//! Say where the format is described, and what of it is left out. Any bytes may be read: they give
//! a mesh or an error, in memory that grows with their number alone.

use glam::DVec3;
use mve_core::Control;

use crate::data::{TriMesh, VertexId};

/// Lines that are read between two looks at the control.
const LINES_AT_ONCE: usize = 1 << 12;

/// Reads a file; each triangle has vertices of its own.
///
/// # Errors
/// What is wrong with the file, as a sentence; or that `control` ended it.
pub fn read_template(bytes: &[u8], control: Control) -> Result<TriMesh, String> {
    let text = str::from_utf8(bytes).map_err(|_| "it is not a text".to_owned())?;
    let n_lines = text.lines().count();
    let mut mesh = TriMesh::default();
    for (place, line) in text.lines().enumerate() {
        if place % LINES_AT_ONCE == 0 {
            let cancelled = control.at(place as f64 / n_lines as f64);
            cancelled.map_err(|cancelled| cancelled.to_string())?;
        }
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.len() == 9);
        let numbers = numbers.ok_or_else(|| format!("line {} is not nine numbers", place + 1))?;
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(numbers.chunks_exact(3).map(DVec3::from_slice));
        mesh.faces.push([0, 1, 2].map(|corner| VertexId(first + corner)));
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_read_and_wrong_lines_named() {
        let read = |text: &str| read_template(text.as_bytes(), Control::none());
        let mesh = read("0 0 0 2 0 0 0 3 0\n0 0 0 0 3 0 0 0 4\n").unwrap();
        assert_eq!((mesh.faces.len(), mesh.area()), (2, 3.0 + 6.0));
        assert_eq!(read("0 0 0 1 0 0 0 1 0\n0 0 x\n").unwrap_err(), "line 2 is not nine numbers");
        assert_eq!(read("").unwrap(), TriMesh::default());
    }
}
