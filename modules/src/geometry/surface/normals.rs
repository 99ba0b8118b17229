//! Normals of faces, vertices and corners.
//!
//! A vertex normal is the weighted sum of the unit normals of its faces, scaled to length 1. Faces
//! without area, or with a corner that is not finite, have no normal and add nothing.

use std::f64::consts::PI;

use glam::DVec3;
use mve_core::{Cancelled, Control};

use mve_mesh::adjacency::{Adjacency, EdgeId, Fans};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};

/// How much a face counts in the normal of its vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalWeight {
    /// Each face the same (Gouraud 1971).
    Uniform,
    /// By its area: large faces keep their direction.
    Area,
    /// By its angle at the vertex (Thürmer & Wüthrich, "Computing vertex normals from polygonal
    /// facets", JGT 1998): does not depend on how a flat region is cut into triangles.
    #[default]
    Angle,
}

/// The unit normal of each face, zero where there is none.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn face_normals(mesh: &TriMesh, control: Control) -> Result<Vec<DVec3>, Cancelled> {
    let normal = |f: u32| {
        control.item(f as usize, mesh.faces.len())?;
        let [a, b, c] = mesh.corners(FaceId(f));
        Ok(unit((b - a).cross(c - a)))
    };
    (0..mesh.faces.len() as u32).map(normal).collect()
}

/// The unit normal of each vertex, zero where there is none: no face, only faces without a normal,
/// or normals that cancel.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn vertex_normals(
    mesh: &TriMesh,
    weight: NormalWeight,
    control: Control,
) -> Result<Vec<DVec3>, Cancelled> {
    let normals = face_normals(mesh, control.part(0.0, 0.3))?;
    let control = control.part(0.3, 1.0);
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for corner in 0..3 * mesh.faces.len() {
        control.item(corner, 3 * mesh.faces.len())?;
        let vertex = mesh.faces[corner / 3][corner % 3];
        sums[vertex.idx()] += weighted(mesh, &normals, corner, weight);
    }
    Ok(sums.into_iter().map(unit).collect())
}

/// The layer [`Layer::NORMAL`] over vertices, one value a vertex that has a normal.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn vertex_normal_layer(
    mesh: &TriMesh,
    weight: NormalWeight,
    control: Control,
) -> Result<Layer, Cancelled> {
    let mut values = Vec::with_capacity(mesh.positions.len());
    let index = vertex_normals(mesh, weight, control)?
        .into_iter()
        .map(|normal| push_value(&mut values, normal))
        .collect();
    Ok(layer(Domain::Vertex, values, index))
}

/// The layer [`Layer::NORMAL`] over corners: corners of one vertex share a value where their faces
/// hang together over smooth edges.
///
/// An edge is smooth when it has exactly two faces, oriented alike, whose normals differ by less
/// than `crease_angle_rad`; at 0 every corner has the normal of its face, at more than π only
/// borders, non-manifold edges and turned faces divide. A face without a normal takes, at each
/// corner, the value of a neighbor across an edge there, and joins nothing. Values are in the
/// order of the vertices. A group whose weighted normals cancel has the normal of its first face.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn corner_normal_layer(
    mesh: &TriMesh,
    weight: NormalWeight,
    crease_angle_rad: f64,
    control: Control,
) -> Result<Layer, Cancelled> {
    let adjacency = Adjacency::new(mesh, control.part(0.0, 0.3))?;
    let normals = face_normals(mesh, control.part(0.3, 0.4))?;
    let n_edges = adjacency.edges().len();
    let is_smooth: Vec<bool> = (0..n_edges as u32)
        .map(|e| {
            control.part(0.4, 0.5).item(e as usize, n_edges)?;
            Ok(is_smooth(mesh, &adjacency, &normals, EdgeId(e), crease_angle_rad))
        })
        .collect::<Result<_, _>>()?;
    let control = control.part(0.5, 1.0);
    let mut values = Vec::new();
    let mut index = vec![NO_VALUE; 3 * mesh.faces.len()];
    let mut fans = Fans::default();
    let mut sums = Vec::new();
    for vertex in (0..mesh.positions.len() as u32).map(VertexId) {
        control.item(vertex.idx(), mesh.positions.len())?;
        let corners = adjacency.corners_of(vertex);
        adjacency.fans(vertex, |edge| is_smooth[edge.idx()], &mut fans);
        sums.clear();
        sums.resize(corners.len(), DVec3::ZERO);
        for (at, &corner) in corners.iter().enumerate() {
            sums[fans.group(at)] += weighted(mesh, &normals, corner as usize, weight);
        }
        for (at, &corner) in corners.iter().enumerate() {
            let group = fans.group(at);
            index[corner as usize] = if group < at {
                index[corners[group] as usize]
            } else {
                let sum = unit(sums[at]);
                let own = normals[corner as usize / 3];
                push_value(&mut values, if sum == DVec3::ZERO { own } else { sum })
            };
        }
        adopt(&adjacency, &normals, vertex, &fans, &mut index);
    }
    Ok(layer(Domain::Corner, values, index))
}

