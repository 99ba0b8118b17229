//! Subdivision of triangles into four, by midpoints, by Loop's scheme or by the modified butterfly.
//!
//! Sources: C. Loop, "Smooth subdivision surfaces based on triangles", University of Utah 1987, for
//! the weights of the interior (his own, not those that Warren simplified later); H. Hoppe et al.,
//! "Piecewise smooth surface reconstruction", SIGGRAPH 1994, for borders and creases. Those of the
//! butterfly are in `butterfly.rs`.
//!
//! Departures: any list of triangles is subdivided. An edge with one face, or more than two, is a
//! crease; a vertex with two creases moves along them, and one with another number of creases, or
//! where parts of the surface touch, stays where it is. Layers are interpolated linearly in all
//! schemes: values at the ends of their ranges stay, and seams stay where they are in texture.

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId, Fans};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};
use thiserror::Error;

use super::butterfly::edge_points;

/// Most faces of a result: the work needs about 100 bytes a face.
pub const MAX_FACES: usize = 1 << 26;

/// Where the vertices of a subdivided mesh go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// New vertices in the middle of edges, old ones where they are: the same surface.
    Midpoint,
    /// All vertices towards Loop's smooth surface.
    Loop,
    /// New vertices on the smooth surface of the modified butterfly scheme, old ones where they
    /// are.
    Butterfly,
}

/// Why a mesh was not subdivided.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SubdivideError {
    /// The result would be too large.
    #[error(
        "{levels} levels would make {n_faces} faces of it, more than the {MAX_FACES} that are \
         allowed"
    )]
    TooManyFaces {
        /// Levels asked for.
        levels: u32,
        /// Faces that there would be.
        n_faces: u128,
    },
    /// The caller ended the computation.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Cuts every face into four, `levels` times.
///
/// Old vertices keep their numbers; then there is one for each edge, by its lower and then its
/// higher vertex. Faces `4 f` to `4 f + 3` come from face `f`: those at its corners in their
/// order, then the middle one. Orientation is kept; a closed or manifold mesh stays so.
///
/// # Errors
/// See [`SubdivideError`]; a result that is too large is refused before anything is computed.
pub fn subdivide(
    mesh: TriMesh,
    scheme: Scheme,
    levels: u32,
    control: Control,
) -> Result<TriMesh, SubdivideError> {
    let factor = 4u128.checked_pow(levels).unwrap_or(u128::MAX);
    let n_faces = factor.saturating_mul(mesh.faces.len() as u128);
    if n_faces > MAX_FACES as u128 {
        return Err(SubdivideError::TooManyFaces { levels, n_faces });
    }
    let mut mesh = mesh;
    // Level k of n takes a share of 4^k in 1 + 4 + … + 4^(n - 1).
    let done = |level: u32| (4f64.powi(level as i32) - 1.0) / (4f64.powi(levels as i32) - 1.0);
    for level in 0..levels {
        mesh = once(mesh, scheme, control.part(done(level), done(level + 1)))?;
    }
    Ok(mesh)
}

