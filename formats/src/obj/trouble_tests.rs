//! Files with a fault here and there, and names and numbers as old programs write them.

use std::fs;
use std::path::Path;

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{Layer, LayerValues, NO_VALUE, TriMesh, name_from_bytes, name_to_bytes};

use super::tests::{read, written};
use super::*;

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn said(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(Warning::to_string).collect()
}

/// The bytes of the names of a layer.
fn names(mesh: &TriMesh, layer: &str) -> Vec<Vec<u8>> {
    let Some(Layer { values: LayerValues::Label(names), .. }) = mesh.layer(layer) else {
        return Vec::new();
    };
    names.iter().map(|name| name_to_bytes(name).into_owned()).collect()
}

fn load_from(folder: &Path, files: &[(&[u8], &[u8])]) -> (TriMesh, Vec<String>) {
    for (name, bytes) in files {
        let path = folder.join(mve_mesh::data::name_to_file(&name_from_bytes(name)));
        fs::create_dir_all(path.parent().expect("a folder")).expect("folder");
        fs::write(path, bytes).expect("write");
    }
    let (mesh, warnings) = load(&folder.join("in.obj"), Control::none()).expect("load");
    (mesh, said(&warnings))
}

#[test]
fn numbers_that_are_none_are_never_smaller_ones() {
    let spellings = [
        "1.#INF",
        "-1.#INF",
        "1.#INF00",
        "1.#IND",
        "-1.#IND",
        "1.#QNAN",
        "1.#SNAN0",
        "1.#J",
        "1.#R",
        "1.#IO",
        "1.$",
        "nan",
        "NaN",
        "-nan(ind)",
        "nan(0x7fffff)",
        "NaNQ",
        "QNAN",
        "inf",
        "-Inf",
        "INFINITY",
        "+inf.0",
        "+nan.0",
        "1e999",
        "*****",
        "\u{221e}",
    ];
    for spelling in spellings {
        let used = format!("{CORNERS}v 1 {spelling} 0\nf 1 2 5\n");
        let error = read(used).expect_err(spelling).to_string();
        assert!(error.starts_with("line 5: found 1 ") && error.contains("finite"), "{error}");
        let others = format!(
            "{CORNERS}v {spelling} 0 0\nvn 0 {spelling} 1\nvt {spelling} 0\n\
             v 0 0 9 1 1 {spelling}\nf 1 2 3\nf 2 6 3\n"
        );
        let (mesh, warnings) = read(others).expect(spelling);
        assert_eq!(
            said(&warnings),
            [
                "line 6: a normal is not finite; it is set to 0",
                "line 7: a texture coordinate is not finite; it is set to 0",
                "line 8: a color is not finite; its vertex has none",
                "line 5: a vertex is not finite; as no face uses it, it is set to 0",
            ]
        );
        assert_eq!((mesh.positions[4], mesh.layer(Layer::COLOR)), (DVec3::ZERO, None));
    }
}

#[test]
fn exponents_of_fortran_and_glued_comments_are_read() {
    let (mesh, warnings) = read("v 1d0 2.5D+01 -1.5q-2\nv 1.25-103 0 1.#\nv 1 2 3#INF\n").unwrap();
    let expected = [[1.0, 25.0, -0.015], [1.25e-103, 0.0, 1.0], [1.0, 2.0, 3.0]];
    assert_eq!(mesh.positions, expected.map(DVec3::from_array));
    assert_eq!(said(&warnings), ["the file has vertices but no faces"]);
    for word in ["1d", "d5", "1dd5", "1.5--103", "15-103", "1.5-3", "0x1p3", "nul", "1e", "-"] {
        let error = read(format!("v {word} x 0\n")).expect_err(word).to_string();
        assert!(error.starts_with("line 1: found `"), "{word}: {error}");
    }
}

#[test]
fn a_bad_number_in_a_face_spoils_that_face_alone() {
    let (mesh, warnings) = read(format!(
        "{CORNERS}vt 0 0\nvn 0 0 1\nf 1/1/0 2/1/1 3/7/-2\nf 1/1/1 3/1/1 4/1/0\nf 1 2 9\nf 1 2\n\
         f 0 1 2\nf 1 2 3.5\nf 4 3 2\n"
    ))
    .unwrap();
    assert_eq!(
        said(&warnings),
        [
            "line 9: found vertex 9, expected 1 to 4, as the file has no more vertices; the face is \
             left out (and 3 more like it)",
            "line 7: found texture coordinate 7, expected 1 to 1, as the file has no more texture \
             coordinates; the corner has no texture coordinate",
            "line 7: found normal 0, expected 1 to 1, as numbers begin at 1; the corner has no \
             normal (and 1 more like it)",
        ]
    );
    assert_eq!((mesh.faces.len(), mesh.area()), (3, 1.5));
    let normal = mesh.layer(Layer::NORMAL).unwrap();
    assert_eq!(normal.index[..6], [NO_VALUE, 0, NO_VALUE, 0, 0, NO_VALUE]);
    let error = read(format!("{CORNERS}f 1 2 9\nf 1 2 8\n")).expect_err("no face").to_string();
    assert!(error.starts_with("line 5: found vertex 9"), "{error}");
}

