//! The edges of a mesh along which its surface or its texture ends: borders, and seams, where the
//! two faces of an edge have different texture coordinates at one of its ends.

use std::sync::Arc;

use glam::DVec2;
use mve_modules::data::{Domain, Layer, LayerValues, TriMesh};

use super::Overlay;
use crate::views::mesh::arrays::Arrays;
use crate::views::mesh::arrays::edges::{EdgeUse, ends_of, sides_of};
use crate::views::mesh::lines::{LineIndices, LineSet};
use crate::views::mesh::look::settings::{Switch, SwitchHome};

/// The overlay of seams and borders.
#[derive(Default)]
pub struct Seams;

static LINES: LineSet = LineSet {
    color: [0.80, 0.10, 0.65, 1.0],
    fades: false,
    find: |mesh, drawn, _| {
        let pairs = seams(mesh, drawn);
        LineIndices { n_indices: pairs.len(), pairs: Arc::new(pairs) }
    },
};

impl Overlay for Seams {
    fn switch(&self) -> Option<Switch> {
        Some(Switch {
            label: "Seams and borders",
            doc: "Edges where texture coordinates are cut, and edges of one face, in purple",
            home: SwitchHome::Menu,
            key: None,
            place: |settings| settings.switch("seams"),
        })
    }

    fn lines(&self) -> Option<&'static LineSet> {
        Some(&LINES)
    }
}

/// The ends of seams and of border edges, as pairs of drawn vertices; O(n log n) in faces.
fn seams(mesh: &TriMesh, drawn: &Arrays) -> Vec<u32> {
    let coords = corner_texcoords(mesh);
    let sides = sides_of(mesh, drawn);
    let is_cut = |sides: &[EdgeUse]| match sides {
        [_] => true,
        [first, rest @ ..] => {
            let of_first = coords_of_side(mesh, drawn, &coords, first);
            rest.iter().any(|side| coords_of_side(mesh, drawn, &coords, side) != of_first)
        }
        [] => false,
    };
    let edges = sides.chunk_by(|a, b| a.edge == b.edge);
    edges.filter(|sides| is_cut(sides)).flat_map(|sides| ends_of(drawn, &sides[0])).collect()
}

/// Coordinates by corner; `None` for a mesh that has none, or one a vertex, which no edge cuts.
type CornerTexcoords<'a> = Option<(&'a [DVec2], &'a [u32])>;

fn corner_texcoords(mesh: &TriMesh) -> CornerTexcoords<'_> {
    match mesh.layer(Layer::TEXCOORD)? {
        Layer { values: LayerValues::Vec2(coords), domain: Domain::Corner, index, .. } => {
            Some((coords, index))
        }
        _ => None,
    }
}

/// The coordinates that a face has at the two ends of an edge, at the lower vertex first. A corner
/// without a coordinate has none in common with one that has.
fn coords_of_side(
    mesh: &TriMesh,
    drawn: &Arrays,
    coords: &CornerTexcoords,
    side: &EdgeUse,
) -> [Option<DVec2>; 2] {
    let (face, k) = (drawn.faces[side.place as usize / 3] as usize, side.place as usize % 3);
    let next = (k + 1) % 3;
    let [low, high] = match mesh.faces[face][k] < mesh.faces[face][next] {
        true => [k, next],
        false => [next, k],
    };
    [low, high].map(|k| {
        let (values, index) = coords.as_ref()?;
        values.get(*index.get(3 * face + k)? as usize).copied()
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::DVec3;
    use mve_modules::mesh::fixtures::cube;

    use super::*;
    use crate::views::mesh::arrays::{CornerSharing, arrays};

    /// The edges that are found, as pairs of vertices, the lower one first.
    fn found(mesh: &TriMesh) -> BTreeSet<[u32; 2]> {
        let mesh = Arc::new(mesh.clone());
        let drawn = arrays(&mesh, 1.0, CornerSharing::Wedges).unwrap();
        let vertex = |drawn_vertex: u32| {
            let corner = drawn.corners[drawn_vertex as usize] as usize;
            mesh.faces[corner / 3][corner % 3].0
        };
        let lines = seams(&mesh, &drawn);
        let edge = |pair: &[u32]| {
            let (a, b) = (vertex(pair[0]), vertex(pair[1]));
            [a.min(b), a.max(b)]
        };
        let edges: BTreeSet<_> = lines.chunks(2).map(edge).collect();
        assert_eq!(2 * edges.len(), lines.len(), "each once");
        edges
    }

    /// Whether an edge lies along an axis; the others of a box are diagonals of its sides.
    fn is_along_axis(mesh: &TriMesh, [a, b]: [u32; 2]) -> bool {
        let along = mesh.positions[b as usize] - mesh.positions[a as usize];
        along.to_array().iter().filter(|part| **part != 0.0).count() == 1
    }

    /// A box with coordinates at each corner of a face by the side that the face is on.
    fn box_with(coord: impl Fn(usize, DVec3) -> DVec2) -> TriMesh {
        let mut mesh = cube(DVec3::ONE);
        let mut values = Vec::new();
        for face in &mesh.faces {
            let corners = face.map(|vertex| mesh.positions[vertex.idx()]);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let axis = (0..3).find(|&axis| normal[axis] != 0.0).unwrap();
            let side = 2 * axis + usize::from(normal[axis] > 0.0);
            values.extend(corners.map(|corner| coord(side, corner)));
        }
        let index = (0..values.len() as u32).collect();
        let (name, values) = (Layer::TEXCOORD.to_owned(), LayerValues::Vec2(values));
        mesh.set_layer(Layer { name, domain: Domain::Corner, values, index });
        mesh
    }

    #[test]
    fn a_box_unfolded_to_six_squares_is_cut_along_its_twelve_edges() {
        let mesh = box_with(|side, at| DVec2::new(side as f64 + at.x, at.y + 10.0 * at.z));
        let edges = found(&mesh);
        assert_eq!(edges.len(), 12);
        assert!(edges.iter().all(|&edge| is_along_axis(&mesh, edge)), "{edges:?}");
    }

    #[test]
    fn one_side_by_itself_is_cut_along_its_four_edges() {
        // Equal coordinates at entries of their own are no cut.
        let mesh = box_with(|side, at| match side {
            5 => DVec2::new(7.0, 7.0),
            _ => DVec2::new(at.x + 10.0 * at.z, at.y),
        });
        let edges = found(&mesh);
        assert_eq!(edges.len(), 4);
        let top = mesh.positions.iter().map(|point| point.z).fold(f64::MIN, f64::max);
        assert!(edges.iter().flatten().all(|&at| mesh.positions[at as usize].z == top));
    }

    #[test]
    fn a_mesh_without_coordinates_has_borders_only() {
        let mut mesh = cube(DVec3::ONE);
        assert_eq!(found(&mesh).len(), 0);
        let [a, b, c] = mesh.faces.remove(0).map(|vertex| vertex.0);
        let sorted = |a: u32, b: u32| [a.min(b), a.max(b)];
        assert_eq!(found(&mesh), [sorted(a, b), sorted(b, c), sorted(c, a)].into());
    }
}
