//! Saves a mesh as a Wavefront OBJ file with its materials and textures.

use mve_formats::obj;

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const PATH: Param<PathBuf> = Param::output_file(
    "path",
    "The file. Materials are written beside it into an MTL file of the same name, and their \
     textures into a folder of that name and -textures.",
    &["obj"],
)
.also_writes(&["mtl", "-textures/"]);
const TEXTURE_FOLDER: Param<String> = Param::text(
    "texture_folder",
    "Where the textures lie, seen from the file, such as ../models/tex: the MTL file names them \
     there, and they are not copied. Empty: they are copied.",
    "",
);

pub static MODULE: Module = Module {
    id: "ObjSaver",
    summary: "Saves a mesh as an OBJ file, with its materials and textures if it has any.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), TEXTURE_FOLDER.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path) = (io.get(MESH_IN)?, io.param(PATH)?);
    let named = io.param(TEXTURE_FOLDER)?;
    let named = named.trim_end_matches('/');
    match named {
        "" => obj::save(&mesh, &path, io.control())?,
        folder => obj::save_naming(&mesh, &path, folder, io.control())?,
    }
    let warnings = obj::textures_not_there(&mesh, &path, named);
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use mve_core::testing::{Trial, plan_options, run_options};
    use mve_core::{CancelToken, Control, FileHashes, Map, Plan, PlanOptions, RunOutcome, run};

    use mve_formats::obj;
    use mve_formats::png::write_png;
    use mve_mesh::data::{Image, PixelKind, TextureRole, TriMesh};
    use mve_mesh::fixtures::tetrahedron;

    #[test]
    fn what_is_saved_loads_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let name = path.to_str().unwrap();
        Trial::of(&super::MODULE).input("mesh", tetrahedron()).set("path", name).run().unwrap();
        let (mesh, _) = obj::load(&path, Control::none()).unwrap();
        assert_eq!(mesh, tetrahedron());
        assert!(!folder.path().join("a-textures").exists());
    }

    /// A folder with `in.obj`, a tetrahedron of one material with the texture `tex/skin.png`.
    fn textured() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let mut mesh = crate::geometry::generate::subdivided_box(&Default::default());
        let labels = mve_mesh::data::LayerValues::Label(vec!["skin".to_owned()]);
        let index = vec![0; mesh.faces.len()];
        let (name, domain) =
            (mve_mesh::data::Layer::MATERIAL.to_owned(), mve_mesh::data::Domain::Face);
        mesh.set_layer(mve_mesh::data::Layer { name, domain, values: labels, index });
        let mtl = b"newmtl skin\nmap_Kd tex/skin.png\nmap_Ks tex/gloss.png\n";
        mesh.materials = obj::parse_mtl(mtl).0;
        obj::save(&mesh, &folder.path().join("in.obj"), Control::none()).unwrap();
        paint(folder.path(), "skin", 7);
        folder
    }

    fn paint(folder: &Path, name: &str, value: u8) {
        let image = Image::filled("texture", [4, 4], PixelKind::Gray, value);
        let mut bytes = Vec::new();
        write_png(&image, &mut bytes, Control::none()).unwrap();
        std::fs::create_dir_all(folder.join("tex")).unwrap();
        std::fs::write(folder.join(format!("tex/{name}.png")), bytes).unwrap();
    }

    fn plan(folder: &Path, save: &str) -> Result<Plan, Vec<String>> {
        let text = format!(
            r#"{{"mve": 1, "nodes": {{
            "load": {{"module": "ObjLoader", "params": {{"path": "in.obj"}}}},
            "simplify": {{"module": "Simplificator", "params": {{"ratio": 0.5}}}},
            "save": {{"module": "ObjSaver", "params": {{"path": "{save}"}}}},
            "render": {{"module": "Render", "params": {{"resolution": 16}}}},
            "png": {{"module": "PngSaver", "params": {{"path": "a-textures/b.png"}}}}}},
            "links": ["load.mesh -> simplify.mesh", "simplify.mesh -> save.mesh",
                "load.mesh -> render.mesh", "render.images -> png.images"]}}"#
        );
        let files = FileHashes::new();
        let output = folder.join("out");
        let options = PlanOptions { output_folder: Some(&output), ..plan_options(folder, &files) };
        let found = Plan::new(&Map::parse(&text).unwrap(), &crate::registry(), &options);
        found.map_err(|problems| problems.iter().map(ToString::to_string).collect())
    }

    fn run_in(folder: &Path) -> RunOutcome {
        let cancel = CancelToken::new();
        run(&plan(folder, "b.obj").unwrap(), &run_options(&folder.join("out"), &cancel))
    }

    #[test]
    fn textures_are_declared_recorded_and_pass_through_a_simplification() {
        let folder = textured();
        let writes = plan(folder.path(), "b.obj").unwrap().find("save").unwrap().writes.clone();
        assert_eq!(writes, ["b.obj", "b.mtl", "b-textures"].map(Path::new));
        let outcome = run_in(folder.path());
        assert!(outcome.is_done(), "{:?}", outcome.failures().collect::<Vec<_>>());
        let record = &outcome.nodes["save"].record;
        assert_eq!(record.files, ["b.obj", "b.mtl", "b-textures/skin.png"].map(Path::new));
        assert!(
            record.log.iter().any(|line| format!("{line:?}").contains("tex/gloss.png was not"))
        );
        let load = |name: &str| -> TriMesh {
            obj::load(&folder.path().join(name), Control::none()).unwrap().0
        };
        let (before, after) = (load("in.obj"), load("out/b.obj"));
        assert!(after.faces.len() < before.faces.len());
        assert_eq!(after.materials, before.materials);
        assert!(after.materials[0].texture(TextureRole::BaseColor).unwrap().image.is_some());
    }

    #[test]
    fn a_folder_of_textures_belongs_to_one_saver() {
        let folder = textured();
        let problems = plan(folder.path(), "a.obj").unwrap_err();
        assert!(problems[0].contains("\"a-textures\" as a folder, which"), "{problems:?}");
        let problems = plan(folder.path(), "A.obj").unwrap_err();
        assert!(problems[0].contains("as a folder, which"), "{problems:?}");
    }

    #[test]
    fn editing_a_texture_makes_its_loader_run_again() {
        let folder = textured();
        let key = || plan(folder.path(), "b.obj").unwrap().find("load").unwrap().key;
        let first = key();
        assert_eq!(key(), first);
        paint(folder.path(), "skin", 200);
        let second = key();
        assert_ne!(second, first);
        // The same content as another texture, while the first is missing, is another mesh.
        let tex = folder.path().join("tex");
        std::fs::rename(tex.join("skin.png"), tex.join("gloss.png")).unwrap();
        assert!(key() != second && key() != first);
        std::fs::rename(tex.join("gloss.png"), tex.join("skin.png")).unwrap();
        assert_eq!(key(), second);
    }

    #[cfg(unix)]
    #[test]
    fn links_in_the_folder_of_textures_are_refused() {
        let folder = textured();
        let own = folder.path().join("own.png");
        std::fs::write(&own, "precious").unwrap();
        std::fs::create_dir_all(folder.path().join("out/b-textures")).unwrap();
        let link = folder.path().join("out/b-textures/skin.png");
        std::os::unix::fs::symlink(&own, &link).unwrap();
        let outcome = run_in(folder.path());
        let failures: Vec<_> = outcome.failures().map(|failure| format!("{failure:?}")).collect();
        assert!(failures[0].contains("is a symbolic link"), "{failures:?}");
        assert_eq!(std::fs::read_to_string(&own).unwrap(), "precious");
        assert!(!folder.path().join("out/b.obj").exists());
    }
}
