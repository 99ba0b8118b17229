//! From the bytes of an OBJ file to a mesh.
//!
//! One pass in file order. Only when a face names a vertex that comes after it are there two more:
//! one over the vertices and one over the faces. Time and memory are linear in the length of the
//! file, apart from concave polygons of many corners.

use std::io;

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Material, NO_VALUE, TriMesh, name_from_bytes};

use super::builder::{Corner, MeshBuilder};
use super::cursor::{Cursor, quoted};
use super::kind::check_kind;
use super::number::{integer, numbers};
use super::trouble::Trouble;
use super::{Companions, MtlSource, ObjError, Warning, Warnings, materials};
use crate::polygon::{Cut, Triangulator};

/// Bytes between two calls of the control.
const PROGRESS_STEP: usize = 1 << 20;

/// Statements of the format that say nothing about a triangle mesh, and how they are called.
const LEFT_OUT: [(&[u8], &str); 8] = [
    (b"l", "lines (`l`) are left out"),
    (b"p", "points (`p`) are left out"),
    (b"vp", "free-form geometry is left out"),
    (b"cstype", "free-form geometry is left out"),
    (b"curv", "free-form geometry is left out"),
    (b"curv2", "free-form geometry is left out"),
    (b"surf", "free-form geometry is left out"),
    (b"call", "included files (`call`) are left out"),
];

/// Statements that are left out without a warning: parts of a free-form element, of which there
/// was a warning, and what concerns only the display.
const PASSED_OVER: [&[u8]; 22] = [
    b"mg",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"maplib",
    b"usemap",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"deg",
    b"bmat",
    b"step",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
    b"csh",
];

