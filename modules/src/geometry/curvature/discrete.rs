//! Curvature from angle defects and cotangents.
//!
//! Source: M. Meyer, M. Desbrun, P. Schröder & A. Barr, "Discrete differential-geometry operators
//! for triangulated 2-manifolds", VisMath 2003, sections 3 to 5: mixed Voronoi areas, the mean
//! curvature normal (8), the angle defect (9), and principal directions from the curvatures of the
//! edges (section 5.3).
//!
//! Departures: the tensor of the directions is fitted without forcing its trace and determinant,
//! as only its axes are used; cotangents that are negative count as 0 there. Faces without area
//! are left out. Vertices that are not inside a manifold, oriented part of the surface, those of
//! borders among them, have no curvature.

use std::f64::consts::TAU;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, Fans};
use mve_mesh::data::{FaceId, TriMesh, VertexId};
use rayon::prelude::*;

use super::{CHUNK, Curvature, eigen, normalized, tangents};
use crate::geometry::surface::normals::{NormalWeight, vertex_normals};

/// The curvature at each vertex, in time linear in the size of the mesh.
///
/// The sum of Gaussian curvature times mixed area over a closed mesh is 2 π times its Euler
/// characteristic.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn discrete(mesh: &TriMesh, control: Control) -> Result<Vec<Curvature>, Cancelled> {
    let (mesh, scale) = normalized(mesh);
    let adjacency = Adjacency::new(&mesh, control.part(0.0, 0.3))?;
    let normals = vertex_normals(&mesh, NormalWeight::Angle, control.part(0.3, 0.5))?;
    let mut found = vec![Curvature::UNDEFINED; mesh.positions.len()];
    let steps = control.part(0.5, 1.0).steps(found.len().div_ceil(CHUNK));
    found.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, found)| {
        let mut fans = Fans::default();
        for (place, found) in found.iter_mut().enumerate() {
            let vertex = VertexId((chunk * CHUNK + place) as u32);
            if is_inside(&mesh, &adjacency, vertex, &mut fans) {
                *found = at_vertex(&mesh, &adjacency, vertex, normals[vertex.idx()]).scaled(scale);
            }
        }
        steps.step()
    })?;
    Ok(found)
}

/// Whether the faces at a vertex are one closed, oriented fan.
fn is_inside(mesh: &TriMesh, adjacency: &Adjacency, vertex: VertexId, fans: &mut Fans) -> bool {
    let n_corners = adjacency.corners_of(vertex).len();
    adjacency.fans(vertex, |_| true, fans);
    n_corners > 0
        && (1..n_corners).all(|corner| fans.group(corner) == 0)
        && fans.spokes().iter().all(|(edge, _)| adjacency.is_oriented(mesh, *edge))
}

fn at_vertex(mesh: &TriMesh, adjacency: &Adjacency, vertex: VertexId, normal: DVec3) -> Curvature {
    let at = mesh.positions[vertex.idx()];
    let (mut area, mut angles, mut bend) = (0.0, 0.0, DVec3::ZERO);
    let mut tensor = TensorFit::new(normal);
    for &corner in adjacency.corners_of(vertex) {
        let points = mesh.corners(FaceId(corner / 3));
        let [p, q] = [1, 2].map(|k| points[(corner as usize + k) % 3]);
        let (to_p, to_q, p_to_q) = (p - at, q - at, q - p);
        let double_area = to_p.cross(to_q).length();
        if double_area == 0.0 {
            continue;
        }
        let (cot_p, cot_q) = (-to_p.dot(p_to_q) / double_area, to_q.dot(p_to_q) / double_area);
        let dot = to_p.dot(to_q);
        angles += double_area.atan2(dot);
        area += if dot < 0.0 {
            double_area / 4.0
        } else if cot_p < 0.0 || cot_q < 0.0 {
            double_area / 8.0
        } else {
            (to_p.length_squared() * cot_q + to_q.length_squared() * cot_p) / 8.0
        };
        // An edge gets the cotangents across it from the two faces that it has.
        bend -= cot_q * to_p + cot_p * to_q;
        tensor.add(to_p, cot_q.max(0.0));
        tensor.add(to_q, cot_p.max(0.0));
    }
    let mean = bend.length() / (4.0 * area);
    let mean = if bend.dot(normal) < 0.0 { -mean } else { mean };
    let gaussian = (TAU - angles) / area;
    if !(mean.is_finite() && gaussian.is_finite()) || normal == DVec3::ZERO {
        return Curvature::UNDEFINED;
    }
    let root = (mean * mean - gaussian).max(0.0).sqrt();
    let [max_direction, min_direction] = tensor.directions();
    Curvature {
        mean,
        gaussian,
        maximum: mean + root,
        minimum: mean - root,
        max_direction,
        min_direction,
    }
}

/// The least squares fit of a symmetric 2 × 2 matrix to curvatures along edges.
struct TensorFit {
    normal: DVec3,
    tangents: [DVec3; 2],
    /// The normal equations, the right side last.
    rows: [[f64; 4]; 3],
}

impl TensorFit {
    fn new(normal: DVec3) -> Self {
        Self { normal, tangents: tangents(normal), rows: [[0.0; 4]; 3] }
    }

    /// Adds an edge by what it adds to the mixed area: its cotangent times its squared length.
    fn add(&mut self, edge: DVec3, cotangent: f64) {
        let square = edge.length_squared();
        let flat = self.tangents.map(|tangent| tangent.dot(edge));
        let length = flat[0].hypot(flat[1]);
        if length == 0.0 {
            return;
        }
        let [u, v] = flat.map(|x| x / length);
        let curvature = -2.0 * edge.dot(self.normal) / square;
        let terms = [u * u, 2.0 * u * v, v * v, curvature];
        for (row, term) in self.rows.iter_mut().zip(terms) {
            for (sum, other) in row.iter_mut().zip(terms) {
                *sum += cotangent * square * term * other;
            }
        }
    }

    /// The directions of the largest and the smallest curvature, by Cramer's rule; any two where
    /// the edges do not tell.
    fn directions(&self) -> [DVec3; 2] {
        let column = |k: usize| DVec3::new(self.rows[0][k], self.rows[1][k], self.rows[2][k]);
        let [a, b, c, right] = [0, 1, 2, 3].map(column);
        let whole = a.dot(b.cross(c));
        let solved = [right.dot(b.cross(c)), a.dot(right.cross(c)), a.dot(b.cross(right))];
        let [a, b, c] = solved.map(|part| part / whole);
        if !(a + b + c).is_finite() {
            return self.tangents;
        }
        let (_, [cos, sin]) = eigen(a, b, c);
        let [u, v] = self.tangents;
        [cos * u + sin * v, cos * v - sin * u]
    }
}
