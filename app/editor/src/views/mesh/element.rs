//! What is known of one element of a mesh: where it is, and its values.

use glam::DVec3;
use mve_modules::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh};

use super::look::coloring::PinnedField;
use crate::views::PickedElement;
use crate::views::number::number_text;

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
    fn of_numbers(name: &str, numbers: &[f64], unit: &str) -> Self {
        let join = |text: &dyn Fn(f64) -> String, between: &str| {
            numbers.iter().map(|number| text(*number)).collect::<Vec<_>>().join(between)
        };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let brief = join(&number_text, ", ") + &unit;
        Self { name: name.to_owned(), brief, exact: join(&|number| number.to_string(), "\t") }
    }

    fn of_text(name: &str, text: String) -> Self {
        Self { name: name.to_owned(), brief: text.clone(), exact: text }
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
            let around = mesh.faces.iter().filter(|face| face.iter().any(|v| v.idx() == vertex));
            around.filter_map(area).sum()
        }
        None => area(mesh.faces.get(element.index)?)?,
    };
    (!points.is_empty() && middle.is_finite()).then_some((middle, towards))
}

/// All that is known of an element: where it is, then the fields and layers of its kind.
pub fn facts(mesh: &TriMesh, element: &PickedElement, fields: &[PinnedField]) -> Vec<Fact> {
    let mut facts = Vec::new();
    match points_of(mesh, element).as_slice() {
        [point] => facts.push(Fact::of_numbers("position", &point.to_array(), "")),
        [a, b, c] => {
            let middle = (a + b + c) / 3.0;
            facts.push(Fact::of_numbers("middle", &middle.to_array(), ""));
            facts.push(Fact::of_numbers("area", &[0.5 * (b - a).cross(c - a).length()], ""));
        }
        _ => {}
    }
    if let Some(corners) = face_of(mesh, element) {
        let corners = corners.map(|vertex| vertex.to_string());
        let (brief, exact) = (corners.join(", "), corners.join("\t"));
        facts.push(Fact { name: "vertices".to_owned(), brief, exact });
    }
    let fitting = fields.iter().filter(|pinned| {
        pinned.field.domain == element.domain && pinned.field.check_fits(mesh).is_ok()
    });
    for PinnedField { title, field } in fitting {
        if let Some(&value) = field.values.get(element.index) {
            let name = format!("{title}: {}", field.name);
            facts.push(Fact::of_numbers(&name, &[value], &field.unit));
        }
    }
    let layers = mesh.layers.iter().filter(|layer| layer.domain == element.domain);
    facts.extend(layers.filter_map(|layer| fact_of_layer(layer, element.index)));
    facts
}

fn fact_of_layer(layer: &Layer, element: usize) -> Option<Fact> {
    let at = *layer.index.get(element).filter(|at| **at != NO_VALUE)? as usize;
    let name = &layer.name;
    Some(match &layer.values {
        LayerValues::Number(values) => Fact::of_numbers(name, &[*values.get(at)?], ""),
        LayerValues::Vec2(values) => Fact::of_numbers(name, &values.get(at)?.to_array(), ""),
        LayerValues::Vec3(values) => Fact::of_numbers(name, &values.get(at)?.to_array(), ""),
        LayerValues::Label(names) => Fact::of_text(name, names.get(at)?.clone()),
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_modules::data::Field;
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
        let told = |domain, index| {
            let facts = facts(&mesh, &element(domain, index), &fields).into_iter();
            facts.map(|fact| format!("{} = {}", fact.name, fact.brief)).collect::<Vec<_>>()
        };
        assert_eq!(told(Domain::Vertex, 1), ["position = 3, 0, 0", "b.field: far = 0.3 mm"]);
        assert_eq!(
            told(Domain::Face, 0),
            [
                "middle = 1, 1.33333, 0",
                "area = 6",
                "vertices = 0, 1, 2",
                "b.field: far = 7 mm",
                "material = tin"
            ]
        );
        assert!(!told(Domain::Face, 1).iter().any(|fact| fact.starts_with("material")));
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
