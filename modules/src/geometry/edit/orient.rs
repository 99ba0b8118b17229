//! Makes the faces of a mesh look the same way, and those of closed parts outwards.

use mve_core::{Cancelled, Control};

use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, TriMesh};

/// What was found and done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Oriented {
    /// Whether each face is to be turned over.
    pub is_turned: Vec<bool>,
    /// Parts of the surface that hang together over edges of two faces.
    pub n_components: usize,
    /// Closed ones among them that can be oriented.
    pub n_closed: usize,
    /// Those with one side only, like a Möbius strip.
    pub n_one_sided: usize,
    /// Edges in those whose two faces still look different ways.
    pub n_turned_edges: usize,
    /// Edges of more than two faces, across which nothing is decided.
    pub n_non_manifold_edges: usize,
}

/// Decides which faces to turn over, O(n log n).
///
/// Within a component, faces that share an edge of exactly two faces come to run along it in
/// opposite directions. As few faces as possible are turned, and the first face stays where there
/// are as many of both; with `is_outward` closed components come to have a positive volume instead.
/// In a one-sided component some edges stay turned, those that a walk from its first face meets
/// last.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn orient(mesh: &TriMesh, is_outward: bool, control: Control) -> Result<Oriented, Cancelled> {
    let adjacency = Adjacency::new(mesh, control.part(0.0, 0.5))?;
    let edges = || (0..adjacency.edges().len() as u32).map(EdgeId);
    let n_faces = mesh.faces.len();
    let mut found = Oriented {
        is_turned: vec![false; n_faces],
        n_non_manifold_edges: edges().filter(|&e| adjacency.sides_of(e).len() > 2).count(),
        ..Oriented::default()
    };
    let control = control.part(0.5, 1.0);
    let mut is_reached = vec![false; n_faces];
    let mut component: Vec<FaceId> = Vec::new();
    let mut n_done = 0;
    for first in (0..n_faces as u32).map(FaceId) {
        if is_reached[first.idx()] {
            continue;
        }
        component.clear();
        component.push(first);
        is_reached[first.idx()] = true;
        let (mut is_closed, mut n_conflicts, mut at) = (true, 0, 0);
        while let Some(&face) = component.get(at) {
            control.item(n_done, n_faces)?;
            (at, n_done) = (at + 1, n_done + 1);
            for edge in adjacency.edges_of(face) {
                let Some(other) = across(&adjacency, face, edge) else {
                    is_closed = false;
                    continue;
                };
                let is_other = adjacency.is_oriented(mesh, edge) == found.is_turned[face.idx()];
                if !is_reached[other.idx()] {
                    is_reached[other.idx()] = true;
                    found.is_turned[other.idx()] = is_other;
                    component.push(other);
                } else if found.is_turned[other.idx()] != is_other {
                    n_conflicts += 1;
                }
            }
        }
        found.n_components += 1;
        // Each edge is met from both of its faces.
        found.n_turned_edges += n_conflicts / 2;
        found.n_one_sided += usize::from(n_conflicts > 0);
        let is_inside_out = if is_closed && n_conflicts == 0 {
            found.n_closed += 1;
            is_outward.then(|| volume(mesh, &component, &found.is_turned)).filter(|v| *v != 0.0)
        } else {
            None
        };
        let n_turned = component.iter().filter(|face| found.is_turned[face.idx()]).count();
        let is_wrong = is_inside_out.map_or(2 * n_turned > component.len(), |volume| volume < 0.0);
        if is_wrong {
            component.iter().for_each(|face| found.is_turned[face.idx()] ^= true);
        }
    }
    Ok(found)
}

/// The other face at an edge of exactly two different ones.
fn across(adjacency: &Adjacency, face: FaceId, edge: EdgeId) -> Option<FaceId> {
    if edge == EdgeId::NONE {
        return None;
    }
    match adjacency.sides_of(edge) {
        [a, b] if a.face() != b.face() => Some(if a.face() == face { b.face() } else { a.face() }),
        _ => None,
    }
}

/// The volume within some faces, some of which are turned over; 0 where it is not finite.
fn volume(mesh: &TriMesh, faces: &[FaceId], is_turned: &[bool]) -> f64 {
    // From a vertex of the part, not the origin: far models would lose their digits.
    let Some([start, ..]) = faces.first().map(|&face| mesh.corners(face)) else { return 0.0 };
    let of_face = |&face: &FaceId| {
        let [a, b, c] = mesh.corners(face).map(|p| p - start);
        let six_volumes = a.dot(b.cross(c));
        if is_turned[face.idx()] { -six_volumes } else { six_volumes }
    };
    let sum: f64 = faces.iter().map(of_face).sum();
    if sum.is_finite() { sum } else { 0.0 }
}

