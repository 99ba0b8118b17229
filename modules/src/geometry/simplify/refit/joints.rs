//! Pairs of nearest points of two surfaces.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};
use rayon::prelude::*;

use crate::geometry::distance::bvh::{Bvh, Hit};
use crate::geometry::distance::many::ManyQueries;
use crate::geometry::distance::point_triangle::PreparedTriangle;
use crate::geometry::distance::sample::{Sample, SurfaceSampler};

/// Samples that one thread makes at a time.
const CHUNK: usize = 4096;
/// Samples of the original in one step at most, so that they take some hundreds of megabytes.
const MOST_SAMPLES: f64 = 4e6;

/// A point of the simplified mesh, and how far it should go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    /// The face of the simplified mesh.
    pub face: FaceId,
    /// The barycentric coordinates of the point in it.
    pub shares: [f64; 3],
    /// Unit vector to the nearest point of the other surface; its normal where both are at one
    /// place, or zero where it has none.
    pub direction: DVec3,
    /// How far that is, in model units.
    pub distance: f64,
}

impl Joint {
    /// Joins the point `from` of a face of the simplified mesh with the point `to` of the original;
    /// `normal` is that of either.
    fn new(face: FaceId, ours: &PreparedTriangle, from: DVec3, to: DVec3, normal: DVec3) -> Self {
        /// Shorter offsets, relative to the face, have no direction but that of their rounding.
        const LEAST: f64 = 1e-9;
        let shares = ours.coordinates(from);
        let is_flat = shares.iter().any(|share| !share.is_finite());
        let shares = if is_flat { [1.0 / 3.0; 3] } else { shares.map(|s| s.clamp(0.0, 1.0)) };
        let offset = to - from;
        let distance = offset.length();
        if distance > LEAST * ours.longest_side() {
            return Self { face, shares, direction: offset / distance, distance };
        }
        let direction = if normal.is_finite() { normal } else { DVec3::ZERO };
        Self { face, shares, direction, distance: 0.0 }
    }
}

/// Distances at samples of the original and at those of the simplified mesh, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Root of the mean square, from the original and from the simplified mesh.
    pub rms: [f64; 2],
    /// The largest of each.
    pub max: [f64; 2],
}

impl Spread {
    /// The larger maximum of the two directions.
    pub fn max(&self) -> f64 {
        self.max[0].max(self.max[1])
    }

    /// Root of the mean square over both directions.
    pub fn rms(&self) -> f64 {
        (0.5 * (self.rms[0] * self.rms[0] + self.rms[1] * self.rms[1])).sqrt()
    }
}

/// The joints of both directions.
#[derive(Debug)]
pub(super) struct Joints {
    /// Those of samples of the original.
    pub of_original: Vec<Joint>,
    /// Those of samples of the simplified mesh.
    pub of_simplified: Vec<Joint>,
}

impl Joints {
    pub fn spread(&self) -> Spread {
        let both = [&self.of_original, &self.of_simplified];
        let rms = both.map(|joints| {
            let sum: f64 = joints.iter().map(|joint| joint.distance * joint.distance).sum();
            (sum / joints.len().max(1) as f64).sqrt()
        });
        let max =
            both.map(|joints| joints.iter().fold(0.0, |most: f64, joint| most.max(joint.distance)));
        Spread { rms, max }
    }
}

/// Finds the joints of a mesh with one original.
pub(super) struct JointFinder<'a> {
    original: &'a TriMesh,
    queries: &'a ManyQueries<'a>,
    sampler: SurfaceSampler<'a>,
    per_face: f64,
}

impl<'a> JointFinder<'a> {
    /// With queries of the original.
    pub fn new(
        original: &'a TriMesh,
        queries: &'a ManyQueries<'a>,
        per_face: f64,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let order = queries.tree().faces().iter().copied();
        let sampler = SurfaceSampler::along(original, order, 0, 0, control)?;
        Ok(Self { original, queries, sampler, per_face })
    }

    /// The joints at the samples of this seed, and the tree of the mesh; `None` where it has no
    /// surface.
    pub fn find(
        &self,
        mesh: &TriMesh,
        seed: u64,
        control: Control,
    ) -> Result<Option<(Joints, Bvh)>, Cancelled> {
        let tree = Bvh::build_quickly(mesh, control.part(0.0, 0.1))?;
        if tree.n_faces() == 0 {
            return Ok(None);
        }
        let n = (self.per_face * tree.n_faces() as f64).ceil().min(MOST_SAMPLES) as usize;
        let of_original = join(
            &self.sampler.resampled(n, 2 * seed),
            &ManyQueries::new(&tree, self.queries.tree().center()),
            control.part(0.1, 0.6),
            |sample, hit| {
                let ours = PreparedTriangle::new(mesh.corners(hit.face));
                let from = ours.closest_point(sample.point);
                Joint::new(hit.face, &ours, from, sample.point, ours.normal())
            },
        )?;
        let (order, n_own) = (tree.faces().iter().copied(), n.div_ceil(2));
        let own = SurfaceSampler::along(mesh, order, n_own, 2 * seed + 1, control.part(0.6, 0.7))?;
        let of_simplified = join(&own, self.queries, control.part(0.7, 1.0), |sample, hit| {
            let ours = PreparedTriangle::new(mesh.corners(sample.face));
            let theirs = PreparedTriangle::new(self.original.corners(hit.face));
            let to = theirs.closest_point(sample.point);
            Joint::new(sample.face, &ours, sample.point, to, theirs.normal())
        })?;
        Ok(Some((Joints { of_original, of_simplified }, tree)))
    }
}

/// The joints of all samples with the faces nearest to them, in order.
fn join(
    sampler: &SurfaceSampler,
    queries: &ManyQueries,
    control: Control,
    joint: impl Fn(&Sample, Hit) -> Joint + Sync,
) -> Result<Vec<Joint>, Cancelled> {
    let n = sampler.n_samples();
    let chunk = |chunk: usize| chunk * CHUNK..((chunk + 1) * CHUNK).min(n);
    let chunks = (0..n.div_ceil(CHUNK)).into_par_iter();
    let samples: Vec<Sample> = chunks.flat_map_iter(|at| sampler.samples(chunk(at))).collect();
    let points: Vec<DVec3> = samples.iter().map(|sample| sample.point).collect();
    let hits = queries.closest(&points, control)?;
    let found = samples.par_iter().zip(hits);
    Ok(found.filter_map(|(sample, hit)| Some(joint(sample, hit?))).collect())
}
