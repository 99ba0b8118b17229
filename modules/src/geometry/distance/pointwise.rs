//! Compares what two surfaces have at the same places.
//!
//! From a point of one surface one goes to the nearest point of the other and compares what both
//! have there. Where several faces of the other are equally near (edges, vertices, sheets that lie
//! on each other, seams of attributes), the least difference counts, so that a surface does not
//! differ from itself and rounding decides nothing. Means are area integrals by the samples of
//! [`SurfaceSampler`]; they are the same for any number of threads.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};
use rayon::prelude::*;

use super::bvh::{Bvh, Hit, Walker};
use super::point_triangle::PreparedTriangle;
use super::sample::{Sample, SurfaceSampler};

/// Samples of one chunk: some milliseconds of work.
const CHUNK: usize = 2048;
/// Faces no farther than the nearest one by this part of the diagonal of the other mesh are as
/// near as it.
const EQUALLY_NEAR: f64 = 1e-9;
/// The same by this part of the largest coordinate: a few roundings.
const ROUNDING: f64 = 2e-15;
/// Equally near faces that are looked at.
const MOST_FACES: usize = 64;

/// A point of a face.
#[derive(Clone, Copy, Debug)]
pub struct FacePoint<'m> {
    /// The mesh.
    pub mesh: &'m TriMesh,
    /// The face.
    pub face: FaceId,
    /// The share of each corner in the point; not numbers for a face without area.
    pub shares: [f64; 3],
    /// The unit normal of the face; not a number for a face without area.
    pub normal: DVec3,
}

/// How often a difference was measured, its mean, root mean square and maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Samples at which there was something to compare.
    pub n: usize,
    /// Their sum.
    sum: f64,
    /// The sum of their squares.
    squares: f64,
    /// The largest.
    max: f64,
}

impl Difference {
    /// The mean; not a number without a sample.
    pub fn mean(&self) -> f64 {
        self.sum / self.n as f64
    }

    /// The root of the mean square; not a number without a sample.
    pub fn rms(&self) -> f64 {
        (self.squares / self.n as f64).sqrt()
    }

    /// The largest; not a number without a sample.
    pub fn max(&self) -> f64 {
        if self.n > 0 { self.max } else { f64::NAN }
    }

    fn add(&mut self, value: f64) {
        if value.is_nan() {
            return;
        }
        self.n += 1;
        self.sum += value;
        self.squares += value * value;
        self.max = self.max.max(value);
    }

    fn join(&mut self, other: &Self) {
        self.n += other.n;
        self.sum += other.sum;
        self.squares += other.squares;
        self.max = self.max.max(other.max);
    }
}

/// One surface seen from another.
#[derive(Clone, Copy, Debug)]
pub struct Pointwise<'a> {
    from: &'a TriMesh,
    to: &'a TriMesh,
    tree: &'a Bvh,
    /// Faces no farther than the nearest one by this are as near as it.
    equally_near: f64,
}

impl<'a> Pointwise<'a> {
    /// From the points of one surface to another, whose tree this is. O(faces).
    pub fn new(from: &'a TriMesh, to: &'a TriMesh, tree: &'a Bvh) -> Self {
        let diagonal = to.diagonal();
        let diagonal = if diagonal.is_finite() { diagonal } else { 0.0 };
        Self { from, to, tree, equally_near: EQUALLY_NEAR * diagonal }
    }

    /// The mean, RMS and maximum, over the area of `from`, of `N` differences, by `n_samples`
    /// points. `measure` gives the differences of two points; what is not a number does not count.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn differences<const N: usize>(
        &self,
        (n_samples, seed): (usize, u64),
        measure: impl Fn(&FacePoint, &FacePoint) -> [f64; N] + Sync,
        control: Control,
    ) -> Result<[Difference; N], Cancelled> {
        let sampler = SurfaceSampler::new(self.from, n_samples, seed, control.part(0.0, 0.1))?;
        let n_samples = sampler.n_samples();
        let n_chunks = n_samples.div_ceil(CHUNK);
        let control = control.part(0.1, 1.0);
        let steps = control.steps(n_chunks);
        let of_chunk = |chunk: usize| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(n_samples);
            let mut found = [Difference::default(); N];
            let mut look = Look::new(self);
            for sample in sampler.samples(range) {
                let values = look.at(&sample, &measure, &control)?;
                found.iter_mut().zip(values).for_each(|(found, value)| found.add(value));
            }
            steps.step()?;
            Ok(found)
        };
        let chunks = (0..n_chunks).into_par_iter().map(of_chunk);
        let chunks: Vec<[Difference; N]> = chunks.collect::<Result<_, Cancelled>>()?;
        let mut all = [Difference::default(); N];
        for chunk in &chunks {
            all.iter_mut().zip(chunk).for_each(|(all, chunk)| all.join(chunk));
        }
        Ok(all)
    }

    /// The difference at the middle of each face of `from`; not a number where there is nothing to
    /// compare.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn at_faces(
        &self,
        measure: impl Fn(&FacePoint, &FacePoint) -> f64 + Sync,
        control: Control,
    ) -> Result<Vec<f64>, Cancelled> {
        let n_faces = self.from.faces.len();
        let n_chunks = n_faces.div_ceil(CHUNK);
        let steps = control.steps(n_chunks);
        let of_chunk = |chunk: usize| {
            let mut look = Look::new(self);
            let faces = chunk * CHUNK..((chunk + 1) * CHUNK).min(n_faces);
            let values = faces.map(|face| {
                let face = FaceId(face as u32);
                let [a, b, c] = self.from.corners(face);
                let sample = Sample { point: (a + b + c) / 3.0, face };
                look.at(&sample, &|a, b| [measure(a, b)], &control).map(|[value]| value)
            });
            let values = values.collect::<Result<Vec<f64>, Cancelled>>()?;
            steps.step()?;
            Ok(values)
        };
        let chunks = (0..n_chunks).into_par_iter().map(of_chunk);
        Ok(chunks.collect::<Result<Vec<_>, Cancelled>>()?.concat())
    }
}