#[test]
fn colors_have_the_range_that_their_numbers_say() {
    let colors = |of: [&str; 3]| {
        let vertices: String = of.iter().map(|color| format!("v 0 0 0 {color}\n")).collect();
        let (mesh, warnings) = read(format!("{vertices}f 1 2 3\n")).unwrap();
        let values = mesh.layer(Layer::COLOR).unwrap().values.clone();
        let LayerValues::Vec3(values) = values else { panic!("colors") };
        (values, said(&warnings))
    };
    let bytes = "line 1: colors are taken as numbers from 0 to 255";
    let (values, warnings) = colors(["255 0 0", "128 64 0", "0 0 1"]);
    assert_eq!(values[1] * 255.0, DVec3::new(128.0, 64.0, 0.0));
    assert_eq!(warnings, [format!("{bytes} (and 1 more like it)")]);
    assert_eq!(colors(["20.5 0 0", "0 0 0", "0 1 0"]).1, [bytes]);
    assert_eq!(colors(["2 0 0", "0 0 0", "0 1 0"]).1, [bytes]);
    let (values, warnings) = colors(["65535 256 0", "0 0 0", "0 1 0"]);
    assert_eq!((values[0].x, warnings[0].ends_with("65535")), (1.0, true));
    let kept = "line 1: a color lies outside 0 to 1 and is kept as it is";
    for bright in ["1.5 0.5 0", "-1 0 0", "300.5 0 0", "70000 0 0"] {
        assert_eq!(colors([bright, "0 0 0", "0 1 0"]).1, [kept], "{bright}");
    }
    assert_eq!(colors(["1 0 0", "0 0 0", "0 1 0"]).1, [""; 0]);
}

#[test]
fn a_name_is_all_of_its_line() {
    let faces =
        "f 1 2 3\nusemtl Material #26\nf 1 3 4\nusemtl #red\nf 1 2 4\nusemtl # none\nf 2 3 4";
    let (mesh, _) =
        read(format!("{CORNERS}g C:\\temp\\\nusemtl Material #25  \n{faces}\n")).unwrap();
    assert_eq!(names(&mesh, Layer::GROUP), [b"C:\\temp\\"]);
    let materials: [&[u8]; 3] = [b"Material #25", b"Material #26", b"#red"];
    assert_eq!(names(&mesh, Layer::MATERIAL), materials);
    assert_eq!(mesh.layer(Layer::MATERIAL).unwrap().index, [0, 1, 2, NO_VALUE]);
    let (again, warnings) = read(written(&mesh)).unwrap();
    assert_eq!((again, warnings), (mesh, Vec::new()));
}

#[test]
fn backslashes_join_lines_with_and_without_blanks_behind() {
    let text =
        "v 0 0 0\nv 1 0 0\r\nv 1\\\n1 \\ \t\r\n 0\ng one \\ \n two\nf 1\\\r\n2\\ \n3\nf 1 2 3 \\";
    let (mesh, _) = read(text).unwrap();
    assert_eq!((mesh.faces.len(), mesh.area()), (2, 1.0));
    assert_eq!(names(&mesh, Layer::GROUP), [b"one   two"]);
}

#[test]
fn names_keep_their_bytes_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    // Latin-1, GBK, and the Shift-JIS of a character that ends in a backslash.
    let (red, green, sheet): (&[u8], &[u8], &[u8]) = (b"T\xfcr", b"\xc2\xcc\xc9\xab", b"\x95\x5c");
    let parts: [&[u8]; 9] = [
        b"mtllib ",
        sheet,
        b".mtl\n",
        CORNERS.as_bytes(),
        b"usemtl ",
        red,
        b"\nf 1 2 3\nusemtl ",
        sheet,
        b"\nf 1 3 4\n",
    ];
    let mtl: [&[u8]; 7] =
        [b"newmtl ", red, b"\nKd 1 0 0\nnewmtl ", green, b"\nnewmtl ", sheet, b"\nKd 0 1 0\n"];
    let library = [sheet, b".mtl"].concat();
    let files = [(&b"in.obj"[..], &parts.concat()[..]), (&library, &mtl.concat())];
    let (mesh, warnings) = load_from(folder.path(), &files);
    assert_eq!(warnings, [""; 0]);
    assert_eq!(names(&mesh, Layer::MATERIAL), [red, sheet]);
    let path = folder.path().join("out.obj");
    save(&mesh, &path, Control::none()).unwrap();
    let saved = fs::read(path.with_extension("mtl")).unwrap();
    for name in [red, green, sheet] {
        let line = [b"newmtl ", name, b"\n"].concat();
        assert!(saved.windows(line.len()).any(|part| part == line), "{name:?}");
    }
    assert_eq!(load(&path, Control::none()).unwrap().0, mesh);
}

