//! The one element of a mesh that a person looks at: picked in a picture, in a table, or by its
//! number. All views of a panel share it.

use mve_modules::data::{Domain, TriMesh};

/// An element of a mesh that is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PickedElement {
    /// Where the mesh comes from: `simplify.mesh`.
    pub title: String,
    /// Of which kind it is.
    pub domain: Domain,
    /// Its number, from 0; corners count 3 × face + k.
    pub index: usize,
}

impl PickedElement {
    /// Whether the mesh has it: after another run there may be fewer.
    pub fn is_in(&self, mesh: &TriMesh) -> bool {
        self.index < n_elements(mesh, self.domain)
    }
}

/// How many elements of a kind a mesh has.
pub fn n_elements(mesh: &TriMesh, domain: Domain) -> usize {
    match domain {
        Domain::Vertex => mesh.positions.len(),
        Domain::Corner => 3 * mesh.faces.len(),
        Domain::Face => mesh.faces.len(),
    }
}
