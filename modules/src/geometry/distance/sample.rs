//! Points spread over the surface of a mesh, uniform by area.
//!
//! The faces are laid end to end by area, along a Morton curve through their centers, and sample
//! `i` of `n` falls at a random place of the `i`-th of `n` equal lengths (stratified sampling).
//! Within its face the place unrolls into the triangle by repeated four-way division, as in Basu &
//! Owen, "Low discrepancy constructions in the triangle", SIAM J. Numer. Anal. 2015, section 4,
//! with a random point in the last cell. Both steps keep area, so the mean of any function over
//! the samples is an **unbiased** estimate of its mean over the surface, with less variance than
//! independent samples have; and samples that follow each other in the list are neighbors.
//!
//! Random numbers are counted, not drawn in sequence: each depends on the seed and on the index of
//! the sample alone, so any part of the list can be made on any thread.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use mve_core::{Cancelled, Control};

use mve_mesh::data::{FaceId, TriMesh};
use mve_mesh::morton::morton_order;
use mve_mesh::random::IndexedRandom;

/// Faces or edges between two looks whether the work was cancelled.
const STRIDE: usize = 1 << 15;
/// Four-way divisions within a face at most: with 12, cells are 1/4096 of a side.
const MOST_LEVELS: u32 = 12;

/// A point on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// In model space.
    pub point: DVec3,
    /// The face that it is on.
    pub face: FaceId,
}

/// The area-uniform samples of one mesh for one number and seed; see the head of this file.
#[derive(Clone, Debug)]
pub struct SurfaceSampler<'a> {
    mesh: &'a TriMesh,
    /// Faces with area, along the curve; those of other samples of the mesh, too.
    faces: Arc<[FaceId]>,
    /// Sum of the areas of the faces before each, and the total at the end.
    areas_before: Arc<[f64]>,
    n_samples: usize,
    random: IndexedRandom,
}

impl<'a> SurfaceSampler<'a> {
    /// Prepares `n_samples` samples, O(faces). Faces without a positive, finite area get none; a
    /// mesh of such faces has no samples.
    pub fn new(
        mesh: &'a TriMesh,
        n_samples: usize,
        seed: u64,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let n_faces = mesh.faces.len();
        let mut centers = Vec::with_capacity(n_faces);
        for face in 0..n_faces {
            if face % STRIDE == 0 {
                control.at(0.0)?;
            }
            let center = corners_of(mesh, face).map(|[a, b, c]| (a + b + c) / 3.0);
            centers.push(center.unwrap_or(DVec3::NAN));
        }
        let order = morton_order(&centers, control.part(0.1, 0.1))?;
        let order = order.into_iter().map(FaceId);
        Self::along(mesh, order, n_samples, seed, control.part(0.5, 1.0))
    }

    /// The same with the faces in this order, in which neighbors are to follow each other.
    pub fn along(
        mesh: &'a TriMesh,
        order: impl ExactSizeIterator<Item = FaceId>,
        n_samples: usize,
        seed: u64,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let n_faces = order.len();
        let mut faces = Vec::with_capacity(n_faces);
        let mut areas_before = Vec::with_capacity(n_faces + 1);
        let mut total = 0.0;
        for (k, face) in order.enumerate() {
            if k % STRIDE == 0 {
                control.at(k as f64 / n_faces as f64)?;
            }
            let Some([a, b, c]) = corners_of(mesh, face.idx()) else { continue };
            let area = 0.5 * (b - a).cross(c - a).length();
            if area > 0.0 && area.is_finite() {
                faces.push(face);
                areas_before.push(total);
                total += area;
            }
        }
        areas_before.push(total);
        let n_samples = if faces.is_empty() { 0 } else { n_samples };
        let (faces, areas_before) = (faces.into(), areas_before.into());
        Ok(Self { mesh, faces, areas_before, n_samples, random: IndexedRandom::new(seed) })
    }

    /// Other samples of the same mesh, O(1).
    pub fn resampled(&self, n_samples: usize, seed: u64) -> Self {
        let n_samples = if self.faces.is_empty() { 0 } else { n_samples };
        Self { n_samples, random: IndexedRandom::new(seed), ..self.clone() }
    }

    /// How many samples there are.
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// The area that the samples stand for, in squared model units.
    pub fn area(&self) -> f64 {
        self.areas_before.last().copied().unwrap_or(0.0)
    }

