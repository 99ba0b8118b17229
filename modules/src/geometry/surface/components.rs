//! Parts of a surface that hang together, and which of them are small.

use glam::DVec3;
use mve_core::{Cancelled, Control};

use mve_mesh::data::{Domain, Layer, TriMesh, VertexId};
use mve_mesh::union_find::UnionFind;

/// Whether each face is of a small component: one whose box has a diagonal of at most `size`, in
/// model units. Faces that share a vertex are of one component; the largest, of equal ones the
/// first, is never small. Faces that name a vertex that is not there are of none.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn small_components(
    mesh: &TriMesh,
    size: f64,
    control: Control,
) -> Result<Vec<bool>, Cancelled> {
    let n_vertices = mesh.positions.len();
    let is_whole = |face: &[VertexId; 3]| face.iter().all(|v| v.idx() < n_vertices);
    let mut sets = UnionFind::new(n_vertices);
    for (at, face) in mesh.faces.iter().enumerate() {
        control.item(at, 2 * mesh.faces.len())?;
        if is_whole(face) {
            sets.union(face[0].0, face[1].0);
            sets.union(face[0].0, face[2].0);
        }
    }
    let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); n_vertices];
    for (at, face) in mesh.faces.iter().enumerate() {
        control.item(mesh.faces.len() + at, 2 * mesh.faces.len())?;
        if is_whole(face) {
            let (low, high) = &mut boxes[sets.find(face[0].0) as usize];
            for v in face {
                let position = mesh.positions[v.idx()];
                // What is nowhere makes no component larger.
                if position.is_finite() {
                    (*low, *high) = (low.min(position), high.max(position));
                }
            }
        }
    }
    let diagonals: Vec<f64> = boxes.iter().map(|(low, high)| (*high - *low).length()).collect();
    let is_there = |set: &usize| boxes[*set].0.x <= boxes[*set].1.x;
    let largest = (0..n_vertices)
        .filter(is_there)
        .reduce(|most, set| if diagonals[set] > diagonals[most] { set } else { most });
    let is_small = |face: &[VertexId; 3]| {
        if !is_whole(face) {
            return false;
        }
        let set = sets.find(face[0].0) as usize;
        Some(set) != largest && is_there(&set) && diagonals[set] <= size
    };
    Ok(mesh.faces.iter().map(is_small).collect())
}

/// The mesh without some of its faces; their vertices stay.
pub fn without_faces(mesh: &TriMesh, is_gone: &[bool]) -> TriMesh {
    let layer = |layer: &Layer| {
        let per_face = match layer.domain {
            Domain::Vertex => return layer.clone(),
            Domain::Face => 1,
            Domain::Corner => 3,
        };
        let index = layer.index.chunks(per_face).zip(is_gone);
        let index = index.filter(|(_, is_gone)| !**is_gone).flat_map(|(index, _)| index);
        Layer { index: index.copied().collect(), ..layer.clone() }
    };
    let faces = mesh.faces.iter().zip(is_gone).filter(|(_, is_gone)| !**is_gone);
    TriMesh {
        positions: mesh.positions.clone(),
        faces: faces.map(|(face, _)| *face).collect(),
        layers: mesh.layers.iter().map(layer).collect(),
        materials: mesh.materials.clone(),
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::LayerValues;
    use mve_mesh::fixtures::mesh_of;

    use super::*;

    /// Triangles with legs of 1, 3 and 2, apart from each other.
    fn three() -> TriMesh {
        let corner = |x: f64, leg: f64| [[x, 0.0, 0.0], [x + leg, 0.0, 0.0], [x, leg, 0.0]];
        let points = [corner(0.0, 1.0), corner(10.0, 3.0), corner(20.0, 2.0)].concat();
        mesh_of(&points, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]])
    }

    #[test]
    fn components_are_small_by_their_diagonals_and_the_largest_never_is() {
        let found = |size| small_components(&three(), size, Control::none()).unwrap();
        assert_eq!(found(1.4), [false, false, false]);
        assert_eq!(found(1.5), [true, false, false]);
        assert_eq!(found(100.0), [true, false, true]);
        let none = small_components(&TriMesh::default(), 1.0, Control::none()).unwrap();
        assert!(none.is_empty());
    }

    #[test]
    fn faces_go_with_what_layers_say_of_them() {
        let mut mesh = three();
        let numbers = |n: u32| LayerValues::Number((0..n).map(f64::from).collect());
        let layer = |name: &str, domain, n: u32| Layer {
            name: name.to_owned(),
            domain,
            values: numbers(n),
            index: (0..n).collect(),
        };
        mesh.layers = vec![
            layer("v", Domain::Vertex, 9),
            layer("f", Domain::Face, 3),
            layer("c", Domain::Corner, 9),
        ];
        let found = without_faces(&mesh, &[true, false, true]);
        assert_eq!(found.faces, [mesh.faces[1]]);
        let index: Vec<&[u32]> = found.layers.iter().map(|layer| &layer.index[..]).collect();
        assert_eq!(index, [&[0, 1, 2, 3, 4, 5, 6, 7, 8][..], &[1], &[3, 4, 5]]);
    }
}