/// Gives the corners at a vertex whose face has no normal the value of a neighbor.
fn adopt(
    adjacency: &Adjacency,
    normals: &[DVec3],
    vertex: VertexId,
    fans: &Fans,
    index: &mut [u32],
) {
    let corners = adjacency.corners_of(vertex);
    let has_normal = |at: u32| normals[corners[at as usize] as usize / 3] != DVec3::ZERO;
    for (at, &corner) in corners.iter().enumerate() {
        if has_normal(at as u32) {
            continue;
        }
        let own = fans.spokes().iter().filter(|(_, other)| *other == at as u32);
        let neighbor = own
            .flat_map(|(edge, _)| fans.spokes().iter().filter(move |(other, _)| other == edge))
            .find(|(_, other)| has_normal(*other));
        if let Some((_, other)) = neighbor {
            index[corner as usize] = index[corners[*other as usize] as usize];
        }
    }
}

fn is_smooth(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    normals: &[DVec3],
    edge: EdgeId,
    crease_angle_rad: f64,
) -> bool {
    if !adjacency.is_oriented(mesh, edge) {
        return false;
    }
    let [a, b] = [0, 1].map(|k| normals[adjacency.sides_of(edge)[k].face().idx()]);
    a != DVec3::ZERO && b != DVec3::ZERO && angle_between(a, b) < crease_angle_rad
}

/// The normal of the corner's face times its weight.
fn weighted(mesh: &TriMesh, normals: &[DVec3], corner: usize, weight: NormalWeight) -> DVec3 {
    let normal = normals[corner / 3];
    if normal == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let points = mesh.corners(FaceId((corner / 3) as u32));
    let [at, next, last] = [0, 1, 2].map(|k| points[(corner + k) % 3]);
    let (to_next, to_last) = (next - at, last - at);
    normal
        * match weight {
            NormalWeight::Uniform => 1.0,
            NormalWeight::Area => 0.5 * to_next.cross(to_last).length(),
            NormalWeight::Angle => angle_between(to_next, to_last),
        }
}

/// From 0 to π; by the arc tangent, which is exact near both ends where the arc cosine is not.
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).clamp(0.0, PI)
}

/// The vector at length 1, or zero when it has none. Scaled first, so that the squares of tiny
/// faces do not vanish.
fn unit(vector: DVec3) -> DVec3 {
    let largest = vector.abs().max_element();
    if largest > 0.0 && vector.is_finite() { (vector / largest).normalize() } else { DVec3::ZERO }
}

/// Adds a value and returns its index; a zero vector is no value.
fn push_value(values: &mut Vec<DVec3>, normal: DVec3) -> u32 {
    if normal == DVec3::ZERO {
        return NO_VALUE;
    }
    values.push(normal);
    values.len() as u32 - 1
}

fn layer(domain: Domain, values: Vec<DVec3>, index: Vec<u32>) -> Layer {
    Layer { name: Layer::NORMAL.to_owned(), domain, values: LayerValues::Vec3(values), index }
}

#[cfg(test)]
#[path = "normals_tests.rs"]
mod tests;
