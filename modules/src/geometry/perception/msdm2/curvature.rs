//! Curvature at a vertex as MSDM and MSDM2 measure it: the normal cycle within a sphere.
//!
//! D. Cohen-Steiner and J.-M. Morvan, "Restricted Delaunay triangulations and normal cycle", SoCG
//! 2003, and P. Alliez et al., "Anisotropic polygonal remeshing", SIGGRAPH 2003: each edge in the
//! sphere adds its bend times its length within, on the dyad of its direction; the sum over the
//! area π r² is the tensor. [`Published`](super::Variant::Published) keeps what the published
//! program does: edges that do not lead outward from the walk are not counted, a bend is the arc
//! sine of the turn (so that turns over a right angle fold back), borders do not bend, and the area
//! is always that of a full disc. Where edges are longer than the radius this measures creases, not
//! curvature.

use std::f64::consts::PI;

use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use super::bend::Bend;
use super::curvature_mesh::CurvatureMesh;
use super::walk::Walk;
use super::{CHUNK, Levels, MAX_LEVELS};

/// The mean of the two principal magnitudes at every vertex and level, times `size`: dimensionless.
pub(in crate::geometry) fn curvatures(
    surface: &CurvatureMesh,
    levels: &Levels,
    control: Control,
) -> Result<Vec<[f64; MAX_LEVELS]>, Cancelled> {
    let n = surface.n_vertices();
    let steps = control.steps(n.div_ceil(CHUNK));
    let mut found = vec![[0.0; MAX_LEVELS]; n];
    found.par_chunks_mut(CHUNK).enumerate().try_for_each_init(
        || Walk::new(n),
        |walk, (chunk, out)| {
            for (at, out) in out.iter_mut().enumerate() {
                let vertex = (chunk * CHUNK + at) as u32;
                *out = curvature(surface, levels, vertex, walk, &control)?;
            }
            steps.step()
        },
    )?;
    Ok(found)
}

fn curvature(
    surface: &CurvatureMesh,
    levels: &Levels,
    vertex: u32,
    walk: &mut Walk,
    control: &Control,
) -> Result<[f64; MAX_LEVELS], Cancelled> {
    let mut found = [0.0; MAX_LEVELS];
    if surface.neighbors_of(vertex).is_empty() {
        return Ok(found);
    }
    let share = surface.disc_shares.get(vertex as usize).copied().unwrap_or(1.0);
    let mut whole = Bend::default();
    let mut n_whole = 0;
    let mut last: Option<(f64, f64)> = None;
    walk.start(vertex);
    for (found, level) in found.iter_mut().zip(levels.iter()) {
        walk.grow(surface, level.curvature_radius, control)?;
        let radius = level.curvature_radius;
        if let (Some((value, at)), true) = (last, walk.whole().is_empty()) {
            // As long as the sphere cuts every edge the tensor grows as the radius does.
            *found = value * at / radius;
            continue;
        }
        for &edge in &walk.whole()[n_whole..] {
            whole.add(&surface.bends[edge as usize], 1.0);
        }
        n_whole = walk.whole().len();
        let mut sum = whole;
        for cut in walk.cuts() {
            sum.add(&surface.bends[cut.edge as usize], cut.part);
        }
        *found = levels.size * sum.two_largest() / (2.0 * PI * radius * radius * share);
        last = Some((*found, radius));
    }
    Ok(found)
}
