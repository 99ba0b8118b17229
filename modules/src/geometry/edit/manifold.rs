//! Makes a surface manifold: by cutting it open where parts of it meet, or by leaving faces out.
//!
//! Source of the cuts: A. Guéziec, G. Taubin, F. Lazarus and B. Horn, "Cutting and stitching:
//! converting sets of polygons to manifold surfaces", IEEE TVCG 7(2), 2001, section 4.1 (the local
//! method: marked edges, and a copy of a vertex for each group of its faces that unmarked edges
//! join). Around a vertex such a group is a row of faces with two ends, so that no more than two of
//! its faces can have one marked edge.

use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId, Fans};
use mve_mesh::data::{FaceId, TriMesh, VertexId};

use super::rebuild::{Draft, Origin};
use crate::geometry::surface::components::without_faces;

/// What becomes of what is not manifold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repair {
    /// It stays.
    Kept,
    /// The surface is cut open there.
    Split,
    /// Faces are left out until it is manifold.
    Removed,
}

/// A mesh after a repair.
#[derive(Clone, Debug)]
pub struct Repaired {
    /// The mesh.
    pub mesh: TriMesh,
    /// Edges, or vertices, that were not manifold.
    pub n_found: usize,
    /// Vertices that there are more now.
    pub n_copies: usize,
    /// Faces that there are fewer now.
    pub n_removed: usize,
}

/// Repairs edges of more than two faces. With [`Repair::Removed`] the smallest faces at such an
/// edge go, of equal ones the last. With any but [`Repair::Kept`] no such edge is left.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn repair_edges(
    mesh: TriMesh,
    repair: Repair,
    control: Control,
) -> Result<Repaired, Cancelled> {
    let adjacency = Adjacency::new(&mesh, control.part(0.0, 0.3))?;
    let edges = || (0..adjacency.edges().len() as u32).map(EdgeId);
    let n_found = edges().filter(|&edge| adjacency.sides_of(edge).len() > 2).count();
    let mut repaired = Repaired { mesh, n_found, n_copies: 0, n_removed: 0 };
    if n_found == 0 || repair == Repair::Kept {
        return Ok(repaired);
    }
    if repair == Repair::Removed {
        let is_gone = superfluous(&repaired.mesh, control.part(0.3, 0.8))?;
        leave_out(&mut repaired, &is_gone, control.part(0.8, 1.0))?;
    } else {
        let mesh = &repaired.mesh;
        let mut is_at = vec![false; mesh.positions.len()];
        for edge in edges().filter(|&edge| adjacency.sides_of(edge).len() > 2) {
            adjacency.edges()[edge.idx()].iter().for_each(|v| is_at[v.idx()] = true);
        }
        let is_link = |edge| adjacency.sides_of(edge).len() <= 2;
        let part = control.part(0.3, 1.0);
        let cut = split_fans(mesh, &adjacency, is_link, |v| is_at[v.idx()], part)?;
        repaired.n_copies = cut.positions.len() - mesh.positions.len();
        repaired.mesh = cut;
    }
    Ok(repaired)
}

/// Repairs vertices whose faces are in several groups that share no edge there. With
/// [`Repair::Removed`] the group with the most faces stays, of equal ones the first.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn repair_vertices(
    mesh: TriMesh,
    repair: Repair,
    control: Control,
) -> Result<Repaired, Cancelled> {
    let adjacency = Adjacency::new(&mesh, control.part(0.0, 0.3))?;
    let (n_found, is_gone) = smaller_fans(&mesh, &adjacency, control.part(0.3, 0.5))?;
    let mut repaired = Repaired { mesh, n_found, n_copies: 0, n_removed: 0 };
    match repair {
        _ if n_found == 0 => {}
        Repair::Kept => {}
        Repair::Split => {
            let mesh = &repaired.mesh;
            let part = control.part(0.5, 1.0);
            let cut = split_fans(mesh, &adjacency, |_| true, |_| true, part)?;
            repaired.n_copies = cut.positions.len() - mesh.positions.len();
            repaired.mesh = cut;
        }
        Repair::Removed => {
            let mut is_gone = is_gone;
            // What goes may part the faces at another vertex.
            while is_gone.contains(&true) {
                leave_out(&mut repaired, &is_gone, control.part(0.5, 0.6))?;
                let adjacency = Adjacency::new(&repaired.mesh, control.part(0.6, 0.8))?;
                is_gone = smaller_fans(&repaired.mesh, &adjacency, control.part(0.8, 1.0))?.1;
            }
        }
    }
    Ok(repaired)
}

