//! Keeps the largest distance from growing.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::{FaceId, TriMesh, VertexId};

use super::guard::Guard;
use crate::geometry::distance::bvh::{Bvh, Hit};
use crate::geometry::distance::many::ManyQueries;

/// What the limit is below the largest distance of a point, since points miss the largest.
const SAFETY: f64 = 0.97;
/// A face with a point beyond this part of the limit is looked at more closely.
const DEAR: f64 = 0.7;
/// Points that began within this part of the limit, of a face, are looked at again only where that
/// face has moved by as much as is missing to [`DEAR`].
const NEAR: f64 = 0.5;
/// Faces that are looked at closely at a time: each takes some kilobytes.
const FACES_AT_ONCE: usize = 1 << 14;
/// How often vertices go back before they go all the way; after twice as many rounds all do.
const N_ROUNDS: usize = 6;
/// They go a little farther than the limit asks for, since distances change about evenly only.
const MARGIN: f64 = 0.95;

/// A squared distance, and the face of the mesh that it belongs to.
type Far = (f64, FaceId);

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

/// A place, and a face of the mesh at the start that is near to it or has it.
#[derive(Clone, Copy)]
struct Watched<T> {
    what: T,
    /// `None` where it began far away: it is looked at in any case.
    near: Option<FaceId>,
}

/// The largest distance before, and the points that no vertex may take farther.
pub(super) struct Maximum<'a> {
    /// Of the original.
    queries: &'a ManyQueries<'a>,
    /// The vertices of the original that faces use, along a curve.
    points: Vec<Watched<DVec3>>,
    /// Corners, the middles of edges and those of faces, along a curve.
    riders: Vec<Watched<Rider>>,
    limit: f64,
}

impl<'a> Maximum<'a> {
    /// Of a mesh of which such a distance is already known; `tree` is of the mesh.
    pub fn new(
        mesh: &TriMesh,
        original: &TriMesh,
        tree: &Bvh,
        queries: &'a ManyQueries<'a>,
        known: f64,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let mut is_known = vec![false; original.positions.len()];
        let mut points = Vec::with_capacity(original.positions.len());
        for (at, face) in queries.tree().faces().iter().enumerate() {
            control.item(at, usize::MAX)?;
            for v in original.faces[face.idx()] {
                if !std::mem::replace(&mut is_known[v.idx()], true) {
                    points.push(original.positions[v.idx()]);
                }
            }
        }
        let riders = riders(mesh, tree, control.part(0.2, 0.3))?;
        let places: Vec<DVec3> = riders.iter().map(|rider| rider.place(mesh)).collect();

        let distance = SAFETY * NEAR * known;
        let ours = ManyQueries::new(tree, queries.tree().center());
        let of_points = ours.nearby(&points, distance, control.part(0.3, 0.6))?;
        let of_riders = queries.nearby(&places, distance, control.part(0.6, 1.0))?;
        let all = of_points.iter().chain(&of_riders).flatten();
        let most_sq = all.fold(known * known, |most, hit| most.max(hit.distance_sq));
        let is_near = |hit: &Option<Hit>| {
            hit.filter(|hit| hit.distance_sq <= distance * distance).map(|hit| hit.face)
        };
        let points = points.into_iter().zip(&of_points);
        let points = points.map(|(what, hit)| Watched { what, near: is_near(hit) }).collect();
        let riders = riders.into_iter().zip(&of_riders);
        let riders = riders
            .map(|(what, hit)| Watched { what, near: is_near(hit).map(|_| what.face) })
            .collect();
        Ok(Self { queries, points, riders, limit: SAFETY * most_sq.sqrt() })
    }

    /// Takes vertices back towards `start` where a point is farther than any was before.
    pub fn hold(
        &self,
        start: &TriMesh,
        fitted: &mut TriMesh,
        guard: &Guard,
        adjacency: &Adjacency,
        control: Control,
    ) -> Result<(), Cancelled> {
        let ways = fitted.positions.iter().zip(&start.positions);
        // Of infinite coordinates, too, which stay, the difference is none.
        let way = |(to, from): (&DVec3, &DVec3)| if to == from { DVec3::ZERO } else { *to - *from };
        let moves: Vec<DVec3> = ways.map(way).collect();
        let mut shares = vec![1.0; moves.len()];
        for round in 0..2 * N_ROUNDS {
            let part = |done: f64| (round as f64 + done) / (2 * N_ROUNDS) as f64;
            let mut nearby = vec![1.0_f64; moves.len()];
            let here = control.part(part(0.0), part(0.8));
            for (sq, face) in self.beyond(start, fitted, here)? {
                let kept = MARGIN * self.limit / sq.sqrt();
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
                return Ok(());
            }
            let (now, here) = (&start.positions, control.part(part(0.8), part(1.0)));
            fitted.positions = guard.moved(start, now, &moves, shares.clone(), adjacency, here)?;
        }
        // What is still farther would take others along without end.
        fitted.positions.clone_from(&start.positions);
        Ok(())
    }

