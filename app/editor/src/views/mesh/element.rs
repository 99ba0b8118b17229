//! What is known of one element of a mesh: where it is, and its values.

use std::sync::Arc;

use glam::DVec3;
use mve_modules::data::{Domain, TriMesh};

use super::look::coloring::PinnedField;
use crate::views::PickedElement;
use crate::views::number::number_text;
use crate::views::sheet::{SheetColumn, mesh_columns};

/// One thing that is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// As it is read.
    pub brief: String,
    /// To the last digit.
    pub exact: String,
}

impl Fact {
    /// What columns of a table that are parts of one thing say of an element; `None` where they
    /// say nothing.
    fn of(columns: &[SheetColumn], element: usize) -> Option<Self> {
        let first = columns.first()?;
        let said = |column: &SheetColumn| {
            let number = column.number(element).map(number_text);
            number.or_else(|| column.text(element))
        };
        let brief = columns.iter().map(said).collect::<Option<Vec<_>>>()?.join(", ");
        let unit = if first.unit.is_empty() { "" } else { " " };
        let brief = format!("{brief}{unit}{}", first.unit);
        let exact: Vec<_> = columns.iter().map(|column| column.copied(element)).collect();
        Some(Self { name: first.of.clone(), brief, exact: exact.join("\t") })
    }
}

/// The corners of the face that an element is, or is on.
fn face_of(mesh: &TriMesh, element: &PickedElement) -> Option<[usize; 3]> {
    let face = match element.domain {
        Domain::Vertex => return None,
        Domain::Corner => element.index / 3,
        Domain::Face => element.index,
    };
    mesh.faces.get(face).map(|face| face.map(|vertex| vertex.idx()))
}

fn vertex_of(mesh: &TriMesh, element: &PickedElement) -> Option<usize> {
    match element.domain {
        Domain::Vertex => Some(element.index),
        Domain::Corner => Some(face_of(mesh, element)?[element.index % 3]),
        Domain::Face => None,
    }
}

/// The points of an element: of a face three, else one.
pub fn points_of(mesh: &TriMesh, element: &PickedElement) -> Vec<DVec3> {
    let vertices: Vec<usize> = match vertex_of(mesh, element) {
        Some(vertex) => vec![vertex],
        None => face_of(mesh, element).into_iter().flatten().collect(),
    };
    vertices.into_iter().filter_map(|vertex| mesh.positions.get(vertex).copied()).collect()
}

/// The middle of an element, and what points away from the surface there; O(n) for a vertex.
pub fn place_of(mesh: &TriMesh, element: &PickedElement) -> Option<(DVec3, DVec3)> {
    let points = points_of(mesh, element);
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let area = |face: &[mve_modules::data::VertexId; 3]| {
        let at = |k: usize| mesh.positions.get(face[k].idx()).copied();
        let (a, b, c) = (at(0)?, at(1)?, at(2)?);
        Some((b - a).cross(c - a)).filter(|area| area.is_finite())
    };
    let towards = match vertex_of(mesh, element) {
        Some(vertex) => {
            let around =
                mesh.faces.iter().filter(|face| face.iter().any(|corner| corner.idx() == vertex));
            around.filter_map(area).sum()
        }
        None => area(mesh.faces.get(element.index)?)?,
    };
    (!points.is_empty() && middle.is_finite()).then_some((middle, towards))
}

/// All that is known of an element: what the table of its kind says.
pub fn facts(mesh: &Arc<TriMesh>, element: &PickedElement, fields: &[PinnedField]) -> Vec<Fact> {
    let fields: Vec<_> =
        fields.iter().map(|pinned| (pinned.title.clone(), Arc::clone(&pinned.field))).collect();
    let columns = mesh_columns(mesh, element.domain, &fields, None);
    // The first one is the number of the element.
    let parts = columns[1..].chunk_by(|one, next| one.of == next.of);
    parts.filter_map(|columns| Fact::of(columns, element.index)).collect()
}

/// The first face around a vertex, O(n).
pub fn first_face_at(mesh: &TriMesh, vertex: usize) -> Option<usize> {
    mesh.faces.iter().position(|face| face.iter().any(|corner| corner.idx() == vertex))
}

#[cfg(test)]
mod tests {
    use mve_modules::data::{Field, Layer, LayerValues, NO_VALUE};
    use mve_modules::mesh::fixtures::mesh_of;

    use super::*;

    fn element(domain: Domain, index: usize) -> PickedElement {
        PickedElement { title: "a.mesh".to_owned(), domain, index }
    }

    fn corner() -> TriMesh {
        let points = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 1.0]];
        mesh_of(&points, &[[0, 1, 2], [0, 3, 1]])
    }

    #[test]
    fn an_element_has_its_place_and_the_values_of_its_kind() {
        let mut mesh = corner();
        let names = LayerValues::Label(vec!["wood".to_owned(), "tin".to_owned()]);
        let (name, domain, index) = (Layer::MATERIAL.to_owned(), Domain::Face, vec![1, NO_VALUE]);
        mesh.set_layer(Layer { name, domain, values: names, index });
        let field = |domain, values| {
            let (name, unit) = ("far".to_owned(), "mm".to_owned());
            let field = Arc::new(Field { name, unit, domain, values });
            PinnedField { title: "b.field".to_owned(), field }
        };
        let fields = [
            field(Domain::Vertex, vec![0.0, 0.1 + 0.2, 0.5, 1.0]),
            field(Domain::Face, vec![7.0, 8.0]),
            field(Domain::Vertex, vec![1.0]),
        ];
        let mesh = Arc::new(mesh);
        let told = |domain, index| {
            let facts = facts(&mesh, &element(domain, index), &fields).into_iter();
            facts.map(|fact| format!("{} = {}", fact.name, fact.brief)).collect::<Vec<_>>()
        };
        assert_eq!(told(Domain::Vertex, 1), ["position = 3, 0, 0", "b.field: far = 0.3 mm"]);
        assert_eq!(
            told(Domain::Face, 0),
            [
                "vertices = 0, 1, 2",
                "center = 1, 1.33333, 0",
                "area = 6",
                "least angle = 36.8699 °",
                "material = tin",
                "b.field: far = 7 mm"
            ]
        );
        assert!(!told(Domain::Face, 1).iter().any(|fact| fact.starts_with("material")));
        assert_eq!(told(Domain::Corner, 4), ["face = 1", "vertex = 3", "position = 0, 0, 1"]);
        assert_eq!([1, 9].map(|vertex| first_face_at(&mesh, vertex)), [Some(0), None]);
        let exact = &facts(&mesh, &element(Domain::Vertex, 1), &fields)[1].exact;
        assert_eq!(exact, "0.30000000000000004");
        assert_eq!(told(Domain::Vertex, 99), Vec::<String>::new());
    }

    #[test]
    fn an_element_is_looked_at_from_outside() {
        let mesh = corner();
        let (middle, towards) = place_of(&mesh, &element(Domain::Face, 0)).unwrap();
        assert_eq!((middle, towards), (DVec3::new(1.0, 4.0 / 3.0, 0.0), DVec3::Z * 12.0));
        // Both faces of the vertex: 12 along z, and 3 along y.
        let (at, towards) = place_of(&mesh, &element(Domain::Vertex, 1)).unwrap();
        assert_eq!((at, towards), (DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 12.0)));
        assert_eq!(place_of(&mesh, &element(Domain::Face, 9)), None);
    }
}
