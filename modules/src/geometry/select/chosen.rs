//! Selections as fields, read over the vertices or the faces of a mesh.

use mve_mesh::data::{Domain, Field, TriMesh};

/// What a selection is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Elements {
    /// Faces.
    Faces,
    /// Vertices.
    Vertices,
}

/// When a face is chosen by what is chosen of its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerRule {
    /// All three are.
    All,
    /// One of them is.
    Any,
    /// Two of them are.
    Most,
}

impl CornerRule {
    fn holds(self, corners: [bool; 3]) -> bool {
        let n = corners.iter().filter(|is| **is).count();
        match self {
            Self::All => n == 3,
            Self::Any => n > 0,
            Self::Most => n > 1,
        }
    }
}

/// Whether a value of a field means that its element is chosen: from 0.5 on. What is not a number
/// is not.
pub fn is_chosen(value: f64) -> bool {
    value >= 0.5
}

/// Whether each face of a mesh is chosen.
///
/// # Errors
/// A sentence, when the field belongs to another mesh.
pub fn chosen_faces(
    selection: &Field,
    mesh: &TriMesh,
    rule: CornerRule,
) -> Result<Vec<bool>, String> {
    selection.check_fits(mesh)?;
    let is: Vec<bool> = selection.values.iter().map(|value| is_chosen(*value)).collect();
    Ok(over_faces(&is, selection.domain, mesh, rule))
}

/// Whether each vertex of a mesh is chosen: those of chosen faces, and those with a chosen corner.
///
/// # Errors
/// A sentence, when the field belongs to another mesh.
pub fn chosen_vertices(selection: &Field, mesh: &TriMesh) -> Result<Vec<bool>, String> {
    selection.check_fits(mesh)?;
    let is: Vec<bool> = selection.values.iter().map(|value| is_chosen(*value)).collect();
    Ok(over_vertices(&is, selection.domain, mesh))
}

/// What is chosen of a domain, over faces.
pub fn over_faces(is: &[bool], domain: Domain, mesh: &TriMesh, rule: CornerRule) -> Vec<bool> {
    let corners = |(face, vertices): (usize, &[_; 3])| match domain {
        Domain::Face => is[face],
        Domain::Corner => rule.holds([0, 1, 2].map(|k| is[3 * face + k])),
        Domain::Vertex => rule.holds(vertices.map(|v: mve_mesh::data::VertexId| is[v.idx()])),
    };
    mesh.faces.iter().enumerate().map(corners).collect()
}

/// What is chosen of a domain, over vertices.
pub fn over_vertices(is: &[bool], domain: Domain, mesh: &TriMesh) -> Vec<bool> {
    if domain == Domain::Vertex {
        return is.to_vec();
    }
    let mut found = vec![false; mesh.positions.len()];
    for (corner, v) in mesh.faces.iter().flatten().enumerate() {
        let at = if domain == Domain::Face { corner / 3 } else { corner };
        found[v.idx()] |= is[at];
    }
    found
}

/// What is selected from: the faces or vertices of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// What of it.
    pub elements: Elements,
    /// When a face is chosen, where vertices or corners are.
    pub rule: CornerRule,
}

impl Target<'_> {
    /// How many elements there are.
    pub fn len(&self) -> usize {
        match self.elements {
            Elements::Faces => self.mesh.faces.len(),
            Elements::Vertices => self.mesh.positions.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What is chosen of a domain, over the elements; faces by the given rule.
    pub fn over(&self, is: &[bool], domain: Domain, rule: CornerRule) -> Vec<bool> {
        match self.elements {
            Elements::Faces => over_faces(is, domain, self.mesh, rule),
            Elements::Vertices => over_vertices(is, domain, self.mesh),
        }
    }
}

/// The field of a selection: 1 where it is chosen, else 0.
pub fn selection_field(is: &[bool], elements: Elements) -> Field {
    let domain = match elements {
        Elements::Faces => Domain::Face,
        Elements::Vertices => Domain::Vertex,
    };
    let values = is.iter().map(|is| f64::from(*is)).collect();
    Field { name: "selection".to_owned(), unit: String::new(), domain, values }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    fn field(domain: Domain, values: &[f64]) -> Field {
        let (name, unit) = ("s".to_owned(), String::new());
        Field { name, unit, domain, values: values.to_vec() }
    }

    #[test]
    fn corners_decide_of_a_face_by_the_rule() {
        // Faces 0 2 1, 0 1 3, 0 3 2 and 1 2 3.
        let vertices = field(Domain::Vertex, &[1.0, 0.5, 0.49, f64::NAN]);
        let found = |rule| chosen_faces(&vertices, &tetrahedron(), rule).unwrap();
        assert_eq!(found(CornerRule::All), [false; 4]);
        assert_eq!(found(CornerRule::Most), [true, true, false, false]);
        assert_eq!(found(CornerRule::Any), [true; 4]);
        let mut corners = vec![0.0; 12];
        corners[3..6].fill(1.0);
        let corners = field(Domain::Corner, &corners);
        let found = chosen_faces(&corners, &tetrahedron(), CornerRule::All).unwrap();
        assert_eq!(found, [false, true, false, false]);
        assert_eq!(chosen_vertices(&corners, &tetrahedron()).unwrap(), [true, true, false, true]);
    }

    #[test]
    fn vertices_of_chosen_faces_are_chosen() {
        let faces = field(Domain::Face, &[1.0, 0.0, 0.0, 0.0]);
        assert_eq!(chosen_vertices(&faces, &tetrahedron()).unwrap(), [true, true, true, false]);
        assert!(chosen_vertices(&field(Domain::Face, &[1.0]), &tetrahedron()).is_err());
    }
}
