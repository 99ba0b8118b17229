//! What is said of each element, in a table and beside a picture: where it is, what the layers and
//! fields of the mesh have for it, and what is soon computed from its points.
//!
//! Nothing is read before it is asked for, so the table of a large mesh costs as much as that of a
//! small one.

use std::sync::Arc;

use glam::DVec3;
use mve_core::Expression;
use mve_modules::data::{Domain, Field, Layer, LayerValues, NO_VALUE, TriMesh, shown_name};

use crate::views::picked::one_of;
use crate::views::table::{compare_texts, title_of};

/// What joins the conditions of a filter.
pub const AND: &str = "and";
/// The same, where one is enough.
pub const OR: &str = "or";

/// Whether a word means something in a filter, so that no column can have it as its name.
fn is_word_of_filters(name: &str) -> bool {
    [AND, OR].contains(&name) || Expression::has_meaning(name)
}

/// A field beside a mesh, and where it comes from.
pub type TitledField = (String, Arc<Field>);

/// The numbers of a column by element; `None` where there is none.
type Reader = Box<dyn Fn(usize) -> Option<f64> + Send + Sync>;

/// One column.
pub struct SheetColumn {
    /// Its name, as a filter takes it: `normal_x`.
    pub name: String,
    /// The unit of its numbers, or empty.
    pub unit: String,
    /// What it holds.
    pub doc: String,
    /// What it is a part of, as a person reads it: the layer `2nd normal`.
    pub of: String,
    /// What is in it.
    pub cells: Cells,
}

/// What is in a column.
pub enum Cells {
    /// A number each.
    Numbers(Reader),
    /// A name each.
    Names(NameLayer),
}

/// The names of a layer, such as those of materials.
pub struct NameLayer {
    mesh: Arc<TriMesh>,
    layer: usize,
}

impl NameLayer {
    fn names(&self) -> &[String] {
        match self.mesh.layers.get(self.layer).map(|layer| &layer.values) {
            Some(LayerValues::Label(names)) => names,
            _ => &[],
        }
    }

    fn place(&self, element: usize) -> Option<usize> {
        place_in(self.mesh.layers.get(self.layer)?, element)
    }

    /// The name of an element, as it is stored.
    pub fn get(&self, element: usize) -> Option<&str> {
        self.names().get(self.place(element)?).map(String::as_str)
    }

    /// The place of each name in the order of names, so that elements are put in order by numbers.
    pub fn ranks(&self) -> impl Fn(usize) -> Option<f64> + '_ {
        let names = self.names();
        let mut places: Vec<usize> = (0..names.len()).collect();
        places.sort_by(|&a, &b| compare_texts(&names[a], &names[b]));
        let mut ranks = vec![0.0; names.len()];
        let mut rank = 0.0;
        for (nth, &place) in places.iter().enumerate() {
            let is_another = nth > 0 && names[place] != names[places[nth - 1]];
            rank += f64::from(u8::from(is_another));
            ranks[place] = rank;
        }
        move |element| ranks.get(self.place(element)?).copied()
    }
}

fn place_in(layer: &Layer, element: usize) -> Option<usize> {
    layer.index.get(element).filter(|place| **place != NO_VALUE).map(|place| *place as usize)
}

impl SheetColumn {
    /// Its name and unit.
    pub fn title(&self) -> String {
        title_of(&self.name, &self.unit)
    }

    /// Whether it holds numbers.
    pub fn is_numeric(&self) -> bool {
        matches!(self.cells, Cells::Numbers(_))
    }

    /// The number of an element.
    pub fn number(&self, element: usize) -> Option<f64> {
        match &self.cells {
            Cells::Numbers(read) => read(element),
            Cells::Names(_) => None,
        }
    }

    /// The name of an element.
    pub fn text(&self, element: usize) -> Option<String> {
        match &self.cells {
            Cells::Numbers(_) => None,
            Cells::Names(names) => names.get(element).map(shown_name),
        }
    }

    /// A cell as it is copied: numbers in full.
    pub fn copied(&self, element: usize) -> String {
        let text = self.number(element).map(|number| number.to_string());
        // Tabs and line ends in a name would be taken for the table's own.
        let text = text.or_else(|| self.text(element)).unwrap_or_default();
        text.replace(['\t', '\n', '\r'], " ")
    }
}

/// Columns in the making: each name stands for one.
struct Columns(Vec<SheetColumn>);

