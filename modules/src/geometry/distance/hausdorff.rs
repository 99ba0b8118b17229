//! Distances between two surfaces: Hausdorff, mean and root mean square.
//!
//! The distance of a point from a surface is that to the nearest point of it. Seen from mesh A, the
//! mean and the RMS are integrals over the area of A divided by that area, estimated without bias
//! from area-uniform samples alone (Cignoni, Rocchini & Scopigno, "Metro: measuring error on
//! simplified surfaces", CGF 1998); vertices and edges never enter them. The maximum is sought over
//! the samples, all vertices that faces use, the edges, and by bisection (`hausdorff_max`).
//!
//! The result is the same for any number of threads: chunks are fixed and sums are taken in their
//! order.

use std::ops::Range;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Field, TriMesh};
use mve_mesh::morton::{morton_order, sort_by_code};
use rayon::prelude::*;
use thiserror::Error;

use super::bvh::{Bvh, Hit};
use super::hausdorff_max::{FarthestPoint, MaxSearch, search};
use super::many::ManyQueries;
use super::sample::{SurfaceSampler, sample_edges};

/// Samples of one chunk: about a millisecond of work.
const CHUNK: usize = 8192;
/// Samples whose hard ones are asked together, which bounds the memory for them.
const BATCH: usize = 128 * CHUNK;
/// The maximum is known well enough within this part of the diagonal.
const LEAST_TOLERANCE: f64 = 1e-9;
/// Seeds of the streams that are not the surface samples' own.
const EDGE_STREAM: u64 = 0x45c1_20f7_9d3b_6a8e;

/// What to measure, and how finely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HausdorffOptions {
    /// Area samples on each mesh. `None`: ten a face of the larger mesh, between 100,000 and
    /// 2,000,000.
    pub n_samples: Option<usize>,
    /// Chooses among sets of samples.
    pub seed: u64,
    /// Samples along the edges of each mesh, uniform by length, for the maximum only. The bisection
    /// covers edges as well, so this matters only without it.
    pub n_edge_samples: usize,
    /// Bisection of the faces that may hold the maximum ends when the maximum is known within
    /// this fraction of itself, or within 1e-9 of the diagonal of the original where it is less.
    /// `None`: no bisection, the maximum is the largest of the samples and has no upper bound.
    pub max_tolerance: Option<f64>,
    /// Parts of faces, beyond all faces and their quarters, that one bisection may look at before
    /// it gives up with what bounds it has.
    pub max_parts: usize,
}

impl HausdorffOptions {
    /// The default.
    pub const DEFAULT: Self = Self {
        n_samples: None,
        seed: 0,
        n_edge_samples: 0,
        max_tolerance: Some(0.01),
        max_parts: 1_000_000,
    };
}

impl Default for HausdorffOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Distances of the points of one surface from another, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directed {
    /// The largest distance found, a lower bound of the true one; [`Directed::max_point`] has it.
    pub max: f64,
    /// No point of the surface is farther than this (but for rounding), if bisection was asked for.
    pub max_upper_bound: Option<f64>,
    /// A point of this surface at the distance [`Directed::max`].
    pub max_point: DVec3,
    /// Mean over the area.
    pub mean: f64,
    /// Root of the mean square over the area.
    pub rms: f64,
    /// Area samples behind the mean and the RMS.
    pub n_samples: usize,
}

/// Both directions, and the distances of the vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Hausdorff {
    /// From points of the original to the simplified mesh.
    pub from_original: Directed,
    /// From points of the simplified mesh to the original.
    pub from_simplified: Directed,
    /// Diagonal of the box of the original, by which distances become relative.
    pub diagonal: f64,
    /// Distance of each vertex of the original from the simplified surface; not a number where
    /// the vertex is not finite.
    pub original_distance: Field,
    /// Distance of each vertex of the simplified mesh from the original surface.
    pub simplified_distance: Field,
    /// Faces of the original that were left out because a coordinate is not finite.
    pub n_left_out_original: usize,
    /// The same of the simplified mesh.
    pub n_left_out_simplified: usize,
}

impl Hausdorff {
    /// The Hausdorff distance: the larger maximum of the two directions.
    pub fn max(&self) -> f64 {
        self.from_original.max.max(self.from_simplified.max)
    }

    /// The larger mean of the two directions.
    pub fn mean(&self) -> f64 {
        self.from_original.mean.max(self.from_simplified.mean)
    }

