//! Smooths a surface by drawing vertices to their neighbors.
//!
//! Sources: G. Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995,
//! section 3, for the steps of λ and μ; M. Desbrun, M. Meyer, P. Schröder and A. Barr, "Implicit
//! fairing of irregular meshes using diffusion and curvature flow", SIGGRAPH 1999, section 2.4 for
//! the implicit step, 3.2 for keeping the volume, 4 for the cotangents. Departures: in the implicit
//! step the weights of a vertex are scaled to a sum of 1 with cotangents as well, so that its
//! length does not depend on the size of the mesh; weights below 0 count as 0; and the matrix,
//! symmetric once each row is multiplied by the sum of its weights, is solved by conjugate
//! gradients in place of biconjugate ones.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{FaceId, TriMesh};

use super::shading::renew_normals;
use super::weights::{Borders, EdgeWeight, Pattern, Weights};

/// How a step moves the vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SmoothMethod {
    /// By a share of the way to the mean of the neighbors.
    Laplace {
        /// The share, 0 to 1.
        lambda: f64,
    },
    /// A step forth and one back, which keeps what is larger than a wavelength.
    Taubin {
        /// The share of the way forth.
        lambda: f64,
        /// The share of the way back, below −λ.
        mu: f64,
    },
    /// A long step of the diffusion at once: stable for any length.
    Implicit {
        /// The length of the step.
        lambda: f64,
    },
}

/// How to smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothOptions {
    /// What a step does.
    pub method: SmoothMethod,
    /// How many steps.
    pub steps: u32,
    /// How much each neighbor counts.
    pub weight: EdgeWeight,
    /// What holds vertices at borders.
    pub borders: Borders,
    /// Whether the mesh is scaled to its old volume after each step.
    pub keeps_volume: bool,
}

/// A mesh that was smoothed.
#[derive(Clone, Debug)]
pub struct Smoothed {
    /// The mesh.
    pub mesh: TriMesh,
    /// Whether its volume could be kept, where that was asked for: it is closed, oriented and has
    /// one.
    pub has_volume: bool,
    /// Whether all implicit steps came to their end.
    pub is_solved: bool,
}

/// The part of the first residual at which an implicit step is solved.
const RESIDUAL: f64 = 1e-10;
/// Most rounds of a solution.
const MAX_ROUNDS: usize = 2000;

/// Moves the vertices of a mesh; faces and layers stay, and normals are computed anew. Vertices
/// without a neighbor, and those that are not finite, stay where they are, as do those that are not
/// among `chosen` where that is given; then the volume is not kept. O(n) a step, and O(n) a round
/// of an implicit one.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn smooth(
    mut mesh: TriMesh,
    options: &SmoothOptions,
    chosen: Option<&[bool]>,
    control: Control,
) -> Result<Smoothed, Cancelled> {
    let adjacency = Adjacency::new(&mesh, control.part(0.0, 0.1))?;
    let pattern = Pattern::of(&mesh, &adjacency, options.borders, chosen);
    let edges = 0..adjacency.edges().len() as u32;
    let is_closed = edges.map(EdgeId).all(|e| adjacency.winding(&mesh, e) == 0);
    let before = Body::of(&mesh).filter(|_| is_closed && chosen.is_none());
    let has_volume = before.is_some() || !options.keeps_volume;
    let mut is_solved = true;
    let steps = control.part(0.1, 0.9);
    for step in 0..options.steps {
        let share = |s: u32| f64::from(s) / f64::from(options.steps);
        let part = steps.part(share(step), share(step + 1));
        part.at(0.0)?;
        let weights = || pattern.weights(&mesh, &adjacency, options.weight);
        match options.method {
            SmoothMethod::Laplace { lambda } => draw(&weights(), lambda, &mut mesh.positions),
            SmoothMethod::Taubin { lambda, mu } => {
                // Both ways by the weights of one place, so that they undo each other.
                let weights = weights();
                draw(&weights, lambda, &mut mesh.positions);
                draw(&weights, mu, &mut mesh.positions);
            }
            SmoothMethod::Implicit { lambda } => {
                let weights = weights();
                is_solved &= diffuse(&weights, lambda, &mut mesh.positions, part)?;
            }
        }
        if let Some(before) = before.filter(|_| options.keeps_volume) {
            before.restore(&mut mesh);
        }
    }
    renew_normals(&mut mesh, control.part(0.9, 1.0))?;
    Ok(Smoothed { mesh, has_volume, is_solved })
}

fn draw(weights: &Weights, share: f64, positions: &mut [DVec3]) {
    let ways = weights.laplacian(positions);
    positions.iter_mut().zip(ways).for_each(|(position, way)| *position += share * way);
}

