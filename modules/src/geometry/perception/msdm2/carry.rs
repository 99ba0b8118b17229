//! The nearest points of the reference, and its curvature there.
//!
//! Several faces may be equally near to a vertex, and have other curvatures there: those around a
//! vertex or edge of the reference that the vertex lies before, and sheets that lie in one place.
//! [`Ties`] says which of them is taken.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::FaceId;
use mve_mesh::morton::morton_order;
use rayon::prelude::*;

use super::curvature_mesh::CurvatureMesh;
use super::{MAX_LEVELS, MeshCurvature, Variant};
use crate::geometry::distance::bvh::{Hit, Walker};
use crate::geometry::distance::many::ManyQueries;

/// Vertices of one chunk.
const CHUNK: usize = 256;
/// Distances that differ by less than this part of the longest side of the reference are equal.
const EQUALLY_NEAR: f64 = 1e-12;
/// Equally near faces of other corners that are looked at; more are rare.
const MOST_TIES: usize = 64;

/// Which of equally near faces is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::geometry) enum Ties {
    /// Any, as the published program does; of those that a vertex lies on, the most alike, so that
    /// a sheet is compared with itself.
    Any,
    /// The one whose curvature is most like that of the vertex.
    MostAlike,
    /// The one whose curvature is least like it; but of those that a vertex lies on, the most
    /// alike.
    LeastAlike,
}

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

/// Carries the curvature of the reference to the vertices of the degraded mesh, whose own
/// curvature decides between equally near faces.
pub(in crate::geometry) fn carry(
    [(reference, of_reference), (degraded, of_degraded)]: [MeshCurvature; 2],
    (variant, ties): (Variant, Ties),
    control: Control,
) -> Result<Vec<ReferencePoint>, Cancelled> {
    let positions = &degraded.mesh.positions;
    let order = morton_order(positions, control.part(0.0, 0.1))?;
    let reference = Reference { surface: reference, curvature: of_reference, variant };
    let queries = ManyQueries::new(&reference.surface.bvh, degraded.bvh.center());
    let points: Vec<DVec3> = order.iter().map(|&v| positions[v as usize]).collect();
    let hits = queries.closest(&points, control.part(0.1, 0.5))?;
    let steps = control.part(0.5, 1.0).steps(order.len().div_ceil(CHUNK));
    let found: Vec<Vec<ReferencePoint>> = (order.par_chunks(CHUNK), points.par_chunks(CHUNK))
        .into_par_iter()
        .zip(hits.par_chunks(CHUNK))
        .map(|((chunk, points), hits)| {
            let mut walker = reference.surface.bvh.walker();
            let mut carried = Vec::with_capacity(points.len());
            for ((&v, &point), hit) in chunk.iter().zip(points).zip(hits) {
                let own = &of_degraded[v as usize];
                carried.push(hit.map_or(ReferencePoint::NONE, |hit| {
                    reference.carried(point, &hit, own, ties, &mut walker)
                }));
                walker.poll(&control)?;
            }
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

/// What curvature is carried from.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct Reference<'a> {
    pub surface: &'a CurvatureMesh,
    pub curvature: &'a [[f64; MAX_LEVELS]],
    pub variant: Variant,
}

impl Reference<'_> {
    /// Carries to a point with this nearest face and this curvature of its own.
    fn carried(
        &self,
        position: DVec3,
        hit: &Hit,
        own: &[f64; MAX_LEVELS],
        ties: Ties,
        walker: &mut Walker,
    ) -> ReferencePoint {
        let mut carried = self.carried_from(position, hit, hit.face);
        let nearest = hit.distance_sq.sqrt();
        let equal = EQUALLY_NEAR * self.surface.longest_side;
        let is_on_it = nearest <= equal;
        if ties == Ties::Any && !is_on_it {
            return carried;
        }
        let difference = |carried: &ReferencePoint| -> f64 {
            carried.curvature.iter().zip(own).map(|(a, b)| (a - b).abs()).sum()
        };
        let mut least = difference(&carried);
        let mut hits = Vec::new();
        walker.within(position, nearest + equal, MOST_TIES, &mut hits);
        for hit in &hits {
            for face in self.surface.bvh.same_as(hit) {
                let other = self.carried_from(position, hit, face);
                let difference = difference(&other);
                let is_better = match ties {
                    Ties::LeastAlike if !is_on_it => difference > least,
                    _ => difference < least,
                };
                if is_better {
                    (carried, least) = (other, difference);
                }
            }
        }
        carried
    }

    /// Carries from a face with the corners of that of `hit`.
    fn carried_from(&self, position: DVec3, hit: &Hit, face: FaceId) -> ReferencePoint {
        let point = self.surface.bvh.closest_point(position, hit);
        let from = match self.variant {
            // The vertex itself, though it may lie off the surface: so does the published program.
            Variant::Published => position,
            Variant::Mended => point,
        };
        let weights = area_weights(from, self.surface.mesh.corners(face));
        let corners = self.surface.mesh.faces[face.idx()].map(|v| self.curvature[v.idx()]);
        let mut mixed = [0.0; MAX_LEVELS];
        for (weight, curvature) in weights.iter().zip(corners) {
            for (sum, term) in mixed.iter_mut().zip(curvature) {
                *sum += weight * term;
            }
        }
        ReferencePoint { point, curvature: mixed }
    }

    /// Carries to a point from any face that is nearest to it.
    pub fn carried_to(&self, position: DVec3, walker: &mut Walker) -> ReferencePoint {
        let hit = walker.closest(position);
        hit.map_or(ReferencePoint::NONE, |hit| self.carried_from(position, &hit, hit.face))
    }
}

/// The areas between the point and each side, over their sum: for a point of the triangle its
/// barycentric coordinates.
pub(in crate::geometry) fn area_weights(point: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let [a, b, c] = [a - point, b - point, c - point];
    let areas = [b.cross(c).length(), c.cross(a).length(), a.cross(b).length()];
    let sum = areas[0] + areas[1] + areas[2];
    if sum > 0.0 { areas.map(|area| area / sum) } else { [1.0 / 3.0; 3] }
}