    /// The larger RMS of the two directions.
    pub fn rms(&self) -> f64 {
        self.from_original.rms.max(self.from_simplified.rms)
    }

    /// No point of either surface is farther than this from the other.
    pub fn max_upper_bound(&self) -> Option<f64> {
        Some(self.from_original.max_upper_bound?.max(self.from_simplified.max_upper_bound?))
    }
}

/// Which of the two meshes that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshRole {
    /// The mesh before.
    Original,
    /// The mesh after.
    Simplified,
}

impl std::fmt::Display for MeshRole {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Original => "original",
            Self::Simplified => "simplified",
        })
    }
}

/// Why two meshes have no distance.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum HausdorffError {
    /// A mesh without faces is no surface.
    #[error("the {0} mesh has no faces; a distance needs a surface on both sides")]
    NoFaces(MeshRole),
    /// No face has three finite corners.
    #[error("the {0} mesh has {1} faces but none with finite coordinates")]
    NothingFinite(MeshRole, usize),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Measures two surfaces against each other.
///
/// Cost: a tree a mesh, O(faces × log faces), and about O(log faces) a sample. A mesh whose faces
/// all lack area (segments, points) is measured over its vertices instead of its area.
pub fn hausdorff(
    original: &TriMesh,
    simplified: &TriMesh,
    options: &HausdorffOptions,
    control: Control,
) -> Result<Hausdorff, HausdorffError> {
    let (a, b) = rayon::join(
        || surface(original, MeshRole::Original, control.part(0.0, 0.05)),
        || surface(simplified, MeshRole::Simplified, control.part(0.05, 0.1)),
    );
    let (a, b) = (a?, b?);
    let diagonal = a.diagonal;
    let from =
        |from: &MeasuredMesh, to: &MeasuredMesh, part| directed(from, to, diagonal, options, part);
    let (from_original, original_distance) = from(&a, &b, control.part(0.1, 0.55))?;
    let (from_simplified, simplified_distance) = from(&b, &a, control.part(0.55, 1.0))?;
    Ok(Hausdorff {
        from_original,
        from_simplified,
        diagonal,
        original_distance,
        simplified_distance,
        n_left_out_original: a.bvh.n_left_out(),
        n_left_out_simplified: b.bvh.n_left_out(),
    })
}

/// A mesh with its tree.
struct MeasuredMesh<'a> {
    mesh: &'a TriMesh,
    bvh: Bvh,
    /// Of the box around the faces in the tree.
    diagonal: f64,
}

fn surface<'a>(
    mesh: &'a TriMesh,
    side: MeshRole,
    control: Control,
) -> Result<MeasuredMesh<'a>, HausdorffError> {
    if mesh.faces.is_empty() {
        return Err(HausdorffError::NoFaces(side));
    }
    let bvh = Bvh::build(mesh, control)?;
    if bvh.n_faces() == 0 {
        return Err(HausdorffError::NothingFinite(side, mesh.faces.len()));
    }
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for chunk in bvh.faces().chunks(CHUNK) {
        control.at(1.0)?;
        for v in chunk.iter().flat_map(|f| mesh.faces[f.idx()]) {
            low = low.min(mesh.positions[v.idx()]);
            high = high.max(mesh.positions[v.idx()]);
        }
    }
    Ok(MeasuredMesh { mesh, bvh, diagonal: (high - low).length() })
}

