//! What floats of 32 bits do to positions.

use std::fmt;

use glam::DVec3;
use mve_core::brief;
use mve_mesh::data::{FaceId, TriMesh};

/// How far floats move vertices, where that shows.
pub(super) struct Rounding {
    /// In model units, at most.
    distance: f64,
    /// The same as a part of the diagonal of the mesh.
    share: f64,
    /// Faces that it moves by more than a tenth of their longest edge.
    n_faces: usize,
}

impl Rounding {
    /// That of a mesh, if it is more than a hundred-thousandth of its diagonal, or shows in some
    /// face.
    pub fn of_floats(mesh: &TriMesh) -> Option<Self> {
        // A float has 24 bits: it tells points apart that are 2⁻²⁴ of their coordinates away.
        let step = |farthest: f64| farthest * 2f64.powi(-24);
        let farthest = mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let distance = step(farthest);
        let diagonal = mesh.diagonal();
        let is_moved = |face: &u32| {
            let [a, b, c] = mesh.corners(FaceId(*face));
            let longest = [b - a, c - b, a - c].map(DVec3::length_squared).into_iter();
            let longest = longest.fold(0.0, f64::max).sqrt();
            let moved = step(a.abs().max(b.abs()).max(c.abs()).max_element());
            longest > 0.0 && moved > 0.1 * longest
        };
        let n_faces = (0..mesh.faces.len() as u32).filter(is_moved).count();
        let shows = distance > 1e-5 * diagonal || n_faces > 0;
        shows.then(|| Self { distance, share: distance / diagonal, n_faces })
    }

    /// Whether the whole mesh is far from the origin, not a part of it.
    pub fn is_of_all(&self) -> bool {
        self.share > 1e-5
    }
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { distance, share, n_faces } = self;
        let distance = brief(*distance);
        if self.is_of_all() {
            let share = brief(*share);
            return write!(
                f,
                "floats round positions by up to {distance} units, {share} of the mesh's diagonal"
            );
        }
        let faces = if *n_faces == 1 { "1 face has" } else { &format!("{n_faces} faces have") };
        write!(
            f,
            "floats round positions by up to {distance} units: {faces} edges hardly longer, and \
             may become flat"
        )
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;

    #[test]
    fn a_small_part_far_away_is_told_of() {
        let near = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let far = near.map(|[x, y, z]| [x + 1e8, y, z]);
        let points: Vec<_> = near.into_iter().chain(far).collect();
        let said = |mesh: &TriMesh| Rounding::of_floats(mesh).map(|found| found.to_string());
        assert_eq!(said(&mesh_of(&near, &[[0, 1, 2]])), None);
        let both = said(&mesh_of(&points, &[[0, 1, 2], [3, 4, 5]])).unwrap();
        assert!(both.contains("by up to 5.9605 units: 1 face has edges hardly longer"), "{both}");
        let alone = said(&mesh_of(&far, &[[0, 1, 2]])).unwrap();
        assert!(alone.contains("units, 4.2147 of the mesh's diagonal"), "{alone}");
    }
}