fn leave_out(repaired: &mut Repaired, is_gone: &[bool], control: Control) -> Result<(), Cancelled> {
    let n_gone = is_gone.iter().filter(|is| **is).count();
    if n_gone > 0 {
        repaired.n_removed += n_gone;
        control.at(0.0)?;
        repaired.mesh = without_faces(&repaired.mesh, is_gone);
    }
    Ok(())
}

/// Gives each group of faces at some vertices a copy of its own. The group of the first face keeps
/// the vertex; copies come behind all vertices, by vertex and first face.
fn split_fans(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    is_link: impl Fn(EdgeId) -> bool,
    is_split: impl Fn(VertexId) -> bool,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let mut draft = Draft::of_vertices(mesh);
    (0..mesh.faces.len() as u32).for_each(|face| draft.push_face(mesh, face));
    let mut fans = Fans::default();
    let mut copies: Vec<VertexId> = Vec::new();
    for vertex in (0..mesh.positions.len() as u32).map(VertexId).filter(|&v| is_split(v)) {
        control.part(0.0, 0.5).item(vertex.idx(), mesh.positions.len())?;
        let corners = adjacency.corners_of(vertex);
        adjacency.fans(vertex, &is_link, &mut fans);
        copies.clear();
        for (at, &corner) in corners.iter().enumerate() {
            let group = fans.group(at);
            let copy = match group {
                0 => vertex,
                group if group < at => copies[group],
                _ => {
                    draft.positions.push(mesh.positions[vertex.idx()]);
                    draft.vertices.push(Origin::Of(vertex.0));
                    VertexId(draft.positions.len() as u32 - 1)
                }
            };
            copies.push(copy);
            draft.faces[corner as usize / 3][corner as usize % 3] = copy;
        }
    }
    draft.finish(mesh, control.part(0.5, 1.0))
}

/// The smallest faces at edges of more than two, without which each has two.
fn superfluous(mesh: &TriMesh, control: Control) -> Result<Vec<bool>, Cancelled> {
    let adjacency = Adjacency::new(mesh, control)?;
    let mut n_living: Vec<usize> = (0..adjacency.edges().len() as u32)
        .map(|edge| adjacency.sides_of(EdgeId(edge)).len())
        .collect();
    let edges_of =
        |face: FaceId| adjacency.edges_of(face).into_iter().filter(|edge| *edge != EdgeId::NONE);
    let area = |face: FaceId| {
        let [a, b, c] = mesh.corners(face);
        let area = (b - a).cross(c - a).length();
        if area.is_finite() { area } else { 0.0 }
    };
    let all = (0..mesh.faces.len() as u32).map(FaceId);
    let is_at = |face: &FaceId| edges_of(*face).any(|edge| n_living[edge.idx()] > 2);
    let mut faces: Vec<(f64, FaceId)> = all.filter(is_at).map(|face| (area(face), face)).collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let mut is_gone = vec![false; mesh.faces.len()];
    for (_, face) in faces {
        if edges_of(face).any(|edge| n_living[edge.idx()] > 2) {
            is_gone[face.idx()] = true;
            edges_of(face).for_each(|edge| n_living[edge.idx()] -= 1);
        }
    }
    Ok(is_gone)
}

