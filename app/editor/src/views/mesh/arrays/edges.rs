//! The edges of what is drawn, each once, for the lines over a surface and for counts.

use std::sync::Arc;

use mve_modules::data::TriMesh;
use rayon::prelude::*;

use crate::views::mesh::arrays::Arrays;

/// Edges as lines between drawn vertices.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// Pairs of drawn vertices; those of the border come first.
    pub indices: Arc<Vec<u32>>,
    /// Edges of exactly one face.
    pub n_border: usize,
    /// Edges of more than two faces.
    pub n_non_manifold: usize,
}

/// One face at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct EdgeUse {
    /// The two vertices of the mesh, the lower in the upper half.
    pub edge: u64,
    /// The place among the drawn indices of the corner that the edge goes from in this face.
    pub place: u32,
}

/// The sides of all edges; those of one edge follow each other. O(n log n) in faces.
pub fn sides_of(mesh: &TriMesh, drawn: &Arrays) -> Vec<EdgeUse> {
    let mut sides: Vec<EdgeUse> = (0..drawn.indices.len() as u32)
        .into_par_iter()
        .filter_map(|place| {
            let face = mesh.faces[drawn.faces[place as usize / 3] as usize];
            let k = place as usize % 3;
            let (a, b) = (face[k].0, face[(k + 1) % 3].0);
            let edge = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
            (a != b).then_some(EdgeUse { edge, place })
        })
        .collect();
    sides.par_sort_unstable();
    sides
}

/// The drawn vertices at the ends of an edge, as one of its faces has them.
pub fn ends_of(drawn: &Arrays, side: &EdgeUse) -> [u32; 2] {
    let (face, k) = (side.place / 3 * 3, side.place % 3);
    [face + k, face + (k + 1) % 3].map(|corner| drawn.indices[corner as usize])
}

/// Finds the edges, O(n log n) in faces.
pub fn edges(mesh: &TriMesh, drawn: &Arrays) -> Edges {
    let (mut border, mut inner) = (Vec::new(), Vec::new());
    let mut n_non_manifold = 0;
    for sides in sides_of(mesh, drawn).chunk_by(|a, b| a.edge == b.edge) {
        let ends = ends_of(drawn, &sides[0]);
        if sides.len() == 1 {
            border.extend(ends)
        } else {
            inner.extend(ends)
        }
        n_non_manifold += usize::from(sides.len() > 2);
    }
    let n_border = border.len() / 2;
    border.append(&mut inner);
    Edges { indices: Arc::new(border), n_border, n_non_manifold }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_modules::mesh::fixtures::{mesh_of, tetrahedron};

    use super::*;
    use crate::views::mesh::arrays::{CornerSharing, arrays};

    #[test]
    fn edges_are_found_once_and_borders_first() {
        let closed = Arc::new(tetrahedron());
        for sharing in [CornerSharing::Wedges, CornerSharing::Corners] {
            let found = edges(&closed, &arrays(&closed, 1.0, sharing).unwrap());
            assert_eq!((found.indices.len() / 2, found.n_border, found.n_non_manifold), (6, 0, 0));
        }
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
        let fan = mesh_of(&points, &[[0, 1, 2], [1, 0, 3], [0, 1, 4], [2, 2, 2]]);
        let fan = Arc::new(fan);
        let drawn = arrays(&fan, 4.0, CornerSharing::Wedges).unwrap();
        let found = edges(&fan, &drawn);
        assert_eq!((found.indices.len() / 2, found.n_border, found.n_non_manifold), (7, 6, 1));
        let last: Vec<usize> = found.indices[12..]
            .iter()
            .map(|&at| {
                let corner = drawn.corners[at as usize] as usize;
                fan.faces[corner / 3][corner % 3].idx()
            })
            .collect();
        assert_eq!(last, [0, 1]);
    }
}
