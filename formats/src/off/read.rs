//! From the bytes of an OFF file to a mesh.

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{TriMesh, VertexId};

use crate::ReadError;
use crate::raw_mesh::RawMesh;
use crate::warnings::Warning;
use crate::words::Words;

/// Lines between two looks whether the work was cancelled.
const LINES: u64 = 1 << 15;
/// Elements whose memory is taken before they are read.
const MOST_AT_ONCE: u64 = 1 << 24;

/// Reads an OFF file: polygons, with normals, colors and texture coordinates of vertices and colors
/// of faces. Colors are bytes if all are whole numbers and one is beyond 1.
///
/// # Errors
/// What is wrong with it, with the line; when `control` says so.
pub fn read_off(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let mut words = Words::new(bytes, 1, true);
    let kind = Kind::read(&mut words)?;
    let mut count = |what| {
        let n = words.whole(what)?;
        u64::try_from(n).map_err(|_| words.wrong_at(format!("found {n}, expected {what}")))
    };
    let n_vertices = count("the number of vertices")?;
    let n_faces = count("the number of faces")?;
    // Some programs leave the number of edges out, which nobody reads.
    words.next_line();
    let least = n_vertices.saturating_mul(6).saturating_add(n_faces.saturating_mul(2));
    if least > words.n_left() as u64 + 1 {
        return Err(ReadError::Wrong(format!(
            "it promises {n_vertices} vertices and {n_faces} faces, for which the {} bytes that \
             follow are too few",
            words.n_left()
        )));
    }
    let mut mesh = RawMesh::default();
    mesh.positions.reserve(n_vertices.min(MOST_AT_ONCE) as usize);
    for at in 0..n_vertices {
        if at % LINES == 0 {
            control.at(words.fraction())?;
        }
        read_vertex(kind, &mut words, &mut mesh)?;
    }
    mesh.polygons.reserve(n_faces.min(MOST_AT_ONCE) as usize);
    let mut colors = Vec::new();
    let mut polygon = Vec::new();
    for at in 0..n_faces {
        if at % LINES == 0 {
            control.at(words.fraction())?;
        }
        if read_face(n_vertices, &mut words, &mut mesh, &mut polygon)? {
            colors.push(read_color(&mut words));
        }
        words.next_line();
    }
    scale(mesh.colors.iter_mut());
    if colors.iter().any(Option::is_some) {
        scale(colors.iter_mut().flatten());
        mesh.face_colors = colors.into_iter().map(|color| color.unwrap_or(DVec3::ONE)).collect();
    }
    mesh.finish(control)
}

/// What a vertex has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Kind {
    has_texcoord: bool,
    has_color: bool,
    has_fourth: bool,
    has_normal: bool,
}

impl Kind {
    /// Reads the keyword, if there is one.
    fn read(words: &mut Words) -> Result<Self, ReadError> {
        let Some(word) = words.peek() else {
            return Err(ReadError::Wrong("the file is empty".to_owned()));
        };
        if word.iter().all(u8::is_ascii_digit) {
            return Ok(Self::default());
        }
        let mut kind = Self::default();
        let (mut is_off, mut is_of_any_dimension) = (false, false);
        // Some programs write the letters in another order.
        if let Some(mut letters) = word.strip_suffix(b"OFF") {
            while let Some((letter, rest)) = letters.split_first() {
                letters = rest;
                match letter {
                    b'S' if rest.starts_with(b"T") => {
                        kind.has_texcoord = true;
                        letters = &rest[1..];
                    }
                    b'C' => kind.has_color = true,
                    b'N' => kind.has_normal = true,
                    b'4' => kind.has_fourth = true,
                    b'n' => is_of_any_dimension = true,
                    _ => return Err(words.wrong("`OFF`: is it an OFF file?")),
                }
            }
            is_off = true;
        }
        if !is_off {
            return Err(words.wrong("`OFF`, or two numbers: is it an OFF file?"));
        }
        if is_of_any_dimension {
            return Err(words.wrong("a file in three dimensions, `OFF` without `n`"));
        }
        words.next();
        if words.peek().is_some_and(|word| word.eq_ignore_ascii_case(b"binary")) {
            return Err(words.wrong("text: save it as OFF without BINARY"));
        }
        Ok(kind)
    }
}

