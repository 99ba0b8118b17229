//! What kind of surface a mesh is: counts, topology, area, volume, bounds.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId, Fans};
use mve_mesh::data::{FaceId, TriMesh, VertexId};
use mve_mesh::union_find::UnionFind;
use mve_mesh::weld::{coincident, same_places};

use super::folds::{n_folded_edges, n_slivers};

/// The facts about one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshInfo {
    /// Vertices, with and without faces.
    pub n_vertices: usize,
    /// Faces, degenerate and doubled ones included.
    pub n_faces: usize,
    /// Pairs of different vertices that are a side of some face.
    pub n_edges: usize,
    /// Vertices without a face.
    pub n_isolated_vertices: usize,
    /// Parts of the surface, faces being together when they share a vertex.
    pub n_components_by_vertex: usize,
    /// Parts of the surface, faces being together when they share an edge.
    pub n_components_by_edge: usize,
    /// Edges of one face.
    pub n_border_edges: usize,
    /// Closed or broken-off runs of border edges; at a vertex with several borders each run stays
    /// with its own fan of faces.
    pub n_border_loops: usize,
    /// Border edges that lie on another one: the surface looks whole there.
    pub n_coincident_border_edges: usize,
    /// Edges of more than two faces.
    pub n_non_manifold_edges: usize,
    /// Vertices whose faces do not all hang together over shared edges at the vertex.
    pub n_non_manifold_vertices: usize,
    /// Edges of two faces that run along it in the same direction.
    pub n_inconsistent_edges: usize,
    /// Vertices at the place of an earlier one.
    pub n_doubled_vertices: usize,
    /// Faces that name the same three vertices as an earlier face, in any order.
    pub n_duplicate_faces: usize,
    /// Faces that name a vertex twice.
    pub n_degenerate_index_faces: usize,
    /// Faces without area whose corners are finite, those that name a vertex twice among them.
    pub n_zero_area_faces: usize,
    /// Faces with an angle of less than 1°, those without area among them.
    pub n_slivers: usize,
    /// Edges of two faces that are folded onto each other, by more than 150°.
    pub n_folded_edges: usize,
    /// Faces with a coordinate that is not finite; they enter neither area nor volume.
    pub n_non_finite_faces: usize,
    /// Vertices that have faces, less edges, plus faces.
    pub euler_characteristic: i64,
    /// Handles, summed over the components: `(2 C - B - χ) / 2` with C components and B border
    /// loops. `None` unless the mesh is manifold and consistently oriented.
    pub genus: Option<u64>,
    /// In squared model units.
    pub area: f64,
    /// Signed, positive when faces are counter-clockwise from outside, in cubed model units.
    /// `None` unless each edge is run along as often one way as the other: only then does the
    /// number not depend on the origin.
    pub volume: Option<f64>,
    /// Lowest and highest corner of the box around the finite vertices that faces use, or around
    /// all finite ones when there is no face.
    pub bounds: Option<(DVec3, DVec3)>,
}

impl MeshInfo {
    /// There are faces, and no edge has one face only.
    pub fn is_closed(&self) -> bool {
        self.n_faces > 0 && self.n_border_edges == 0
    }

    /// Every point has a neighborhood like a disk or a half-disk: no edge with more than two faces,
    /// no vertex where surfaces touch, no face that names a vertex twice.
    pub fn is_manifold(&self) -> bool {
        self.n_non_manifold_edges == 0
            && self.n_non_manifold_vertices == 0
            && self.n_degenerate_index_faces == 0
    }

    /// Neighboring faces have the same side outside, wherever two faces meet.
    pub fn is_oriented(&self) -> bool {
        self.n_inconsistent_edges == 0
    }

    /// Length of the diagonal of the box; 0 without one.
    pub fn diagonal(&self) -> f64 {
        self.bounds.map_or(0.0, |(low, high)| (high - low).length())
    }
}

