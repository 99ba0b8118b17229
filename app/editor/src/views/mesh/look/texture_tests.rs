//! Tests of what materials say of textures, and of files that are not as they should be.

use image::Rgba;
use mve_modules::mesh::fixtures::tetrahedron;

use super::*;

fn textured(statements: &[(&str, &str)]) -> TriMesh {
    let mut mesh = tetrahedron();
    let material = |(name, text): &(&str, &str)| Material {
        name: (*name).to_owned(),
        statements: vec![("map_Kd".to_owned(), (*text).to_owned())],
    };
    mesh.materials = statements.iter().map(material).collect();
    let mut names: Vec<String> = mesh.materials.iter().map(|m| m.name.clone()).collect();
    names.push("plain".to_owned());
    let last = names.len() as u32 - 1;
    mesh.set_layer(Layer {
        name: Layer::MATERIAL.to_owned(),
        domain: Domain::Face,
        values: LayerValues::Label(names),
        index: (0..4).map(|face| face.min(last)).collect(),
    });
    mesh
}

#[test]
fn names_stand_after_options_and_may_have_blanks() {
    let cases = [
        ("wood.png", "wood.png"),
        ("  my wood.png ", "my wood.png"),
        ("-s 1 1 1 my picture.png", "my picture.png"),
        ("-clamp on -o 0.5 -mm 0 1 a.png", "a.png"),
        ("-s 2 2 2.png", "2.png"),
        ("-bm 0.5 7", "7"),
        ("", ""),
    ];
    for (text, name) in cases {
        assert_eq!(without_options(text), name, "{text}");
    }
}

#[test]
fn faces_have_the_texture_of_their_material() {
    let mesh = textured(&[("a", "x.png"), ("b", "y.png"), ("c", "-clamp on x.png")]);
    let files = TextureFiles::of(&mesh);
    assert_eq!(files.names, ["x.png", "y.png"]);
    let of_faces = [0, 1, 2, 3, 4].map(|face| files.of_face(face));
    assert_eq!(of_faces, [Some(0), Some(1), Some(0), None, None]);
    assert_eq!(TextureFiles::of(&tetrahedron()).names, [""; 0]);
}

#[test]
fn files_are_found_beside_the_mesh_and_brought_to_one_size() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, side: u32, color: [u8; 4]| {
        RgbaImage::from_pixel(side, side, Rgba(color)).save(folder.path().join(name)).unwrap();
    };
    save("x.png", 8, [200, 10, 10, 255]);
    save("y.png", 2, [10, 200, 10, 255]);
    let mesh = Arc::new(textured(&[("a", "C:\\old\\x.png"), ("b", "y.png # green")]));
    let folders = [folder.path().join("elsewhere"), folder.path().to_owned()];
    let made = pictures(&files_of(&mesh, &folders), 4).unwrap();
    assert_eq!((made.size, made.problem, made.layers.len()), ([4, 4], None, 2));
    assert_eq!(made.layers[0].get_pixel(3, 3).0, [200, 10, 10, 255]);
    assert_eq!(made.layers[1].get_pixel(0, 3).0, [10, 200, 10, 255]);
}

#[test]
fn what_is_wrong_with_a_file_is_said_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("text.png"), "no picture").unwrap();
    std::fs::write(folder.path().join("text.bin"), "no picture").unwrap();
    std::fs::write(folder.path().join("cut.png"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap();
    std::fs::create_dir(folder.path().join("folder.png")).unwrap();
    let of = |names: &[(&str, &str)], folders: &[PathBuf]| {
        pictures(&files_of(&Arc::new(textured(names)), folders), 64)
    };
    let here = [folder.path().to_owned()];
    let cases = [
        ("gone.png", "texture gone.png is not there"),
        ("folder.png", "texture folder.png is not there"),
        ("text.png", "texture text.png is no picture"),
        ("text.bin", "texture text.bin is neither a PNG nor a JPEG file"),
        ("cut.png", "texture cut.png cannot be read"),
    ];
    for (name, message) in cases {
        let found = of(&[("a", name)], &here).unwrap_err();
        assert!(found.starts_with(message) && !found.contains('\n'), "{found}");
    }
    assert!(of(&[("a", "x.png")], &[]).unwrap_err().contains("not known which folder"));
    RgbaImage::new(2, 2).save(folder.path().join("good.png")).unwrap();
    let made = of(&[("a", "gone.png"), ("b", "good.png")], &here).unwrap();
    assert_eq!((made.layers.len(), made.problem.unwrap().as_str()), (2, cases[0].1));
}

#[test]
fn smaller_versions_end_in_a_pixel() {
    let sizes: Vec<_> = smaller(&RgbaImage::new(10, 3)).iter().map(|s| s.dimensions()).collect();
    assert_eq!(sizes, [(5, 1), (2, 1), (1, 1)]);
}
