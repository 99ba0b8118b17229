//! Curvature from a polynomial that is fitted to the points around a vertex.
//!
//! Source: F. Cazals & M. Pouget, "Estimating differential quantities using polynomial fitting of
//! osculating jets", CAGD 2005: a height over the tangent plane, fitted by least squares, and the
//! curvature of its graph at the vertex. A fit of degree d has an error of order d - 1 in the
//! distance of the points, and of order d for even d where they lie evenly around the vertex.
//!
//! Departures: the frame is that of the vertex normal, weighted by angles, not of a principal
//! component analysis, so that the sign is known; the graph passes through the vertex; where the
//! points do not determine a polynomial of the degree asked for, rings are added, then degrees
//! taken away.

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::{TriMesh, VertexId};
use rayon::prelude::*;

use super::{Curvature, eigen, normalized, tangents};
use crate::geometry::surface::normals::{NormalWeight, vertex_normals};

/// Vertices that are worked on in one piece: some 20 ms where the rings are widest.
const CHUNK: usize = 1 << 7;

/// Most points of a fit. Ten rings of vertices with six neighbors have 330.
const MAX_POINTS: usize = 400;

/// Coefficients of the largest degree, 4, without the constant.
const MAX_TERMS: usize = 14;

/// A column is taken for a combination of others when what is left of it is below this part of
/// its length; rounding leaves 1e-16, the worst regular grids 1e-3.
const RANK_TOLERANCE: f64 = 1e-7;

/// How much of the surface is fitted, by what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FitOptions {
    /// Rings of neighbors, from 1.
    pub ring: u32,
    /// Degree of the polynomial, 2 to 4.
    pub degree: usize,
}

/// The curvature at each vertex.
///
/// Vertices of borders are fitted to the points on their one side. Parts of the surface that touch
/// are taken for one. A vertex without a normal, or with fewer than 5 points around it that
/// determine a quadric, has no curvature.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn quadric_fit(
    mesh: &TriMesh,
    options: FitOptions,
    control: Control,
) -> Result<Vec<Curvature>, Cancelled> {
    let (mesh, scale) = normalized(mesh);
    let adjacency = Adjacency::new(&mesh, control.part(0.0, 0.1))?;
    let normals = vertex_normals(&mesh, NormalWeight::Angle, control.part(0.1, 0.2))?;
    let n_vertices = mesh.positions.len();
    let mut found = vec![Curvature::UNDEFINED; n_vertices];
    let steps = control.part(0.2, 1.0).steps(n_vertices.div_ceil(CHUNK));
    found.par_chunks_mut(CHUNK).enumerate().try_for_each_init(
        || Neighborhood::new(n_vertices),
        |around, (chunk, found)| {
            for (place, found) in found.iter_mut().enumerate() {
                let vertex = VertexId((chunk * CHUNK + place) as u32);
                let normal = normals[vertex.idx()];
                if normal != DVec3::ZERO {
                    *found = at_vertex(&mesh, &adjacency, vertex, normal, options, around)
                        .unwrap_or(Curvature::UNDEFINED)
                        .scaled(scale);
                }
            }
            steps.step()
        },
    )?;
    Ok(found)
}

/// The vertices around one, ring by ring.
struct Neighborhood {
    /// For each vertex of the mesh, the last one that it was found around.
    seen_from: Vec<u32>,
    members: Vec<VertexId>,
    /// Where the ring that comes next was begun.
    start: usize,
}

impl Neighborhood {
    fn new(n_vertices: usize) -> Self {
        Self { seen_from: vec![u32::MAX; n_vertices], members: Vec::new(), start: 0 }
    }

    fn begin(&mut self, vertex: VertexId) {
        self.members.clear();
        self.members.push(vertex);
        self.seen_from[vertex.idx()] = vertex.0;
        self.start = 0;
    }

    /// Adds the next ring; `false` when there is none.
    fn grow(&mut self, mesh: &TriMesh, adjacency: &Adjacency) -> bool {
        let (center, ring) = (self.members[0], self.start..self.members.len());
        self.start = ring.end;
        for place in ring {
            for &corner in adjacency.corners_of(self.members[place]) {
                let face = mesh.faces[corner as usize / 3];
                for vertex in [1, 2].map(|k| face[(corner as usize + k) % 3]) {
                    if self.members.len() > MAX_POINTS {
                        return false;
                    }
                    if self.seen_from[vertex.idx()] != center.0 {
                        self.seen_from[vertex.idx()] = center.0;
                        self.members.push(vertex);
                    }
                }
            }
        }
        self.members.len() > self.start
    }
}

