//! The largest distance of a surface from another, between two bounds.
//!
//! Branch and bound over parts of faces, as in Kang, Kyung, Yoon & Kim, "Fast and robust Hausdorff
//! distance computation from triangle mesh to quad mesh in near-zero cases", CAGD 2018, with these
//! bounds:
//!
//! - The distance from one triangle of the target is a convex function of the point, so over a
//!   convex piece of a face it is largest at a corner, and so is the distance from the whole
//!   target at most `min over triangles t of (max over corners of distance to t)`. The triangles
//!   tried are those nearest to the corners and to the center.
//! - Where the target is finer than the part, [`covered`] bounds better: the distance changes no
//!   faster than the point moves.
//! - A part over several triangles is cut along their sides until each piece is over one of them:
//!   [`Splitter::cover`]. The first bound then holds piece by piece, wherever the cuts are. Two
//!   triangulations of the same plane need this, as a part over an edge between two triangles
//!   otherwise stays open until it is as small as the tolerance.
//!
//! A part whose bound exceeds the largest distance found so far by more than the tolerance, a part
//! of that distance, is split in four. Parts are looked at in rounds, whose results do not depend
//! on threads.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};
use rayon::prelude::*;

use super::bvh::{Bvh, Hit, Walker};
use super::polygon::Polygon;

/// Parts of one chunk.
const CHUNK: usize = 1024;
/// Pieces that one part is cut into before it is split in four instead: more close more parts, but
/// cost more where they fail. Of 16, 32 and 64 the middle one took the least time on scans, sharp
/// models and cylinders against their halves and tenths.
const MOST_CUTS: usize = 32;

/// Parts that are longer than so many times their height are walked along.
const SLIVER: f64 = 16.0;
/// In steps whose half is this part of the limit,
const BALL: f64 = 0.75;
/// and no more of them than this.
const MOST_STEPS: f64 = 256.0;

/// The farthest point so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FarthestPoint {
    pub distance_sq: f64,
    pub point: DVec3,
}

impl FarthestPoint {
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
    /// A part of the largest distance.
    pub tolerance: f64,
    /// Parts that are no farther than this beyond the largest distance need no closer look, in
    /// model units: where both surfaces are one, there is nothing to be relative to.
    pub least_tolerance: f64,
    /// After so many parts other than faces and quarters of faces the search ends.
    pub max_parts: usize,
}

/// A part of a face that may hold the maximum.
#[derive(Clone, Copy)]
struct Part {
    corners: [DVec3; 3],
    hits: [Hit; 3],
    /// Of the center; any in parts that are let go.
    center: Hit,
    /// No point of the part is farther, squared.
    bound_sq: f64,
}

/// Raises `most` to the largest distance within the tolerance, and returns an upper bound.
pub(super) fn search(
    task: &MaxSearch,
    most: &mut FarthestPoint,
    control: Control,
) -> Result<f64, Cancelled> {
    let mut round = merged(
        task.faces
            .par_chunks(CHUNK)
            .map(|chunk| {
                control.at(0.0)?;
                first_parts(task, chunk, *most, &control)
            })
            .collect::<Result<_, Cancelled>>()?,
        most,
        control,
    )?;
    let mut n_seen = 0;
    let max_parts = task.max_parts.saturating_add(4 * task.faces.len());
    // The largest bound among the parts that were let go.
    let mut closed_sq = most.distance_sq.max(0.0);
    loop {
        let done = (n_seen as f64 / max_parts.max(1) as f64).min(1.0);
        let here = control.part(done, done);
        let limit_sq = limit_sq(task, most);
        closed_sq = closed_sq.max(round.closed_sq);
        let mut parts = round.open;
        parts.retain(|part| {
            let is_open = part.bound_sq > limit_sq;
            if !is_open {
                closed_sq = closed_sq.max(part.bound_sq);
            }
            is_open
        });
        n_seen += 4 * parts.len();
        if parts.is_empty() || n_seen > max_parts {
            let open_sq = parts.iter().map(|part| part.bound_sq).fold(0.0, f64::max);
            return Ok(closed_sq.max(open_sq).max(most.distance_sq).sqrt());
        }
        let rounds = parts
            .par_chunks(CHUNK)
            .map(|chunk| {
                here.at(0.0)?;
                split_all(task, chunk, *most, &here)
            })
            .collect::<Result<_, Cancelled>>()?;
        drop(parts);
        round = merged(rounds, most, here)?;
    }
}

