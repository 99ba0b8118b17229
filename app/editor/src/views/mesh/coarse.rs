//! A rough version of a large surface, for pictures in motion where the processor draws them.
//!
//! Vertex clustering (J. Rossignac & P. Borrel, "Multi-resolution 3D approximations for rendering
//! complex scenes", 1993), each cell of a grid standing for its first vertex, so that a list of
//! indices is all that the rough version needs. Normals are not looked at: thin walls may merge.

use super::arrays::Arrays;

/// Surfaces with fewer faces are drawn as they are.
pub const FEW_FACES: usize = 150_000;

/// Cells along the longest side of the box.
const N_CELLS: f32 = 160.0;

/// Indices of the rough version, O(n); empty when the surface has few faces.
pub fn coarse_indices(arrays: &Arrays) -> Vec<u32> {
    if arrays.faces.len() < FEW_FACES {
        return Vec::new();
    }
    let first = first_of_cells(&arrays.positions);
    let faces = arrays.indices.as_chunks::<3>().0.iter();
    let faces = faces.map(|face| face.map(|vertex| first[vertex as usize]));
    let mut faces: Vec<[u32; 3]> =
        faces.filter(|[a, b, c]| a != b && b != c && c != a).map(rotated).collect();
    faces.sort_unstable();
    faces.dedup();
    faces.into_iter().flatten().collect()
}

/// The same face, beginning with its lowest vertex.
fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        low if low == a => [a, b, c],
        low if low == b => [b, c, a],
        _ => [c, a, b],
    }
}

/// For each vertex the first one in its cell.
fn first_of_cells(positions: &[[f32; 3]]) -> Vec<u32> {
    // Positions are within -1 and 1.
    let cell = |position: &[f32; 3]| {
        let [x, y, z] = position.map(|part| ((part + 1.0) * 0.5 * N_CELLS) as u32 & 0x3ff);
        x << 20 | y << 10 | z
    };
    let mut by_cell: Vec<(u32, u32)> =
        positions.iter().enumerate().map(|(at, position)| (cell(position), at as u32)).collect();
    by_cell.sort_unstable();
    let mut first = vec![0; positions.len()];
    for run in by_cell.chunk_by(|a, b| a.0 == b.0) {
        for (_, at) in run {
            first[*at as usize] = run[0].1;
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_modules::mesh::fixtures::{tetrahedron, torus};

    use super::super::arrays::{Sharing, arrays};
    use super::*;

    #[test]
    fn a_large_surface_has_a_rough_version_and_a_small_one_has_none() {
        let small = Arc::new(tetrahedron());
        let drawn = arrays(&small, 1.0, Sharing::Wedges).unwrap();
        assert!(coarse_indices(&drawn).is_empty());
        let large = Arc::new(torus(3.0, 1.0, 600));
        let drawn = arrays(&large, 1.0, Sharing::Wedges).unwrap();
        let coarse = coarse_indices(&drawn);
        let n_faces = coarse.len() / 3;
        assert!(n_faces > 10_000 && n_faces < drawn.faces.len() / 4, "{n_faces}");
        // What is left is a surface: as large as the ring, but for its steps.
        let point = |at: u32| glam::Vec3::from(drawn.positions[at as usize]);
        let area = |indices: &[u32]| -> f32 {
            let faces = indices.as_chunks::<3>().0.iter().map(|face| face.map(point));
            faces.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
        };
        let ratio = area(&coarse) / area(&drawn.indices);
        assert!((0.9..1.2).contains(&ratio), "{ratio}");
    }
}
