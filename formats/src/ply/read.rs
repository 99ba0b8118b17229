//! From the bytes of a PLY file to a mesh.

use std::iter;

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Layer, Material, Texture, TextureRole, TriMesh, VertexId};

use super::fixed::layout;
use super::header::{Element, Format, Header, Shape};
use super::source::{Binary, Source, Text};
use crate::ReadError;
use crate::raw_mesh::RawMesh;
use crate::warnings::Warning;
use crate::words::Words;

/// Rows between two looks whether the work was cancelled.
const ROWS: u64 = 1 << 16;
/// Rows whose memory is taken before they are read.
const MOST_AT_ONCE: u64 = 1 << 24;

/// Reads a PLY file: ASCII or binary of either order, any type for any property.
///
/// Polygons are cut into triangles; triangle strips are taken apart. Kept are normals, colors,
/// texture coordinates of vertices and corners, the pictures that comments name, as materials
/// without their content, and other properties of vertices and faces that are one number, as layers
/// of their names. Other elements and lists are passed over.
///
/// # Errors
/// What is wrong with the header or the rows, with the line or the row; when `control` says so.
pub fn read_ply(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let header = Header::read(bytes)?;
    let body = &bytes[header.n_bytes..];
    match header.format {
        Format::Ascii => {
            let words = Words::new(body, header.n_lines, false);
            read_rows(&header, Text(words), control)
        }
        Format::LittleEndian => {
            read_rows(&header, Binary::<false> { bytes: body, pos: 0 }, control)
        }
        Format::BigEndian => read_rows(&header, Binary::<true> { bytes: body, pos: 0 }, control),
    }
}

fn read_rows(
    header: &Header,
    mut source: impl Source,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let mut mesh = RawMesh::default();
    mesh.materials = materials(&header.textures);
    let n_vertices = header.n_rows("vertex");
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        let least = element.least_bytes(header.format);
        // The last row of a text may end without a blank.
        if element.n_rows.saturating_mul(least) > source.n_left() + 1 {
            return Err(ReadError::Wrong(format!(
                "the header promises {} rows of \"{}\", for which the {} bytes that follow are too \
                 few",
                element.n_rows,
                element.name,
                source.n_left()
            )));
        }
        match element.name.as_str() {
            "vertex" if mesh.positions.is_empty() => {
                read_vertices(element, &mut source, &mut mesh, control)?;
            }
            "face" => read_faces(element, n_vertices, &mut source, &mut mesh, control)?,
            "tristrips" => read_strips(element, n_vertices, &mut source, &mut mesh, control)?,
            _ => {
                each_row(element, &mut source, control, |_, _, _| Ok(()))?;
            }
        }
    }
    if mesh.positions.len() as u64 != n_vertices {
        return Err(ReadError::Wrong("the element \"vertex\" has no properties".to_owned()));
    }
    if n_vertices == 0 && mesh.polygons.len() > 0 {
        return Err(ReadError::Wrong("there are faces, but no vertices".to_owned()));
    }
    mesh.finish(control)
}

/// The pictures as materials: one for each.
fn materials(textures: &[String]) -> Vec<Material> {
    let material = |name: &String| {
        let texture = Texture {
            role: TextureRole::BaseColor,
            keyword: "map_Kd".to_owned(),
            options: String::new(),
            name: name.clone(),
            place: 0,
            image: None,
        };
        Material { name: name.clone(), statements: Vec::new(), textures: vec![texture] }
    };
    textures.iter().map(material).collect()
}

/// Numbers of a row: one of each property that is one, and the items of each list.
struct Row {
    ones: Vec<f64>,
    lists: Vec<Vec<f64>>,
}

/// Reads the rows of an element and tells of each.
fn each_row<S: Source>(
    element: &Element,
    source: &mut S,
    control: Control,
    mut tell: impl FnMut(u64, &Row, &S) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let n = element.properties.len();
    let mut row = Row { ones: vec![0.0; n], lists: vec![Vec::new(); n] };
    let at_row = |number: u64, error: ReadError| match error {
        ReadError::Wrong(message) => {
            let name = &element.name;
            ReadError::Wrong(format!(
                "\"{name}\", row {} of {}: {message}",
                number + 1,
                element.n_rows
            ))
        }
        cancelled => cancelled,
    };
    for number in 0..element.n_rows {
        if number % ROWS == 0 {
            control.at(source.fraction())?;
        }
        for (at, property) in element.properties.iter().enumerate() {
            match property.shape {
                Shape::One(kind) => {
                    row.ones[at] = source.number(kind).map_err(|error| at_row(number, error))?;
                }
                Shape::List { n, item } => {
                    let n = source.number(n).map_err(|error| at_row(number, error))?;
                    let list = &mut row.lists[at];
                    list.clear();
                    // Each item takes a byte at least.
                    if !(n >= 0.0 && n <= source.n_left() as f64 && n.fract() == 0.0) {
                        let message = format!(
                            "the list \"{}\" has {n} items, of which the file has no room",
                            property.name
                        );
                        return Err(at_row(number, ReadError::Wrong(message)));
                    }
                    for _ in 0..n as usize {
                        list.push(source.number(item).map_err(|error| at_row(number, error))?);
                    }
                }
            }
        }
        tell(number, &row, source)?;
    }
    Ok(())
}

