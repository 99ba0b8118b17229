//! Loads a mesh from a file of triangles.

use crate::formats::FileError;
use crate::formats::plain_file::read_plain;
use crate::formats::template::read_template;
use crate::prelude::*;

/// Bytes of the largest file that is read.
const MAX_FILE_BYTES: u64 = 1 << 30;

const PATH: Param<PathBuf> = Param::input_file("path", "The file.", &["template"]);
const MESH_OUT: Out<TriMesh> = Out::new("mesh", "All of the file as one mesh.");

pub static MODULE: Module = Module {
    id: "Template",
    summary: "Loads a mesh from a file of triangles, one a line as nine numbers.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let bytes =
        read_plain(&path, MAX_FILE_BYTES).map_err(|source| FileError::read(&path, source))?;
    let mesh = read_template(&bytes, io.control());
    // Who ends the work is no fault of the file.
    io.check()?;
    io.put(MESH_OUT, mesh.map_err(|message| ModuleError::io(&path, message))?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use crate::data::TriMesh;

    #[test]
    fn loads_a_file_and_names_it_where_it_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.template");
        let load = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Trial::of(&super::MODULE).set("path", path.to_str().unwrap()).run()
        };
        let outputs = load("0 0 0 1 0 0 0 1 0\n").unwrap();
        assert_eq!(outputs["mesh"].get::<TriMesh>().unwrap().area(), 0.5);
        let message = load("0 0 0\n").unwrap_err().to_string();
        assert!(message.contains("a.template: line 1 is not nine numbers"), "{message}");
    }
}