impl Columns {
    /// The numbers of the elements alone.
    fn of(domain: Domain) -> Self {
        let mut columns = Self(Vec::new());
        columns.add_numbers(one_of(domain), "Its number, from 0", |element| Some(element as f64));
        columns
    }

    fn add(&mut self, name: &str, (of, unit): (&str, &str), doc: impl Into<String>, cells: Cells) {
        let (name, of, unit) = (self.free_name(name), of.to_owned(), unit.to_owned());
        self.0.push(SheetColumn { name, unit, doc: doc.into(), of, cells });
    }

    fn add_numbers(
        &mut self,
        name: &str,
        doc: impl Into<String>,
        read: impl Fn(usize) -> Option<f64> + Send + Sync + 'static,
    ) {
        self.add(name, (name, ""), doc, Cells::Numbers(Box::new(read)));
    }

    /// The name in letters that a filter can have, and no other column has.
    fn free_name(&self, name: &str) -> String {
        let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let mut free: String = shown_name(name).chars().map(letter).collect();
        if free.chars().next().is_none_or(|first| first.is_ascii_digit()) {
            free.insert(0, '_');
        }
        let is_taken =
            |name: &str| is_word_of_filters(name) || self.0.iter().any(|one| one.name == name);
        if !is_taken(&free) {
            return free;
        }
        let mut others = (2..).map(|n| format!("{free}_{n}"));
        others.find(|name| !is_taken(name)).unwrap_or(free)
    }

    fn add_point(
        &mut self,
        doc: &str,
        point: impl Fn(usize) -> Option<DVec3> + Clone + Send + Sync + 'static,
    ) {
        let of = doc.to_lowercase();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let point = point.clone();
            let read = move |element: usize| Some(point(element)?[axis]);
            let doc = format!("{doc}, {name}");
            self.add(name, (&of, ""), doc, Cells::Numbers(Box::new(read)));
        }
    }

    /// The layers and fields over a kind of elements.
    fn add_layers(&mut self, mesh: &Arc<TriMesh>, domain: Domain, fields: &[TitledField]) {
        for (at, layer) in mesh.layers.iter().enumerate() {
            if layer.domain == domain {
                self.add_layer(mesh, at, layer);
            }
        }
        for (title, field) in fields {
            if field.domain == domain && field.check_fits(mesh).is_ok() {
                self.add_field(title, field);
            }
        }
    }

    fn add_field(&mut self, title: &str, field: &Arc<Field>) {
        let (name, doc) = (&field.name, format!("The field {title}"));
        let field = Arc::clone(field);
        let unit = field.unit.clone();
        let read = move |element: usize| field.values.get(element).copied();
        let of = if name.is_empty() { title.to_owned() } else { format!("{title}: {name}") };
        let name = if name.is_empty() { title } else { name };
        self.add(name, (&of, &unit), doc, Cells::Numbers(Box::new(read)));
    }

    fn add_layer(&mut self, mesh: &Arc<TriMesh>, at: usize, layer: &Layer) {
        let name = layer.name.as_str();
        let of = shown_name(name);
        let parts: &[&str] = match &layer.values {
            LayerValues::Label(_) => {
                let names = NameLayer { mesh: Arc::clone(mesh), layer: at };
                return self.add(name, (&of, ""), layer_doc(name), Cells::Names(names));
            }
            LayerValues::Number(_) => &[""],
            LayerValues::Vec2(_) => &["_u", "_v"],
            LayerValues::Vec3(_) if name == Layer::COLOR => &["_r", "_g", "_b"],
            LayerValues::Vec3(_) => &["_x", "_y", "_z"],
        };
        for (part, letters) in parts.iter().enumerate() {
            let mesh = Arc::clone(mesh);
            let read = move |element: usize| {
                let layer = mesh.layers.get(at)?;
                let place = place_in(layer, element)?;
                match &layer.values {
                    LayerValues::Number(values) => values.get(place).copied(),
                    LayerValues::Vec2(values) => Some(values.get(place)?[part]),
                    LayerValues::Vec3(values) => Some(values.get(place)?[part]),
                    LayerValues::Label(_) => None,
                }
            };
            let name = format!("{name}{letters}");
            self.add(&name, (&of, ""), layer_doc(&layer.name), Cells::Numbers(Box::new(read)));
        }
    }
}

fn layer_doc(name: &str) -> String {
    format!("The layer {}", shown_name(name))
}

/// The columns of a field that no mesh goes with.
pub fn field_columns(title: &str, field: &Arc<Field>) -> Vec<SheetColumn> {
    let mut columns = Columns::of(field.domain);
    columns.add_field(title, field);
    columns.0
}