fn at_vertex(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    vertex: VertexId,
    normal: DVec3,
    options: FitOptions,
    around: &mut Neighborhood,
) -> Option<Curvature> {
    around.begin(vertex);
    let mut grows = true;
    for _ in 0..options.ring {
        grows = grows && around.grow(mesh, adjacency);
    }
    let at = mesh.positions[vertex.idx()];
    let [u, v] = tangents(normal);
    for degree in (2..=options.degree).rev() {
        // Twice the rings that were asked for are enough of what is no longer near.
        for _ in 0..options.ring.max(2) {
            if around.members.len() > n_terms(degree) || !grows {
                break;
            }
            grows = around.grow(mesh, adjacency);
        }
        let points = around.members[1..].iter().map(|member| {
            let offset = mesh.positions[member.idx()] - at;
            (DVec2::new(offset.dot(u), offset.dot(v)), offset.dot(normal))
        });
        if let Some(jet) = fit(points, degree) {
            return Some(of_jet(jet, [u, v, normal]));
        }
    }
    None
}

/// Coefficients of a polynomial in two variables without its constant.
fn n_terms(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2 - 1
}

/// The first five coefficients (u, v, u², u v, v²) of the polynomial through the origin that fits
/// heights over points of the plane best; `None` where the points do not determine it.
fn fit(points: impl Iterator<Item = (DVec2, f64)> + Clone, degree: usize) -> Option<[f64; 5]> {
    let n_terms = n_terms(degree);
    let radius = points.clone().map(|(point, _)| point.length()).fold(0.0, f64::max);
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); n_terms + 1];
    for (point, height) in points {
        let p = point / radius;
        let mut column = 0;
        for power in 1..=degree as i32 {
            for of_v in 0..=power {
                columns[column].push(p.x.powi(power - of_v) * p.y.powi(of_v));
                column += 1;
            }
        }
        columns[n_terms].push(height / radius);
    }
    if columns[0].len() < n_terms {
        return None;
    }
    let mut solution = least_squares(&mut columns)?;
    solution[2..5].iter_mut().for_each(|second| *second /= radius);
    let jet = [0, 1, 2, 3, 4].map(|k| solution[k]);
    jet.iter().all(|number| number.is_finite()).then_some(jet)
}

/// Solves for the factors by which the columns come nearest to the last one, by the modified
/// method of Gram and Schmidt, each column made orthogonal twice.
fn least_squares(columns: &mut [Vec<f64>]) -> Option<[f64; MAX_TERMS]> {
    let n = columns.len() - 1;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    // Column k of the triangular factor, and last what the right side has of each column.
    let mut factor: Vec<[f64; MAX_TERMS]> = Vec::with_capacity(n + 1);
    for k in 0..=n {
        let (done, rest) = columns.split_at_mut(k);
        let column = &mut rest[0];
        let before = dot(column, column).sqrt();
        let mut parts = [0.0; MAX_TERMS];
        for _ in 0..2 {
            for (other, sum) in done.iter().zip(&mut parts) {
                let part = dot(other, column);
                *sum += part;
                column.iter_mut().zip(other).for_each(|(x, y)| *x -= part * y);
            }
        }
        if k < n {
            let length = dot(column, column).sqrt();
            if length.is_nan() || length <= RANK_TOLERANCE * before {
                return None;
            }
            parts[k] = length;
            column.iter_mut().for_each(|x| *x /= length);
        }
        factor.push(parts);
    }
    let mut solution = [0.0; MAX_TERMS];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| factor[j][k] * solution[j]).sum();
        solution[k] = (factor[n][k] - known) / factor[k][k];
    }
    Some(solution)
}

/// The curvature of the graph at the origin. Down is away from the normal, so convex is positive.
fn of_jet([a, b, uu, uv, vv]: [f64; 5], [u, v, normal]: [DVec3; 3]) -> Curvature {
    let slope = (1.0 + a * a + b * b).sqrt();
    let (along_u, along_v) = (u + a * normal, v + b * normal);
    // An orthonormal basis of the tangent plane, in steps along u and v.
    let first = 1.0 / along_u.length();
    let shear = along_u.dot(along_v) / along_u.length_squared();
    let second = 1.0 / (along_v - shear * along_u).length();
    let form = [uu, 0.5 * uv, vv].map(|term| -2.0 * term / slope);
    let basis = [[first, 0.0], [-shear * second, second]];
    let bend = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        a * c * form[0] + (a * d + b * c) * form[1] + b * d * form[2]
    };
    let ([maximum, minimum], [cos, sin]) =
        eigen(bend(basis[0], basis[0]), bend(basis[0], basis[1]), bend(basis[1], basis[1]));
    let [e, f] = basis.map(|[a, b]| a * along_u + b * along_v);
    Curvature {
        mean: 0.5 * (maximum + minimum),
        gaussian: maximum * minimum,
        maximum,
        minimum,
        max_direction: cos * e + sin * f,
        min_direction: cos * f - sin * e,
    }
}
