//! The largest distance of a surface from another, between two bounds.
//!
//! Branch and bound over parts of faces, as in Kang, Kyung, Yoon & Kim, "Fast and robust Hausdorff
//! distance computation from triangle mesh to quad mesh in near-zero cases", CAGD 2018, with this
//! bound: the distance from one triangle of the target is a convex function of the point, so over
//! a part of a face it is largest at a corner of that part, and so is the distance from the whole
//! target at most `min over triangles t of (max over corners of distance to t)`. The triangles
//! tried are those nearest to the corners and to the center. Where the target is finer than the
//! part, [`covered`] bounds better: the distance changes no faster than the point moves. A part whose bound exceeds the largest
//! distance found so far by more than the tolerance is split in four.
//!
//! Parts are looked at in rounds, whose results do not depend on threads.

use glam::DVec3;
use rayon::prelude::*;

use super::bvh::{Bvh, Hit, Walker};
use super::control::{Cancelled, Control};
use crate::data::{FaceId, TriMesh};

/// Parts of one chunk.
const CHUNK: usize = 1024;

/// The farthest point so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub distance_sq: f64,
    pub point: DVec3,
}

impl Found {
    /// Nearer than every point.
    pub const NONE: Self = Self { distance_sq: -1.0, point: DVec3::NAN };

    /// Takes the point if it is farther; of equally far ones the first stays.
    pub fn offer(&mut self, distance_sq: f64, point: DVec3) {
        if distance_sq > self.distance_sq {
            *self = Self { distance_sq, point };
        }
    }
}

/// What to search.
pub(super) struct MaxSearch<'a> {
    pub mesh: &'a TriMesh,
    /// Faces of `mesh` with usable corners.
    pub faces: &'a [FaceId],
    pub to: &'a Bvh,
    /// Of each vertex of `mesh`.
    pub vertex_hits: &'a [Option<Hit>],
    /// In model units.
    pub tolerance: f64,
    /// After so many parts the search ends.
    pub max_parts: usize,
}

/// A part of a face that may hold the maximum.
#[derive(Clone, Copy)]
struct Part {
    corners: [DVec3; 3],
    hits: [Hit; 3],
    /// No point of the part is farther, squared.
    bound_sq: f64,
}

/// Raises `most` to the largest distance within the tolerance, and returns an upper bound.
pub(super) fn search(
    task: &MaxSearch,
    most: &mut Found,
    control: Control,
) -> Result<f64, Cancelled> {
    let mut parts = first_parts(task, most, control)?;
    let mut n_seen = parts.len();
    // The largest bound among the parts that were let go.
    let mut closed_sq = most.distance_sq.max(0.0);
    while !parts.is_empty() {
        control.at((n_seen as f64 / task.max_parts.max(1) as f64).min(1.0))?;
        let limit_sq = limit_sq(task, most);
        parts.retain(|part| {
            let is_open = part.bound_sq > limit_sq;
            if !is_open {
                closed_sq = closed_sq.max(part.bound_sq);
            }
            is_open
        });
        if n_seen + 4 * parts.len() > task.max_parts {
            break;
        }
        n_seen += 4 * parts.len();
        let rounds: Vec<(Vec<Part>, Found, f64)> = parts
            .par_chunks(CHUNK)
            .map(|chunk| {
                control.at(0.0)?;
                Ok(split_all(task, chunk, *most))
            })
            .collect::<Result<_, Cancelled>>()?;
        parts.clear();
        for (children, found, closed) in rounds {
            parts.extend(children);
            most.offer(found.distance_sq, found.point);
            closed_sq = closed_sq.max(closed);
        }
    }
    let open_sq = parts.iter().map(|part| part.bound_sq).fold(0.0, f64::max);
    Ok(closed_sq.max(open_sq).max(most.distance_sq).sqrt())
}

/// Parts up to this squared bound need no closer look.
fn limit_sq(task: &MaxSearch, most: &Found) -> f64 {
    let limit = most.distance_sq.max(0.0).sqrt() * (1.0 + 1e-12) + task.tolerance;
    limit * limit
}

