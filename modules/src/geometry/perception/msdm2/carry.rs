//! The nearest points of the reference, and its curvature there.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use super::curvature_mesh::CurvatureMesh;
use super::{MAX_LEVELS, Variant};
use crate::geometry::distance::bvh::Walker;
use crate::mesh::morton::morton_order;

/// Vertices of one chunk.
const CHUNK: usize = 256;

/// What a vertex of the degraded mesh gets from the reference.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct ReferencePoint {
    /// The nearest point.
    pub point: DVec3,
    /// The curvature of the reference, a level each.
    pub curvature: [f64; MAX_LEVELS],
}

impl ReferencePoint {
    /// Of a vertex that is nowhere.
    pub const NONE: Self = Self { point: DVec3::NAN, curvature: [f64::NAN; MAX_LEVELS] };
}

/// Carries the curvature of the reference to the vertices of the degraded mesh.
pub(in crate::geometry) fn carry(
    reference: &CurvatureMesh,
    degraded: &CurvatureMesh,
    curvature: &[[f64; MAX_LEVELS]],
    variant: Variant,
    control: Control,
) -> Result<Vec<ReferencePoint>, Cancelled> {
    let positions = &degraded.mesh.positions;
    let order = morton_order(positions, control.part(0.0, 0.1))?;
    let steps = control.part(0.1, 1.0).steps(order.len().div_ceil(CHUNK));
    let found: Vec<Vec<ReferencePoint>> = order
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut walker = reference.bvh.walker();
            let carried = chunk.iter().map(|&v| {
                carry_to(positions[v as usize], reference, curvature, variant, &mut walker)
            });
            let carried = carried.collect();
            steps.step()?;
            Ok(carried)
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut carried = vec![ReferencePoint::NONE; order.len()];
    for (&v, found) in order.iter().zip(found.into_iter().flatten()) {
        carried[v as usize] = found;
    }
    Ok(carried)
}

/// Carries the curvature of the reference to one point.
pub(in crate::geometry) fn carry_to(
    position: DVec3,
    reference: &CurvatureMesh,
    curvature: &[[f64; MAX_LEVELS]],
    variant: Variant,
    walker: &mut Walker,
) -> ReferencePoint {
    let Some(hit) = walker.closest(position) else { return ReferencePoint::NONE };
    let point = reference.bvh.closest_point(position, &hit);
    let from = match variant {
        // The vertex itself, though it may lie off the surface: so does the published program.
        Variant::Published => position,
        Variant::Mended => point,
    };
    let weights = area_weights(from, reference.mesh.corners(hit.face));
    let corners = reference.mesh.faces[hit.face.idx()].map(|v| curvature[v.idx()]);
    let mut mixed = [0.0; MAX_LEVELS];
    for (weight, curvature) in weights.iter().zip(corners) {
        for (sum, term) in mixed.iter_mut().zip(curvature) {
            *sum += weight * term;
        }
    }
    ReferencePoint { point, curvature: mixed }
}

/// The areas between the point and each side, over their sum: for a point of the triangle its
/// barycentric coordinates.
pub(in crate::geometry) fn area_weights(point: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let [a, b, c] = [a - point, b - point, c - point];
    let areas = [b.cross(c).length(), c.cross(a).length(), a.cross(b).length()];
    let sum = areas[0] + areas[1] + areas[2];
    if sum > 0.0 { areas.map(|area| area / sum) } else { [1.0 / 3.0; 3] }
}
