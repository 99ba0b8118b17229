//! The squared length of the edge, in model units squared; the shortest edge collapses first.
//!
//! Say what the cost measures, in which unit, and name its source: authors, title, venue, year.

use mve_core::Entry;

use super::{Cost, MakeCost};
use crate::geometry::simplify::collapse::{Batch, Contraction, WorkingMesh};

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
            let Contraction { kept, gone, .. } = proposal.contraction;
            *price = mesh.position(kept).distance_squared(mesh.position(gone));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::TriMesh;
    use crate::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
    use crate::mesh::fixtures::mesh_of;
    use crate::placement::Endpoint;
    use mve_core::Control;

    /// A square of four triangles whose inner vertex is off its center.
    fn square() -> TriMesh {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]];
        let positions: Vec<_> = corners.into_iter().chain([[1.0, 2.0, 0.0]]).collect();
        mesh_of(&positions, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    }

    #[test]
    fn the_shortest_edge_collapses_first() {
        let options = SimplifyOptions {
            stop: Stop { faces: Some(2), ..Stop::default() },
            ..SimplifyOptions::default()
        };
        let result = simplify(&square(), &mut Template, &mut Endpoint, options, Control::none());
        let mesh = result.unwrap().mesh;
        assert_eq!(mesh.faces.len(), 2);
        assert_eq!(mesh.area(), 16.0);
    }
}