/// The faces that may hold something farther than `most`.
fn first_parts(
    task: &MaxSearch,
    most: &mut Found,
    control: Control,
) -> Result<Vec<Part>, Cancelled> {
    let limit_sq = limit_sq(task, most);
    let rounds: Vec<(Vec<Part>, Found)> = task
        .faces
        .par_chunks(CHUNK)
        .map(|chunk| {
            control.at(0.0)?;
            let mut walker = task.to.walker();
            let mut found = *most;
            let mut parts = Vec::new();
            for face in chunk {
                let corners = task.mesh.corners(*face);
                let hits = task.mesh.faces[face.idx()].map(|v| task.vertex_hits[v.idx()]);
                let [Some(a), Some(b), Some(c)] = hits else { continue };
                let part = bounded(&mut walker, corners, [a, b, c], limit_sq, &mut found);
                parts.push(part);
            }
            Ok((parts, found))
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut parts = Vec::new();
    for (round, found) in rounds {
        parts.extend(round);
        most.offer(found.distance_sq, found.point);
    }
    Ok(parts)
}

/// Splits parts in four: the children that stay open, what was found, and the largest bound of
/// the children that were closed.
fn split_all(task: &MaxSearch, parts: &[Part], most: Found) -> (Vec<Part>, Found, f64) {
    let limit_sq = limit_sq(task, &most);
    let mut walker = task.to.walker();
    let mut found = most;
    let mut closed_sq = 0.0f64;
    let mut open = Vec::new();
    for part in parts {
        let [a, b, c] = part.corners;
        let middles = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        walker.start_from(&part.hits[0]);
        let [Some(hit_ab), Some(hit_bc), Some(hit_ca)] = middles.map(|m| walker.closest(m)) else {
            continue;
        };
        for (hit, middle) in [hit_ab, hit_bc, hit_ca].iter().zip(middles) {
            found.offer(hit.distance_sq, middle);
        }
        let [ab, bc, ca] = middles;
        let [hit_a, hit_b, hit_c] = part.hits;
        for (corners, hits) in [
            ([a, ab, ca], [hit_a, hit_ab, hit_ca]),
            ([ab, b, bc], [hit_ab, hit_b, hit_bc]),
            ([ca, bc, c], [hit_ca, hit_bc, hit_c]),
            ([ab, bc, ca], [hit_ab, hit_bc, hit_ca]),
        ] {
            let mut child = bounded(&mut walker, corners, hits, limit_sq, &mut found);
            child.bound_sq = child.bound_sq.min(part.bound_sq);
            if child.bound_sq > limit_sq {
                open.push(child);
            } else {
                closed_sq = closed_sq.max(child.bound_sq);
            }
        }
    }
    (open, found, closed_sq)
}

/// Bounds the distance over a triangle whose corners have these hits.
fn bounded(
    walker: &mut Walker,
    corners: [DVec3; 3],
    hits: [Hit; 3],
    limit_sq: f64,
    found: &mut Found,
) -> Part {
    let bound_by = |walker: &Walker, hit: &Hit| {
        corners.iter().map(|&p| walker.distance_sq_to(p, hit)).fold(0.0, f64::max)
    };
    let mut bound_sq = f64::INFINITY;
    for hit in &hits {
        bound_sq = bound_sq.min(bound_by(walker, hit));
        if bound_sq <= limit_sq {
            return Part { corners, hits, bound_sq };
        }
    }
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    walker.start_from(&hits[0]);
    if let Some(hit) = walker.closest(center) {
        found.offer(hit.distance_sq, center);
        bound_sq = bound_sq.min(bound_by(walker, &hit));
        let by_center = covered(corners, hits.map(|h| h.distance_sq), center, hit.distance_sq);
        bound_sq = bound_sq.min(by_center * by_center);
    }
    Part { corners, hits, bound_sq }
}

/// A bound from the distances at the corners and the center alone: moving by some length changes
/// the distance by at most that length, and no point of the third between two corners and the
/// center is farther from all three than their [`cover_radius`].
fn covered(corners: [DVec3; 3], corners_sq: [f64; 3], center: DVec3, center_sq: f64) -> f64 {
    (0..3)
        .map(|k| {
            let next = (k + 1) % 3;
            let known = corners_sq[k].max(corners_sq[next]).max(center_sq).sqrt();
            known + cover_radius(corners[k], corners[next], center)
        })
        .fold(0.0, f64::max)
        * (1.0 + 1e-12)
}

/// The largest distance that a point of the triangle can have from the nearest of its corners.
///
/// Where the angle at `c` is obtuse, as it mostly is at a center, the points equally far from `c`
/// and from `p` meet the side `pq` at `|pc|² |pq| / (2 pc · pq)` from `p`, and those for `q` alike:
/// these are the farthest. Otherwise half the longest side over the sine of 60° is enough: it is no
/// less than the circumradius where no angle is obtuse, as the largest is then between 60° and 90°,
/// and where another angle is obtuse the radius is at most half the longest side.
fn cover_radius(p: DVec3, q: DVec3, c: DVec3) -> f64 {
    let (pq, pc, qc) = (q - p, c - p, c - q);
    if pc.dot(qc) < 0.0 {
        let along =
            |from: DVec3, side: DVec3| 0.5 * from.length_squared() * pq.length() / from.dot(side);
        let radius = along(pc, pq).max(along(qc, -pq));
        if radius.is_finite() {
            return radius;
        }
    }
    let longest_sq = pq.length_squared().max(pc.length_squared()).max(qc.length_squared());
    longest_sq.sqrt() / 3f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn every_point_of_a_triangle_is_covered(p in any_point(), q in any_point(), c in any_point()) {
            let radius = cover_radius(p, q, c);
            for i in 0..=30 {
                for j in 0..=30 - i {
                    let (s, t) = (f64::from(i) / 30.0, f64::from(j) / 30.0);
                    let x = p + (q - p) * s + (c - p) * t;
                    let nearest = x.distance(p).min(x.distance(q)).min(x.distance(c));
                    prop_assert!(nearest <= radius * (1.0 + 1e-12), "{} {}", nearest, radius);
                }
            }
        }
    }
}