/// What became of the parts of a chunk or of a round.
struct Round {
    /// Parts that may hold the maximum.
    open: Vec<Part>,
    found: FarthestPoint,
    /// The largest bound of the parts that were let go.
    closed_sq: f64,
}

/// Puts the chunks of a round together.
fn merged(
    chunks: Vec<Round>,
    most: &mut FarthestPoint,
    control: Control,
) -> Result<Round, Cancelled> {
    let n_open = chunks.iter().map(|chunk| chunk.open.len()).sum();
    let mut round = Round { open: Vec::with_capacity(n_open), found: *most, closed_sq: 0.0 };
    for chunk in chunks {
        control.at(0.0)?;
        round.open.extend(chunk.open);
        round.closed_sq = round.closed_sq.max(chunk.closed_sq);
        most.offer(chunk.found.distance_sq, chunk.found.point);
    }
    Ok(round)
}

/// Parts up to this squared bound need no closer look.
fn limit_sq(task: &MaxSearch, most: &FarthestPoint) -> f64 {
    let most = most.distance_sq.max(0.0).sqrt();
    let limit = most * (1.0 + 1e-12) + task.least_tolerance.max(task.tolerance * most);
    limit * limit
}

/// Bounds faces as they are.
fn first_parts(
    task: &MaxSearch,
    faces: &[FaceId],
    most: FarthestPoint,
    control: &Control,
) -> Result<Round, Cancelled> {
    let mut splitter = Splitter::new(task, most);
    for face in faces {
        let hits = task.mesh.faces[face.idx()].map(|v| task.vertex_hits[v.idx()]);
        // The corners of usable faces are usable.
        let [Some(a), Some(b), Some(c)] = hits else { continue };
        splitter.add(task.mesh.corners(*face), [a, b, c], a, f64::INFINITY);
        splitter.walker.poll(control)?;
    }
    Ok(splitter.round)
}

/// Splits parts.
fn split_all(
    task: &MaxSearch,
    parts: &[Part],
    most: FarthestPoint,
    control: &Control,
) -> Result<Round, Cancelled> {
    let mut splitter = Splitter::new(task, most);
    for part in parts {
        if !splitter.walk_along(part) && !splitter.cover(part) {
            splitter.quarter(part);
        }
        splitter.walker.poll(control)?;
    }
    Ok(splitter.round)
}

/// Bounds and splits the parts of one chunk.
struct Splitter<'a> {
    walker: Walker<'a>,
    limit_sq: f64,
    round: Round,
    /// What is left of the part in work, each with a triangle that it was cut off from.
    pieces: Vec<(Polygon, Hit)>,
    /// Steps along a thin part that are left, as parts of its longest side.
    steps: Vec<(f64, f64)>,
}

impl<'a> Splitter<'a> {
    fn new(task: &MaxSearch<'a>, most: FarthestPoint) -> Self {
        Self {
            walker: task.to.walker(),
            limit_sq: limit_sq(task, &most),
            round: Round { open: Vec::new(), found: most, closed_sq: 0.0 },
            pieces: Vec::new(),
            steps: Vec::new(),
        }
    }

    /// Bounds a part of what was bounded by `bound_sq`; keeps it if it may hold the maximum.
    /// `near` is a hit of a point near it.
    fn add(&mut self, corners: [DVec3; 3], hits: [Hit; 3], near: Hit, bound_sq: f64) {
        let mut part = self.bounded(corners, hits, near);
        part.bound_sq = part.bound_sq.min(bound_sq);
        if part.bound_sq > self.limit_sq {
            self.round.open.push(part);
        } else {
            self.close(part.bound_sq);
        }
    }