    /// The samples of these indices, in order.
    ///
    /// # Panics
    /// When the range ends beyond [`SurfaceSampler::n_samples`].
    pub fn samples(&self, range: Range<usize>) -> impl Iterator<Item = Sample> + '_ {
        assert!(range.end <= self.n_samples, "sample {} of {}", range.end, self.n_samples);
        let step = self.area() / self.n_samples.max(1) as f64;
        let mut at = usize::MAX;
        let mut cell = FaceCells::default();
        range.map(move |i| {
            let place = (i as f64 + self.random.unit(2 * i as u64)) * step;
            if at == usize::MAX {
                at = self.areas_before.partition_point(|&before| before <= place) - 1;
                at = at.min(self.faces.len() - 1);
                cell = self.cells(at, step);
            }
            while at + 1 < self.faces.len() && self.areas_before[at + 1] <= place {
                at += 1;
                if self.areas_before[at + 1] > place || at + 1 == self.faces.len() {
                    cell = self.cells(at, step);
                }
            }
            let point = cell.point(place, self.random.bits(2 * i as u64 + 1));
            Sample { point, face: self.faces[at] }
        })
    }

    fn cells(&self, at: usize, step: f64) -> FaceCells {
        let [a, b, c] = self.mesh.corners(self.faces[at]);
        let (before, after) = (self.areas_before[at], self.areas_before[at + 1]);
        // Whole numbers only: a logarithm may be rounded differently on another machine.
        let n_bits = u64::BITS - (((after - before) / step) as u64).leading_zeros();
        let levels = (n_bits.div_ceil(2) + 1).min(MOST_LEVELS);
        FaceCells { a, ab: b - a, ac: c - a, before, per_area: 1.0 / (after - before), levels }
    }
}

/// The corners of a face whose indices and coordinates can be used.
fn corners_of(mesh: &TriMesh, face: usize) -> Option<[DVec3; 3]> {
    let [a, b, c] = mesh.faces[face].map(|v| mesh.positions.get(v.idx()).copied());
    let corners = [a?, b?, c?];
    corners.iter().all(|p| p.is_finite()).then_some(corners)
}

/// Of each of the four parts of a triangle: its corner along both sides, in halves of a side, and
/// the factor from half the side to half that of the part. The third part is the turned one.
const PARTS: [[f64; 3]; 4] = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 1.0, -0.5], [0.0, 1.0, 0.5]];

/// One face as a run of cells of equal area.
#[derive(Clone, Copy, Debug, Default)]
struct FaceCells {
    a: DVec3,
    ab: DVec3,
    ac: DVec3,
    before: f64,
    per_area: f64,
    levels: u32,
}

impl FaceCells {
    /// The point at a place along the areas, with random bits for the place in the last cell.
    #[inline]
    fn point(&self, place: f64, bits: u64) -> DVec3 {
        let n_cells = f64::from(1u32 << (2 * self.levels));
        let fraction = (place - self.before) * self.per_area;
        let index = ((fraction * n_cells) as u32).min((1u32 << (2 * self.levels)) - 1);
        // The cell so far is the triangle (u, v), (u + s, v), (u, v + s) for a signed side s: the
        // middle one of four equal parts is turned over, the three others are not.
        let (mut u, mut v, mut side) = (0.0, 0.0, 0.5);
        for level in (0..self.levels).rev() {
            // A table, not branches: the digits are as good as random.
            let [du, dv, turn] = PARTS[(index >> (2 * level)) as usize & 3];
            u += du * side;
            v += dv * side;
            side *= turn;
        }
        side *= 2.0;
        let per_u32 = 1.0 / f64::from(u32::MAX) / (1.0 + 1e-9);
        let s = f64::from(bits as u32) * per_u32;
        let t = f64::from((bits >> 32) as u32) * per_u32;
        // A point of the square beyond the diagonal is turned back: 1 - s where s + t > 1.
        let (from, sign) = if s + t > 1.0 { (1.0, -1.0) } else { (0.0, 1.0) };
        let (s, t) = (from + sign * s, from + sign * t);
        self.a + self.ab * (u + side * s) + self.ac * (v + side * t)
    }
}

