//! How a mesh bends at its edges, the summands of curvature, and what part of a disc each vertex
//! has.
//!
//! See `curvature.rs` for the sources and for what the variants differ in.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{FaceId, TriMesh, VertexId};

use super::Variant;

/// The least part of a disc that a vertex on a border counts as.
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// A symmetric 3×3 matrix: xx, xy, xz, yy, yz, zz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::geometry) struct Bend(pub [f64; 6]);

impl Bend {
    /// `(angle / length) e eᵀ` of an edge.
    pub fn new(angle_rad: f64, along: DVec3) -> Self {
        let length = along.length();
        if length == 0.0 || !length.is_finite() || angle_rad == 0.0 {
            return Self::default();
        }
        let DVec3 { x, y, z } = along;
        Self([x * x, x * y, x * z, y * y, y * z, z * z].map(|term| angle_rad / length * term))
    }

    #[inline]
    pub fn add(&mut self, other: &Self, factor: f64) {
        for (sum, term) in self.0.iter_mut().zip(other.0) {
            *sum += factor * term;
        }
    }

    /// The sum of the two largest magnitudes among the eigenvalues.
    ///
    /// Eigenvalues in closed form: O. K. Smith, CACM 4(4), 1961.
    pub fn two_largest(&self) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let mean = (xx + yy + zz) / 3.0;
        let (dx, dy, dz) = (xx - mean, yy - mean, zz - mean);
        let off = xy * xy + xz * xz + yz * yz;
        let spread = ((dx * dx + dy * dy + dz * dz + 2.0 * off) / 6.0).sqrt();
        if spread.is_nan() || spread == 0.0 {
            return 2.0 * mean.abs();
        }
        let minors = dx * (dy * dz - yz * yz) - xy * (xy * dz - yz * xz) + xz * (xy * yz - dy * xz);
        let cosine = (minors / (2.0 * spread * spread * spread)).clamp(-1.0, 1.0);
        let angle_rad = cosine.acos() / 3.0;
        let high = mean + 2.0 * spread * angle_rad.cos();
        let low = mean + 2.0 * spread * (angle_rad + TAU / 3.0).cos();
        let [a, b, c] = [high, low, 3.0 * mean - high - low].map(f64::abs);
        a + b + c - a.min(b).min(c)
    }
}

/// The unit normal; zero where the triangle has none.
pub(in crate::geometry) fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The published angle between two faces at an edge, by the arc sine of its sine.
pub(in crate::geometry) fn turn_rad(right: DVec3, left: DVec3, along: DVec3) -> f64 {
    (right.cross(left).dot(along) / along.length()).clamp(-1.0, 1.0).asin()
}

/// The bend of every edge, and the share of a disc at every vertex (empty: 1 everywhere).
pub(super) fn bends(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    variant: Variant,
    control: Control,
) -> Result<(Vec<Bend>, Vec<f64>), Cancelled> {
    let mut normals = Vec::with_capacity(mesh.faces.len());
    for face in 0..mesh.faces.len() {
        control.item(face, usize::MAX)?;
        normals.push(normal(mesh.corners(FaceId(face as u32))));
    }
    let mut bends = Vec::with_capacity(adjacency.edges().len());
    for (edge, ends) in adjacency.edges().iter().enumerate() {
        control.item(edge, adjacency.edges().len())?;
        let along = mesh.positions[ends[1].idx()] - mesh.positions[ends[0].idx()];
        let id = EdgeId(edge as u32);
        let angle_rad = match (variant, adjacency.sides_of(id)) {
            (_, [_]) => 0.0,
            (Variant::Published, [a, b]) => {
                let runs_along = mesh.faces[a.face().idx()][a.corner()] == ends[0];
                let (left, right) = if runs_along { (a, b) } else { (b, a) };
                turn_rad(normals[right.face().idx()], normals[left.face().idx()], along)
            }
            (Variant::Published, _) => 0.0,
            (Variant::Mended, _) => unfolded_turn_rad(mesh, adjacency, id, along),
        };
        bends.push(Bend::new(angle_rad, along));
    }
    let shares = match variant {
        Variant::Published => Vec::new(),
        Variant::Mended => disc_shares(mesh, adjacency, control)?,
    };
    Ok((bends, shares))
}

/// The turn at an edge of two or more faces: half the sum of |π − wedge| over the wedges between
/// faces that follow each other around the edge. For two faces that is the angle between their
/// normals, 0 to π, negative at a valley where they are oriented alike.
fn unfolded_turn_rad(mesh: &TriMesh, adjacency: &Adjacency, edge: EdgeId, along: DVec3) -> f64 {
    let [from, to] = adjacency.edges()[edge.idx()];
    let origin = mesh.positions[from.idx()];
    let Some(axis) = along.try_normalize() else { return 0.0 };
    let x = axis.any_orthonormal_vector();
    let y = axis.cross(x);
    let mut angles: Vec<f64> = Vec::with_capacity(2);
    for side in adjacency.sides_of(edge) {
        let apex = mesh.faces[side.face().idx()].into_iter().find(|&v| v != from && v != to);
        let away = apex.map_or(DVec3::ZERO, |v| mesh.positions[v.idx()] - origin);
        angles.push(away.dot(y).atan2(away.dot(x)));
    }
    let first_angle = angles[0];
    angles.sort_by(f64::total_cmp);
    let wrapped = angles[0] + TAU;
    let next = angles.iter().skip(1).copied().chain([wrapped]);
    let turn: f64 = angles.iter().zip(next).map(|(a, b)| (PI - (b - a)).abs()).sum::<f64>() / 2.0;
    match adjacency.sides_of(edge) {
        [a, b] if adjacency.is_oriented(mesh, edge) => {
            // Seen along the edge the face to the left lies at `left`; inside is clockwise of it.
            let first_runs_along = mesh.faces[a.face().idx()][a.corner()] == from;
            debug_assert_ne!(a, b);
            let other = if angles[0] == first_angle { angles[1] } else { angles[0] };
            let (left, right) =
                if first_runs_along { (first_angle, other) } else { (other, first_angle) };
            if (right - left).rem_euclid(TAU) > PI { turn } else { -turn }
        }
        _ => turn,
    }
}

/// The angle that the faces at each vertex take up, over the full one: 1 at inner vertices.
fn disc_shares(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let mut is_inner = vec![true; mesh.positions.len()];
    for (edge, ends) in adjacency.edges().iter().enumerate() {
        control.item(edge, usize::MAX)?;
        if adjacency.sides_of(EdgeId(edge as u32)).len() != 2 {
            ends.iter().for_each(|v| is_inner[v.idx()] = false);
        }
    }
    let share = |vertex: usize| {
        if is_inner[vertex] {
            return 1.0;
        }
        let corners = adjacency.corners_of(VertexId(vertex as u32));
        let angle = |&corner: &u32| {
            let [a, b, c] = [0, 1, 2].map(|k| {
                let v = mesh.faces[corner as usize / 3][(corner as usize + k) % 3];
                mesh.positions[v.idx()]
            });
            (b - a).angle_between(c - a)
        };
        let sum: f64 = corners.iter().map(angle).filter(|angle| angle.is_finite()).sum();
        (sum / TAU).max(LEAST_SHARE)
    };
    (0..is_inner.len())
        .map(|vertex| control.item(vertex, usize::MAX).map(|()| share(vertex)))
        .collect()
}
