//! The cheaper end of the edge: a half-edge collapse. Where the corners of a face merge, the
//! cheapest of the three.
//!
//! The vertices of the result are vertices of the input, bit for bit, with their attributes.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, WorkingMesh};

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "Endpoint",
    summary: "The cheaper end of the edge: vertices of the result are vertices of the input.",
    params: &[],
    build: |_, _| Ok(Box::new(Endpoint)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Endpoint;

impl Placement for Endpoint {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, also_gone, .. }) in batch.iter().enumerate() {
            out.push(at, mesh.position(*kept));
            out.push(at, mesh.position(*gone));
            also_gone.iter().for_each(|third| out.push(at, mesh.position(*third)));
        }
    }

    fn for_block(&self) -> Option<Box<dyn Placement>> {
        Some(Box::new(*self))
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::FaceId;
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::geometry::simplify::collapse::trial::{face_places, first_places};

    #[test]
    fn both_ends_are_proposed() {
        let corners = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mesh = mesh_of(&corners, &[[0, 1, 2]]);
        for (from, to, places) in first_places(&mesh, &mut Endpoint) {
            let ends = [from, to].map(|v| mesh.positions[v as usize]);
            assert!(places == ends || places == [ends[1], ends[0]]);
        }
        assert_eq!(face_places(&mesh, FaceId(0), &mut Endpoint), mesh.positions);
    }
}