/// `n_samples` points on the edges of the faces, uniform by length and stratified along them.
///
/// `edges` are pairs of points; those without a positive, finite length get none.
pub fn sample_edges(
    edges: &[[DVec3; 2]],
    n_samples: usize,
    seed: u64,
    control: Control,
) -> Result<Vec<DVec3>, Cancelled> {
    let length = |[a, b]: &[DVec3; 2]| Some(a.distance(*b)).filter(|&l| l > 0.0 && l.is_finite());
    let mut total = 0.0;
    for chunk in edges.chunks(STRIDE) {
        control.at(0.0)?;
        total += chunk.iter().filter_map(length).sum::<f64>();
    }
    let step = total / n_samples.max(1) as f64;
    let random = IndexedRandom::new(seed);
    let mut points = Vec::with_capacity(n_samples);
    let mut before = 0.0;
    for (k, edge) in edges.iter().enumerate() {
        if k % STRIDE == 0 {
            control.at(k as f64 / edges.len() as f64)?;
        }
        let Some(length) = length(edge) else { continue };
        while points.len() < n_samples {
            let place = (points.len() as f64 + random.unit(points.len() as u64)) * step;
            if place >= before + length {
                break;
            }
            if points.len() % STRIDE == STRIDE - 1 {
                control.at(k as f64 / edges.len() as f64)?;
            }
            points.push(edge[0].lerp(edge[1], ((place - before) / length).clamp(0.0, 1.0)));
        }
        before += length;
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    use super::*;

    fn sampler(mesh: &TriMesh, n: usize, seed: u64) -> SurfaceSampler<'_> {
        SurfaceSampler::new(mesh, n, seed, Control::none()).unwrap()
    }

    fn points(mesh: &TriMesh, n: usize, seed: u64) -> Vec<DVec3> {
        sampler(mesh, n, seed).samples(0..n).map(|s| s.point).collect()
    }

    fn triangle() -> TriMesh {
        mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])
    }

    /// First and second moments over the corner triangle are 1/3, 1/6 (x²) and 1/12 (x y).
    #[test]
    fn moments_over_a_triangle_are_those_of_uniform_points() {
        let n = 20_000;
        let points = points(&triangle(), n, 7);
        let mean = |f: &dyn Fn(&DVec3) -> f64| points.iter().map(f).sum::<f64>() / n as f64;
        assert!((mean(&|p| p.x) - 1.0 / 3.0).abs() < 1e-4);
        assert!((mean(&|p| p.y) - 1.0 / 3.0).abs() < 1e-4);
        assert!((mean(&|p| p.x * p.x) - 1.0 / 6.0).abs() < 1e-4);
        assert!((mean(&|p| p.x * p.y) - 1.0 / 12.0).abs() < 1e-4);
        assert!(points.iter().all(|p| p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 1.0 + 1e-12));
    }

    /// One sample from many seeds must be uniform too: that is what unbiased means.
    #[test]
    fn a_single_sample_is_unbiased_over_seeds() {
        let mesh = tetrahedron();
        let n_seeds = 40_000u64;
        let mut sum = DVec3::ZERO;
        for seed in 0..n_seeds {
            sum += points(&mesh, 1, seed)[0];
        }
        // Three right faces of area 1/2 and one of √3/2, whose centroid is (1/3, 1/3, 1/3).
        let slanted = 3f64.sqrt() / 2.0;
        let expected = (2.0 * 0.5 / 3.0 + slanted / 3.0) / (1.5 + slanted);
        let mean = sum / n_seeds as f64;
        assert!((mean - DVec3::splat(expected)).abs().max_element() < 5e-3, "{mean}");
    }

    #[test]
    fn any_part_of_the_list_is_the_same() {
        let mesh = tetrahedron();
        let sampler = sampler(&mesh, 1000, 3);
        let whole: Vec<Sample> = sampler.samples(0..1000).collect();
        for range in [0..1, 17..23, 500..1000] {
            assert!(sampler.samples(range.clone()).eq(whole[range].iter().copied()));
        }
    }

    /// The stream is part of every recorded result, so it may never change.
    #[test]
    fn the_stream_is_fixed() {
        let random = IndexedRandom::new(1);
        let bits = [random.bits(0), random.bits(1), random.bits(2)];
        assert_eq!(
            bits,
            [15_916_886_550_466_581_944, 6_791_897_765_849_424_158, 17_405_687_883_870_564_846]
        );
    }

    #[test]
    fn faces_without_area_get_no_sample() {
        let flat = mesh_of(&[[0.0; 3], [1.0; 3], [f64::NAN; 3]], &[[0, 1, 1], [0, 1, 2]]);
        assert_eq!(sampler(&flat, 10, 0).n_samples(), 0);
        assert_eq!(sampler(&TriMesh::default(), 10, 0).n_samples(), 0);
        let mut mesh = triangle();
        mesh.faces.extend([mesh.faces[0]; 2].map(|[a, b, _]| [a, b, b]));
        let sampler = sampler(&mesh, 100, 0);
        assert!(sampler.samples(0..100).all(|s| s.face == FaceId(0)));
    }

    #[test]
    fn edge_samples_are_spread_by_length() {
        let edges = [[DVec3::ZERO, DVec3::X], [DVec3::Y, DVec3::Y], [DVec3::ZERO, DVec3::Z * 3.0]];
        let points = sample_edges(&edges, 400, 5, Control::none()).unwrap();
        assert_eq!(points.len(), 400);
        assert_eq!(points.iter().filter(|p| p.x > 0.0).count(), 100);
        let mean_z: f64 = points.iter().map(|p| p.z).sum::<f64>() / 400.0;
        assert!((mean_z - 0.75 * 1.5).abs() < 0.01);
    }
}
