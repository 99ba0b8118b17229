//! Meshes on their way to an outside program and back.

use std::path::Path;

use mve_core::{Control, ModuleError};
use mve_mesh::data::TriMesh;

use super::obj::{self, FileScope};
use super::ply::{self, Encoding, PlyOptions, Precision, write_ply};
use super::stl::{self, StlEncoding, write_stl};
use super::warnings::Warning;
use super::{load_with, off, save_atomic};

/// The endings of files that meshes are written to, the usual one first.
pub const ENDINGS: &[&str] = &["ply", "obj", "stl", "off"];

/// Writes a mesh in the format of an ending. Textures are written beside OBJ files alone. PLY files
/// are binary, with floats where these hold every coordinate as it is, else with doubles.
///
/// # Errors
/// As those of the format's writer; an ending that is none of [`ENDINGS`].
pub fn save(mesh: &TriMesh, path: &Path, control: Control) -> Result<(), ModuleError> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    match &*ending {
        "obj" => obj::save(mesh, path, control)?,
        "stl" => {
            save_atomic(path, |out| write_stl(mesh, StlEncoding::Binary, out, control))?;
        }
        "off" => save_atomic(path, |out| off::write_off(mesh, out, control))?,
        "ply" => {
            let fits = |x: f64| f64::from(x as f32) == x;
            let is_float = mesh.positions.iter().all(|p| p.to_array().into_iter().all(fits));
            let precision = if is_float { Precision::Float } else { Precision::Double };
            let options = PlyOptions { encoding: Encoding::Binary, precision };
            save_atomic(path, |out| write_ply(mesh, None, options, out, control))?;
        }
        other => return Err(unknown(path, other)),
    }
    Ok(())
}

/// Reads what a program wrote as the format of an ending, with the files beside it. What the file
/// begins with does not count: whatever else a program wrote would be read as something.
///
/// # Errors
/// As those of the format's reader; an ending that is none of [`ENDINGS`].
pub fn load(path: &Path, control: Control) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    match &*ending {
        "obj" => obj::load(path, control).map_err(|error| error.about(path)),
        "stl" => load_with(path, control, stl::read_stl),
        "off" => load_with(path, control, off::read_off),
        "ply" => ply::load(path, FileScope::Folder, control),
        other => Err(unknown(path, other)),
    }
}

fn unknown(path: &Path, ending: &str) -> ModuleError {
    ModuleError::io(path, format!("meshes are neither read from .{ending} files nor written so"))
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn every_ending_has_a_writer_and_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let mut mesh = tetrahedron();
        for shift in [0.0, 0.1] {
            mesh.positions.iter_mut().for_each(|p| p.x += shift);
            for ending in ENDINGS {
                let path = folder.path().join("a").with_extension(ending);
                save(&mesh, &path, Control::none()).unwrap();
                let (read, warnings) = load(&path, Control::none()).unwrap();
                assert!(warnings.is_empty(), "{ending}");
                assert_eq!(read.faces.len(), 4, "{ending}");
                let close = if *ending == "stl" { 1e-7 } else { 0.0 };
                assert!((read.area() - mesh.area()).abs() <= close, "{ending} {shift}");
            }
        }
        assert!(save(&mesh, &folder.path().join("a.blend"), Control::none()).is_err());
    }
}
