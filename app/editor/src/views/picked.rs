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
        self.index < mesh.n_elements(self.domain)
    }

    /// The same place as an element of another kind: the face or the vertex of a corner, the first
    /// corner of a face. A vertex has no one face.
    pub fn seen_as(&self, domain: Domain, mesh: &TriMesh) -> Option<Self> {
        let corner = match self.domain {
            known if known == domain => return Some(self.clone()),
            Domain::Vertex => return None,
            Domain::Corner => self.index,
            Domain::Face => 3 * self.index,
        };
        let index = match domain {
            Domain::Vertex => mesh.faces.get(corner / 3)?[corner % 3].idx(),
            Domain::Corner => corner,
            Domain::Face => corner / 3,
        };
        Some(Self { domain, index, ..self.clone() })
    }
}

/// The noun for one element.
pub fn one_of(domain: Domain) -> &'static str {
    match domain {
        Domain::Vertex => "vertex",
        Domain::Corner => "corner",
        Domain::Face => "face",
    }
}

/// The noun for several.
pub fn many_of(domain: Domain) -> &'static str {
    match domain {
        Domain::Vertex => "vertices",
        Domain::Corner => "corners",
        Domain::Face => "faces",
    }
}

#[cfg(test)]
mod tests {
    use mve_modules::mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn a_corner_leads_to_its_face_and_its_vertex() {
        let mesh = tetrahedron();
        let element = |domain, index| PickedElement { title: "a.mesh".to_owned(), domain, index };
        let corner = element(Domain::Corner, 7);
        let vertex = corner.seen_as(Domain::Vertex, &mesh).unwrap();
        assert_eq!(vertex.index, mesh.faces[2][1].idx());
        assert_eq!(corner.seen_as(Domain::Face, &mesh), Some(element(Domain::Face, 2)));
        assert_eq!(vertex.seen_as(Domain::Face, &mesh), None);
        let nowhere = element(Domain::Face, 99);
        assert!(!nowhere.is_in(&mesh));
        assert_eq!(nowhere.seen_as(Domain::Vertex, &mesh), None);
    }
}
