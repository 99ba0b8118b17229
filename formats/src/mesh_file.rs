//! Mesh files of any format: read by how they begin, written by how their names end. What an
//! outside program wrote is read by the ending, too: by its beginning, anything would be read as
//! something.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mve_core::{Control, ModuleError};
use mve_mesh::data::{Domain, Layer, TriMesh};

use super::gltf::{self, Vertices};
use super::obj::{self, FileScope};
use super::plain_file::{load_with, read_beginning};
use super::ply::{Encoding, PlyOptions, Precision};
use super::stl::StlEncoding;
use super::warnings::Warning;
use super::{iv, off, ply, stl};

/// Bytes at the beginning of a file that say what it is.
const N_BYTES: u64 = 4096;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
    Stl,
    Off,
    Gltf,
    Iv,
}

impl Format {
    /// By the first bytes of a file. Text that is nothing else is OBJ, which may begin with
    /// anything.
    fn of(bytes: &[u8]) -> Self {
        let mut text = bytes.trim_ascii_start();
        while text.starts_with(b"#") {
            let length = text.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            text = text[length.unwrap_or(text.len())..].trim_ascii_start();
        }
        let word = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let is_text = !bytes.contains(&0);
        match word {
            b"ply" => Self::Ply,
            _ if ["#Inventor V", "#VRML V"]
                .iter()
                .any(|head| bytes.starts_with(head.as_bytes())) =>
            {
                Self::Iv
            }
            _ if bytes.starts_with(b"glTF") || text.starts_with(b"{") => Self::Gltf,
            _ if word.ends_with(b"OFF") && word.len() <= 8 || is_counts(text) => Self::Off,
            _ if word.eq_ignore_ascii_case(b"solid") || !is_text => Self::Stl,
            _ => Self::Obj,
        }
    }

    fn of_file(path: &Path) -> Option<Self> {
        read_beginning(path, N_BYTES).ok().map(|bytes| Self::of(&bytes))
    }
}

/// Whether text begins with a line of two or three whole numbers, as OFF does whose first word is
/// missing: the vertices, faces and edges. No other format begins with a number.
fn is_counts(text: &[u8]) -> bool {
    let line = text.split(|byte| matches!(byte, b'\n' | b'\r')).next().unwrap_or_default();
    let words = || line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    (2..=3).contains(&words().count()) && words().all(|word| word.iter().all(u8::is_ascii_digit))
}

/// What a file is that begins with these bytes and holds no mesh, or one that nobody reads here.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 11] = [
        (b"\x89PNG", "is a PNG picture, no mesh; PngLoader reads it"),
        (b"\xff\xd8\xff", "is a JPEG picture, no mesh"),
        (b"GIF8", "is a GIF picture, no mesh"),
        (b"%PDF", "is a PDF document, no mesh"),
        (b"PK\x03\x04", "is a ZIP archive (also .3mf, .usdz, .docx); unpack it first"),
        (b"7z\xbc\xaf", "is a 7z archive; unpack it first"),
        (b"BZh", "is packed by bzip2; unpack it first, or pack it by gzip"),
        (b"\xfd7zXZ", "is packed by xz; unpack it first, or pack it by gzip"),
        (b"Kaydara FBX Binary", "is an FBX file; save it as glTF, PLY or OBJ there"),
        (b"BLENDER", "is a file of Blender; save it as glTF, PLY or OBJ there"),
        (b"PXR-USDC", "is a USD file; save it as glTF, PLY or OBJ there"),
    ];
    let (_, what) = KINDS.iter().find(|(start, _)| bytes.starts_with(start))?;
    Some(what)
}

/// Whether a file that is not text has about the length that binary STL says of itself. Of a
/// compressed file the length is not known.
fn can_be_stl(path: &Path) -> bool {
    let Ok(bytes) = read_beginning(path, N_BYTES) else { return true };
    if bytes.trim_ascii_start().to_ascii_lowercase().starts_with(b"solid") {
        return true;
    }
    let mut raw = [0; 2];
    let file = File::open(path).and_then(|mut file| {
        let n_bytes = file.metadata()?.len();
        file.read_exact(&mut raw).map(|()| n_bytes)
    });
    let (Ok(n_bytes), Some(count)) = (file, bytes.get(80..84)) else { return true };
    let n_faces = count.iter().rev().fold(0, |n, byte| n << 8 | u64::from(*byte));
    raw == [0x1f, 0x8b] || n_bytes <= 2 * (84 + 50 * n_faces) + N_BYTES
}