    /// Lets something go.
    fn close(&mut self, bound_sq: f64) {
        self.round.closed_sq = self.round.closed_sq.max(bound_sq);
    }

    /// Splits a part in four at the middles of its sides.
    fn quarter(&mut self, part: &Part) {
        let [a, b, c] = part.corners;
        let middles = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        self.walker.start_from(&part.center);
        let [Some(hit_ab), Some(hit_bc), Some(hit_ca)] = middles.map(|m| self.walker.closest(m))
        else {
            // Middles of usable points are usable.
            return self.close(part.bound_sq);
        };
        for (hit, middle) in [hit_ab, hit_bc, hit_ca].iter().zip(middles) {
            self.round.found.offer(hit.distance_sq, middle);
        }
        let [ab, bc, ca] = middles;
        let [hit_a, hit_b, hit_c] = part.hits;
        self.add([a, ab, ca], [hit_a, hit_ab, hit_ca], part.center, part.bound_sq);
        self.add([ab, b, bc], [hit_ab, hit_b, hit_bc], part.center, part.bound_sq);
        self.add([ca, bc, c], [hit_ca, hit_bc, hit_c], part.center, part.bound_sq);
        self.add([ab, bc, ca], [hit_ab, hit_bc, hit_ca], part.center, part.bound_sq);
    }

    /// Tries to let a long thin part go by balls along its longest side; says whether it did.
    ///
    /// With `d` the distance of a point of the side, no point within `r` of it is farther than
    /// `d + r`. That needs no nearest face, but any within the limit less `r`, which is
    /// found sooner.
    fn walk_along(&mut self, part: &Part) -> bool {
        let [a, b, c] = part.corners;
        let sides = [(a, b, c), (b, c, a), (c, a, b)];
        let length_sq = |(from, to, _): &(DVec3, DVec3, DVec3)| from.distance_squared(*to);
        let longest = sides.into_iter().max_by(|a, b| length_sq(a).total_cmp(&length_sq(b)));
        let (from, to, peak) = longest.unwrap_or(sides[0]);
        let side = to - from;
        let length = side.length();
        // Points of the part are no farther from the side than the third corner, if that is beside
        // it, as it is where no side is longer.
        let height = (peak - from).cross(side).length() / length;
        let limit = self.limit_sq.sqrt();
        if !(length > SLIVER * height && BALL * limit > 2.0 * height) {
            return false;
        }
        let n_steps = (length / (2.0 * BALL * limit)).ceil();
        if n_steps > MOST_STEPS {
            return false;
        }
        self.walker.start_from(&part.center);
        let mut bound = 0.0f64;
        self.steps.clear();
        let ends = |k: f64| (k / n_steps, (k + 1.0) / n_steps);
        self.steps.extend((0..n_steps as u32).rev().map(|k| ends(f64::from(k))));
        let shortest = 1.0 / (8.0 * n_steps);
        while let Some((start, end)) = self.steps.pop() {
            let center = from + side * (0.5 * (start + end));
            // Wider by the rounding of the ends.
            let radius = (0.5 * (end - start) * length).hypot(height) * (1.0 + 1e-9);
            let enough = (limit - radius).max(0.0);
            let Some(hit) = self.walker.reach(center, enough * enough) else { return false };
            let distance = hit.distance_sq.sqrt();
            if distance + radius <= limit {
                bound = bound.max(distance + radius);
                continue;
            }
            // Nothing is near enough, so this is the nearest.
            self.round.found.offer(hit.distance_sq, center);
            if end - start < shortest {
                return false;
            }
            let middle = 0.5 * (start + end);
            self.steps.extend([(middle, end), (start, middle)]);
        }
        self.close((bound * bound).min(part.bound_sq));
        true
    }

