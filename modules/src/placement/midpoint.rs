//! The middle of the edge; where the corners of a face merge, that of the face.

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
        for (at, Contraction { kept, gone, also_gone, .. }) in batch.iter().enumerate() {
            let (from, to) = (mesh.position(*kept), mesh.position(*gone));
            let of_face = also_gone.map(|third| (from + to + mesh.position(third)) / 3.0);
            out.push(at, of_face.unwrap_or_else(|| from.midpoint(to)));
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
    use glam::DVec3;

    #[test]
    fn the_middle_is_proposed() {
        let corners = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mesh = mesh_of(&corners, &[[0, 1, 2]]);
        let places = first_places(&mesh, &mut Midpoint);
        let expected = [[1.5, 0.0, 0.0], [0.0, 2.0, 0.0], [1.5, 2.0, 0.0]].map(DVec3::from);
        assert!(places.iter().map(|(_, _, places)| places[0]).eq(expected));
        let of_face = face_places(&mesh, FaceId(0), &mut Midpoint);
        assert_eq!(of_face, [DVec3::new(1.0, 4.0 / 3.0, 0.0)]);
    }
}