/// Looks a mesh over, O(n log n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
///
/// # Panics
/// When a face names a vertex that is not there; see [`TriMesh::check`].
pub fn mesh_info(mesh: &TriMesh, control: Control) -> Result<MeshInfo, Cancelled> {
    let adjacency = Adjacency::new(mesh, control.part(0.0, 0.5))?;
    let vertices = || (0..mesh.positions.len() as u32).map(VertexId);
    let edges = || (0..adjacency.edges().len() as u32).map(EdgeId);
    let n_isolated = vertices().filter(|&v| adjacency.corners_of(v).is_empty()).count();
    let around = look_around(mesh, &adjacency, control.part(0.5, 0.7))?;
    let shape = shape(mesh, control.part(0.7, 0.75))?;
    let n_used = mesh.positions.len() - n_isolated;
    let places = same_places(&mesh.positions, control.part(0.75, 0.75))?;
    let n_doubled = vertices().filter(|v| places[v.idx()] != v.0).count();
    let borders = edges().filter(|&e| adjacency.sides_of(e).len() == 1);
    let border_ends = borders.map(|e| adjacency.edges()[e.idx()]);
    let n_coincident = coincident(&places, border_ends);
    let euler = n_used as i64 - adjacency.edges().len() as i64 + mesh.faces.len() as i64;
    let mut info = MeshInfo {
        n_vertices: mesh.positions.len(),
        n_faces: mesh.faces.len(),
        n_edges: adjacency.edges().len(),
        n_isolated_vertices: n_isolated,
        n_components_by_vertex: components_by_vertex(mesh, control.part(0.75, 0.8))? - n_isolated,
        n_components_by_edge: components_by_edge(mesh, &adjacency, control.part(0.8, 0.85))?,
        n_border_edges: edges().filter(|&e| adjacency.sides_of(e).len() == 1).count(),
        n_border_loops: around.n_border_loops,
        n_coincident_border_edges: n_coincident,
        n_non_manifold_edges: edges().filter(|&e| adjacency.sides_of(e).len() > 2).count(),
        n_non_manifold_vertices: around.n_non_manifold_vertices,
        n_inconsistent_edges: edges()
            .filter(|&e| adjacency.sides_of(e).len() == 2 && !adjacency.is_oriented(mesh, e))
            .count(),
        n_doubled_vertices: n_doubled,
        n_duplicate_faces: duplicate_faces(mesh, &adjacency, control.part(0.85, 0.95))?,
        n_degenerate_index_faces: mesh.faces.iter().filter(|f| names_twice(f)).count(),
        n_zero_area_faces: shape.n_zero_area,
        n_slivers: n_slivers(mesh, control.part(0.95, 0.97))?,
        n_folded_edges: n_folded_edges(mesh, &adjacency, control.part(0.97, 1.0))?,
        n_non_finite_faces: shape.n_non_finite,
        euler_characteristic: euler,
        genus: None,
        area: shape.area,
        volume: edges().all(|e| adjacency.winding(mesh, e) == 0).then_some(shape.volume),
        bounds: shape.bounds,
    };
    if mesh.faces.is_empty() || shape.n_non_finite > 0 {
        info.volume = None;
    }
    if info.is_manifold() && info.is_oriented() {
        let closed = 2 * info.n_components_by_edge as i64 - info.n_border_loops as i64;
        info.genus = u64::try_from((closed - euler) / 2).ok();
    }
    Ok(info)
}

fn names_twice([a, b, c]: &[VertexId; 3]) -> bool {
    a == b || b == c || c == a
}

/// Isolated vertices count as components of their own.
fn components_by_vertex(mesh: &TriMesh, control: Control) -> Result<usize, Cancelled> {
    let mut sets = UnionFind::new(mesh.positions.len());
    for (place, [a, b, c]) in mesh.faces.iter().enumerate() {
        control.item(place, mesh.faces.len())?;
        sets.union(a.0, b.0);
        sets.union(b.0, c.0);
    }
    Ok((0..mesh.positions.len() as u32).filter(|&v| sets.find(v) == v).count())
}