/// How many vertices have faces in several groups, and the faces of all groups but the largest.
fn smaller_fans(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<(usize, Vec<bool>), Cancelled> {
    let mut fans = Fans::default();
    let mut sizes: Vec<usize> = Vec::new();
    let (mut n_found, mut is_gone) = (0, vec![false; mesh.faces.len()]);
    for vertex in (0..mesh.positions.len() as u32).map(VertexId) {
        control.item(vertex.idx(), mesh.positions.len())?;
        let corners = adjacency.corners_of(vertex);
        adjacency.fans(vertex, |_| true, &mut fans);
        sizes.clear();
        sizes.resize(corners.len(), 0);
        (0..corners.len()).for_each(|at| sizes[fans.group(at)] += 1);
        let Some(most) = sizes.iter().copied().max().filter(|most| *most < corners.len()) else {
            continue;
        };
        n_found += 1;
        let largest = sizes.iter().position(|size| *size == most);
        for (at, &corner) in corners.iter().enumerate() {
            is_gone[corner as usize / 3] |= Some(fans.group(at)) != largest;
        }
    }
    Ok((n_found, is_gone))
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of};

    use super::*;
    use crate::geometry::surface::mesh_info::mesh_info;

    /// Three triangles at the edge 0–1, of areas 1/2, 1 and 3/2.
    fn book() -> TriMesh {
        let points =
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [0.0, -3.0, 0.0]];
        mesh_of(&points, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]])
    }

    #[test]
    fn an_edge_of_three_faces_is_cut_open() {
        let found = repair_edges(book(), Repair::Split, Control::none()).unwrap();
        assert_eq!((found.n_found, found.n_copies, found.n_removed), (1, 4, 0));
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert_eq!((info.n_non_manifold_edges, info.n_components_by_edge), (0, 3));
        assert_eq!(found.mesh.area(), book().area());
    }

    #[test]
    fn or_loses_its_smallest_face() {
        let found = repair_edges(book(), Repair::Removed, Control::none()).unwrap();
        assert_eq!((found.n_copies, found.n_removed, found.mesh.area()), (0, 1, 2.5));
        let kept = repair_edges(book(), Repair::Kept, Control::none()).unwrap();
        assert_eq!((kept.n_found, kept.mesh), (1, book()));
    }

    /// Two cubes that share an edge are two cubes once they are cut apart.
    #[test]
    fn cubes_at_an_edge_come_apart() {
        let mut mesh = cube(glam::DVec3::ZERO);
        let other = cube(glam::DVec3::new(1.0, 1.0, 0.0));
        // Its vertices 0 and 4 are the first one's 3 and 7.
        let number = |v: VertexId| match v.0 {
            0 => VertexId(3),
            4 => VertexId(7),
            other => VertexId(8 + other),
        };
        mesh.positions.extend(other.positions);
        mesh.faces.extend(other.faces.iter().map(|face| face.map(number)));
        let found = repair_edges(mesh, Repair::Split, Control::none()).unwrap();
        assert_eq!((found.n_found, found.n_copies, found.n_removed), (1, 2, 0));
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert!(info.is_manifold() && info.is_closed() && info.is_oriented());
        assert_eq!((info.n_components_by_edge, info.volume), (2, Some(2.0)));
    }

    /// A face that lies on another one is cut off, as is that one: nothing says which is the cube.
    #[test]
    fn a_doubled_face_comes_off() {
        let mut mesh = cube(glam::DVec3::ZERO);
        mesh.faces.push(mesh.faces[0]);
        let found = repair_edges(mesh, Repair::Split, Control::none()).unwrap();
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert_eq!((found.n_found, found.n_copies, found.n_removed), (3, 6, 0));
        assert_eq!((info.n_non_manifold_edges, info.n_components_by_edge), (0, 3));
    }

    #[test]
    fn triangles_at_a_point_come_apart_or_one_stays() {
        let points =
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let mesh = mesh_of(&points, &[[0, 1, 2], [0, 3, 4]]);
        let found = repair_vertices(mesh.clone(), Repair::Split, Control::none()).unwrap();
        assert_eq!((found.n_found, found.n_copies), (1, 1));
        assert_eq!(found.mesh.faces[1].map(|v| v.0), [5, 3, 4]);
        let found = repair_vertices(mesh.clone(), Repair::Removed, Control::none()).unwrap();
        assert_eq!((found.n_removed, &found.mesh.faces[..]), (1, &mesh.faces[..1]));
    }
}