/// The places of the first of these sets of properties that an element has whole, as numbers.
fn places<const N: usize>(element: &Element, sets: &[[&str; N]]) -> Option<[usize; N]> {
    let place = |name: &str| {
        let is = |p: &super::header::Property| p.name == name && matches!(p.shape, Shape::One(_));
        element.properties.iter().position(is)
    };
    sets.iter().find_map(|names| {
        let found = names.map(place);
        found.iter().all(Option::is_some).then(|| found.map(Option::unwrap_or_default))
    })
}

const COLORS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];

/// What a number of a color property stands for 1; floats beyond 1 are bytes.
fn whole_of(element: &Element, places: Option<[usize; 3]>) -> f64 {
    match places.map(|places| element.properties[places[0]].shape) {
        Some(Shape::One(kind)) => kind.whole(),
        _ => 1.0,
    }
}

/// Colors as fractions.
fn scaled(mut colors: Vec<DVec3>, whole: f64) -> Vec<DVec3> {
    let most = colors.iter().map(|color| color.max_element()).fold(0.0, f64::max);
    let whole = if whole == 1.0 && most > 1.0 && most <= 255.0 { 255.0 } else { whole };
    if whole != 1.0 {
        colors.iter_mut().for_each(|color| *color /= whole);
    }
    colors
}

/// The properties that are one number and stand for nothing else, and their values.
fn others(element: &Element, known: &[usize]) -> Vec<(usize, (String, Vec<f64>))> {
    const RESERVED: [&str; 7] = [
        Layer::NORMAL,
        Layer::TEXCOORD,
        Layer::COLOR,
        Layer::MATERIAL,
        Layer::GROUP,
        Layer::OBJECT,
        Layer::SMOOTHING,
    ];
    let numbered = element.properties.iter().enumerate();
    let others = numbered.filter(|(at, property)| {
        matches!(property.shape, Shape::One(_))
            && !known.contains(at)
            && !RESERVED.contains(&property.name.as_str())
    });
    others.map(|(at, property)| (at, (property.name.clone(), Vec::new()))).collect()
}

