//! The edges of what is drawn, each once, for the lines over a surface and for counts.

use mve_modules::data::TriMesh;
use rayon::prelude::*;

use super::arrays::Arrays;

/// Edges as lines between drawn vertices.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// Pairs of drawn vertices; those of the border come first.
    pub indices: Vec<u32>,
    /// Edges of exactly one face.
    pub n_border: usize,
    /// Edges of more than two faces.
    pub n_non_manifold: usize,
}

/// Finds the edges, O(n log n) in faces.
pub fn edges(mesh: &TriMesh, drawn: &Arrays) -> Edges {
    // The two vertices, the lower first, as one number; and the place of the corner it goes from.
    let mut sides: Vec<(u64, u32)> = (0..drawn.indices.len() as u32)
        .into_par_iter()
        .filter_map(|place| {
            let face = mesh.faces[drawn.faces[place as usize / 3] as usize];
            let k = place as usize % 3;
            let (a, b) = (face[k].0, face[(k + 1) % 3].0);
            let key = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
            (a != b).then_some((key, place))
        })
        .collect();
    sides.par_sort_unstable();
    let line = |place: u32| {
        let (face, k) = (place / 3 * 3, place % 3);
        [face + k, face + (k + 1) % 3].map(|corner| drawn.indices[corner as usize])
    };
    let mut edges = Edges::default();
    let mut inner = Vec::new();
    for sides in sides.chunk_by(|a, b| a.0 == b.0) {
        let ends = line(sides[0].1);
        match sides.len() {
            1 => {
                edges.indices.extend(ends);
                edges.n_border += 1;
            }
            n => {
                inner.extend(ends);
                edges.n_non_manifold += usize::from(n > 2);
            }
        }
    }
    edges.indices.append(&mut inner);
    edges
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_modules::mesh::fixtures::{mesh_of, tetrahedron};

    use super::super::arrays::{Sharing, arrays};
    use super::*;

    #[test]
    fn edges_are_found_once_and_borders_first() {
        let closed = Arc::new(tetrahedron());
        for sharing in [Sharing::Wedges, Sharing::Corners] {
            let found = edges(&closed, &arrays(&closed, 1.0, sharing).unwrap());
            assert_eq!((found.indices.len() / 2, found.n_border, found.n_non_manifold), (6, 0, 0));
        }
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
        let fan = mesh_of(&points, &[[0, 1, 2], [1, 0, 3], [0, 1, 4], [2, 2, 2]]);
        let fan = Arc::new(fan);
        let drawn = arrays(&fan, 4.0, Sharing::Wedges).unwrap();
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