fn once(mesh: TriMesh, scheme: Scheme, control: Control) -> Result<TriMesh, Cancelled> {
    let adjacency = Adjacency::new(&mesh, control.part(0.0, 0.4))?;
    let positions = positions(&mesh, &adjacency, scheme, control.part(0.4, 0.7))?;
    let n_vertices = mesh.positions.len() as u32;
    let mut faces = Vec::with_capacity(4 * mesh.faces.len());
    for (f, &[a, b, c]) in mesh.faces.iter().enumerate() {
        control.part(0.7, 0.8).item(f, mesh.faces.len())?;
        let edges = adjacency.edges_of(FaceId(f as u32));
        // A side from a vertex to itself has its middle there.
        let middle = |k: usize, from: VertexId| match edges[k] {
            EdgeId::NONE => from,
            EdgeId(edge) => VertexId(n_vertices + edge),
        };
        let [ab, bc, ca] = [middle(0, a), middle(1, b), middle(2, c)];
        faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    let n_layers = mesh.layers.len() as f64;
    let control = control.part(0.8, 1.0);
    let mut layers = Vec::with_capacity(mesh.layers.len());
    for (place, layer) in mesh.layers.iter().enumerate() {
        let part = control.part(place as f64 / n_layers, (place + 1) as f64 / n_layers);
        layers.push(subdivided_layer(layer, &adjacency, part)?);
    }
    Ok(TriMesh { positions, faces, layers, materials: mesh.materials })
}

/// Positions of the old vertices, then of one for each edge.
fn positions(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    scheme: Scheme,
    control: Control,
) -> Result<Vec<DVec3>, Cancelled> {
    let old = &mesh.positions;
    let (n_vertices, n_edges) = (old.len(), adjacency.edges().len());
    let mut positions = Vec::with_capacity(n_vertices + n_edges);
    match scheme {
        Scheme::Midpoint => positions.extend_from_slice(old),
        Scheme::Butterfly => {
            positions.extend_from_slice(old);
            positions.extend(edge_points(mesh, adjacency, control)?);
            return Ok(positions);
        }
        Scheme::Loop => {
            let mut room = Room::default();
            for vertex in (0..n_vertices as u32).map(VertexId) {
                control.part(0.0, 0.6).item(vertex.idx(), n_vertices)?;
                positions.push(smoothed(mesh, adjacency, vertex, &mut room));
            }
        }
    }
    for (e, [a, b]) in adjacency.edges().iter().map(|ends| ends.map(|v| old[v.idx()])).enumerate() {
        control.part(0.6, 1.0).item(e, n_edges)?;
        // The halves first: their sum is finite wherever the ends are.
        let middle = 0.5 * a + 0.5 * b;
        let is_smooth = scheme == Scheme::Loop && !adjacency.is_crease(EdgeId(e as u32));
        positions.push(match adjacency.sides_of(EdgeId(e as u32)) {
            [one, two] if is_smooth => {
                let [c, d] = [one, two]
                    .map(|side| old[mesh.faces[side.face().idx()][(side.corner() + 2) % 3].idx()]);
                0.75 * middle + 0.125 * (c + d)
            }
            _ => middle,
        });
    }
    Ok(positions)
}

/// Room to work in at one vertex.
#[derive(Default)]
struct Room {
    fans: Fans,
    edges: Vec<EdgeId>,
}

/// Where Loop's rules put an old vertex.
fn smoothed(mesh: &TriMesh, adjacency: &Adjacency, vertex: VertexId, room: &mut Room) -> DVec3 {
    let at = mesh.positions[vertex.idx()];
    let n_corners = adjacency.corners_of(vertex).len();
    adjacency.fans(vertex, |_| true, &mut room.fans);
    room.edges.clear();
    room.edges.extend(room.fans.spokes().iter().map(|(edge, _)| *edge));
    room.edges.dedup();
    if n_corners == 0 || (1..n_corners).any(|corner| room.fans.group(corner) != 0) {
        return at;
    }
    let other_end = |edge: EdgeId| {
        let [a, b] = adjacency.edges()[edge.idx()];
        mesh.positions[if a == vertex { b } else { a }.idx()]
    };
    let mut creases = room.edges.iter().copied().filter(|&edge| adjacency.is_crease(edge));
    match [creases.next(), creases.next(), creases.next()] {
        [None, ..] => {
            let valence = room.edges.len() as f64;
            let sum: DVec3 = room.edges.iter().map(|&edge| other_end(edge)).sum();
            let beta = loop_weight(valence);
            (1.0 - valence * beta) * at + beta * sum
        }
        [Some(one), Some(two), None] => 0.75 * at + 0.125 * (other_end(one) + other_end(two)),
        _ => at,
    }
}

/// Loop's weight of each neighbor of a vertex of this valence: 1/16 for 6, 3/16 for 3.
fn loop_weight(valence: f64) -> f64 {
    let center = 0.375 + 0.25 * (std::f64::consts::TAU / valence).cos();
    (0.625 - center * center) / valence
}

fn subdivided_layer(
    layer: &Layer,
    adjacency: &Adjacency,
    control: Control,
) -> Result<Layer, Cancelled> {
    let mut middles =
        Middles { is_normal: layer.name == Layer::NORMAL, values: layer.values.clone() };
    let index = match layer.domain {
        Domain::Face => layer.index.iter().flat_map(|&value| [value; 4]).collect(),
        Domain::Vertex => {
            let mut index = layer.index.clone();
            for (e, ends) in adjacency.edges().iter().enumerate() {
                control.item(e, adjacency.edges().len())?;
                let [a, b] = ends.map(|v| layer.index[v.idx()]);
                index.push(middles.of(a, b));
            }
            index
        }
        Domain::Corner => corner_index(layer, adjacency, &mut middles, control)?,
    };
    let (name, domain) = (layer.name.clone(), layer.domain);
    Ok(Layer { name, domain, values: middles.values, index })
}

/// The index of a layer over corners. Sides on one edge whose ends have the same two values share
/// the value in the middle; where they have others, the edge is a seam and stays one.
fn corner_index(
    layer: &Layer,
    adjacency: &Adjacency,
    middles: &mut Middles,
    control: Control,
) -> Result<Vec<u32>, Cancelled> {
    let n_faces = layer.index.len() / 3;
    let ends = |f: usize, k: usize| {
        let (one, two) = (layer.index[3 * f + k], layer.index[3 * f + (k + 1) % 3]);
        (one.min(two), one.max(two))
    };
    let mut at_sides = vec![NO_VALUE; 3 * n_faces];
    let mut pairs = Vec::new();
    for edge in (0..adjacency.edges().len() as u32).map(EdgeId) {
        control.part(0.0, 0.7).item(edge.idx(), adjacency.edges().len())?;
        pairs.clear();
        let sides = adjacency.sides_of(edge).iter();
        pairs.extend(sides.map(|side| {
            let (f, k) = (side.face().idx(), side.corner());
            (ends(f, k), 3 * f + k)
        }));
        pairs.sort_unstable();
        let mut last = None;
        for &((one, two), side) in &pairs {
            let middle = match last {
                Some((pair, middle)) if pair == (one, two) => middle,
                _ => middles.of(one, two),
            };
            last = Some(((one, two), middle));
            at_sides[side] = middle;
        }
    }
    let mut index = Vec::with_capacity(12 * n_faces);
    for f in 0..n_faces {
        control.part(0.7, 1.0).item(f, n_faces)?;
        // A side from a vertex to itself lies on no edge.
        let edges = adjacency.edges_of(FaceId(f as u32));
        let side = |k: usize, middles: &mut Middles| match edges[k] {
            EdgeId::NONE => middles.of(ends(f, k).0, ends(f, k).1),
            _ => at_sides[3 * f + k],
        };
        let [ab, bc, ca] = [side(0, middles), side(1, middles), side(2, middles)];
        let [a, b, c] = [0, 1, 2].map(|k| layer.index[3 * f + k]);
        index.extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca]);
    }
    Ok(index)
}