/// Reads an OBJ file.
///
/// `mtl` is asked for the material files that it names; one that is missing is a warning. Textures
/// have the names that stand there, and no pictures.
///
/// # Errors
/// See [`ObjError`]; none of them leaves anything behind.
pub fn parse(
    bytes: &[u8],
    mtl: &mut MtlSource,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ObjError> {
    parse_with(bytes, &mut MaterialsOnly(mtl), control)
}

/// Material files without the pictures that they name.
struct MaterialsOnly<'a, 'b>(&'a mut MtlSource<'b>);

impl Companions for MaterialsOnly<'_, '_> {
    fn material_file(&mut self, name: &str) -> io::Result<Vec<u8>> {
        (self.0)(name)
    }

    fn pictures(&mut self, _: &str, _: &mut [Material], _: &mut Warnings) {}
}

/// Reads an OBJ file and what it names.
pub(super) fn parse_with(
    bytes: &[u8],
    companions: &mut dyn Companions,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ObjError> {
    check_kind(bytes)?;
    let mut reader = Reader::new(control);
    match reader.run(bytes, Pass::All) {
        Err(Stop::Forward) => {
            reader = Reader::new(control);
            reader.run(bytes, Pass::Vertices).map_err(Stop::into_error)?;
            reader.run(bytes, Pass::Faces).map_err(Stop::into_error)?;
        }
        result => result.map_err(Stop::into_error)?,
    }
    if reader.mesh.positions.is_empty() {
        return Err(ObjError::NoVertices);
    }
    let Reader { mut mesh, mut warnings, libraries, trouble, .. } = reader;
    trouble.settle(&mut mesh, &mut warnings)?;
    if mesh.faces().is_empty() {
        warnings.add_general("the file has vertices but no faces".to_owned());
    }
    let last = bytes.rsplit(|byte| *byte == b'\n').next().unwrap_or_default();
    if last.starts_with(b"f ") || last.starts_with(b"v ") {
        let message = "the last line has no end; the file may have been cut there";
        warnings.add_general(message.to_owned());
    }
    let libraries = materials::read_all(&libraries, companions, &mut warnings);
    libraries.match_names(&mut mesh.material, &mut warnings);
    let mut mesh = mesh.finish();
    mesh.materials = libraries.materials;
    Ok((mesh, warnings.into_list()))
}

/// What one run over the file reads.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pass {
    All,
    Vertices,
    Faces,
}

/// Why a run stops.
enum Stop {
    /// A face names a vertex, texture coordinate or normal that has not come yet.
    Forward,
    Error(ObjError),
}

impl Stop {
    fn into_error(self) -> ObjError {
        match self {
            Self::Error(error) => error,
            // Only the first pass stops in this way.
            Self::Forward => ObjError::NoVertices,
        }
    }
}

impl From<ObjError> for Stop {
    fn from(error: ObjError) -> Self {
        Self::Error(error)
    }
}

/// Names of the three lists that a corner refers to.
const LISTS: [(&str, &str); 3] =
    [("vertex", "vertices"), ("texture coordinate", "texture coordinates"), ("normal", "normals")];

struct Reader<'p> {
    control: Control<'p>,
    reported: f64,
    mesh: MeshBuilder,
    pass: Pass,
    /// How many vertices, texture coordinates and normals came before the present line.
    n_seen: [usize; 3],
    libraries: Vec<String>,
    warnings: Warnings,
    trouble: Trouble,
    triangulator: Triangulator,
    polygon: Vec<Corner>,
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl<'p> Reader<'p> {
    fn new(control: Control<'p>) -> Self {
        Self {
            control,
            reported: 0.0,
            mesh: MeshBuilder::default(),
            pass: Pass::All,
            n_seen: [0; 3],
            libraries: Vec::new(),
            warnings: Warnings::default(),
            trouble: Trouble::default(),
            triangulator: Triangulator::default(),
            polygon: Vec::new(),
            points: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn run(&mut self, bytes: &[u8], pass: Pass) -> Result<(), Stop> {
        (self.pass, self.n_seen) = (pass, [0; 3]);
        let mut cursor = Cursor::new(bytes);
        let mut next_report = 0;
        while !cursor.is_done() {
            if cursor.pos() >= next_report {
                next_report = cursor.pos() + PROGRESS_STEP;
                self.report(cursor.fraction())?;
            }
            self.statement(&mut cursor)?;
            cursor.next_line();
        }
        self.report(1.0)
    }

    fn report(&mut self, fraction: f64) -> Result<(), Stop> {
        self.reported = self.reported.max(fraction);
        self.control.at(self.reported).map_err(|_| ObjError::Cancelled.into())
    }

    /// Reads one statement; what it leaves of the line may be left out.
    #[inline]
    fn statement(&mut self, cursor: &mut Cursor) -> Result<(), Stop> {
        if cursor.is_line_over() {
            return Ok(());
        }
        let keyword = cursor.word();
        match keyword {
            b"v" => self.list_line(cursor, 0),
            b"vt" => self.list_line(cursor, 1),
            b"vn" => self.list_line(cursor, 2),
            _ if self.pass == Pass::Vertices => Ok(()),
            b"f" | b"fo" => self.face(cursor),
            _ => self.other(cursor, keyword),
        }
    }

    fn list_line(&mut self, cursor: &mut Cursor, list: usize) -> Result<(), Stop> {
        self.n_seen[list] += 1;
        if self.pass == Pass::Faces {
            return Ok(());
        }
        if self.n_seen[list] >= NO_VALUE as usize {
            let (line, what) = (cursor.line(), LISTS[list].1);
            return Err(ObjError::TooMany { line, what }.into());
        }
        match list {
            0 => self.vertex(cursor)?,
            1 => self.texcoord(cursor)?,
            _ => self.normal(cursor)?,
        }
        Ok(())
    }

    fn vertex(&mut self, cursor: &mut Cursor) -> Result<(), ObjError> {
        let mut position = DVec3::from(numbers::<3>(cursor, "3 coordinates after `v`")?);
        if !position.is_finite() {
            self.trouble.points.push((self.mesh.positions.len() as u32, cursor.line(), position));
            position = DVec3::ZERO;
        }
        let color = if cursor.is_line_over() { NO_VALUE } else { self.vertex_extras(cursor)? };
        self.mesh.color_index.push(self.mesh.positions.len(), color);
        self.mesh.positions.push(position);
        Ok(())
    }

    /// What follows the coordinates: a weight, a color, or something of other programs. Gives the
    /// index of the color.
    #[cold]
    fn vertex_extras(&mut self, cursor: &mut Cursor) -> Result<u32, ObjError> {
        let line = cursor.line();
        let mut extras = [0.0; 4];
        let mut n_extras = 0;
        while n_extras < extras.len() && !cursor.is_line_over() {
            [extras[n_extras]] = numbers(cursor, "a number or the end of the line")?;
            n_extras += 1;
        }
        let color = DVec3::new(extras[0], extras[1], extras[2]);
        let mut color_id = NO_VALUE;
        match n_extras {
            1 if extras[0] == 1.0 => {}
            1 => self.warnings.add(line, "the weight `w` of a vertex is left out"),
            2 => self.warnings.add(line, "2 numbers after the coordinates are left out"),
            _ if !color.is_finite() => {
                self.warnings.add(line, "a color is not finite; its vertex has none");
            }
            _ => {
                if color.min_element() < 0.0 || color.max_element() > 1.0 {
                    self.trouble.colors.add(line);
                }
                // There are no more colors than vertices, so the index fits.
                color_id = self.mesh.colors.len() as u32;
                self.mesh.colors.push(color);
            }
        }
        if n_extras > 3 {
            self.warnings.add(line, "the numbers after the color are left out");
        }
        Ok(color_id)
    }

    fn texcoord(&mut self, cursor: &mut Cursor) -> Result<(), ObjError> {
        let [u] = numbers(cursor, "1 to 3 numbers after `vt`")?;
        let mut others = [0.0; 2];
        for other in &mut others {
            if !cursor.is_line_over() {
                [*other] = numbers(cursor, "1 to 3 numbers after `vt`")?;
            }
        }
        if others[1] != 0.0 {
            self.warnings.add(cursor.line(), "the third texture coordinate is left out");
        }
        let mut value = DVec2::new(u, others[0]);
        if !value.is_finite() {
            value = DVec2::ZERO;
            self.warnings.add(cursor.line(), "a texture coordinate is not finite; it is set to 0");
        }
        self.mesh.texcoords.push(value);
        Ok(())
    }

    fn normal(&mut self, cursor: &mut Cursor) -> Result<(), ObjError> {
        let mut value = DVec3::from(numbers::<3>(cursor, "3 numbers after `vn`")?);
        if !value.is_finite() {
            value = DVec3::ZERO;
            self.warnings.add(cursor.line(), "a normal is not finite; it is set to 0");
        }
        self.mesh.normals.push(value);
        Ok(())
    }

    /// Reads a face. One that cannot be read is left out.
    #[inline]
    fn face(&mut self, cursor: &mut Cursor) -> Result<(), Stop> {
        let line = cursor.line();
        match self.corners(cursor, line) {
            Ok(()) => {}
            Err(Stop::Error(error @ ObjError::Line { .. })) => {
                self.trouble.add_face(error);
                return Ok(());
            }
            Err(stop) => return Err(stop),
        }
        match self.polygon[..] {
            [a, b, c] => self.mesh.push_triangle([a, b, c]),
            _ => self.cut_polygon(line)?,
        }
        Ok(())
    }

    #[inline]
    fn corners(&mut self, cursor: &mut Cursor, line: usize) -> Result<(), Stop> {
        self.polygon.clear();
        while !cursor.is_line_over() {
            let corner = self.corner(cursor)?;
            self.polygon.push(corner);
        }
        if self.mesh.faces().len() + self.polygon.len() >= NO_VALUE as usize {
            return Err(ObjError::TooMany { line, what: "triangles" }.into());
        }
        if self.polygon.len() < 3 {
            let found = format!("a face of {} vertices", self.polygon.len());
            let expected = "3 or more".to_owned();
            return Err(ObjError::Line { line, found, expected }.into());
        }
        Ok(())
    }

    fn cut_polygon(&mut self, line: usize) -> Result<(), Stop> {
        self.points.clear();
        let positions = &self.mesh.positions;
        self.points.extend(self.polygon.iter().map(|corner| positions[corner[0] as usize]));
        self.triangles.clear();
        // The share of the file that is read stays as it is meanwhile.
        let control = self.control.part(self.reported, self.reported);
        let cut = self.triangulator.cut(&self.points, &mut self.triangles, control);
        if cut.map_err(|Cancelled| ObjError::Cancelled)? == Cut::Fan {
            let text = "a polygon has no area or crosses itself; it is cut into a fan";
            self.warnings.add(line, text);
        }
        for triangle in &self.triangles {
            self.mesh.push_triangle(triangle.map(|k| self.polygon[k as usize]));
        }
        Ok(())
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    fn corner(&mut self, cursor: &mut Cursor) -> Result<Corner, Stop> {
        let start = cursor.pos();
        let mut corner = [NO_VALUE; 3];
        for (list, value) in corner.iter_mut().enumerate() {
            if list > 0 {
                if cursor.peek() != Some(b'/') {
                    break;
                }
                cursor.advance(1);
            }
            match integer(cursor) {
                Some(raw) => *value = self.resolve(raw, list, cursor.line())?,
                None if list > 0 => {}
                None => return Err(bad_corner(cursor, start).into()),
            }
        }
        if cursor.is_word_over() { Ok(corner) } else { Err(bad_corner(cursor, start).into()) }
    }

    /// The index from 0 for one of the file, which counts from 1, or back from -1. The corner of a
    /// texture coordinate or normal that is not there has none.
    #[inline]
    fn resolve(&mut self, raw: i64, list: usize, line: usize) -> Result<u32, Stop> {
        let n_seen = self.n_seen[list];
        let n_known = match list {
            0 => self.mesh.positions.len(),
            1 => self.mesh.texcoords.len(),
            _ => self.mesh.normals.len(),
        };
        let idx = if raw > 0 { raw - 1 } else { n_seen as i64 + raw };
        if raw != 0 && (0..n_known as i64).contains(&idx) {
            // Lists are shorter than `NO_VALUE`, so the index fits.
            return Ok(idx as u32);
        }
        if raw > 0 && self.pass == Pass::All {
            return Err(Stop::Forward);
        }
        let error = out_of_range(raw, list, line, n_known);
        if list == 0 {
            return Err(error.into());
        }
        self.trouble.add_corner(list, line, error);
        Ok(NO_VALUE)
    }

    #[cold]
    fn other(&mut self, cursor: &mut Cursor, keyword: &[u8]) -> Result<(), Stop> {
        match keyword {
            b"o" => self.mesh.object.set(cursor.name()),
            b"g" => self.mesh.group.set(cursor.name()),
            b"usemtl" => self.mesh.material.set(cursor.name()),
            b"s" => {
                cursor.skip_blanks();
                let number = cursor.word();
                let is_off = matches!(number, b"off" | b"0");
                self.mesh.smoothing.set(if is_off { "".into() } else { name_from_bytes(number) });
            }
            b"mtllib" => {
                let name = cursor.name();
                if !name.is_empty() && !self.libraries.contains(&name) {
                    self.libraries.push(name);
                }
            }
            _ if PASSED_OVER.contains(&keyword) => {}
            _ => {
                let line = cursor.line();
                if keyword.iter().any(|&byte| byte < b' ') {
                    return Err(ObjError::NotObj { line, kind: "it holds binary data" }.into());
                }
                match LEFT_OUT.iter().find(|(name, _)| *name == keyword) {
                    Some((_, text)) => self.warnings.add(line, text),
                    None => {
                        let text = format!("unknown statement {} is left out", quoted(keyword));
                        self.warnings.add(line, &text);
                    }
                }
            }
        }
        Ok(())
    }
}

#[cold]
fn bad_corner(cursor: &mut Cursor, start: usize) -> ObjError {
    cursor.back_to(start);
    let (line, found) = (cursor.line(), quoted(cursor.word()));
    ObjError::Line { line, found, expected: "a corner v, v/vt, v//vn or v/vt/vn".to_owned() }
}

#[cold]
fn out_of_range(raw: i64, list: usize, line: usize, n_known: usize) -> ObjError {
    let (one, many) = LISTS[list];
    let found = format!("{one} {raw}");
    let expected = match (raw, n_known) {
        (_, 0) => format!("none, since the file has no {many}"),
        (0, _) => format!("1 to {n_known}, as numbers begin at 1"),
        (1.., _) => format!("1 to {n_known}, as the file has no more {many}"),
        (..0, _) => format!("one of the {many} above that line"),
    };
    ObjError::Line { line, found, expected }
}