/// The columns of a mesh. `n_faces_at` is how many faces each vertex has, once that is known.
pub fn mesh_columns(
    mesh: &Arc<TriMesh>,
    domain: Domain,
    fields: &[TitledField],
    n_faces_at: Option<Arc<Vec<u32>>>,
) -> Vec<SheetColumn> {
    let mut columns = Columns::of(domain);
    match domain {
        Domain::Vertex => {
            let job = Arc::clone(mesh);
            columns.add_point("Position", move |vertex| job.positions.get(vertex).copied());
            columns.add_numbers("faces", "How many faces it is a corner of", move |vertex| {
                n_faces_at.as_ref()?.get(vertex).map(|n| f64::from(*n))
            });
        }
        Domain::Corner => {
            columns.add_numbers("face", "The face that it is a corner of", |corner| {
                Some((corner / 3) as f64)
            });
            let job = Arc::clone(mesh);
            let vertex_at = move |corner: usize| {
                job.faces.get(corner / 3).map(|vertices| vertices[corner % 3].idx())
            };
            let of_corner = vertex_at.clone();
            columns.add_numbers("vertex", "The vertex that it lies at", move |corner| {
                of_corner(corner).map(|vertex| vertex as f64)
            });
            let job = Arc::clone(mesh);
            columns.add_point("Position", move |corner| {
                job.positions.get(vertex_at(corner)?).copied()
            });
        }
        Domain::Face => add_faces(&mut columns, mesh),
    }
    columns.add_layers(mesh, domain, fields);
    columns.0
}

/// The columns that all faces have.
fn add_faces(columns: &mut Columns, mesh: &Arc<TriMesh>) {
    for (corner, name) in ["a", "b", "c"].into_iter().enumerate() {
        let (job, doc) = (Arc::clone(mesh), format!("Its {} vertex", ORDINALS[corner]));
        let read =
            move |face: usize| job.faces.get(face).map(|vertices| f64::from(vertices[corner].0));
        columns.add(name, ("vertices", ""), doc, Cells::Numbers(Box::new(read)));
    }
    let job = Arc::clone(mesh);
    let corners = move |face: usize| corners_of(&job, face);
    let points = corners.clone();
    columns.add_point("Center", move |face| {
        let [a, b, c] = points(face)?;
        Some((a + b + c) / 3.0)
    });
    let points = corners.clone();
    columns.add_numbers("area", "Its area, in squared model units", move |face| {
        let [a, b, c] = points(face)?;
        Some(0.5 * (b - a).cross(c - a).length())
    });
    let least = move |face: usize| corners(face).map(least_angle_rad).map(f64::to_degrees);
    let doc = "The least of its angles: near 0 for a sliver, 60 at most";
    columns.add("least_angle", ("least angle", "°"), doc, Cells::Numbers(Box::new(least)));
}

const ORDINALS: [&str; 3] = ["first", "second", "third"];

fn corners_of(mesh: &TriMesh, face: usize) -> Option<[DVec3; 3]> {
    let mut points = [DVec3::ZERO; 3];
    for (point, vertex) in points.iter_mut().zip(mesh.faces.get(face)?) {
        *point = *mesh.positions.get(vertex.idx())?;
    }
    Some(points)
}

/// The least angle of a triangle; not a number where two of its points are one.
fn least_angle_rad(points: [DVec3; 3]) -> f64 {
    let angle = |k: usize| {
        let (to_next, to_last) = (points[(k + 1) % 3] - points[k], points[(k + 2) % 3] - points[k]);
        let (sine, cosine) = (to_next.cross(to_last).length(), to_next.dot(to_last));
        if sine == 0.0 && cosine == 0.0 { f64::NAN } else { sine.atan2(cosine) }
    };
    let angles = [0, 1, 2].map(angle);
    if angles.iter().any(|angle| angle.is_nan()) {
        return f64::NAN;
    }
    angles.into_iter().fold(f64::INFINITY, f64::min)
}

