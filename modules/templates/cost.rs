//! The squared length of the edge, in model units squared; the shortest edge collapses first.
//!
//! Say what the cost measures, in which unit, and name its source: authors, title, venue, year.

use mve_core::Entry;

use super::{Cost, MakeCost};
use crate::geometry::simplify::collapse::{Batch, WorkingMesh};

pub static COST: Entry<MakeCost> = Entry {
    id: "Template",
    summary: "The squared length of the edge.",
    params: &[],
    build: |_, _| Ok(Box::new(Template)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug)]
struct Template;

impl Cost for Template {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            *price = proposal.contraction.length_squared(|v| mesh.position(v));
        }
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::geometry::simplify::collapse::trial::first_prices;
    use crate::placement::Endpoint;

    #[test]
    fn edges_cost_their_length_squared() {
        let mesh = mesh_of(&[[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[[0, 1, 2]]);
        let prices = first_prices(&mesh, &mut Template, &mut Endpoint);
        assert_eq!(prices, [(0, 1, 9.0), (0, 2, 16.0), (1, 2, 25.0)]);
    }
}
