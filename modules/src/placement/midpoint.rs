//! The middle of the edge.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, WorkingMesh};

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "Midpoint",
    summary: "The middle of the edge.",
    params: &[],
    build: |_, _| Ok(Box::new(Midpoint)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint;

impl Placement for Midpoint {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, .. }) in batch.iter().enumerate() {
            out.push(at, mesh.position(*kept).midpoint(mesh.position(*gone)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::simplify::collapse::trial::first_places;
    use crate::mesh::fixtures::mesh_of;
    use glam::DVec3;

    #[test]
    fn the_middle_is_proposed() {
        let corners = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let places = first_places(&mesh_of(&corners, &[[0, 1, 2]]), &mut Midpoint);
        let expected = [[1.5, 0.0, 0.0], [0.0, 2.0, 0.0], [1.5, 2.0, 0.0]].map(DVec3::from);
        assert!(places.iter().map(|(_, _, places)| places[0]).eq(expected));
    }
}
