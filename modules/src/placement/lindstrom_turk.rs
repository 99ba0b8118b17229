//! The placement of Lindstrom and Turk: volume and border are preserved, then the cost is least.
//!
//! P. Lindstrom and G. Turk, "Fast and memory efficient polygonal simplification", IEEE
//! Visualization 1998, section 4; see [`crate::geometry::simplify::lindstrom_turk`]. Where the
//! constraints determine no point, the middle of the edge is taken; the paper leaves such an edge.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, Reach, WorkingMesh};
use crate::geometry::simplify::lindstrom_turk::Patch;

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "LindstromTurk",
    summary: "Keeps the volume and the border, then makes the change of volume least (Lindstrom and \
              Turk 1998).",
    params: &[],
    build: |_, _| Ok(Box::new(LindstromTurk)),
};

/// See the file's header.
#[derive(Clone, Copy, Debug, Default)]
pub struct LindstromTurk;

impl Placement for LindstromTurk {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, contraction) in batch.iter().enumerate() {
            let Some(patch) = Patch::around(mesh, contraction) else { continue };
            let offset = patch.place(mesh, contraction).unwrap_or_else(|| patch.middle());
            out.push(at, mesh.position(contraction.kept) + offset);
        }
    }

    fn gives_way(&self) -> bool {
        true
    }

    fn for_block(&self) -> Option<Box<dyn Placement>> {
        Some(Box::new(*self))
    }

    fn reach(&self) -> Reach {
        Reach::NEIGHBORS
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{mesh_of, tetrahedron, torus};

    use super::*;
    use crate::geometry::simplify::collapse::trial::first_places;
    use crate::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
    use glam::DVec3;
    use mve_core::Control;

    #[test]
    fn where_volumes_are_least_if_nothing_else_says() {
        // All faces count, so the volume says nothing; x² + y² + z² + (1 − x − y − z)² is least at
        // a quarter each.
        for (_, _, places) in first_places(&tetrahedron(), &mut LindstromTurk) {
            assert!((places[0] - DVec3::splat(0.25)).length() < 1e-12, "{places:?}");
        }
    }

    #[test]
    fn a_straight_border_stays_straight_and_a_flat_part_even() {
        // A strip of three squares in the plane z = 1, cut along one diagonal each.
        let at = |i: u32, j: u32| [f64::from(i), f64::from(j), 1.0];
        let points: Vec<_> = (0..2).flat_map(|j| (0..4).map(move |i| at(i, j))).collect();
        let cell = |i: u32| [[i, i + 1, i + 5], [i, i + 5, i + 4]];
        let faces: Vec<_> = (0..3).flat_map(cell).collect();
        let places = first_places(&mesh_of(&points, &faces), &mut LindstromTurk);
        let (_, _, along) = places.iter().find(|(a, b, _)| (*a, *b) == (1, 2)).unwrap();
        // The middle edge of the lower border: on it, and the mean along it of the neighbors, which
        // stand at 0, 3, 1, 2 and 3.
        assert!((along[0] - DVec3::new(1.8, 0.0, 1.0)).length() < 1e-9, "{along:?}");
    }

    #[test]
    fn the_volume_of_a_closed_mesh_is_kept_through_a_whole_run() {
        let mesh = torus(2.0, 0.5, 24);
        let options = SimplifyOptions {
            stop: Stop { ratio: Some(0.2), ..Stop::default() },
            ..SimplifyOptions::default()
        };
        let (mut cost, mut placement) = (crate::cost::LindstromTurk, LindstromTurk);
        let found = simplify(&mesh, &mut cost, &mut placement, options, Control::none()).unwrap();
        let change = found.mesh.signed_volume() / mesh.signed_volume() - 1.0;
        assert!(change.abs() < 1e-9, "{change}");
    }
}