/// The mesh with some faces turned over, as `(a, c, b)`. What layers say of corners goes along;
/// normals of turned corners point the other way, those of vertices where all faces were turned.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn turned(
    mut mesh: TriMesh,
    is_turned: &[bool],
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let mut is_vertex_turned = vec![true; mesh.positions.len()];
    for (face, _) in mesh.faces.iter().zip(is_turned).filter(|(_, is_turned)| !**is_turned) {
        face.iter().for_each(|v| is_vertex_turned[v.idx()] = false);
    }
    // Vertices without a face have nothing that was turned.
    let mut has_face = vec![false; mesh.positions.len()];
    mesh.faces.iter().flatten().for_each(|v| has_face[v.idx()] = true);
    is_vertex_turned.iter_mut().zip(has_face).for_each(|(is, has)| *is &= has);
    let places = is_turned.iter().enumerate().filter(|(_, is_turned)| **is_turned);
    let faces: Vec<usize> = places.map(|(face, _)| face).collect();
    faces.iter().for_each(|&face| mesh.faces[face].swap(1, 2));
    for layer in &mut mesh.layers {
        control.at(0.5)?;
        let is_normal = layer.name == Layer::NORMAL;
        match layer.domain {
            Domain::Corner => {
                faces.iter().for_each(|&face| layer.index.swap(3 * face + 1, 3 * face + 2));
                if is_normal {
                    reverse(layer, |corner| is_turned[corner / 3]);
                }
            }
            Domain::Vertex if is_normal => reverse(layer, |vertex| is_vertex_turned[vertex]),
            Domain::Face if is_normal => reverse(layer, |face| is_turned[face]),
            _ => {}
        }
    }
    Ok(mesh)
}

/// Gives some elements of a layer the opposite of their vectors; elements that shared one still do.
fn reverse(layer: &mut Layer, is_reversed: impl Fn(usize) -> bool) {
    let LayerValues::Vec3(values) = &mut layer.values else { return };
    let mut opposites = vec![u32::MAX; values.len()];
    for (element, value) in layer.index.iter_mut().enumerate() {
        let Some(opposite) = opposites.get_mut(*value as usize).filter(|_| is_reversed(element))
        else {
            continue;
        };
        if *opposite == u32::MAX {
            *opposite = values.len() as u32;
            values.push(-values[*value as usize]);
        }
        *value = *opposite;
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::data::VertexId;
    use mve_mesh::fixtures::{cube, mesh_of, torus};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::{any_mesh, layered_square};

    fn oriented(mesh: &TriMesh, is_outward: bool) -> (TriMesh, Oriented) {
        let found = orient(mesh, is_outward, Control::none()).unwrap();
        (turned(mesh.clone(), &found.is_turned, Control::none()).unwrap(), found)
    }

    /// Turns over every face whose number gives no rest by some number.
    fn mixed(mut mesh: TriMesh, by: usize) -> TriMesh {
        mesh.faces.iter_mut().step_by(by).for_each(|face| face.swap(1, 2));
        mesh
    }

    #[test]
    fn closed_parts_come_to_look_outwards() {
        let mut mesh = mixed(cube(DVec3::ZERO), 3);
        let other = mixed(cube(DVec3::splat(1e6)), 1);
        mesh.positions.extend(other.positions);
        mesh.faces.extend(other.faces.iter().map(|f| f.map(|v| VertexId(v.0 + 8))));
        let (found, facts) = oriented(&mesh, true);
        assert_eq!(facts.is_turned.iter().filter(|is| **is).count(), 4 + 12);
        assert_eq!((facts.n_components, facts.n_closed, facts.n_one_sided), (2, 2, 0));
        let mut first = found;
        first.faces.truncate(12);
        assert_eq!(first.signed_volume(), 1.0);
        // Consistent alone: the cube that was inside out as a whole stays as it is.
        let (_, facts) = oriented(&mesh, false);
        assert_eq!(facts.is_turned.iter().filter(|is| **is).count(), 4);
    }

    #[test]
    fn an_open_part_turns_as_few_faces_as_it_can() {
        let mut mesh = torus(2.0, 0.5, 12);
        mesh.faces.truncate(200);
        let (found, facts) = oriented(&mixed(mesh.clone(), 3), true);
        assert_eq!((found, facts.n_closed), (mesh, 0));
    }

    /// Five triangles in a ring with a twist.
    #[test]
    fn a_moebius_strip_is_said_to_have_one_side() {
        let faces: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
        let points: Vec<[f64; 3]> =
            (0..5_u32).map(|i| [f64::from(i), f64::from(i * i), f64::from(i % 2)]).collect();
        let (_, facts) = oriented(&mesh_of(&points, &faces), true);
        assert_eq!((facts.n_components, facts.n_one_sided, facts.n_turned_edges), (1, 1, 1));
    }

    #[test]
    fn nothing_is_decided_across_an_edge_of_three_faces() {
        let mesh = mesh_of(&[[0.0; 3]; 5], &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]);
        let facts = oriented(&mesh, true).1;
        assert_eq!((facts.n_components, facts.n_non_manifold_edges), (3, 1));
        assert_eq!(facts.is_turned, [false; 3]);
    }

    #[test]
    fn values_of_corners_go_along_and_normals_turn() {
        let mesh = layered_square();
        let one = turned(mesh.clone(), &[true, false], Control::none()).unwrap();
        assert_eq!(one.layer(Layer::TEXCOORD).unwrap().index, [0, 2, 1, 3, 4, 5]);
        // Vertex 1 alone has only faces that were turned.
        let normals = one.layer(Layer::NORMAL).unwrap();
        assert_eq!(normals.index, [0, 1, 0, 0]);
        assert_eq!(normals.values, LayerValues::Vec3(vec![DVec3::Z, DVec3::NEG_Z]));
    }

    proptest! {
        #[test]
        fn twice_is_once_for_any_mesh(mesh in any_mesh(), is_outward in any::<bool>()) {
            let (once, facts) = oriented(&mesh, is_outward);
            prop_assert_eq!(once.check(), Ok(()));
            let (_, again) = oriented(&once, is_outward);
            if facts.n_one_sided == 0 {
                prop_assert!(again.is_turned.iter().all(|is| !is), "{:?}", facts);
            }
        }
    }
}