#[test]
fn names_of_material_files_are_put_together_from_words() {
    let folder = tempfile::tempdir().unwrap();
    let in_obj = format!(
        "mtllib a.mtl two  words.mtl gone too.mtl \"my own.mtl\" b.mtl # all\n{CORNERS}f 1 2 3\n"
    );
    let mtl = |name: &str| format!("newmtl {name}\n").into_bytes();
    let files: [(&[u8], &[u8]); 5] = [
        (b"in.obj", in_obj.as_bytes()),
        (b"a.mtl", &mtl("a")),
        (b"two  words.mtl", &mtl("two words")),
        (b"b.mtl", &mtl("b")),
        (b"words.mtl", &mtl("words")),
    ];
    let (mesh, warnings) = load_from(folder.path(), &files);
    let found: Vec<_> = mesh.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(found, ["a", "two words", "b"]);
    assert!(warnings[0].starts_with("material file \"gone too.mtl\" is left out"), "{warnings:?}");
    assert!(warnings[1].contains("\"\"my own.mtl\"\""), "{warnings:?}");
    assert_eq!(warnings.len(), 2);
    let known = companions(&folder.path().join("in.obj"));
    for name in ["two  words.mtl", "gone too.mtl", "words.mtl"] {
        assert!(known.contains(&folder.path().join(name)), "{name}");
    }
}

#[test]
fn comments_behind_names_of_materials_are_seen_by_what_is_defined() {
    let folder = tempfile::tempdir().unwrap();
    let in_obj = format!(
        "mtllib in.mtl # ours\n{CORNERS}usemtl red # left\nf 1 2 3\nusemtl blue\nf 1 3 4\n\
         usemtl red\nf 1 2 4\n"
    );
    let mtl = b"newmtl red\nKd 1 0 0\nnewmtl blue # right\nKd 0 0 1\n";
    let files: [(&[u8], &[u8]); 2] = [(b"in.obj", in_obj.as_bytes()), (b"in.mtl", mtl)];
    let (mesh, warnings) = load_from(folder.path(), &files);
    assert_eq!(warnings, [""; 0]);
    assert_eq!(names(&mesh, Layer::MATERIAL), [b"red".to_vec(), b"blue # right".to_vec()]);
    assert_eq!(mesh.layer(Layer::MATERIAL).unwrap().index, [0, 1, 0]);
}

#[test]
fn files_outside_of_the_folder_are_not_read_and_not_quoted() {
    let folder = tempfile::tempdir().unwrap();
    let below = folder.path().join("below");
    let in_obj = format!("mtllib ../secret.mtl\nmtllib notes.txt\n{CORNERS}f 1 2 3\n");
    let files: [(&[u8], &[u8]); 3] = [
        (b"in.obj", in_obj.as_bytes()),
        (b"../secret.mtl", b"newmtl a\nKd 1 1 1\n"),
        (b"notes.txt", b"root:x:0:0\nsecret\n"),
    ];
    fs::create_dir(&below).unwrap();
    let (mesh, warnings) = load_from(&below, &files);
    assert_eq!(mesh.materials, []);
    assert!(warnings[0].contains("lies outside of the folder of the mesh"), "{warnings:?}");
    assert_eq!(warnings[1], "notes.txt, it defines no material: is it an MTL file?");
    assert_eq!(warnings.len(), 2);
    let all = load_within(&below.join("in.obj"), FileScope::Anywhere, Control::none()).unwrap();
    assert_eq!(all.0.materials[0].name, "a");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../secret.mtl", below.join("link.mtl")).unwrap();
        let in_obj = in_obj.replace("../secret.mtl", "link.mtl");
        let (_, warnings) = load_from(&below, &[(b"in.obj", in_obj.as_bytes())]);
        assert!(warnings[0].contains("lies outside of the folder of the mesh"), "{warnings:?}");
    }
}

#[test]
fn smoothing_groups_are_kept() {
    let faces = "f 1 2 3\ns 1\nf 1 3 4\ns off\nf 1 2 4\ns 2\nf 2 3 4\ns 0\nf 1 2 3\n";
    let (mesh, warnings) = read(format!("{CORNERS}{faces}")).unwrap();
    assert_eq!(warnings, []);
    let layer = mesh.layer(Layer::SMOOTHING).unwrap();
    assert_eq!(layer.values, LayerValues::Label(vec!["1".into(), "2".into()]));
    assert_eq!(layer.index, [NO_VALUE, 0, NO_VALUE, 1, NO_VALUE]);
    let text = String::from_utf8(written(&mesh)).unwrap();
    assert!(text.ends_with(&faces.replace("s 0", "s off")), "{text}");
    assert_eq!(read(format!("{CORNERS}s off\nf 1 2 3\n")).unwrap().0.layers, []);
}