fn read_vertices<S: Source>(
    element: &Element,
    source: &mut S,
    mesh: &mut RawMesh,
    control: Control,
) -> Result<(), ReadError> {
    let Some(position) = places(element, &[["x", "y", "z"]]) else {
        return Err(ReadError::Wrong(
            "the element \"vertex\" has no properties x, y and z".to_owned(),
        ));
    };
    let normal = places(element, &[["nx", "ny", "nz"]]);
    let color = places(element, &COLORS);
    let texcoord =
        places(element, &[["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["tx", "ty"]]);
    let known = [Some(position), normal, color].into_iter().flatten().flatten();
    let known: Vec<usize> = known.chain(texcoord.into_iter().flatten()).collect();
    let mut numbers = others(element, &known);
    let rows = layout(element, None)
        .and_then(|(columns, stride)| Some((columns, source.rows(element.n_rows, stride)?)));
    if let Some((columns, rows)) = rows {
        let vectors = |places: [usize; 3]| rows.vectors(places.map(|at| columns[at]), control);
        mesh.positions = vectors(position)?;
        mesh.normals = normal.map(vectors).transpose()?.unwrap_or_default();
        mesh.colors = color.map(vectors).transpose()?.unwrap_or_default();
        let pairs = |places: [usize; 2]| rows.vectors(places.map(|at| columns[at]), control);
        mesh.texcoords = texcoord.map(pairs).transpose()?.unwrap_or_default();
        for (at, (_, values)) in &mut numbers {
            *values = rows.numbers(columns[*at], control)?;
        }
        let n_bytes = rows.bytes.len();
        source.advance(n_bytes);
    } else {
        each_row(element, source, control, |_, row, _| {
            let vector = |places: [usize; 3]| DVec3::from_array(places.map(|at| row.ones[at]));
            mesh.positions.push(vector(position));
            mesh.normals.extend(normal.map(vector));
            mesh.colors.extend(color.map(vector));
            mesh.texcoords.extend(texcoord.map(|at| DVec2::from_array(at.map(|at| row.ones[at]))));
            numbers.iter_mut().for_each(|(at, (_, values))| values.push(row.ones[*at]));
            Ok(())
        })?;
    }
    mesh.colors = scaled(std::mem::take(&mut mesh.colors), whole_of(element, color));
    mesh.numbers = numbers.into_iter().map(|(_, named)| named).collect();
    Ok(())
}

/// Which properties of faces are what.
struct FaceProperties {
    corners: usize,
    texcoords: Option<usize>,
    color: Option<[usize; 3]>,
    picture: Option<[usize; 1]>,
    /// Others that are one number: property, name and values.
    numbers: Vec<(usize, (String, Vec<f64>))>,
}

fn read_faces<S: Source>(
    element: &Element,
    n_vertices: u64,
    source: &mut S,
    mesh: &mut RawMesh,
    control: Control,
) -> Result<(), ReadError> {
    let list = |names: &[&str]| {
        let is = |p: &super::header::Property| {
            names.contains(&p.name.as_str()) && matches!(p.shape, Shape::List { .. })
        };
        element.properties.iter().position(is)
    };
    let Some(corners) = list(&["vertex_indices", "vertex_index"]) else {
        mesh.warnings.add_general("the faces have no list \"vertex_indices\"".to_owned());
        return each_row(element, source, control, |_, _, _| Ok(()));
    };
    let color = places(element, &COLORS);
    let picture = places(element, &[["texnumber"], ["texture_index"]]);
    let known = color.into_iter().flatten().chain(picture.into_iter().flatten());
    let numbers = others(element, &known.collect::<Vec<_>>());
    let texcoords = list(&["texcoord"]);
    let mut faces = FaceProperties { corners, texcoords, color, picture, numbers };
    // A file may have several elements of faces, and strips before them.
    let n_before = mesh.polygons.len();
    let colors_before = std::mem::take(&mut mesh.face_colors);
    if texcoords.is_some() {
        mesh.corner_texcoords.resize(mesh.polygons.n_corners(), DVec2::NAN);
    }
    if !mesh.materials.is_empty() {
        mesh.face_materials.resize(n_before, u32::MAX);
    }
    if !read_triangles(element, n_vertices, &mut faces, source, mesh, control)? {
        read_polygons(element, n_vertices, &mut faces, source, mesh, control)?;
    }
    let colors = scaled(std::mem::take(&mut mesh.face_colors), whole_of(element, color));
    mesh.face_colors = joined(colors_before, n_before, colors, DVec3::ONE);
    for (_, (name, values)) in faces.numbers {
        let known = mesh.face_numbers.iter().position(|(known, _)| *known == name);
        let before = known.map(|at| mesh.face_numbers.swap_remove(at).1).unwrap_or_default();
        mesh.face_numbers.push((name, joined(before, n_before, values, f64::NAN)));
    }
    Ok(())
}

/// Values of the first faces, filled up to so many, and those of the next; none if nobody has one.
fn joined<T: Copy>(mut before: Vec<T>, n_before: usize, more: Vec<T>, none: T) -> Vec<T> {
    if !more.is_empty() {
        before.resize(n_before, none);
        before.extend(more);
    }
    before
}

/// The material of a face with this number of a picture.
fn material_of(number: f64, mesh: &RawMesh) -> u32 {
    let is_one = number >= 0.0 && number < mesh.materials.len() as f64;
    if is_one { number as u32 } else { u32::MAX }
}

/// Reads faces that all are triangles in rows of one length; whether they are.
fn read_triangles<S: Source>(
    element: &Element,
    n_vertices: u64,
    faces: &mut FaceProperties,
    source: &mut S,
    mesh: &mut RawMesh,
    control: Control,
) -> Result<bool, ReadError> {
    let Shape::List { n, item } = element.properties[faces.corners].shape else { return Ok(false) };
    let Some((columns, stride)) = layout(element, Some(faces.corners)) else { return Ok(false) };
    let Some(rows) = source.rows(element.n_rows, stride) else { return Ok(false) };
    let start = columns[faces.corners].0;
    let Some(triangles) = rows.triangles(start, (n, item), n_vertices, control)? else {
        return Ok(false);
    };
    if let Some(color) = faces.color {
        mesh.face_colors.extend(rows.vectors::<3, DVec3>(color.map(|at| columns[at]), control)?);
    }
    if !mesh.materials.is_empty() {
        let numbers = match faces.picture {
            Some([at]) => rows.numbers(columns[at], control)?,
            None => vec![0.0; triangles.len()],
        };
        let materials: Vec<u32> = numbers.iter().map(|number| material_of(*number, mesh)).collect();
        mesh.face_materials.extend(materials);
    }
    for (at, (_, values)) in &mut faces.numbers {
        *values = rows.numbers(columns[*at], control)?;
    }
    mesh.polygons.push_all(triangles);
    let n_bytes = rows.bytes.len();
    source.advance(n_bytes);
    Ok(true)
}

/// Reads faces of any kind, row by row.
fn read_polygons<S: Source>(
    element: &Element,
    n_vertices: u64,
    faces: &mut FaceProperties,
    source: &mut S,
    mesh: &mut RawMesh,
    control: Control,
) -> Result<(), ReadError> {
    let FaceProperties { corners, texcoords, color, picture, numbers } = faces;
    mesh.polygons.reserve(element.n_rows.min(MOST_AT_ONCE) as usize);
    let mut polygon = Vec::new();
    let mut n_odd_texcoords = 0_usize;
    each_row(element, source, control, |number, row, source| {
        let place = || format!("face {number}, before {}", source.place());
        let list = &row.lists[*corners];
        polygon.clear();
        polygon.extend(list.iter().map_while(|&corner| RawMesh::vertex(corner, n_vertices)));
        if let Some(corner) = list.get(polygon.len()) {
            mesh.leave_out(place, || {
                format!("found vertex {corner}, expected 0 to {}", n_vertices.saturating_sub(1))
            });
            return Ok(());
        }
        if polygon.len() < 3 {
            mesh.leave_out(place, || format!("it has {} corners, fewer than 3", polygon.len()));
            return Ok(());
        }
        mesh.polygons.push(&polygon);
        if let Some(at) = *texcoords {
            n_odd_texcoords += usize::from(!add_texcoords(&row.lists[at], polygon.len(), mesh));
        }
        mesh.face_colors.extend(color.map(|at| DVec3::from_array(at.map(|at| row.ones[at]))));
        if !mesh.materials.is_empty() {
            let number = picture.map_or(0.0, |[at]| row.ones[at]);
            mesh.face_materials.push(material_of(number, mesh));
        }
        numbers.iter_mut().for_each(|(at, (_, values))| values.push(row.ones[*at]));
        Ok(())
    })?;
    if n_odd_texcoords > 0 {
        mesh.warnings.add_general(format!(
            "{n_odd_texcoords} face(s) have other than two texture coordinates a corner, which are \
             left out"
        ));
    }
    Ok(())
}

/// Adds the texture coordinates of a polygon's corners, or that they have none; whether the list is
/// empty or has two for each.
fn add_texcoords(list: &[f64], n_corners: usize, mesh: &mut RawMesh) -> bool {
    let is_whole = list.len() == 2 * n_corners;
    if is_whole {
        let texcoords = list.as_chunks().0.iter().map(|&uv| DVec2::from_array(uv));
        mesh.corner_texcoords.extend(texcoords);
    } else {
        mesh.corner_texcoords.extend(iter::repeat_n(DVec2::NAN, n_corners));
    }
    is_whole || list.is_empty()
}

/// Strips of triangles, each with the last two vertices of the one before; -1 ends a strip.
fn read_strips<S: Source>(
    element: &Element,
    n_vertices: u64,
    source: &mut S,
    mesh: &mut RawMesh,
    control: Control,
) -> Result<(), ReadError> {
    each_row(element, source, control, |_, row, source| {
        for strip in row.lists.iter().flat_map(|list| list.split(|number| *number == -1.0)) {
            for (at, corners) in strip.windows(3).enumerate() {
                let vertices = [0, 1, 2].map(|k| RawMesh::vertex(corners[k], n_vertices));
                let [Some(a), Some(b), Some(c)] = vertices else {
                    mesh.leave_out(
                        || format!("a strip before {}", source.place()),
                        || format!("a vertex is not one of {n_vertices}"),
                    );
                    continue;
                };
                // Strips repeat a vertex to turn a corner.
                if a != b && b != c && c != a {
                    let corners: [VertexId; 3] = if at % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    mesh.polygons.push_triangle(corners);
                }
            }
        }
        Ok(())
    })
}
