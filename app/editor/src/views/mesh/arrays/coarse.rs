//! A rough version of a large surface, for pictures in motion where the processor draws them.
//!
//! Vertex clustering (J. Rossignac & P. Borrel, "Multi-resolution 3D approximations for rendering
//! complex scenes", 1993), each cell of a grid standing for its first vertex. Normals are not
//! looked at: thin walls may merge.

use rayon::prelude::*;

use crate::views::mesh::arrays::{Arrays, CornerSharing};

/// Surfaces with fewer faces are drawn as they are.
pub const FEW_FACES: usize = 60_000;

/// Cells along each side of the cube around the surface; a few pixels each in a window.
const N_CELLS: usize = 100;

/// The rough version, made of drawn vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coarse {
    /// For each of its vertices the drawn vertex that lies where it does.
    pub places: Vec<u32>,
    /// For each of its vertices the drawn vertex whose normal and attribute it has.
    pub sources: Vec<u32>,
    /// Its faces, three vertices each.
    pub indices: Vec<u32>,
}

/// Makes the rough version, O(n log n); `None` when the surface has few faces.
pub fn coarse(arrays: &Arrays, sharing: CornerSharing) -> Option<Coarse> {
    if arrays.faces.len() < FEW_FACES {
        return None;
    }
    let first = first_of_cells(&arrays.positions);
    let corners = arrays.indices.as_chunks::<3>().0;
    // The vertices that stand for a face's, the lowest of them first, and the face.
    let clustered = |(face, corners): (usize, &[u32; 3])| {
        let [a, b, c] = corners.map(|vertex| first[vertex as usize]);
        let is_left = a != b && b != c && c != a;
        is_left.then(|| (rotated([a, b, c]), face as u32))
    };
    let mut faces: Vec<([u32; 3], u32)> =
        corners.par_iter().enumerate().filter_map(clustered).collect();
    faces.par_sort_unstable();
    faces.dedup_by_key(|(corners, _)| *corners);
    Some(match sharing {
        CornerSharing::Wedges => shared(&faces, first.len()),
        CornerSharing::Corners => apart(&faces, &first, corners),
    })
}

/// Faces that share vertices, each with what its place has.
fn shared(faces: &[([u32; 3], u32)], n_vertices: usize) -> Coarse {
    const NONE: u32 = u32::MAX;
    let mut names = vec![NONE; n_vertices];
    let mut coarse = Coarse::default();
    for vertex in faces.iter().flat_map(|(corners, _)| corners) {
        let name = &mut names[*vertex as usize];
        if *name == NONE {
            *name = coarse.places.len() as u32;
            coarse.places.push(*vertex);
        }
        coarse.indices.push(*name);
    }
    coarse.sources.clone_from(&coarse.places);
    coarse
}

/// Faces that share nothing, so that none takes over the color or the texture of its neighbor.
fn apart(faces: &[([u32; 3], u32)], first: &[u32], corners: &[[u32; 3]]) -> Coarse {
    let sources: Vec<u32> = faces.iter().flat_map(|(_, face)| corners[*face as usize]).collect();
    let places = sources.iter().map(|&vertex| first[vertex as usize]).collect();
    let indices = (0..sources.len() as u32).collect();
    Coarse { places, sources, indices }
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
    const NONE: u32 = u32::MAX;
    let low = positions.iter().flatten().copied().fold(f32::INFINITY, f32::min);
    let high = positions.iter().flatten().copied().fold(-f32::INFINITY, f32::max);
    let cells_per_unit = (N_CELLS - 1) as f32 / (high - low).max(f32::MIN_POSITIVE);
    let cell = |position: &[f32; 3]| {
        let place = |part: f32| (((part - low) * cells_per_unit) as usize).min(N_CELLS - 1);
        let [x, y, z] = position.map(place);
        (x * N_CELLS + y) * N_CELLS + z
    };
    let mut first = vec![NONE; N_CELLS * N_CELLS * N_CELLS];
    let stands_for = |(at, position): (usize, &[f32; 3])| {
        let first = &mut first[cell(position)];
        if *first == NONE {
            *first = at as u32;
        }
        *first
    };
    positions.iter().enumerate().map(stands_for).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_modules::mesh::fixtures::{tetrahedron, torus};

    use super::*;
    use crate::views::mesh::arrays::arrays;

    #[test]
    fn a_large_surface_has_a_rough_version_and_a_small_one_has_none() {
        let small = Arc::new(tetrahedron());
        let drawn = arrays(&small, 1.0, CornerSharing::Wedges).unwrap();
        assert_eq!(coarse(&drawn, CornerSharing::Wedges), None);
        let large = Arc::new(torus(3.0, 1.0, 600));
        for sharing in [CornerSharing::Wedges, CornerSharing::Corners] {
            let drawn = arrays(&large, 1.0, sharing).unwrap();
            let rough = coarse(&drawn, sharing).unwrap();
            let n_faces = rough.indices.len() / 3;
            assert!(n_faces > 10_000 && n_faces < drawn.faces.len() / 4, "{n_faces}");
            // What is left is a surface: as large as the ring, but for its steps.
            let point = |at: u32| glam::Vec3::from(drawn.positions[at as usize]);
            let area = |indices: &mut dyn Iterator<Item = [u32; 3]>| -> f32 {
                let faces = indices.map(|face| face.map(point));
                faces.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
            };
            let whole = area(&mut drawn.indices.as_chunks::<3>().0.iter().copied());
            let of_places = |face: &[u32; 3]| face.map(|at| rough.places[at as usize]);
            let kept = area(&mut rough.indices.as_chunks::<3>().0.iter().map(of_places));
            assert!((0.9..1.2).contains(&(kept / whole)), "{kept} of {whole}");
            // Normals and attributes are those of a vertex in the same cell.
            let is_near = |(place, source): (&u32, &u32)| {
                point(*place).distance(point(*source)) < 2.0 * 3f32.sqrt() / N_CELLS as f32
            };
            assert!(rough.places.iter().zip(&rough.sources).all(is_near));
        }
    }
}
