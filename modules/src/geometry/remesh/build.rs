//! The working mesh of a remeshing, and the lines that it keeps.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId, Fans};
use mve_mesh::data::{FaceId, TriMesh, VertexId};
use mve_mesh::union_find::UnionFind;

use super::mesh::{FLAT, Kind, WorkMesh};
use crate::geometry::surface::normals::face_normals;

/// Which edges are kept as lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineOptions<'a> {
    /// Cosine of the angle between the normals of two faces from which their edge is sharp; `None`
    /// for no angle.
    pub most_cos: Option<f64>,
    /// Sharp lines that are shorter in all are none.
    pub shortest: f64,
    /// Whether an edge divides what layers say, by its number.
    pub is_seam: &'a [bool],
}

/// What an edge is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EdgeKind {
    Smooth,
    Sharp,
    Border,
    /// Of more than two faces, or of two that are turned against each other.
    Odd,
}

/// The working mesh, and the lines of the mesh as edges.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn build(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    options: &LineOptions,
    control: Control,
) -> Result<(WorkMesh, Vec<[VertexId; 2]>), Cancelled> {
    let kinds = edge_kinds(mesh, adjacency, options, control.part(0.0, 0.5))?;
    let is_line = |edge: EdgeId| edge != EdgeId::NONE && kinds[edge.idx()] != EdgeKind::Smooth;
    let mut work = WorkMesh {
        points: mesh.positions.clone(),
        kinds: vec![Kind::Free; mesh.positions.len()],
        faces: mesh.faces.iter().map(|face| face.map(|v| v.0)).collect(),
        lines: Vec::with_capacity(mesh.faces.len()),
        around: Vec::with_capacity(mesh.positions.len()),
    };
    for face in 0..mesh.faces.len() as u32 {
        work.lines.push(adjacency.edges_of(mve_mesh::data::FaceId(face)).map(is_line));
    }
    let mut at: Vec<Vec<EdgeId>> = vec![Vec::new(); mesh.positions.len()];
    let mut lines = Vec::new();
    for (place, ends) in adjacency.edges().iter().enumerate() {
        let edge = EdgeId(place as u32);
        if is_line(edge) {
            ends.iter().for_each(|v| at[v.idx()].push(edge));
            lines.push(*ends);
        }
    }
    let mut fans = Fans::default();
    for v in (0..mesh.positions.len() as u32).map(VertexId) {
        control.part(0.5, 1.0).item(v.idx(), mesh.positions.len())?;
        work.around.push(adjacency.faces_of(v).map(|face| face.0).collect());
        adjacency.fans(v, |_| true, &mut fans);
        let n_corners = adjacency.corners_of(v).len();
        let is_one = (0..n_corners).all(|corner| fans.group(corner) == 0);
        let turn = |ends: [EdgeId; 2]| {
            let [one, two] = ends.map(|edge| {
                let [a, b] = adjacency.edges()[edge.idx()];
                let other = if a == v { b } else { a };
                (mesh.positions[other.idx()] - mesh.positions[v.idx()]).normalize_or_zero()
            });
            -one.dot(two)
        };
        work.kinds[v.idx()] = match at[v.idx()].as_slice() {
            _ if !is_one => Kind::Fixed,
            [] => Kind::Free,
            &[one, two] if options.most_cos.is_some_and(|cos| turn([one, two]) < cos) => {
                Kind::Fixed
            }
            [one, two] => match [kinds[one.idx()], kinds[two.idx()]] {
                [EdgeKind::Sharp, EdgeKind::Sharp] => Kind::Line,
                [EdgeKind::Border, EdgeKind::Border] => Kind::Border,
                _ => Kind::Fixed,
            },
            _ => Kind::Fixed,
        };
    }
    Ok((work, lines))
}

fn edge_kinds(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    options: &LineOptions,
    control: Control,
) -> Result<Vec<EdgeKind>, Cancelled> {
    let mut normals = face_normals(mesh, control.part(0.0, 0.5))?;
    let control = control.part(0.5, 1.0);
    lend_normals(mesh, adjacency, &mut normals);
    let n_edges = adjacency.edges().len();
    let mut kinds = Vec::with_capacity(n_edges);
    for edge in (0..n_edges as u32).map(EdgeId) {
        control.item(edge.idx(), n_edges)?;
        let sides = adjacency.sides_of(edge);
        kinds.push(match sides {
            [_] => EdgeKind::Border,
            [a, b] if adjacency.is_oriented(mesh, edge) => {
                let [one, two] = [a, b].map(|side| normals[side.face().idx()]);
                let has_sides = one != DVec3::ZERO && two != DVec3::ZERO;
                let is_sharp = options.most_cos.is_some_and(|cos| one.dot(two) < cos);
                if has_sides && is_sharp { EdgeKind::Sharp } else { EdgeKind::Smooth }
            }
            _ => EdgeKind::Odd,
        });
    }
    drop_short_lines(mesh, adjacency, options.shortest, &mut kinds);
    for (kind, is_seam) in kinds.iter_mut().zip(options.is_seam) {
        if *is_seam && *kind == EdgeKind::Smooth {
            *kind = EdgeKind::Sharp;
        }
    }
    Ok(kinds)
}