/// How many faces each vertex is a corner of, O(n).
pub fn count_faces(mesh: &TriMesh) -> Vec<u32> {
    let mut counts = vec![0u32; mesh.positions.len()];
    for vertex in mesh.faces.iter().flatten() {
        if let Some(count) = counts.get_mut(vertex.idx()) {
            *count += 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use mve_modules::mesh::fixtures::mesh_of;

    use super::*;

    fn labels(name: &str, names: &[&str], index: &[u32]) -> Layer {
        let values = LayerValues::Label(names.iter().map(|name| (*name).to_owned()).collect());
        Layer { name: name.to_owned(), domain: Domain::Face, values, index: index.to_vec() }
    }

    /// A triangle with legs of 3 and 4, and a point that no face has.
    fn mesh() -> TriMesh {
        let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [9.0, 9.0, 9.0]];
        mesh_of(&points, &[[0, 1, 2]])
    }

    fn names(columns: &[SheetColumn]) -> Vec<&str> {
        columns.iter().map(|column| column.name.as_str()).collect()
    }

    fn number(columns: &[SheetColumn], name: &str, element: usize) -> Option<f64> {
        columns.iter().find(|column| column.name == name).unwrap().number(element)
    }

    #[test]
    fn faces_have_area_angle_center_and_names() {
        let mut mesh = mesh();
        mesh.set_layer(labels("material", &["red\tone"], &[0]));
        mesh.set_layer(labels("2nd group", &["b"], &[NO_VALUE]));
        let columns = mesh_columns(&Arc::new(mesh), Domain::Face, &[], None);
        let expected = "face a b c x y z area least_angle material _2nd_group";
        assert_eq!(names(&columns).join(" "), expected);
        assert_eq!(number(&columns, "area", 0), Some(6.0));
        assert_eq!(number(&columns, "x", 0), Some(1.0));
        // The angle at the end of the longer leg: atan 3/4.
        let least = number(&columns, "least_angle", 0).unwrap();
        assert!((least - 36.869_897_645_844_02).abs() < 1e-9, "{least}");
        assert_eq!(columns[9].copied(0), "red one");
        assert_eq!(columns[10].copied(0), "");
        assert_eq!(number(&columns, "area", 1), None);
    }

    #[test]
    fn a_name_in_use_gets_a_number_and_numbers_of_fields_their_unit() {
        let mut mesh = mesh();
        mesh.set_layer(Layer {
            name: "color".to_owned(),
            domain: Domain::Vertex,
            values: LayerValues::Vec3(vec![DVec3::new(0.1, 0.2, 0.3)]),
            index: vec![NO_VALUE, 0, 0, 0],
        });
        let field = |name: &str, n: usize| {
            let (name, unit) = (name.to_owned(), "mm".to_owned());
            Arc::new(Field { name, unit, domain: Domain::Vertex, values: vec![7.0; n] })
        };
        let fields = [
            ("p.one".to_owned(), field("x", 4)),
            ("p.two".to_owned(), field("min", 4)),
            ("p.other".to_owned(), field("of another mesh", 5)),
        ];
        let mesh = Arc::new(mesh);
        let counts = Arc::new(count_faces(&mesh));
        let columns = mesh_columns(&mesh, Domain::Vertex, &fields, Some(counts));
        assert_eq!(
            names(&columns).join(" "),
            "vertex x y z faces color_r color_g color_b x_2 min_2"
        );
        assert_eq!(columns[8].unit, "mm");
        assert_eq!(number(&columns, "color_b", 1), Some(0.3));
        assert_eq!(number(&columns, "color_b", 0), None);
        assert_eq!([0, 3].map(|vertex| number(&columns, "faces", vertex)), [Some(1.0), Some(0.0)]);
    }

    #[test]
    fn corners_know_their_face_and_vertex_whatever_the_indices_are() {
        let mut mesh = mesh();
        mesh.faces.push(mesh.faces[0].map(|vertex| mve_modules::data::VertexId(vertex.0 + 2)));
        let columns = mesh_columns(&Arc::new(mesh), Domain::Corner, &[], None);
        assert_eq!(number(&columns, "face", 4), Some(1.0));
        assert_eq!(number(&columns, "vertex", 4), Some(3.0));
        assert_eq!(number(&columns, "y", 2), Some(4.0));
        // The last corner names a vertex that is not there.
        assert_eq!(number(&columns, "y", 5), None);
    }

    #[test]
    fn ranks_follow_the_order_of_names_and_equal_names_share_one() {
        let layer = labels("group", &["b10", "b9", "a", "b9"], &[0, 1, 2, 3, NO_VALUE]);
        let mut mesh = mesh();
        mesh.layers.push(layer);
        let names = NameLayer { mesh: Arc::new(mesh), layer: 0 };
        let rank = names.ranks();
        let ranks = [0, 1, 2, 3, 4].map(&rank);
        assert_eq!(ranks, [Some(2.0), Some(1.0), Some(0.0), Some(1.0), None]);
    }
}
