//! Keeps the largest distance from growing.

use glam::DVec3;
use mve_core::{Cancelled, Control};

use super::guard::Guard;
use crate::data::{FaceId, TriMesh, VertexId};
use crate::geometry::distance::bvh::{Bvh, Hit};
use crate::geometry::distance::many::ManyQueries;
use crate::geometry::distance::point_triangle::PreparedTriangle;
use crate::geometry::distance::sample::SurfaceSampler;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::morton::morton_order;

/// Points on the simplified mesh for each of its faces, apart from its vertices.
const PER_FACE: usize = 8;
/// What the limit is below the largest distance of a point, since points miss the largest.
const SAFETY: f64 = 0.97;
/// A face with a point beyond this part of the limit is looked at more closely.
const DEAR: f64 = 0.7;
/// How often vertices go back before they go all the way; after twice as many rounds all do.
const N_ROUNDS: usize = 6;
/// They go a little farther than the limit asks for, since distances change about evenly only.
const MARGIN: f64 = 0.95;

/// The squared distance of each of some points, with the face of the mesh that it belongs to; not a
/// number, and any face, where a place is not finite.
type Distances = Vec<(f64, FaceId)>;

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
    /// Of the original.
    queries: &'a ManyQueries<'a>,
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
        queries: &'a ManyQueries<'a>,
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
        let mut maximum = Self { queries, points, riders, before, limit_sq: 0.0 };
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
        // Of infinite coordinates, too, which stay, the difference is none.
        let way = |(to, from): (&DVec3, &DVec3)| if to == from { DVec3::ZERO } else { *to - *from };
        let moves: Vec<DVec3> = ways.map(way).collect();
        let mut shares = vec![1.0; moves.len()];
        let mut found = self.distances(fitted, control.part(0.0, 0.5))?;
        for round in 0..2 * N_ROUNDS {
            let part = |done: f64| 0.5 + 0.5 * (round as f64 + done) / (2 * N_ROUNDS) as f64;
            let mut nearby = vec![1.0_f64; moves.len()];
            let here = control.part(part(0.0), part(0.5));
            for (sq, face) in self.beyond(start, fitted, &found, here)? {
                let kept = MARGIN * (self.limit_sq / sq).sqrt();
                fitted.faces[face.idx()].iter().for_each(|v| {
                    nearby[v.idx()] = nearby[v.idx()].min(kept);
                });
            }
            // The part of its way that each vertex may keep. The faces around come along, so that
            // the surface stays smooth.
            let mut parts = nearby.clone();
            for face in &fitted.faces {
                let least = face.iter().map(|v| nearby[v.idx()]).fold(1.0, f64::min);
                face.iter().for_each(|v| parts[v.idx()] = parts[v.idx()].min(least));
            }
            let mut has_moved = false;
            for (v, share) in shares.iter_mut().enumerate().filter(|(v, _)| parts[*v] < 1.0) {
                has_moved |= *share > 0.0 && moves[v] != DVec3::ZERO;
                *share *= if round + 1 < N_ROUNDS { parts[v] } else { 0.0 };
            }
            if !has_moved {
                return Ok(round > 0);
            }
            let (now, here) = (&start.positions, control.part(part(0.5), part(0.6)));
            let back = guard.moved(start, now, &moves, shares.clone(), adjacency, here)?;
            let is_moved = |v: VertexId| back[v.idx()] != fitted.positions[v.idx()];
            let touched: Vec<bool> =
                fitted.faces.iter().map(|face| face.iter().any(|v| is_moved(*v))).collect();
            fitted.positions = back;
            self.renew(fitted, &touched, &mut found, control.part(part(0.6), part(1.0)))?;
        }
        // What is still farther would take others along without end.
        fitted.positions.clone_from(&start.positions);
        Ok(true)
    }

    /// Those of the distances that are farther than the limit and than they were, and the faces of
    /// the mesh that they belong to.
    fn beyond(
        &self,
        start: &TriMesh,
        mesh: &TriMesh,
        found: &[Distances; 2],
        control: Control,
    ) -> Result<Distances, Cancelled> {
        let dear = found[1].iter().filter(|(sq, _)| *sq > DEAR * DEAR * self.limit_sq);
        let mut dear: Vec<FaceId> = dear.map(|(_, face)| *face).collect();
        dear.sort_unstable();
        dear.dedup();
        let riders: Vec<Rider> = dear.into_iter().flat_map(grid).collect();
        let now = self.rider_distances(&riders, mesh, control.part(0.0, 0.5))?;
        let before = self.rider_distances(&riders, start, control.part(0.5, 1.0))?;
        let dense = now.into_iter().zip(before.into_iter().map(|(sq, _)| sq));
        let pairs = found.iter().zip(&self.before);
        let all = pairs.flat_map(|(now, before)| now.iter().copied().zip(before.iter().copied()));
        let beyond = all.chain(dense).filter(|((sq, _), before)| sq > before);
        Ok(beyond.map(|(now, _)| now).filter(|(sq, _)| *sq > self.limit_sq).collect())
    }

    /// The distances of the points and of the riders.
    fn distances(&self, mesh: &TriMesh, control: Control) -> Result<[Distances; 2], Cancelled> {
        let points = self.point_distances(&self.points, mesh, control.part(0.0, 0.6))?;
        let riders = self.rider_distances(&self.riders, mesh, control.part(0.6, 1.0))?;
        Ok([points, riders])
    }

    /// Finds anew what belongs to faces that were touched.
    fn renew(
        &self,
        mesh: &TriMesh,
        touched: &[bool],
        found: &mut [Distances; 2],
        control: Control,
    ) -> Result<(), Cancelled> {
        let stale = |found: &Distances| -> Vec<usize> {
            let all = found.iter().enumerate();
            all.filter(|(_, (_, face))| touched[face.idx()]).map(|(at, _)| at).collect()
        };
        let [points, riders] = [stale(&found[0]), stale(&found[1])];
        let places: Vec<DVec3> = points.iter().map(|&at| self.points[at]).collect();
        let renewed = self.point_distances(&places, mesh, control.part(0.0, 0.6))?;
        points.into_iter().zip(renewed).for_each(|(at, renewed)| found[0][at] = renewed);
        let on_mesh: Vec<Rider> = riders.iter().map(|&at| self.riders[at]).collect();
        let renewed = self.rider_distances(&on_mesh, mesh, control.part(0.6, 1.0))?;
        riders.into_iter().zip(renewed).for_each(|(at, renewed)| found[1][at] = renewed);
        Ok(())
    }

    fn point_distances(
        &self,
        points: &[DVec3],
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Distances, Cancelled> {
        let tree = Bvh::build(mesh, control.part(0.0, 0.3))?;
        let queries = ManyQueries::new(&tree, self.queries.tree().center());
        distances(&queries, points, control.part(0.3, 1.0))
    }

    fn rider_distances(
        &self,
        riders: &[Rider],
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Distances, Cancelled> {
        let places: Vec<DVec3> = riders.iter().map(|rider| rider.place(mesh)).collect();
        let mut found = distances(self.queries, &places, control)?;
        found.iter_mut().zip(riders).for_each(|((_, face), rider)| *face = rider.face);
        Ok(found)
    }
}

/// The corners of all faces, and samples between.
fn riders(mesh: &TriMesh, control: Control) -> Result<Vec<Rider>, Cancelled> {
    let n = PER_FACE * mesh.faces.len();
    let sampler = SurfaceSampler::new(mesh, n, 0, control.part(0.0, 0.3))?;
    let mut riders = Vec::with_capacity((PER_FACE + 3) * mesh.faces.len());
    let corner = |k: usize| [0, 1, 2].map(|other| f64::from(u8::from(other == k)));
    for face in 0..mesh.faces.len() {
        control.item(face, mesh.faces.len())?;
        let face = FaceId(face as u32);
        riders.extend([0, 1, 2].map(|k| Rider { face, shares: corner(k) }));
    }
    for (at, sample) in sampler.samples(0..sampler.n_samples()).enumerate() {
        control.item(at, n)?;
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

/// The distances of points from a surface, with its nearest faces.
fn distances(
    queries: &ManyQueries,
    points: &[DVec3],
    control: Control,
) -> Result<Distances, Cancelled> {
    let found = queries.closest(points, control)?.into_iter();
    let of_hit = |hit: Hit| (hit.distance_sq, hit.face);
    Ok(found.map(|hit| hit.map_or((f64::NAN, FaceId(0)), of_hit)).collect())
}
