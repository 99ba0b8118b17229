//! Closes holes of a surface by triangles between the vertices of their borders.
//!
//! Sources: G. Barequet and M. Sharir, "Filling gaps in the boundary of a polyhedron", Computer
//! Aided Geometric Design 12(2), 1995, section 3, for the least triangulation of a polygon in space
//! by dynamic programming; P. Liepa, "Filling holes in meshes", Symposium on Geometry Processing
//! 2003, section 3, for the weight: the sharpest edge first, then the area. Departures: angles are
//! compared by their cosines; no edge is made that the mesh has already, so that none comes to have
//! three faces; no vertices are added (Liepa's refinement and fairing).

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{FaceId, TriMesh, VertexId};

use super::rebuild::{Draft, Origin};

/// What makes one filling of a hole better than another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoleWeight {
    /// The least area (Barequet and Sharir).
    Area,
    /// The least angle at its sharpest edge, those of the border among them; then the area (Liepa).
    Angle,
}

/// A mesh whose holes were filled.
#[derive(Clone, Debug)]
pub struct Filled {
    /// The mesh: its own faces in their order, then the new ones, hole by hole.
    pub mesh: TriMesh,
    /// Holes that were filled.
    pub n_filled: usize,
    /// Holes with more edges than were allowed.
    pub n_too_long: usize,
    /// Holes that cannot be filled: their border runs into edges of three faces or turned ones,
    /// has points that are not finite, or the mesh has all edges that a filling would need.
    pub n_unfillable: usize,
}

/// Fills all holes of at most `max_edges` edges; the border of an open surface is a hole, too.
/// O(n³) for a hole of n edges.
///
/// A border that meets itself at a vertex is several holes. New faces are oriented as their
/// neighbors. At each corner they have the values of the face at the border there, and of that face
/// its material, group and the like.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn fill_holes(
    mesh: &TriMesh,
    max_edges: usize,
    weight: HoleWeight,
    control: Control,
) -> Result<Filled, Cancelled> {
    let adjacency = Adjacency::new(mesh, control.part(0.0, 0.2))?;
    let (holes, mut n_unfillable) = holes(mesh, &adjacency, control.part(0.2, 0.3))?;
    let mut draft = Draft::of_vertices(mesh);
    (0..mesh.faces.len() as u32).for_each(|face| draft.push_face(mesh, face));
    // Edges that are made for one hole must not be made again for another one.
    let mut made: HashSet<[VertexId; 2]> = HashSet::new();
    let (mut n_filled, mut n_too_long) = (0, 0);
    for (place, hole) in holes.iter().enumerate() {
        let share = |place: usize| 0.3 + 0.6 * place as f64 / holes.len() as f64;
        let part = control.part(share(place), share(place + 1));
        if hole.len() > max_edges {
            n_too_long += 1;
            continue;
        }
        let is_taken = |a: VertexId, b: VertexId| {
            let ends = [a.min(b), a.max(b)];
            made.contains(&ends) || has_edge(mesh, &adjacency, ends)
        };
        let Some(pieces) = triangulated(mesh, hole, weight, is_taken, part)? else {
            n_unfillable += 1;
            continue;
        };
        n_filled += 1;
        for places in pieces {
            let vertices = places.map(|at| hole[at].vertex(mesh));
            for (k, &one) in vertices.iter().enumerate() {
                let two = vertices[(k + 1) % 3];
                made.insert([one.min(two), one.max(two)]);
            }
            draft.faces.push(vertices);
            draft.corners.push(places.map(|at| Origin::Of(hole[at].corner)));
            draft.sources.push(hole[places[0]].corner / 3);
        }
    }
    let mesh = draft.finish(mesh, control.part(0.9, 1.0))?;
    Ok(Filled { mesh, n_filled, n_too_long, n_unfillable })
}

/// A vertex of a hole: the corner of the face at the border from it to the vertex before it.
#[derive(Clone, Copy, Debug)]
struct Rim {
    corner: u32,
}

impl Rim {
    fn vertex(self, mesh: &TriMesh) -> VertexId {
        mesh.faces[self.corner as usize / 3][self.corner as usize % 3]
    }

    fn face(self) -> FaceId {
        FaceId(self.corner / 3)
    }
}