/// Everything seen from one side.
fn directed(
    from: &MeasuredMesh,
    to: &MeasuredMesh,
    diagonal: f64,
    options: &HausdorffOptions,
    control: Control,
) -> Result<(Directed, Field), Cancelled> {
    let queries = ManyQueries::new(&to.bvh, from.bvh.center());
    let hits = vertex_hits(from.mesh, &queries, control.part(0.0, 0.1))?;
    let mut values: Vec<f64> = Vec::with_capacity(hits.len());
    values.extend(hits.iter().map(|h| h.map_or(f64::NAN, |h| h.distance_sq.sqrt())));
    let default = (10 * from.mesh.faces.len().max(to.mesh.faces.len())).clamp(100_000, 2_000_000);
    let n_samples = options.n_samples.unwrap_or(default);
    let set_up = control.part(0.1, 0.12);
    let sampler = SurfaceSampler::new(from.mesh, n_samples, options.seed, set_up)?;
    let mut sums = sample_sums(&sampler, &queries, control.part(0.12, 0.7))?;
    for chunk in from.bvh.faces().chunks(CHUNK) {
        control.at(0.7)?;
        for v in chunk.iter().flat_map(|f| from.mesh.faces[f.idx()]) {
            if let Some(hit) = hits[v.idx()] {
                sums.most.offer(hit.distance_sq, from.mesh.positions[v.idx()]);
            }
        }
    }
    offer_edges(from, &queries, options, &mut sums.most, control.part(0.7, 0.7))?;
    let mut max_upper_bound = None;
    if let Some(tolerance) = options.max_tolerance {
        let task = MaxSearch {
            mesh: from.mesh,
            faces: from.bvh.faces(),
            to: &to.bvh,
            vertex_hits: &hits,
            tolerance,
            least_tolerance: LEAST_TOLERANCE * diagonal,
            max_parts: options.max_parts,
        };
        max_upper_bound = Some(search(&task, &mut sums.most, control.part(0.7, 1.0))?);
    }
    control.at(1.0)?;
    if sums.n == 0 {
        sums = vertex_sums(from, &hits, sums.most, control.part(1.0, 1.0))?;
    }
    let n = sums.n.max(1) as f64;
    let directed = Directed {
        max: sums.most.distance_sq.sqrt(),
        max_upper_bound,
        max_point: sums.most.point,
        mean: sums.distance / n,
        rms: (sums.distance_sq / n).sqrt(),
        n_samples: sampler.n_samples(),
    };
    let (name, unit) = ("distance".to_owned(), "model units".to_owned());
    Ok((directed, Field { name, unit, domain: Domain::Vertex, values }))
}

/// The nearest face of each vertex of `mesh`, `None` where the vertex is not finite.
fn vertex_hits(
    mesh: &TriMesh,
    to: &ManyQueries,
    control: Control,
) -> Result<Vec<Option<Hit>>, Cancelled> {
    let order = morton_order(&mesh.positions, control.part(0.0, 0.0))?;
    let points: Vec<DVec3> = order.iter().map(|&v| mesh.positions[v as usize]).collect();
    let mut hits = vec![None; order.len()];
    let found = to.closest(&points, control)?;
    order.iter().zip(found).for_each(|(&v, hit)| hits[v as usize] = hit);
    Ok(hits)
}

/// Sums over samples, and the farthest of them.
#[derive(Clone, Copy)]
struct Sums {
    distance: f64,
    distance_sq: f64,
    n: usize,
    most: FarthestPoint,
}

impl Sums {
    const NONE: Self = Self { distance: 0.0, distance_sq: 0.0, n: 0, most: FarthestPoint::NONE };

    fn over(points: &[DVec3], distances_sq: &[f64]) -> Self {
        let mut sums = Self::NONE;
        for (&point, &distance_sq) in points.iter().zip(distances_sq) {
            sums.distance += distance_sq.sqrt();
            sums.distance_sq += distance_sq;
            sums.n += 1;
            sums.most.offer(distance_sq, point);
        }
        sums
    }

    fn add(&mut self, other: &Self) {
        self.distance += other.distance;
        self.distance_sq += other.distance_sq;
        self.n += other.n;
        self.most.offer(other.most.distance_sq, other.most.point);
    }
}

fn sample_sums(
    sampler: &SurfaceSampler,
    to: &ManyQueries,
    control: Control,
) -> Result<Sums, Cancelled> {
    let points_of = |range: Range<usize>| sampler.samples(range).map(|s| s.point).collect();
    sums_over(sampler.n_samples(), points_of, to, control)
}

/// A chunk of points: its sums, or what is not yet known where some of its points are hard.
enum ChunkSums {
    Done(Sums),
    Open { points: Vec<DVec3>, distances_sq: Vec<f64>, hard: Vec<u32> },
}

