//! The local values: both curvatures compared within the window around a vertex.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use super::curvature_mesh::CurvatureMesh;
use super::walk::{Cut, Walk};
use super::{CHUNK, Levels, MAX_LEVELS, ReferencePoint};

/// What the statistics read of a vertex, in one place.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct Sample {
    pub point: DVec3,
    pub carried_point: DVec3,
    pub own: [f64; MAX_LEVELS],
    pub carried: [f64; MAX_LEVELS],
}

impl Sample {
    pub fn new(point: DVec3, own: [f64; MAX_LEVELS], carried: &ReferencePoint) -> Self {
        Self { point, carried_point: carried.point, own, carried: carried.curvature }
    }
}

/// Sums over the samples of a window, about the values at its center: where these are far from 0
/// and vary little, nothing cancels.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) struct Sums {
    /// −1 / (2 σ²)
    exponent: f64,
    own_center: f64,
    carried_center: f64,
    /// Σ w, Σ w x, Σ w x²
    own: [f64; 3],
    /// Σ w', Σ w' y, Σ w' y²
    carried: [f64; 3],
    /// Σ w' x, Σ w' x y
    mixed: [f64; 2],
}

impl Sums {
    /// Of the center alone.
    pub fn new(center: &Sample, level: usize, kernel: Kernel) -> Self {
        let exponent = match kernel {
            Kernel::Uniform => 0.0,
            Kernel::Gaussian { width } => -0.5 / (width * width),
        };
        Self {
            exponent,
            own_center: center.own[level],
            carried_center: center.carried[level],
            own: [1.0, 0.0, 0.0],
            carried: [1.0, 0.0, 0.0],
            mixed: [0.0; 2],
        }
    }

    /// Adds a sample: squared distances from the center and values on both sides.
    #[inline]
    pub fn add(&mut self, distances_sq: [f64; 2], own: f64, carried: f64) {
        let [weight, carried_weight] = distances_sq.map(|d| (d * self.exponent).exp());
        let x = own - self.own_center;
        let y = carried - self.carried_center;
        self.own[0] += weight;
        self.own[1] += weight * x;
        self.own[2] += weight * x * x;
        self.carried[0] += carried_weight;
        self.carried[1] += carried_weight * y;
        self.carried[2] += carried_weight * y * y;
        self.mixed[0] += carried_weight * x;
        self.mixed[1] += carried_weight * x * y;
    }

    /// Adds a sample between two vertices.
    #[inline]
    pub fn add_between(
        &mut self,
        center: &Sample,
        [from, to]: [&Sample; 2],
        level: usize,
        part: f64,
        distance_sq: f64,
    ) {
        let between = |a: f64, b: f64| (1.0 - part) * a + part * b;
        let carried_point = from.carried_point + (to.carried_point - from.carried_point) * part;
        self.add(
            [distance_sq, carried_point.distance_squared(center.carried_point)],
            between(from.own[level], to.own[level]),
            between(from.carried[level], to.carried[level]),
        );
    }

    /// What the samples amount to. The covariance has the weights of the reference over the sum of
    /// the others, as in the published program.
    pub fn moments(&self) -> Moments {
        let [w, wx, wxx] = self.own;
        let [v, vy, vyy] = self.carried;
        let [vx, vxy] = self.mixed;
        let (x, y) = (wx / w, vy / v);
        Moments {
            means: [x + self.own_center, y + self.carried_center],
            deviations: [wxx / w - x * x, vyy / v - y * y].map(|square| square.max(0.0).sqrt()),
            covariance: (vxy - x * vy - y * vx + x * y * v) / w,
        }
    }
}

/// How samples weigh by their distance from the center.
#[derive(Clone, Copy, Debug)]
pub(in crate::geometry) enum Kernel {
    /// All alike.
    Uniform,
    /// exp(−d² / (2 width²))
    Gaussian { width: f64 },
}

/// The statistics of a window: of its own mesh, and of what is carried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::geometry) struct Moments {
    pub means: [f64; 2],
    pub deviations: [f64; 2],
    pub covariance: f64,
}

impl Moments {
    /// The local value of MSDM2 at one level.
    pub fn local_msdm2(&self) -> f64 {
        let part = |[a, b]: [f64; 2]| (a - b).abs() / (a.max(b) + 1.0);
        let product = self.deviations[0] * self.deviations[1];
        let structure = (product - self.covariance).abs() / (product + 1.0);
        (part(self.means) + part(self.deviations) + 0.5 * structure) / 2.5
    }
}

/// The windows of all levels.
pub(in crate::geometry) struct Windows<'a> {
    pub surface: &'a CurvatureMesh,
    pub levels: &'a Levels,
    /// The curvature of the surface, a vertex each.
    pub curvature: &'a [[f64; MAX_LEVELS]],
    /// What the reference has there.
    pub carried: &'a [ReferencePoint],
    /// The weights within a window of this radius.
    pub kernel: fn(f64) -> Kernel,
}

/// The local value at every vertex, the mean of those of its levels; not a number where no face
/// has the vertex.
pub(in crate::geometry) fn local_values(
    windows: &Windows,
    value: fn(&Moments) -> f64,
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let Windows { surface, levels, .. } = windows;
    let n = surface.n_vertices();
    let mut samples = Vec::with_capacity(n);
    for (vertex, (&own, carried)) in windows.curvature.iter().zip(windows.carried).enumerate() {
        control.item(vertex, usize::MAX)?;
        samples.push(Sample::new(surface.mesh.positions[vertex], own, carried));
    }
    let local_value = |vertex: u32, walk: &mut Walk| {
        let mut sum = 0.0;
        walk.start(vertex);
        for (at, level) in levels.iter().enumerate() {
            walk.grow(surface, level.window_radius, &control)?;
            let kernel = (windows.kernel)(level.window_radius);
            sum += value(&window_sums(walk, &samples, at, kernel).moments());
        }
        Ok(sum / levels.list.len() as f64)
    };
    let steps = control.steps(n.div_ceil(CHUNK));
    let mut found = vec![f64::NAN; n];
    found.par_chunks_mut(CHUNK).enumerate().try_for_each_init(
        || Walk::new(n),
        |walk, (chunk, out)| {
            for (at, out) in out.iter_mut().enumerate() {
                let vertex = (chunk * CHUNK + at) as u32;
                if !surface.neighbors_of(vertex).is_empty() {
                    *out = local_value(vertex, walk)?;
                }
            }
            steps.step()
        },
    )?;
    Ok(found)
}

/// The sums over the window that a walk has reached.
fn window_sums(walk: &Walk, samples: &[Sample], level: usize, kernel: Kernel) -> Sums {
    let center = &samples[walk.reached()[0] as usize];
    let mut sums = Sums::new(center, level, kernel);
    for &vertex in &walk.reached()[1..] {
        let sample = &samples[vertex as usize];
        let distances_sq = [
            sample.point.distance_squared(center.point),
            sample.carried_point.distance_squared(center.carried_point),
        ];
        sums.add(distances_sq, sample.own[level], sample.carried[level]);
    }
    for cut in walk.cuts() {
        let &Cut { from, to, part, .. } = cut;
        let ends = [&samples[from as usize], &samples[to as usize]];
        sums.add_between(center, ends, level, part, cut.distance_sq());
    }
    sums
}