/// The holes, each as its vertices in the order of the faces that will fill it, without a vertex
/// twice; and how many borders lead nowhere.
fn holes(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<(Vec<Vec<Rim>>, usize), Cancelled> {
    let n_corners = 3 * mesh.faces.len();
    let edge_at = |corner: usize| adjacency.edges_of(FaceId(corner as u32 / 3))[corner % 3];
    let is_border = |corner: usize| {
        let edge = edge_at(corner);
        edge != EdgeId::NONE && adjacency.sides_of(edge).len() == 1
    };
    let mut is_seen = vec![false; n_corners];
    let (mut holes, mut n_dead) = (Vec::new(), 0);
    for start in 0..n_corners {
        control.item(start, n_corners)?;
        if is_seen[start] || !is_border(start) {
            continue;
        }
        let mut border = Vec::new();
        let mut at = Some(start);
        while let Some(corner) = at.filter(|corner| !is_seen[*corner]) {
            is_seen[corner] = true;
            border.push(Rim { corner: corner as u32 });
            at = next_border(mesh, adjacency, corner);
        }
        match at {
            Some(corner) if corner == start => simple_holes(mesh, border, &mut holes),
            _ => n_dead += 1,
        }
    }
    Ok((holes, n_dead))
}

/// The border side that ends where this one starts, around the faces of that vertex; `None` where
/// an edge on the way has not two faces that look the same way.
fn next_border(mesh: &TriMesh, adjacency: &Adjacency, side: usize) -> Option<usize> {
    let mut face = side / 3;
    // The side before the one that starts at the vertex ends there.
    let mut before = (side % 3 + 2) % 3;
    for _ in 0..=mesh.faces.len() {
        let edge = adjacency.edges_of(FaceId(face as u32))[before];
        if edge == EdgeId::NONE {
            return None;
        }
        match adjacency.sides_of(edge) {
            [_] => return Some(3 * face + before),
            [a, b] if a.face() != b.face() && adjacency.is_oriented(mesh, edge) => {
                let other = if a.face().idx() == face { b } else { a };
                face = other.face().idx();
                // There the side starts at the vertex; the one before it ends there.
                before = (other.corner() + 2) % 3;
            }
            _ => return None,
        }
    }
    None
}

/// Cuts a border at vertices that it meets again, into holes that have each vertex once.
fn simple_holes(mesh: &TriMesh, border: Vec<Rim>, holes: &mut Vec<Vec<Rim>>) {
    let mut open: Vec<Rim> = Vec::with_capacity(border.len());
    let mut place_of: HashMap<VertexId, usize> = HashMap::new();
    for rim in border {
        let vertex = rim.vertex(mesh);
        if let Some(&place) = place_of.get(&vertex) {
            // Each stands with its side to the one before it: within the part that is cut off that
            // is the side by which the vertex was met again.
            let mut inner = vec![rim];
            inner.extend(open.drain(place + 1..));
            inner[1..].iter().for_each(|rim| _ = place_of.remove(&rim.vertex(mesh)));
            holes.push(inner);
        } else {
            place_of.insert(vertex, open.len());
            open.push(rim);
        }
    }
    holes.push(open);
}

fn has_edge(mesh: &TriMesh, adjacency: &Adjacency, ends: [VertexId; 2]) -> bool {
    let mut corners = adjacency.corners_of(ends[0]).iter();
    corners.any(|corner| mesh.faces[*corner as usize / 3].contains(&ends[1]))
}

/// How bad a filling is: the least cosine at an edge, and the area.
#[derive(Clone, Copy, Debug)]
struct Badness {
    sharpest: f64,
    area: f64,
}

impl Badness {
    const NONE: Self = Self { sharpest: 1.0, area: 0.0 };

    fn plus(self, other: Self) -> Self {
        Self { sharpest: self.sharpest.min(other.sharpest), area: self.area + other.area }
    }

    fn is_better(self, other: Self, weight: HoleWeight) -> bool {
        match weight {
            HoleWeight::Area => self.area < other.area,
            // Rounding must not decide between angles before areas do.
            HoleWeight::Angle if (self.sharpest - other.sharpest).abs() > 1e-12 => {
                self.sharpest > other.sharpest
            }
            HoleWeight::Angle => self.area < other.area,
        }
    }
}

/// The best filling of a part of a hole, and the corner of its triangle at the closing edge.
type Part = Option<(Badness, usize)>;

/// The best triangulation of a hole, as places in it; `None` where there is none.
fn triangulated(
    mesh: &TriMesh,
    hole: &[Rim],
    weight: HoleWeight,
    is_taken: impl Fn(VertexId, VertexId) -> bool,
    control: Control,
) -> Result<Option<Vec<[usize; 3]>>, Cancelled> {
    let n = hole.len();
    let vertices: Vec<VertexId> = hole.iter().map(|rim| rim.vertex(mesh)).collect();
    let points: Vec<DVec3> = vertices.iter().map(|v| mesh.positions[v.idx()]).collect();
    if n < 3 || !points.iter().all(|p| p.is_finite()) || is_back(mesh, hole, &vertices) {
        return Ok(None);
    }
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let unit = |v: DVec3| v.try_normalize().unwrap_or(DVec3::ZERO);
    // Between the places k − 1 and k lies the border side that starts at k.
    let beside: Vec<DVec3> =
        hole.iter().map(|rim| unit(normal(mesh.corners(rim.face())))).collect();
    let mut parts: Vec<Part> = vec![None; n * n];
    (1..n).for_each(|k| parts[(k - 1) * n + k] = Some((Badness::NONE, 0)));
    for gap in 2..n {
        // All triangles of the shorter gaps stand; their number grows with the gap.
        let done = (gap as f64 / n as f64).powi(2);
        for i in 0..n - gap {
            if i % 32 == 0 {
                control.at(done)?;
            }
            let k = i + gap;
            if gap + 1 < n && is_taken(vertices[i], vertices[k]) {
                continue;
            }
            let mut best: Part = None;
            for m in i + 1..k {
                let (Some(one), Some(two)) = (parts[i * n + m], parts[m * n + k]) else { continue };
                let own = normal([points[i], points[m], points[k]]);
                let area = 0.5 * own.length();
                let own = unit(own);
                let across = |low: usize, high: usize, apex: usize| {
                    let other = if high == low + 1 {
                        beside[high]
                    } else {
                        unit(normal([points[low], points[apex], points[high]]))
                    };
                    own.dot(other)
                };
                let mut sharpest = across(i, m, one.1).min(across(m, k, two.1));
                if gap + 1 == n {
                    sharpest = sharpest.min(own.dot(beside[0]));
                }
                let whole = Badness { sharpest, area }.plus(one.0).plus(two.0);
                if best.is_none_or(|(known, _)| whole.is_better(known, weight)) {
                    best = Some((whole, m));
                }
            }
            parts[i * n + k] = best;
        }
    }
    if parts[n - 1].is_none() {
        return Ok(None);
    }
    let (mut pieces, mut open) = (Vec::with_capacity(n - 2), vec![(0, n - 1)]);
    while let Some((i, k)) = open.pop() {
        let Some((_, m)) = parts[i * n + k].filter(|_| k > i + 1) else { continue };
        pieces.push([i, m, k]);
        open.extend([(m, k), (i, m)]);
    }
    Ok(Some(pieces))
}

/// Whether a hole of three edges is the back of a face alone.
fn is_back(mesh: &TriMesh, hole: &[Rim], vertices: &[VertexId]) -> bool {
    let face = mesh.faces[hole[0].face().idx()];
    vertices.len() == 3 && vertices.iter().all(|v| face.contains(v))
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::{Layer, NO_VALUE};
    use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, torus};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::{any_mesh, layered_square};
    use crate::geometry::edit::rebuild::{Isolated, with_faces};
    use crate::geometry::surface::mesh_info::mesh_info;
    use crate::test_models::model;

    fn filled(mesh: &TriMesh, weight: HoleWeight) -> Filled {
        fill_holes(mesh, 100, weight, Control::none()).unwrap()
    }

    fn without(mesh: &TriMesh, is_gone: impl Fn(usize) -> bool) -> TriMesh {
        with_faces(mesh, |f| !is_gone(f), Isolated::Removed, Control::none()).unwrap()
    }

    #[test]
    fn a_cube_gets_its_sides_back() {
        for weight in [HoleWeight::Area, HoleWeight::Angle] {
            // The top, and one triangle of the bottom.
            let found = filled(&without(&cube(DVec3::ZERO), |f| [0, 2, 3].contains(&f)), weight);
            assert_eq!((found.n_filled, found.n_too_long + found.n_unfillable), (2, 0));
            let info = mesh_info(&found.mesh, Control::none()).unwrap();
            assert!(info.is_closed() && info.is_manifold() && info.is_oriented());
            assert_eq!((found.mesh.signed_volume(), found.mesh.area()), (1.0, 6.0));
        }
    }

    /// A hole of four edges with two corners up and two down, and steep slopes around it that rise
    /// from the ends of the long diagonal. A valley along that one folds by acos 0.724, and meets
    /// the slopes with less; a ridge along the other has less area (6.05, not 6.46) and meets them
    /// with acos 0.446.
    #[test]
    fn the_sharpest_edge_decides_before_the_area() {
        let points = [
            [1.0, 0.0, 0.4],
            [0.0, 3.0, 0.0],
            [-1.0, 0.0, 0.4],
            [0.0, -3.0, 0.0],
            [2.0, 4.0, 4.0],
            [-2.0, 4.0, 4.0],
            [-2.0, -4.0, 4.0],
            [2.0, -4.0, 4.0],
        ];
        let slopes = [[1, 0, 4], [2, 1, 5], [3, 2, 6], [0, 3, 7]];
        let between = [[0, 7, 4], [1, 4, 5], [2, 5, 6], [3, 6, 7]];
        let mesh = mesh_of(&points, &[slopes, between].concat());
        let shared = |weight| {
            let found = filled(&mesh, weight).mesh;
            let pieces: Vec<[u32; 3]> = found.faces[8..10].iter().map(|f| f.map(|v| v.0)).collect();
            let is_shared = |v: &u32| pieces.iter().all(|piece| piece.contains(v));
            (0..4).filter(is_shared).collect::<Vec<u32>>()
        };
        assert_eq!(shared(HoleWeight::Angle), [1, 3]);
        assert_eq!(shared(HoleWeight::Area), [0, 2]);
    }

    #[test]
    fn the_least_area_is_found() {
        // A notched polygon: only the triangulation by the notch has its own area.
        let points = [
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [4.0, 4.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 4.0, 0.0],
            [2.0, 2.0, 5.0],
        ];
        // A tent of walls with its ring at the bottom.
        let ring = [0_u32, 1, 2, 3, 4];
        let faces: Vec<[u32; 3]> = (0..5).map(|k| [ring[k], ring[(k + 1) % 5], 5]).collect();
        let mesh = mesh_of(&points, &faces);
        let found = filled(&mesh, HoleWeight::Area);
        assert_eq!(found.n_filled, 1);
        assert!((found.mesh.area() - mesh.area() - 10.0).abs() < 1e-12);
        assert!(mesh_info(&found.mesh, Control::none()).unwrap().is_closed());
    }

    #[test]
    fn long_holes_stay_and_are_counted() {
        let mesh = without(&torus(2.0, 0.5, 12), |f| f < 24);
        let found = fill_holes(&mesh, 11, HoleWeight::Angle, Control::none()).unwrap();
        assert_eq!((found.n_filled, found.n_too_long, found.mesh), (0, 2, mesh.clone()));
        let found = fill_holes(&mesh, 12, HoleWeight::Angle, Control::none()).unwrap();
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert_eq!((found.n_filled, info.genus, info.is_closed()), (2, Some(0), true));
    }

    #[test]
    fn new_faces_have_the_values_at_the_border() {
        let mut mesh = layered_square();
        mesh.positions.push(DVec3::new(0.5, 0.5, 1.0));
        mesh.layers.iter_mut().for_each(|layer| {
            let is_vertex = layer.domain == mve_mesh::data::Domain::Vertex;
            layer.index.extend(is_vertex.then_some(NO_VALUE));
        });
        // The square is the bottom of a pyramid, turned over; its sides are missing.
        let found = filled(&mesh, HoleWeight::Angle);
        assert_eq!((found.n_filled, found.mesh.check()), (1, Ok(())));
        assert_eq!(found.mesh.layer(Layer::MATERIAL).unwrap().index.len(), 4);
        let texcoord = found.mesh.layer(Layer::TEXCOORD).unwrap();
        for corner in 6..12 {
            let vertex = found.mesh.faces[corner / 3][corner % 3];
            let same = mesh.faces.iter().flatten().position(|v| *v == vertex).unwrap();
            let value = |index: u32| match &texcoord.values {
                mve_mesh::data::LayerValues::Vec2(values) => values[index as usize],
                _ => panic!("texture coordinates"),
            };
            assert_eq!(value(texcoord.index[corner]), value(texcoord.index[same]));
        }
    }

    #[test]
    fn what_cannot_be_filled_is_counted() {
        // The back of a face alone; a border that runs into an edge of three faces.
        let one = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        assert_eq!(filled(&one, HoleWeight::Area).n_unfillable, 1);
        let mut book = tetrahedron();
        book.positions.push(DVec3::NEG_ONE);
        book.faces.push([0, 1, 4].map(VertexId));
        let found = filled(&book, HoleWeight::Area);
        assert_eq!((found.n_filled, found.mesh), (0, book));
        assert!(found.n_unfillable > 0);
    }

    /// The scan has five holes, of 223 edges in all.
    #[test]
    fn the_bunny_is_closed() {
        let Some(mesh) = model("stanford-bunny.obj") else { return };
        let before = mesh_info(&mesh, Control::none()).unwrap();
        let found = fill_holes(&mesh, 223, HoleWeight::Angle, Control::none()).unwrap();
        let info = mesh_info(&found.mesh, Control::none()).unwrap();
        assert_eq!((before.n_border_loops, found.n_filled), (5, 5));
        assert!(info.is_closed() && info.is_manifold() && info.is_oriented());
        // They are small beside the surface.
        assert!(info.area < 1.05 * before.area, "{} {}", info.area, before.area);
    }

    proptest! {
        #[test]
        fn any_mesh_stays_a_mesh_and_gets_no_new_fault(mesh in any_mesh()) {
            let found = filled(&mesh, HoleWeight::Angle);
            prop_assert_eq!(found.mesh.check(), Ok(()));
            let [before, after] =
                [&mesh, &found.mesh].map(|mesh| mesh_info(mesh, Control::none()).unwrap());
            prop_assert!(after.n_non_manifold_edges <= before.n_non_manifold_edges);
            prop_assert!(after.n_border_edges <= before.n_border_edges);
        }
    }
}