fn read_vertex(kind: Kind, words: &mut Words, mesh: &mut RawMesh) -> Result<(), ReadError> {
    let mut vector = |names: [&str; 3]| -> Result<DVec3, ReadError> {
        let [x, y, z] = names;
        Ok(DVec3::new(words.number(x)?, words.number(y)?, words.number(z)?))
    };
    let mut position = vector(["x", "y", "z"])?;
    if kind.has_fourth {
        position /= words.number("w")?;
    }
    mesh.positions.push(position);
    if kind.has_normal {
        let mut vector = || -> Result<DVec3, ReadError> {
            Ok(DVec3::new(words.number("nx")?, words.number("ny")?, words.number("nz")?))
        };
        mesh.normals.push(vector()?);
    }
    if kind.has_color {
        let color = |words: &mut Words| -> Result<DVec3, ReadError> {
            Ok(DVec3::new(words.number("red")?, words.number("green")?, words.number("blue")?))
        };
        mesh.colors.push(color(words)?);
    }
    if kind.has_texcoord {
        // A fourth number of the color may stand before them.
        let mut rest = Vec::new();
        while let Some(word) = words.next_here() {
            rest.extend(fast_float2::parse::<f64, _>(word).ok());
        }
        match rest[..] {
            [.., s, t] => mesh.texcoords.push(DVec2::new(s, t)),
            _ => return Err(words.wrong("texture coordinates at the end of the line before")),
        }
    } else if kind.has_color {
        // Its opacity, on the same line.
        words.next_line();
    }
    Ok(())
}

/// Reads the corners of a face; whether it is one.
fn read_face(
    n_vertices: u64,
    words: &mut Words,
    mesh: &mut RawMesh,
    polygon: &mut Vec<VertexId>,
) -> Result<bool, ReadError> {
    let n = words.whole("the number of corners")?;
    let line = words.line();
    if n < 0 || n as u64 > words.n_left() as u64 {
        return Err(
            words.wrong_at(format!("a face has {n} corners, of which the file has no room"))
        );
    }
    polygon.clear();
    let mut fault = None;
    for _ in 0..n {
        let corner = words.whole("the number of a vertex")?;
        match u64::try_from(corner).ok().filter(|corner| *corner < n_vertices) {
            Some(corner) => polygon.push(VertexId(corner as u32)),
            None => fault = Some(corner),
        }
    }
    let place = || format!("line {line}");
    if let Some(corner) = fault {
        mesh.leave_out(place, || {
            format!("found vertex {corner}, expected 0 to {}", n_vertices.saturating_sub(1))
        });
        return Ok(false);
    }
    if n < 3 {
        mesh.leave_out(place, || format!("a face has {n} corners, fewer than 3"));
        return Ok(false);
    }
    mesh.polygons.push(polygon);
    Ok(true)
}

/// The color at the end of a face's line: three or four numbers. A single one is a number in a
/// table of colors that is no part of the file.
fn read_color(words: &mut Words) -> Option<DVec3> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        *number = fast_float2::parse(words.next_here()?).ok()?;
    }
    Some(DVec3::from(numbers))
}

/// Colors of bytes as fractions.
fn scale<'a>(colors: impl Iterator<Item = &'a mut DVec3>) {
    let colors: Vec<&mut DVec3> = colors.collect();
    let numbers = || colors.iter().flat_map(|color| color.to_array());
    let is_bytes = numbers().any(|n| n > 1.0) && numbers().all(|n| n.fract() == 0.0 && n <= 255.0);
    if is_bytes {
        colors.into_iter().for_each(|color| *color /= 255.0);
    }
}
