//! The quadric error of the new vertex, in model units to the fourth power (area × distance²).
//!
//! M. Garland and P. S. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH
//! 1997; faces weigh by their area as in H. Hoppe, "New quadric metric for simplifying meshes
//! with appearance attributes", IEEE Visualization 1999. Deviation: a term of
//! 10⁻¹⁰ × weight × edge length² is added, the error of a vertex that lies 10⁻⁵ of its edge off
//! its planes. Where the surface is flat and every error is zero up to rounding, it makes short
//! edges go first, which keeps the faces there well shaped; elsewhere it does not count. An error
//! that is no larger than this term is none: coordinates of seven digits are off by less. Where
//! the corners of a face merge, the quadric is the sum of all three and the longest edge counts.
//!
//! With less than all `memory` the planes of the faces around the edge as they are count too, or
//! alone, as in the measures of P. Lindstrom and G. Turk, "Evaluation of memoryless
//! simplification", IEEE TVCG 5(2), 1999: old planes keep a vertex from
//! going where the surface is now.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::VertexId;

use super::collapse::{Batch, Contraction, Cost, QuadricOptions, Reach, Renewal, WorkingMesh};

/// Weight of the term that orders collapses of equal error, relative to the quadric's weight.
const TIE: f64 = 1e-10;

/// What orders collapses of equal error.
#[inline]
fn tie(mesh: &WorkingMesh, contraction: &Contraction) -> f64 {
    let length_squared = contraction.length_squared(|v| mesh.position(v));
    TIE * contraction.quadric.weight() * length_squared
}

/// See the file's header. The quadrics themselves live in the engine's mesh.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quadric {
    /// Which planes the quadrics sum.
    pub options: QuadricOptions,
}

impl Cost for Quadric {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            let contraction = &proposal.contraction;
            let (quadric, kept) = (&contraction.quadric, mesh.position(contraction.kept));
            let tie = tie(mesh, contraction);
            // Rounding below zero would put noise before the order that the tie term gives.
            *price = quadric.at(proposal.position - kept).max(0.0) + tie;
        }
    }

    fn for_block(&self) -> Option<Box<dyn Cost>> {
        Some(Box::new(*self))
    }

    fn is_patient(&self) -> bool {
        true
    }

    fn is_free(&self, mesh: &WorkingMesh, contraction: &Contraction, price: f64) -> bool {
        price <= 2.0 * tie(mesh, contraction)
    }

    fn largest_free(&self, mesh: &WorkingMesh, control: Control) -> Result<f64, Cancelled> {
        // No contraction sums more planes than there are, nor is an edge longer than the mesh, but
        // for vertices that move out of the box of the input.
        const MARGIN: f64 = 4.0;
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut weight = 0.0;
        for vertex in (0..mesh.n_vertices() as u32).map(VertexId) {
            if vertex.idx().is_multiple_of(1 << 16) {
                control.at(0.0)?;
            }
            let position = mesh.position(vertex);
            if position.is_finite() {
                (low, high) = (low.min(position), high.max(position));
                weight += mesh.quadric(vertex).weight();
            }
        }
        Ok(MARGIN * 2.0 * TIE * weight * (high - low).length_squared())
    }

    // Quadrics with all memory only gain planes, and none of them is ever negative.
    fn only_grows(&self) -> bool {
        self.options.memory == 1.0
    }

    fn reach(&self) -> Reach {
        if self.options.memory < 1.0 { Reach::NEIGHBORS } else { Reach::MERGED }
    }

    fn renewal(&self) -> Renewal {
        if self.options.memory < 1.0 { Renewal::Lazy } else { Renewal::AtOnce }
    }

    // Prices change less than those of pictures do: with 0.7 the RMS is 0.1 % more than with a
    // third, and a sixth of the time is saved.
    fn waiting_share(&self) -> f64 {
        0.7
    }

    // Nearly all error comes with the last collapses, and it is then that memory is in the way.
    fn head_start(&self) -> Option<f64> {
        (self.options.memory < 1.0).then_some(3.0)
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        Some(self.options)
    }
}