fn components_by_edge(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<usize, Cancelled> {
    let mut sets = UnionFind::new(mesh.faces.len());
    for edge in (0..adjacency.edges().len() as u32).map(EdgeId) {
        control.item(edge.idx(), adjacency.edges().len())?;
        for pair in adjacency.sides_of(edge).windows(2) {
            sets.union(pair[0].face().0, pair[1].face().0);
        }
    }
    Ok((0..mesh.faces.len() as u32).filter(|&f| sets.find(f) == f).count())
}

/// Faces with the same vertices have the same lowest vertex, so each is compared only with the
/// faces there.
fn duplicate_faces(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<usize, Cancelled> {
    let mut n_duplicates = 0;
    let mut faces: Vec<[VertexId; 3]> = Vec::new();
    for vertex in (0..mesh.positions.len() as u32).map(VertexId) {
        control.item(vertex.idx(), mesh.positions.len())?;
        faces.clear();
        faces.extend(adjacency.faces_of(vertex).map(|face| {
            let mut face = mesh.faces[face.idx()];
            face.sort_unstable();
            face
        }));
        faces.retain(|face| face[0] == vertex);
        faces.sort_unstable();
        n_duplicates += faces.windows(2).filter(|pair| pair[0] == pair[1]).count();
    }
    Ok(n_duplicates)
}

/// What shows when walking around each vertex.
struct Around {
    n_non_manifold_vertices: usize,
    n_border_loops: usize,
}

fn look_around(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<Around, Cancelled> {
    let is_border = |edge: EdgeId| adjacency.sides_of(edge).len() == 1;
    let mut runs = UnionFind::new(adjacency.edges().len());
    let mut fans = Fans::default();
    let mut n_non_manifold_vertices = 0;
    let mut ends: Vec<(usize, EdgeId)> = Vec::new();
    for vertex in (0..mesh.positions.len() as u32).map(VertexId) {
        control.item(vertex.idx(), mesh.positions.len())?;
        let n_corners = adjacency.corners_of(vertex).len();
        adjacency.fans(vertex, |_| true, &mut fans);
        if (1..n_corners).any(|at| fans.group(at) != 0) {
            n_non_manifold_vertices += 1;
        }
        // Each fan over manifold edges has two ends; where both are borders the run goes on.
        let has_border = fans.spokes().iter().any(|&(edge, _)| is_border(edge));
        if !has_border {
            continue;
        }
        adjacency.fans(vertex, |edge| adjacency.sides_of(edge).len() == 2, &mut fans);
        ends.clear();
        for at in 0..fans.spokes().len() {
            let (edge, corner) = fans.spokes()[at];
            if is_border(edge) {
                ends.push((fans.group(corner as usize), edge));
            }
        }
        ends.sort_unstable();
        for pair in ends.windows(2) {
            if pair[0].0 == pair[1].0 {
                runs.union(pair[0].1.0, pair[1].1.0);
            }
        }
    }
    let edges = (0..adjacency.edges().len() as u32).map(EdgeId);
    let n_border_loops = edges.filter(|&e| is_border(e) && runs.find(e.0) == e.0).count();
    Ok(Around { n_non_manifold_vertices, n_border_loops })
}

/// What depends on the positions.
struct Shape {
    area: f64,
    volume: f64,
    n_zero_area: usize,
    n_non_finite: usize,
    bounds: Option<(DVec3, DVec3)>,
}

fn shape(mesh: &TriMesh, control: Control) -> Result<Shape, Cancelled> {
    let grow = |bounds: Option<(DVec3, DVec3)>, p: DVec3| match bounds {
        _ if !p.is_finite() => bounds,
        Some((low, high)) => Some((low.min(p), high.max(p))),
        None => Some((p, p)),
    };
    let bounds = if mesh.faces.is_empty() {
        mesh.positions.iter().copied().fold(None, grow)
    } else {
        mesh.faces.iter().flatten().map(|v| mesh.positions[v.idx()]).fold(None, grow)
    };
    // Tetrahedra from the center, not the origin: far models would lose their digits.
    let center = bounds.map_or(DVec3::ZERO, |(low, high)| low.midpoint(high));
    let mut shape = Shape { area: 0.0, volume: 0.0, n_zero_area: 0, n_non_finite: 0, bounds };
    for face in (0..mesh.faces.len() as u32).map(FaceId) {
        control.item(face.idx(), mesh.faces.len())?;
        let [a, b, c] = mesh.corners(face).map(|p| p - center);
        if ![a, b, c].iter().all(|p| p.is_finite()) {
            shape.n_non_finite += 1;
            continue;
        }
        let area = 0.5 * (b - a).cross(c - a).length();
        shape.area += area;
        shape.volume += a.dot(b.cross(c)) / 6.0;
        if area == 0.0 {
            shape.n_zero_area += 1;
        }
    }
    Ok(shape)
}

#[cfg(test)]
#[path = "mesh_info_tests.rs"]
mod tests;
