//! Keeps the largest distance from growing.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use super::guard::Guard;
use crate::data::{FaceId, TriMesh};
use crate::geometry::distance::bvh::Bvh;
use crate::geometry::distance::point_triangle::PreparedTriangle;
use crate::geometry::distance::sample::SurfaceSampler;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::morton::morton_order;

/// Points of one chunk.
const CHUNK: usize = 4096;
/// Points on the simplified mesh for each of its faces, apart from its vertices.
const PER_FACE: usize = 8;
/// What the limit is below the largest distance of a point, since points miss the largest.
const SAFETY: f64 = 0.97;
/// A face with a point beyond this part of the limit is looked at more closely.
const DEAR: f64 = 0.7;
/// How often vertices go back before they go all the way.
const N_ROUNDS: usize = 6;
/// They go a little farther than the limit asks for, since distances change about evenly only.
const MARGIN: f64 = 0.95;

/// A point that goes with its face.
#[derive(Clone, Copy)]
struct Rider {
    face: FaceId,
    shares: [f64; 3],
}

impl Rider {
    fn place(&self, mesh: &TriMesh) -> DVec3 {
        let [a, b, c] = mesh.corners(self.face);
        self.shares[0] * a + self.shares[1] * b + self.shares[2] * c
    }
}

/// The distances of many points before, and the largest.
pub(super) struct Maximum<'a> {
    original_tree: &'a Bvh,
    /// The vertices of the original that faces use, along a curve.
    points: Vec<DVec3>,
    riders: Vec<Rider>,
    /// The squared distances of the points and of the riders before.
    before: [Vec<f64>; 2],
    limit_sq: f64,
}

impl<'a> Maximum<'a> {
    /// Of a mesh of which such a distance is already known.
    pub fn new(
        mesh: &TriMesh,
        original: &TriMesh,
        original_tree: &'a Bvh,
        known: f64,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let mut is_used = vec![false; original.positions.len()];
        original.faces.iter().flatten().for_each(|v| is_used[v.idx()] = true);
        let order = morton_order(&original.positions, control.part(0.0, 0.2))?;
        let used = order.into_iter().filter(|&v| is_used[v as usize]);
        let points = used.map(|v| original.positions[v as usize]).collect();
        let riders = riders(mesh, control.part(0.2, 0.3))?;
        let before = [Vec::new(), Vec::new()];
        let mut maximum = Self { original_tree, points, riders, before, limit_sq: 0.0 };
        let found = maximum.distances(mesh, control.part(0.3, 1.0))?;
        maximum.before = found.map(|list| list.into_iter().map(|(sq, _)| sq).collect());
        let all = maximum.before.iter().flatten().copied().filter(|sq| sq.is_finite());
        maximum.limit_sq = SAFETY * SAFETY * all.fold(known * known, f64::max);
        Ok(maximum)
    }

    /// Takes vertices back towards `start` where a point is farther than any was before; whether
    /// it did.
    pub fn hold(
        &self,
        start: &TriMesh,
        fitted: &mut TriMesh,
        guard: &Guard,
        adjacency: &Adjacency,
        control: Control,
    ) -> Result<bool, Cancelled> {
        let ways = fitted.positions.iter().zip(&start.positions);
        let moves: Vec<DVec3> = ways.map(|(to, from)| *to - *from).collect();
        let mut shares = vec![1.0; moves.len()];
        for round in 0..=N_ROUNDS {
            let part = |done: f64| (round as f64 + done) / (N_ROUNDS + 1) as f64;
            // The part of its way that each vertex may keep.
            let mut parts = vec![1.0_f64; moves.len()];
            for (sq, face) in self.beyond(start, fitted, control.part(part(0.0), part(0.9)))? {
                let kept = MARGIN * (self.limit_sq / sq).sqrt();
                // The faces around come along, so that the surface stays smooth.
                for v in fitted.faces[face.idx()] {
                    let around = adjacency.corners_of(v).iter().map(|&c| c as usize / 3);
                    around.flat_map(|f| fitted.faces[f]).for_each(|v| {
                        parts[v.idx()] = parts[v.idx()].min(kept);
                    });
                }
            }
            let mut has_moved = false;
            for (v, share) in shares.iter_mut().enumerate().filter(|(v, _)| parts[*v] < 1.0) {
                has_moved |= *share > 0.0 && moves[v] != DVec3::ZERO;
                *share *= if round + 1 < N_ROUNDS { parts[v] } else { 0.0 };
            }
            if !has_moved {
                return Ok(round > 0);
            }
            let (now, control) = (&start.positions, control.part(part(0.9), part(1.0)));
            fitted.positions =
                guard.moved(start, now, &moves, shares.clone(), adjacency, control)?;
        }
        Ok(true)
    }

