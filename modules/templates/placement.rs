//! Half way between the middle and each vertex: on an edge, a quarter of it from either end.
//!
//! Say where the vertex goes and what for, and name the source: authors, title, venue, year.

use glam::DVec3;
use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, WorkingMesh};

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "Template",
    summary: "Half way between the middle and the cheapest vertex.",
    params: &[],
    build: |_, _| Ok(Box::new(Template)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug)]
struct Template;

impl Placement for Template {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, contraction) in batch.iter().enumerate() {
            let sum: DVec3 = contraction.vertices().map(|v| mesh.position(v)).sum();
            let middle = sum / contraction.vertices().count() as f64;
            for vertex in contraction.vertices() {
                out.push(at, middle.midpoint(mesh.position(vertex)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::geometry::simplify::collapse::trial::first_places;

    #[test]
    fn both_quarters_are_proposed() {
        let mesh = mesh_of(&[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 8.0, 0.0]], &[[0, 1, 2]]);
        let found = first_places(&mesh, &mut Template);
        let sums = found.iter().map(|(_, _, places)| (places[0] + places[1]).to_array());
        // Both together are as far out as both ends.
        assert!(sums.eq([[4.0, 0.0, 0.0], [0.0, 8.0, 0.0], [4.0, 8.0, 0.0]]));
        assert_eq!((found[0].2[0] - found[0].2[1]).length(), 2.0);
    }
}