    /// Tries to let a part go by cutting it along the sides of the triangles that it is over;
    /// says whether it did.
    ///
    /// The pieces cover the part but for the rounding of their corners, whatever is cut off where,
    /// and each is let go by the largest distance of its corners from one triangle `t`. That
    /// distance is convex, so no point of the piece is farther from `t`, nor from the target, and
    /// the largest of these bounds is one of the part. Slivers are pieces like others: none is
    /// dropped. After [`MOST_CUTS`], or when a piece has nothing over the triangle nearest to its
    /// center, the pieces are forgotten and the part is left to [`Splitter::quarter`].
    fn cover(&mut self, part: &Part) -> bool {
        let mut bound_sq = 0.0f64;
        let mut center = Some(part.center);
        self.pieces.clear();
        self.pieces.push((Polygon::of(part.corners), part.center));
        for _ in 0..MOST_CUTS {
            let Some((piece, beside)) = self.pieces.pop() else {
                self.close(bound_sq.min(part.bound_sq));
                return true;
            };
            // The whole part's center is known, and no triangle nearest to a corner closes it.
            let known = center.take();
            if known.is_none() {
                let by_beside = piece.most_sq(self.walker.triangle(&beside));
                if by_beside <= self.limit_sq {
                    bound_sq = bound_sq.max(by_beside);
                    continue;
                }
            }
            let Some(hit) = known.or_else(|| self.ask(piece.center(), &beside)) else {
                return false;
            };
            let Some(by_target) = self.cut_off(piece, &hit) else { return false };
            bound_sq = bound_sq.max(by_target);
        }
        false
    }

    /// The triangle nearest to a point near `start`; the point may be the farthest.
    fn ask(&mut self, point: DVec3, start: &Hit) -> Option<Hit> {
        self.walker.start_from(start);
        let hit = self.walker.closest(point)?;
        self.round.found.offer(hit.distance_sq, point);
        Some(hit)
    }

    /// Lets go what of the piece is over the triangle of `hit` and leaves the rest in `pieces`.
    /// Returns the squared bound of what it let go, or nothing when it left all as it was.
    ///
    /// "Over" is wider than the triangle by a margin at first: as long as points stay nearer than
    /// the largest distance found, it costs nothing, and takes along what is nearest to a side.
    fn cut_off(&mut self, piece: Polygon, hit: &Hit) -> Option<f64> {
        let target = *self.walker.triangle(hit);
        let n_pieces = self.pieces.len();
        let margin = 0.5 * (self.round.found.distance_sq - hit.distance_sq).max(0.0).sqrt();
        for margin in [margin, 0.0] {
            let mut inside = piece;
            for (side, slope) in target.slopes().into_iter().enumerate() {
                let (within, beyond) = inside.cut(&target, side, margin * slope)?;
                if within.n == 0 {
                    return None;
                }
                if beyond.n > 0 {
                    self.pieces.push((beyond, *hit));
                }
                inside = within;
            }
            let bound_sq = inside.most_sq(&target);
            if bound_sq <= self.limit_sq {
                return Some(bound_sq);
            }
            self.pieces.truncate(n_pieces);
        }
        None
    }

    /// Bounds the distance over a triangle whose corners have these hits.
    fn bounded(&mut self, corners: [DVec3; 3], hits: [Hit; 3], near: Hit) -> Part {
        let mut part = Part { corners, hits, center: near, bound_sq: f64::INFINITY };
        let most_sq = |walker: &Walker, hit: &Hit| {
            corners.iter().map(|&p| walker.distance_sq_to(p, hit)).fold(0.0, f64::max)
        };
        for hit in hits.iter().chain([&near]) {
            part.bound_sq = part.bound_sq.min(most_sq(&self.walker, hit));
            if part.bound_sq <= self.limit_sq {
                return part;
            }
        }
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        if let Some(hit) = self.ask(center, &near) {
            part.center = hit;
            let by_center = covered(corners, hits.map(|h| h.distance_sq), center, hit.distance_sq);
            part.bound_sq =
                part.bound_sq.min(most_sq(&self.walker, &hit)).min(by_center * by_center);
        }
        part
    }
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
        fn every_point_of_a_triangle_is_covered(
            p in any_point(),
            q in any_point(),
            c in any_point(),
        ) {
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