    /// The squared distances that are farther than the limit and than they were, and the faces of
    /// the mesh that they belong to.
    fn beyond(
        &self,
        start: &TriMesh,
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Vec<(f64, FaceId)>, Cancelled> {
        let found = self.distances(mesh, control.part(0.0, 0.8))?;
        let mut dear: Vec<FaceId> = found[1]
            .iter()
            .filter(|(sq, _)| *sq > DEAR * DEAR * self.limit_sq)
            .map(|(_, face)| *face)
            .collect();
        dear.sort_unstable();
        dear.dedup();
        let riders: Vec<Rider> = dear.into_iter().flat_map(grid).collect();
        let now = self.rider_distances(&riders, mesh, control.part(0.8, 0.9))?;
        let before = self.rider_distances(&riders, start, control.part(0.9, 1.0))?;
        let dense = now.into_iter().zip(before.into_iter().map(|(sq, _)| sq));
        let pairs = found.into_iter().zip(&self.before);
        let all = pairs.flat_map(|(now, before)| now.into_iter().zip(before.iter().copied()));
        let beyond = all.chain(dense).filter(|((sq, _), before)| sq > before);
        Ok(beyond.map(|(now, _)| now).filter(|(sq, _)| *sq > self.limit_sq).collect())
    }

    /// Squared distance of each point and of each rider, with the face of the mesh that it belongs
    /// to; not a number where a place is not finite.
    fn distances(
        &self,
        mesh: &TriMesh,
        control: Control,
    ) -> Result<[Vec<(f64, FaceId)>; 2], Cancelled> {
        let tree = Bvh::build(mesh, control.part(0.0, 0.2))?;
        let points = distances(&tree, &self.points, control.part(0.2, 0.6))?;
        let riders = self.rider_distances(&self.riders, mesh, control.part(0.6, 1.0))?;
        Ok([points, riders])
    }

    fn rider_distances(
        &self,
        riders: &[Rider],
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Vec<(f64, FaceId)>, Cancelled> {
        let places: Vec<DVec3> = riders.iter().map(|rider| rider.place(mesh)).collect();
        let mut found = distances(self.original_tree, &places, control)?;
        found.iter_mut().zip(riders).for_each(|((_, face), rider)| *face = rider.face);
        Ok(found)
    }
}

/// The corners of all faces, and samples between.
fn riders(mesh: &TriMesh, control: Control) -> Result<Vec<Rider>, Cancelled> {
    let sampler = SurfaceSampler::new(mesh, PER_FACE * mesh.faces.len(), 0, control)?;
    let mut riders = Vec::with_capacity((PER_FACE + 3) * mesh.faces.len());
    let mut last = None;
    for sample in sampler.samples(0..sampler.n_samples()) {
        if last != Some(sample.face) {
            last = Some(sample.face);
            let corner = |k: usize| [0, 1, 2].map(|other| f64::from(u8::from(other == k)));
            riders.extend([0, 1, 2].map(|k| Rider { face: sample.face, shares: corner(k) }));
        }
        let triangle = PreparedTriangle::new(mesh.corners(sample.face));
        riders.push(Rider { face: sample.face, shares: triangle.coordinates(sample.point) });
    }
    Ok(riders)
}

/// Points all over a face.
fn grid(face: FaceId) -> impl Iterator<Item = Rider> {
    const N: u32 = 12;
    let share = |k: u32| f64::from(k) / f64::from(N);
    let row = move |i: u32| (0..=N - i).map(move |j| [share(i), share(j), share(N - i - j)]);
    (0..=N).flat_map(row).map(move |shares| Rider { face, shares })
}

/// Squared distance and nearest face of each point; not a number, and any face, where it is not
/// finite.
fn distances(
    tree: &Bvh,
    points: &[DVec3],
    control: Control,
) -> Result<Vec<(f64, FaceId)>, Cancelled> {
    let steps = control.steps(points.len().div_ceil(CHUNK));
    let found: Vec<Vec<_>> = points
        .par_chunks(CHUNK)
        .map(|points| {
            let mut walker = tree.walker();
            let mut found = Vec::with_capacity(points.len());
            for &point in points {
                let hit = walker.closest(point).map(|hit| (hit.distance_sq, hit.face));
                found.push(hit.unwrap_or((f64::NAN, FaceId(0))));
                walker.poll(&control)?;
            }
            steps.step()?;
            Ok(found)
        })
        .collect::<Result<_, Cancelled>>()?;
    Ok(found.concat())
}