/// Reads a file by its format's reader.
///
/// # Errors
/// As of the reader; that `control` ended the work.
pub fn load(
    path: &Path,
    scope: FileScope,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    if let Ok(bytes) = read_beginning(path, N_BYTES) {
        if bytes.trim_ascii().is_empty() {
            return Err(ModuleError::io(path, "the file is empty"));
        }
        if let Some(what) = other_kind(&bytes) {
            return Err(ModuleError::io(path, what));
        }
    }
    match Format::of_file(path) {
        Some(Format::Stl) if !can_be_stl(path) => Err(ModuleError::io(
            path,
            "is no mesh file that mve knows: it is not text, and not as long as an STL file of its \
             number of faces is; StlLoader reads it nonetheless",
        )),
        Some(Format::Ply) => ply::load(path, scope, control),
        Some(Format::Stl) => stl::load(path, control),
        Some(Format::Off) => load_with(path, control, off::read_off),
        Some(Format::Gltf) => gltf::load(path, scope, Vertices::Welded, control),
        Some(Format::Iv) => iv::load(path, scope, control),
        // What cannot be read says so here.
        Some(Format::Obj) | None => {
            obj::load_within(path, scope, control).map_err(|error| error.about(path))
        }
    }
}

/// The files that reading one may open, whether they exist or not.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    match Format::of_file(path) {
        Some(Format::Obj) => obj::companions(path),
        Some(Format::Ply) => ply::companions(path),
        Some(Format::Gltf) => gltf::companions(path),
        Some(Format::Iv) => iv::companions(path),
        Some(Format::Stl | Format::Off) | None => Vec::new(),
    }
}

/// The endings of files that are written; the first is what outside programs get.
pub const WRITTEN: [&str; 6] = ["ply", "obj", "stl", "off", "glb", "iv"];

/// Who is to read what is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// Anybody: each format as its saver does without parameters.
    Anybody,
    /// A program that gives something back: PLY has doubles where floats would not hold all
    /// coordinates, and no vertex is split for the sake of its normals or colors, which stay away
    /// then.
    Program,
}

/// Saves a mesh by the ending of the file's name; what is changed or left out comes back in
/// sentences.
///
/// # Errors
/// With the path, where its ending is none of [`WRITTEN`], or as of the saver; that `control` ended
/// the work.
pub fn save(
    mesh: Arc<TriMesh>,
    path: &Path,
    reader: Reader,
    control: Control,
) -> Result<Vec<String>, ModuleError> {
    match &*ending_of(path) {
        "obj" => {
            obj::save(&mesh, path, control)?;
            Ok(obj::textures_not_there(&mesh, path, ""))
        }
        "ply" => {
            let (precision, mesh) = match reader {
                Reader::Anybody => (Precision::Float, mesh),
                Reader::Program => (precision_of(&mesh), with_whole_vertices(mesh)),
            };
            let options = PlyOptions { encoding: Encoding::Binary, precision };
            ply::save(mesh, None, options, path, control)
        }
        "stl" => stl::save(&mesh, StlEncoding::Binary, path, control),
        "off" => off::save(&mesh, path, control),
        "glb" => gltf::save(&mesh, path, control),
        "iv" => iv::save(&mesh, path, control),
        _ => Err(unknown_ending(path)),
    }
}

/// Reads a file as the format that the ending of its name says, with the files in its folder.
///
/// # Errors
/// As [`save`].
pub fn load_by_ending(
    path: &Path,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    match &*ending_of(path) {
        "obj" => obj::load(path, control).map_err(|error| error.about(path)),
        "ply" => ply::load(path, FileScope::Folder, control),
        "stl" => stl::load(path, control),
        "off" => load_with(path, control, off::read_off),
        "glb" => gltf::load(path, FileScope::Folder, Vertices::Welded, control),
        "iv" => iv::load(path, FileScope::Folder, control),
        _ => Err(unknown_ending(path)),
    }
}

fn ending_of(path: &Path) -> String {
    path.extension().unwrap_or_default().to_ascii_lowercase().to_string_lossy().into_owned()
}

fn unknown_ending(path: &Path) -> ModuleError {
    let known = WRITTEN.map(|ending| format!(".{ending}")).join(", ");
    ModuleError::io(path, format!("its ending says no format; end it in one of {known}"))
}