/// Sums over `n` points, which are made range by range. The hard ones of many chunks are asked
/// together.
fn sums_over(
    n: usize,
    points_of: impl Fn(Range<usize>) -> Vec<DVec3> + Sync,
    to: &ManyQueries,
    control: Control,
) -> Result<Sums, Cancelled> {
    let chunk_sums = |start: usize, end: usize, control: &Control| {
        let points = points_of(start..end.min(start + CHUNK));
        let mut distances_sq = Vec::with_capacity(points.len());
        let hard = to.easy_distances_sq(&points, &mut distances_sq, control)?;
        Ok(if hard.is_empty() {
            ChunkSums::Done(Sums::over(&points, &distances_sq))
        } else {
            ChunkSums::Open { points, distances_sq, hard }
        })
    };
    let mut sums = Sums::NONE;
    let done = |at: usize| at as f64 / n.max(1) as f64;
    for start in (0..n).step_by(BATCH) {
        let end = n.min(start + BATCH);
        let batch = control.part(done(start), done(end));
        let steps = batch.part(0.0, 0.5).steps((end - start).div_ceil(CHUNK));
        let starts: Vec<usize> = (start..end).step_by(CHUNK).collect();
        let mut chunks: Vec<ChunkSums> = starts
            .into_par_iter()
            .map(|start| {
                let sums = chunk_sums(start, end, &batch)?;
                steps.step()?;
                Ok(sums)
            })
            .collect::<Result<_, Cancelled>>()?;
        ask_hard(&mut chunks, to, batch.part(0.5, 1.0))?;
        for chunk in &chunks {
            match chunk {
                ChunkSums::Done(chunk) => sums.add(chunk),
                ChunkSums::Open { points, distances_sq, .. } => {
                    sums.add(&Sums::over(points, distances_sq));
                }
            }
        }
    }
    Ok(sums)
}

/// Fills in the distances of the hard points.
fn ask_hard(chunks: &mut [ChunkSums], to: &ManyQueries, control: Control) -> Result<(), Cancelled> {
    let mut hard_points = Vec::new();
    for chunk in chunks.iter() {
        if let ChunkSums::Open { points, hard, .. } = chunk {
            hard_points.extend(hard.iter().map(|&at| points[at as usize]));
        }
    }
    let mut hits = to.hard_hits(&hard_points, &control)?.into_iter();
    for chunk in chunks {
        if let ChunkSums::Open { distances_sq, hard, .. } = chunk {
            for (&at, hit) in hard.iter().zip(&mut hits) {
                distances_sq[at as usize] = hit.map_or(f64::INFINITY, |hit| hit.distance_sq);
            }
        }
    }
    Ok(())
}

/// Sums over the vertices that faces use, where there is no area to sum over.
fn vertex_sums(
    from: &MeasuredMesh,
    hits: &[Option<Hit>],
    most: FarthestPoint,
    control: Control,
) -> Result<Sums, Cancelled> {
    let mut is_counted = vec![false; hits.len()];
    let mut sums = Sums { most, ..Sums::NONE };
    for chunk in from.bvh.faces().chunks(CHUNK) {
        control.at(0.0)?;
        for v in chunk.iter().flat_map(|f| from.mesh.faces[f.idx()]) {
            let is_new = !std::mem::replace(&mut is_counted[v.idx()], true);
            if let Some(hit) = hits[v.idx()].filter(|_| is_new) {
                sums.distance += hit.distance_sq.sqrt();
                sums.distance_sq += hit.distance_sq;
                sums.n += 1;
            }
        }
    }
    Ok(sums)
}

/// Looks along the edges for a larger maximum.
fn offer_edges(
    from: &MeasuredMesh,
    to: &ManyQueries,
    options: &HausdorffOptions,
    most: &mut FarthestPoint,
    control: Control,
) -> Result<(), Cancelled> {
    if options.n_edge_samples == 0 {
        return Ok(());
    }
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(3 * from.bvh.n_faces());
    for chunk in from.bvh.faces().chunks(CHUNK) {
        control.at(0.0)?;
        for face in chunk {
            let [a, b, c] = from.mesh.faces[face.idx()].map(|v| u64::from(v.0));
            edges.extend([[a, b], [b, c], [c, a]].map(|[v, w]| (v.min(w) << 32 | v.max(w), 0)));
        }
    }
    sort_by_code(&mut edges, control)?;
    edges.dedup();
    let end = |v: u64| from.mesh.positions[v as u32 as usize];
    let mut ends: Vec<[DVec3; 2]> = Vec::with_capacity(edges.len());
    for chunk in edges.chunks(CHUNK) {
        control.at(0.0)?;
        ends.extend(chunk.iter().map(|&(edge, _)| [end(edge >> 32), end(edge)]));
    }
    let seed = options.seed ^ EDGE_STREAM;
    let points = sample_edges(&ends, options.n_edge_samples, seed, control)?;
    let sums = sums_over(points.len(), |range| points[range].to_vec(), to, control)?;
    most.offer(sums.most.distance_sq, sums.most.point);
    Ok(())
}

#[cfg(test)]
#[path = "hausdorff_tests.rs"]
mod tests;