/// Queries of one thread.
struct Look<'a> {
    between: &'a Pointwise<'a>,
    walker: Walker<'a>,
    hits: Vec<Hit>,
}

impl<'a> Look<'a> {
    fn new(between: &'a Pointwise<'a>) -> Self {
        Self { between, walker: between.tree.walker(), hits: Vec::new() }
    }

    /// The least differences between a point and those equally near to it.
    fn at<const N: usize>(
        &mut self,
        sample: &Sample,
        measure: &impl Fn(&FacePoint, &FacePoint) -> [f64; N],
        control: &Control,
    ) -> Result<[f64; N], Cancelled> {
        let mut least = [f64::NAN; N];
        self.walker.poll(control)?;
        let Some(nearest) = self.walker.closest(sample.point) else { return Ok(least) };
        let Pointwise { from, to, tree, equally_near } = *self.between;
        let margin = equally_near + ROUNDING * sample.point.abs().max_element();
        let reach = nearest.distance_sq.sqrt() + margin;
        self.walker.within(sample.point, reach, MOST_FACES, &mut self.hits);
        if self.hits.iter().all(|hit| hit.face != nearest.face) {
            self.hits.push(nearest);
        }
        let here = face_point(from, sample.face, sample.point);
        for face in self.hits.iter().flat_map(|hit| tree.same_as(hit)) {
            let there = face_point(to, face, sample.point);
            for (least, value) in least.iter_mut().zip(measure(&here, &there)) {
                *least = least.min(value);
            }
        }
        Ok(least)
    }
}

/// The point of a face that is nearest to a point.
fn face_point(mesh: &TriMesh, face: FaceId, point: DVec3) -> FacePoint<'_> {
    let triangle = PreparedTriangle::new(mesh.corners(face));
    let shares = triangle.coordinates(triangle.closest_point(point));
    FacePoint { mesh, face, shares, normal: triangle.normal() }
}

/// The angle between two vectors, 0 to π, exact for small ones, too; not a number where one has no
/// direction.
pub fn angle_rad(a: DVec3, b: DVec3) -> f64 {
    let (sin, cos) = (a.cross(b).length(), a.dot(b));
    if sin == 0.0 && cos == 0.0 { f64::NAN } else { sin.atan2(cos) }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of, torus};

    use super::*;

    fn compared(from: &TriMesh, to: &TriMesh) -> Difference {
        let tree = Bvh::build(to, Control::none()).unwrap();
        let pointwise = Pointwise::new(from, to, &tree);
        let angle = |a: &FacePoint, b: &FacePoint| [angle_rad(a.normal, b.normal)];
        let [found] = pointwise.differences((10_000, 0), angle, Control::none()).unwrap();
        found
    }

    /// The left half of a square lies on the plane, the right half on a roof over it.
    #[test]
    fn half_of_a_square_under_a_slope() {
        let flat = mesh_of(
            &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            &[[0, 1, 2], [0, 2, 3]],
        );
        // Its right part rises by 45° from the middle, so that the points of the square there are
        // nearest to the slope.
        let bent = mesh_of(
            &[
                [-1.0, 0.0, 0.0],
                [0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [-1.0, 1.0, 0.0],
                [2.0, 0.0, 2.0],
                [2.0, 1.0, 2.0],
            ],
            &[[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]],
        );
        let found = compared(&flat, &bent);
        let eighth = std::f64::consts::FRAC_PI_4;
        assert_eq!(found.n, 10_000);
        assert!((found.mean() - eighth / 2.0).abs() < 1e-3, "{found:?}");
        assert!((found.rms() - eighth / 2.0_f64.sqrt()).abs() < 1e-3, "{found:?}");
        assert!((found.max() - eighth).abs() < 1e-12);
    }

    #[test]
    fn a_surface_does_not_differ_from_itself_where_sheets_lie_on_each_other() {
        let mut both = cube(DVec3::splat(4e6));
        let turned: Vec<_> = both.faces.iter().map(|&[a, b, c]| [c, b, a]).collect();
        both.faces.extend(turned);
        assert!(compared(&both, &both).max() < 1e-12);
        let tree = Bvh::build(&both, Control::none()).unwrap();
        let pointwise = Pointwise::new(&both, &both, &tree);
        let angle = |a: &FacePoint, b: &FacePoint| angle_rad(a.normal, b.normal);
        let values = pointwise.at_faces(angle, Control::none()).unwrap();
        assert!(values.len() == 24 && values.iter().all(|value| *value < 1e-12));
    }

    #[test]
    fn threads_change_no_bit() {
        let (a, b) = (torus(2.0, 0.5, 40), torus(2.1, 0.45, 17));
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        let on = |n| pool(n).install(|| compared(&a, &b));
        assert_eq!(on(1), on(3));
    }
}