/// Gives faces that are flat, whose own normal may be noise, that of the face across their longest
/// side, onto which they fall if they fall: the angles at their other sides are those of the
/// surface then.
fn lend_normals(mesh: &TriMesh, adjacency: &Adjacency, normals: &mut [DVec3]) {
    let flat = |f: FaceId| {
        let corners = mesh.corners(f);
        let length = |k: usize| corners[k].distance_squared(corners[(k + 1) % 3]);
        let long = (0..3).max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap_or(0);
        let [a, b, c] = corners;
        let height = (b - a).cross(c - a).length() / length(long);
        (height < FLAT).then_some(long)
    };
    let own = normals.to_vec();
    for f in (0..mesh.faces.len() as u32).map(FaceId) {
        let Some(long) = flat(f) else { continue };
        let edge = adjacency.edges_of(f)[long];
        if edge == EdgeId::NONE || !adjacency.is_oriented(mesh, edge) {
            continue;
        }
        let over = adjacency.sides_of(edge).iter().find(|side| side.face() != f);
        if let Some(over) = over.filter(|over| flat(over.face()).is_none()) {
            normals[f.idx()] = own[over.face().idx()];
        }
    }
}

/// Makes sharp lines smooth that are shorter than `shortest` in all and hang together with no
/// other line: noise, not a shape.
fn drop_short_lines(mesh: &TriMesh, adjacency: &Adjacency, shortest: f64, kinds: &mut [EdgeKind]) {
    let mut sets = UnionFind::new(mesh.positions.len());
    let lines = || adjacency.edges().iter().enumerate();
    for (edge, ends) in lines().filter(|(edge, _)| kinds[*edge] != EdgeKind::Smooth) {
        let _ = edge;
        sets.union(ends[0].0, ends[1].0);
    }
    let mut lengths = vec![0.0; mesh.positions.len()];
    for (edge, ends) in lines() {
        let length = mesh.positions[ends[0].idx()].distance(mesh.positions[ends[1].idx()]);
        lengths[sets.find(ends[0].0) as usize] += match kinds[edge] {
            EdgeKind::Smooth => 0.0,
            EdgeKind::Sharp => length,
            EdgeKind::Border | EdgeKind::Odd => f64::INFINITY,
        };
    }
    for (edge, ends) in lines() {
        if kinds[edge] == EdgeKind::Sharp && lengths[sets.find(ends[0].0) as usize] < shortest {
            kinds[edge] = EdgeKind::Smooth;
        }
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::cube;

    use super::*;
    use crate::geometry::generate::{CylinderOptions, cylinder};

    fn kinds(mesh: &TriMesh, degrees: f64, shortest: f64) -> ([usize; 4], usize) {
        let adjacency = Adjacency::new(mesh, Control::none()).unwrap();
        let most_cos = Some(degrees.to_radians().cos());
        let options = LineOptions { most_cos, shortest, is_seam: &[] };
        let (work, lines) = build(mesh, &adjacency, &options, Control::none()).unwrap();
        let count = |kind| work.kinds.iter().filter(|own| **own == kind).count();
        ([Kind::Free, Kind::Line, Kind::Border, Kind::Fixed].map(count), lines.len())
    }

    #[test]
    fn cubes_have_corners_and_cylinders_rims() {
        assert_eq!(kinds(&cube(DVec3::ZERO), 30.0, 0.0), ([0, 0, 0, 8], 12));
        let closed = cylinder(&CylinderOptions { height_segments: 3, ..CylinderOptions::DEFAULT });
        // 32 vertices a ring and two in the middles of the caps.
        assert_eq!(kinds(&closed, 30.0, 0.0), ([66, 64, 0, 0], 64));
        assert_eq!(kinds(&closed, 100.0, 0.0), ([130, 0, 0, 0], 0));
        // A rim is about π long.
        assert_eq!(kinds(&closed, 30.0, 3.2), ([130, 0, 0, 0], 0));
        let options = CylinderOptions { is_capped: false, ..CylinderOptions::DEFAULT };
        assert_eq!(kinds(&cylinder(&options), 30.0, 99.0), ([0, 0, 64, 0], 64));
    }

    #[test]
    fn what_is_not_manifold_is_fixed() {
        let points =
            [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
        let book = mve_mesh::fixtures::mesh_of(&points, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
        let ([_, _, border, fixed], n_lines) = kinds(&book, 170.0, 0.0);
        assert_eq!((border + fixed, n_lines), (5, 7));
        assert!(fixed >= 2);
    }
}
