//! What floats of 32 bits do to positions.

use std::fmt;

use mve_mesh::data::TriMesh;

/// How far floats move vertices, where that shows.
pub(super) struct Rounding {
    /// In model units, at most.
    distance: f64,
    /// The same as a part of the diagonal of the mesh.
    share: f64,
}

impl Rounding {
    /// That of a mesh, if it is more than a hundred-thousandth of its diagonal.
    pub fn of_floats(mesh: &TriMesh) -> Option<Self> {
        // A float has 24 bits: it tells points apart that are 2⁻²⁴ of their coordinates away.
        let farthest = mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let distance = farthest * 2f64.powi(-24);
        let diagonal = mesh.diagonal();
        (distance > 1e-5 * diagonal).then(|| Self { distance, share: distance / diagonal })
    }
}

impl fmt::Display for Rounding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { distance, share } = self;
        write!(
            f,
            "floats round positions by up to {distance:.3e}, which is {share:.1e} of the mesh's \
             diagonal"
        )
    }
}