/// The values of a layer, which grow by those in the middle of two others.
struct Middles {
    /// Normals stay unit vectors.
    is_normal: bool,
    values: LayerValues,
}

impl Middles {
    /// The index of the value between two: none where an end has none, and for names the first of
    /// the two. There are fewer new values than faces of the result, so their indices fit.
    fn of(&mut self, one: u32, two: u32) -> u32 {
        if one == two || one == NO_VALUE || two == NO_VALUE {
            return if one == two { one } else { NO_VALUE };
        }
        let (i, j) = (one as usize, two as usize);
        match &mut self.values {
            LayerValues::Number(v) => v.push(0.5 * v[i] + 0.5 * v[j]),
            LayerValues::Vec2(v) => v.push(DVec2::midpoint(v[i], v[j])),
            LayerValues::Vec3(v) => {
                let middle = DVec3::midpoint(v[i], v[j]);
                let normal = middle.try_normalize().filter(|_| self.is_normal);
                let is_canceled = self.is_normal && normal.is_none();
                v.push(if is_canceled { v[i] } else { normal.unwrap_or(middle) });
            }
            LayerValues::Label(_) => return one,
        }
        self.values.len() as u32 - 1
    }
}

#[cfg(test)]
#[path = "subdivide_tests.rs"]
mod tests;