/// Solves (D + λ (D − W)) x = D x₀ for the new positions, where D holds the sums of weights and
/// vertices that stay have the row x = x₀; whether it came to its end.
///
/// What stays is known, so that the rest is symmetric and positive definite. Vertices that are
/// drawn along a border alone are not drawn back by their other neighbors: theirs is a system of
/// its own, which is solved first.
fn diffuse(
    weights: &Weights,
    lambda: f64,
    positions: &mut [DVec3],
    control: Control,
) -> Result<bool, Cancelled> {
    let mut is_solved = true;
    for (is_border, part) in [(true, control.part(0.0, 0.2)), (false, control.part(0.2, 1.0))] {
        let is_open: Vec<bool> = weights
            .sums
            .iter()
            .zip(&weights.is_on_border)
            .map(|(sum, on_border)| *sum > 0.0 && *on_border == is_border)
            .collect();
        if is_open.contains(&true) {
            is_solved &= solve(weights, lambda, &is_open, positions, part)?;
        }
    }
    Ok(is_solved)
}

/// Solves for the open vertices, all others being where they are. By conjugate gradients (Hestenes
/// and Stiefel 1952), preconditioned by the diagonal, the three coordinates at once.
fn solve(
    weights: &Weights,
    lambda: f64,
    is_open: &[bool],
    positions: &mut [DVec3],
    control: Control,
) -> Result<bool, Cancelled> {
    let diagonal = |v: usize| (1.0 + lambda) * weights.sums[v];
    // What D + λ (D − W) makes of a vector that is zero at vertices that are not open.
    let applied = |x: &[DVec3], out: &mut [DVec3]| {
        out.iter_mut().enumerate().for_each(|(v, out)| {
            *out = if is_open[v] { diagonal(v) * x[v] } else { DVec3::ZERO };
        });
        for (&[a, b], &[to_a, to_b]) in weights.edges.iter().zip(&weights.weights) {
            if is_open[a.idx()] && is_open[b.idx()] {
                out[a.idx()] -= lambda * to_a * x[b.idx()];
                out[b.idx()] -= lambda * to_b * x[a.idx()];
            }
        }
    };
    // Started at x₀, the residual D x₀ − A x₀ is λ D times the mean of the neighbors less x₀.
    let ways = weights.laplacian(positions);
    let mut residual: Vec<DVec3> = (0..positions.len())
        .map(|v| if is_open[v] { lambda * weights.sums[v] * ways[v] } else { DVec3::ZERO })
        .collect();
    let scaled = |residual: &[DVec3]| -> Vec<DVec3> {
        let at = |(v, r): (usize, &DVec3)| if is_open[v] { *r / diagonal(v) } else { DVec3::ZERO };
        residual.iter().enumerate().map(at).collect()
    };
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| *a * *b).sum::<DVec3>();
    let mut z = scaled(&residual);
    let mut direction = z.clone();
    let mut product = dot(&residual, &z);
    // Coordinates too large to square.
    if !product.is_finite() {
        return Ok(false);
    }
    let limit = RESIDUAL * RESIDUAL * product;
    let mut image = vec![DVec3::ZERO; positions.len()];
    let mut change = vec![DVec3::ZERO; positions.len()];
    let divided = |a: DVec3, b: DVec3| {
        DVec3::from_array([0, 1, 2].map(|k| if b[k] != 0.0 { a[k] / b[k] } else { 0.0 }))
    };
    let mut is_solved = false;
    for round in 0..MAX_ROUNDS {
        control.at(round as f64 / MAX_ROUNDS as f64)?;
        if !product.cmpgt(limit).any() {
            is_solved = true;
            break;
        }
        applied(&direction, &mut image);
        let alpha = divided(product, dot(&direction, &image));
        for v in 0..positions.len() {
            change[v] += alpha * direction[v];
            residual[v] -= alpha * image[v];
        }
        z = scaled(&residual);
        let next = dot(&residual, &z);
        let beta = divided(next, product);
        product = next;
        for v in 0..positions.len() {
            direction[v] = z[v] + beta * direction[v];
        }
    }
    if change.iter().all(|way| way.is_finite()) {
        positions.iter_mut().zip(&change).for_each(|(position, way)| *position += *way);
        return Ok(is_solved);
    }
    Ok(false)
}

/// The volume of a closed mesh.
#[derive(Clone, Copy)]
struct Body {
    volume: f64,
    center: DVec3,
}

impl Body {
    /// `None` where it is zero or not finite.
    fn of(mesh: &TriMesh) -> Option<Self> {
        let start = mesh.faces.first().map(|face| mesh.positions[face[0].idx()])?;
        let (mut volume, mut moment) = (0.0, DVec3::ZERO);
        for face in (0..mesh.faces.len() as u32).map(FaceId) {
            let [a, b, c] = mesh.corners(face).map(|p| p - start);
            let part = a.dot(b.cross(c)) / 6.0;
            volume += part;
            moment += 0.25 * part * (a + b + c);
        }
        let center = start + moment / volume;
        (volume != 0.0 && volume.is_finite() && center.is_finite())
            .then_some(Self { volume, center })
    }

    /// Scales a mesh to this volume, around this center of gravity.
    fn restore(&self, mesh: &mut TriMesh) {
        let Some(now) = Self::of(mesh) else { return };
        let factor = (self.volume / now.volume).cbrt();
        if factor > 0.0 && factor.is_finite() {
            for position in &mut mesh.positions {
                *position = self.center + factor * (*position - now.center);
            }
        }
    }
}

#[cfg(test)]
#[path = "smooth_tests.rs"]
mod tests;