/// The mesh without values for which a PLY file would have several vertices in place of one.
fn with_whole_vertices(mesh: Arc<TriMesh>) -> Arc<TriMesh> {
    let is_splitting = |layer: &Layer| {
        layer.domain == Domain::Corner && [Layer::NORMAL, Layer::COLOR].contains(&&*layer.name)
    };
    if !mesh.layers.iter().any(is_splitting) {
        return mesh;
    }
    let mut whole = Arc::unwrap_or_clone(mesh);
    whole.layers.retain(|layer| !is_splitting(layer));
    Arc::new(whole)
}

/// Floats, where these hold every coordinate as it is.
fn precision_of(mesh: &TriMesh) -> Precision {
    let fits = |x: f64| f64::from(x as f32) == x;
    let is_float = mesh.positions.iter().all(|p| p.to_array().into_iter().all(fits));
    if is_float { Precision::Float } else { Precision::Double }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::LayerValues;
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn what_a_program_gets_comes_back_in_every_format() {
        let folder = tempfile::tempdir().unwrap();
        let mut mesh = tetrahedron();
        for shift in [0.0, 0.1] {
            mesh.positions.iter_mut().for_each(|p| p.x += shift);
            for ending in WRITTEN {
                let path = folder.path().join("a").with_extension(ending);
                let whole = Arc::new(mesh.clone());
                save(whole, &path, Reader::Program, Control::none()).unwrap();
                let (read, warnings) = load_by_ending(&path, Control::none()).unwrap();
                assert!(warnings.is_empty(), "{ending}");
                assert_eq!((read.faces.len(), read.positions.len()), (4, 4), "{ending}");
                let close = if ["stl", "glb"].contains(&ending) { 1e-7 } else { 0.0 };
                assert!((read.area() - mesh.area()).abs() <= close, "{ending} {shift}");
            }
        }
        for ending in ["blend", ""] {
            let path = folder.path().join("a").with_extension(ending);
            let error = load_by_ending(&path, Control::none()).unwrap_err().to_string();
            assert!(error.contains("end it in one of .ply, .obj"), "{error}");
            let mesh = Arc::new(tetrahedron());
            assert!(save(mesh, &path, Reader::Program, Control::none()).is_err());
        }
    }

    /// Four faces with a normal each: as a file for anybody that is twelve vertices.
    #[test]
    fn a_program_gets_vertices_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let mut mesh = tetrahedron();
        let normals: Vec<glam::DVec3> = (0..4)
            .map(|f| {
                let [a, b, c] = mesh.corners(mve_mesh::data::FaceId(f));
                (b - a).cross(c - a).normalize()
            })
            .collect();
        let (name, domain) = (Layer::NORMAL.to_owned(), Domain::Corner);
        let (values, index) = (LayerValues::Vec3(normals), (0..12).map(|c| c / 3).collect());
        mesh.set_layer(Layer { name, domain, values, index });
        for (reader, n_vertices) in [(Reader::Anybody, 12), (Reader::Program, 4)] {
            save(Arc::new(mesh.clone()), &path, reader, Control::none()).unwrap();
            let (read, _) = load_by_ending(&path, Control::none()).unwrap();
            assert_eq!(read.positions.len(), n_vertices);
            assert_eq!(read.layer(Layer::NORMAL).is_some(), reader == Reader::Anybody);
        }
    }

    #[test]
    fn what_is_no_mesh_is_named_and_off_needs_no_word() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            load(&path, FileScope::Folder, Control::none())
        };
        let png = include_bytes!("../../tests/data/example.png");
        for (bytes, what) in [(&png[..], "is a PNG picture"), (b"PK\x03\x04a", "is a ZIP archive")]
        {
            let error = read(bytes).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
        let (mesh, _) = read(b"# no OFF\n3 1 0\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n").unwrap();
        assert_eq!((mesh.positions.len(), mesh.area()), (3, 2.0));
        // Not a count of anything.
        assert!(read(b"1 2 0.5\n").is_err());
    }

    #[test]
    fn a_program_is_no_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ls");
        // Byte 80 of a program may be anything.
        let mut bytes = vec![0_u8; 50_000];
        (bytes[0], bytes[80]) = (0x7f, 64);
        std::fs::write(&path, &bytes).unwrap();
        let error = load(&path, FileScope::Folder, Control::none()).unwrap_err().to_string();
        assert!(error.contains("is no mesh file that mve knows"), "{error}");
        bytes.truncate(84 + 50 * 64);
        std::fs::write(&path, &bytes).unwrap();
        let (mesh, _) = load(&path, FileScope::Folder, Control::none()).unwrap();
        assert_eq!(mesh.faces.len(), 64);
    }
}