    /// The distances that are larger than the limit and than they were, and the faces of the mesh
    /// that they belong to.
    fn beyond(
        &self,
        start: &TriMesh,
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Vec<Far>, Cancelled> {
        // What was within a part of the limit, of a face that has hardly moved, still is.
        let slack = (DEAR - NEAR) * self.limit;
        let has_moved = |face: &[VertexId; 3]| {
            face.iter().any(|v| mesh.positions[v.idx()].distance(start.positions[v.idx()]) > slack)
        };
        let has_moved: Vec<bool> = mesh.faces.iter().map(has_moved).collect();
        let is_due = |near: Option<FaceId>| near.is_none_or(|face| has_moved[face.idx()]);
        let points: Vec<DVec3> =
            self.points.iter().filter(|w| is_due(w.near)).map(|w| w.what).collect();
        // What a face takes nowhere is as far as it was.
        let stays = |face: &[VertexId; 3]| {
            face.iter().all(|v| mesh.positions[v.idx()] == start.positions[v.idx()])
        };
        let riders = self.riders.iter().filter(|w| is_due(w.near)).map(|w| w.what);
        let riders: Vec<Rider> =
            riders.filter(|rider| !stays(&mesh.faces[rider.face.idx()])).collect();
        let far = self.points_beyond(&points, mesh, control.part(0.0, 0.4))?;
        let dear = self.riders_beyond(&riders, mesh, DEAR * self.limit, control.part(0.4, 0.8))?;
        let dear: Vec<Rider> = dear.into_iter().map(|(at, _)| riders[at]).collect();
        let mut faces: Vec<FaceId> = dear.iter().map(|rider| rider.face).collect();
        faces.sort_unstable();
        faces.dedup();

        let control = control.part(0.8, 1.0);
        let was: Vec<DVec3> = far.iter().map(|(at, _)| points[*at]).collect();
        let before = self.point_distances_sq(&was, start, control.part(0.0, 0.1))?;
        let now = far.into_iter().map(|(_, hit)| (hit.distance_sq, hit.face));
        let all = now.zip(before).filter(|((sq, _), before)| sq > before);
        let mut beyond: Vec<Far> = all.map(|(now, _)| now).collect();
        self.add_farther(&dear, (start, mesh), &mut beyond, control.part(0.1, 0.2))?;
        let n = faces.len().max(1) as f64;
        for (chunk, faces) in faces.chunks(FACES_AT_ONCE).enumerate() {
            let done = |chunk: usize| 0.2 + 0.8 * (chunk * FACES_AT_ONCE) as f64 / n;
            let here = control.part(done(chunk), done(chunk + 1).min(1.0));
            let dense: Vec<Rider> = faces.iter().flat_map(|face| grid(*face)).collect();
            self.add_farther(&dense, (start, mesh), &mut beyond, here)?;
        }
        Ok(beyond)
    }

    /// Adds the riders that are beyond the limit, and farther than they were.
    fn add_farther(
        &self,
        riders: &[Rider],
        (start, mesh): (&TriMesh, &TriMesh),
        beyond: &mut Vec<Far>,
        control: Control,
    ) -> Result<(), Cancelled> {
        let found = self.riders_beyond(riders, mesh, self.limit, control.part(0.0, 0.8))?;
        let was: Vec<DVec3> = found.iter().map(|(at, _)| riders[*at].place(start)).collect();
        let before = distances_sq(self.queries, &was, control.part(0.8, 1.0))?;
        let farther = found.into_iter().zip(before);
        let farther = farther.filter(|((_, hit), before)| hit.distance_sq > *before);
        beyond.extend(farther.map(|((at, hit), _)| (hit.distance_sq, riders[at].face)));
        Ok(())
    }

    /// The points farther than the limit from a mesh.
    fn points_beyond(
        &self,
        points: &[DVec3],
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Vec<(usize, Hit)>, Cancelled> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        let tree = Bvh::build_quickly(mesh, control.part(0.0, 0.4))?;
        let queries = ManyQueries::new(&tree, self.queries.tree().center());
        queries.farther(points, self.limit, control.part(0.4, 1.0))
    }

    /// The riders farther than this from the original, where the mesh takes them.
    fn riders_beyond(
        &self,
        riders: &[Rider],
        mesh: &TriMesh,
        distance: f64,
        control: Control,
    ) -> Result<Vec<(usize, Hit)>, Cancelled> {
        let places: Vec<DVec3> = riders.iter().map(|rider| rider.place(mesh)).collect();
        self.queries.farther(&places, distance, control)
    }

    /// The squared distances of points from a mesh.
    fn point_distances_sq(
        &self,
        points: &[DVec3],
        mesh: &TriMesh,
        control: Control,
    ) -> Result<Vec<f64>, Cancelled> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        let tree = Bvh::build_quickly(mesh, control.part(0.0, 0.3))?;
        let queries = ManyQueries::new(&tree, self.queries.tree().center());
        distances_sq(&queries, points, control.part(0.3, 1.0))
    }
}

/// Points of the mesh that its faces take along, in the order of its tree.
fn riders(mesh: &TriMesh, tree: &Bvh, control: Control) -> Result<Vec<Rider>, Cancelled> {
    const HALF: f64 = 0.5;
    const PLACES: [[f64; 3]; 4] =
        [[1.0 / 3.0; 3], [0.0, HALF, HALF], [HALF, 0.0, HALF], [HALF, HALF, 0.0]];
    let mut is_known = vec![false; mesh.positions.len()];
    let mut riders = Vec::with_capacity(5 * mesh.faces.len());
    for (at, &face) in tree.faces().iter().enumerate() {
        control.item(at, tree.n_faces())?;
        for (k, v) in mesh.faces[face.idx()].into_iter().enumerate() {
            if !std::mem::replace(&mut is_known[v.idx()], true) {
                let shares = [0, 1, 2].map(|other| f64::from(u8::from(other == k)));
                riders.push(Rider { face, shares });
            }
        }
        riders.extend(PLACES.map(|shares| Rider { face, shares }));
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

/// The squared distances of points from a surface; of those that are not finite, infinite.
fn distances_sq(
    queries: &ManyQueries,
    points: &[DVec3],
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let found = queries.closest(points, control)?.into_iter();
    Ok(found.map(|hit| hit.map_or(f64::INFINITY, |hit| hit.distance_sq)).collect())
}
