//! The quadric error of the new vertex, in model units to the fourth power (area × distance²).
//!
//! M. Garland and P. S. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH
//! 1997; faces weigh by their area as in H. Hoppe, "New quadric metric for simplifying meshes
//! with appearance attributes", IEEE Visualization 1999. Deviation: a term of
//! [`TIE`] × weight × edge length² is added, the error of a vertex that lies 10⁻⁵ of its edge off
//! its planes. Where the surface is flat and every error is zero up to rounding, it makes short
//! edges go first, which keeps the faces there well shaped; elsewhere it does not count. An error
//! that is no larger than this term is none: coordinates of seven digits are off by less. Where
//! the corners of a face merge, the quadric is the sum of all three and the longest edge counts.
//!
//! With less than all `memory` the planes of the faces around the edge as they are count too, or
//! alone, as in the measures of P. Lindstrom and G. Turk, "Evaluation of memoryless simplification",
//! IEEE TVCG 5(2), 1999: old planes keep a vertex from going where the surface is now.

use glam::DVec3;
use mve_core::{Cancelled, Control, Entry};

use super::{Cost, MakeCost};
use crate::data::VertexId;
use crate::geometry::simplify::collapse::{
    Batch, Contraction, QuadricOptions, Reach, Renewal, WorkingMesh,
};
use crate::prelude::*;

const BOUNDARY_WEIGHT: Param<f64> = Param::number(
    "boundary_weight",
    "How much a border or seam edge counts against a face of the same size; 0 lets borders shrink.",
    QuadricOptions::DEFAULT.boundary_weight,
)
.within((0.0, 1e6))
.usually((0.0, 1000.0));

const MEMORY: Param<f64> = Param::number(
    "memory",
    "How much the planes of all faces count that the ends of an edge stand for, against those of the \
     faces around it as they are. 1 is the classic quadric, which is fastest; with less the result \
     errs less.",
    0.1,
)
.within((0.0, 1.0));

pub static COST: Entry<MakeCost> = Entry {
    id: "Quadric",
    summary: "The squared distance of the new vertex from the planes of the faces that it stands \
              for, weighted by their area (Garland and Heckbert 1997).",
    params: &[BOUNDARY_WEIGHT.spec(), MEMORY.spec()],
    build: |_, settings| {
        let options = QuadricOptions {
            boundary_weight: settings.get(&BOUNDARY_WEIGHT)?,
            memory: settings.get(&MEMORY)?,
        };
        Ok(Box::new(Quadric { options }))
    },
};

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

    // Nearly all error comes with the last collapses, and it is then that memory is in the way.
    fn head_start(&self) -> Option<f64> {
        (self.options.memory < 1.0).then_some(3.0)
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        Some(self.options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::FaceId;
    use crate::geometry::simplify::collapse::trial::{face_price, first_prices};
    use crate::mesh::fixtures::tetrahedron;
    use crate::placement::Endpoint;
    use glam::DVec3;

    #[test]
    fn a_price_is_the_weighted_squared_distance_from_the_planes() {
        // The corner at the origin has three planes of area 1/2, which count a third each; a leg of
        // length 1 to (1, 0, 0) leaves one of them by 1: (1/2) / 3. The other end has two of them
        // and the slanted face of area √3/2 at distance 1/√3: (√3/2) (1/3) / 3. The dearer is not
        // taken.
        let prices = first_prices(&tetrahedron(), &mut Quadric::default(), &mut Endpoint);
        let expected = f64::min(0.5 / 3.0, 3f64.sqrt() / 2.0 / 3.0 / 3.0);
        let (_, _, price) = prices[0];
        assert!((price - expected).abs() < 1e-9, "{price} {expected}");
        assert_eq!((prices.len(), COST.id), (6, "Quadric"));
    }

    #[test]
    fn a_face_counts_the_planes_of_its_three_corners() {
        // The face in z = 0 has that plane at all of its corners: three times (1/2) / 3. The other
        // three planes go through (0, 0, 1).
        let price = |p| face_price(&tetrahedron(), FaceId(0), p, &mut Quadric::default());
        assert!((price(DVec3::Z) - 0.5).abs() < 1e-9, "{}", price(DVec3::Z));
        // At the corner in the origin there is left what two corners have of the slanted plane of
        // area √3/2 at distance 1/√3: 2 (√3/2) (1/3) / 3.
        let expected = 3f64.sqrt() / 9.0;
        assert!((price(DVec3::ZERO) - expected).abs() < 1e-9, "{}", price(DVec3::ZERO));
    }
}
