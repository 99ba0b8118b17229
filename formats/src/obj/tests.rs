//! Small files whose content is known, one error of each kind, and round trips.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, LayerValues, NO_VALUE, TriMesh};
use mve_mesh::data::{Layer, VertexId};

use super::*;

/// Reads text whose material files are not there.
pub(super) fn read(text: impl AsRef<[u8]>) -> Result<(TriMesh, Vec<Warning>), ObjError> {
    let mut no_mtl = |_: &str| Err(io::Error::from(io::ErrorKind::NotFound));
    parse(text.as_ref(), &mut no_mtl, Control::none())
}

/// The text of a mesh.
pub(super) fn written(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_obj(mesh, &mut bytes, None).expect("write");
    bytes
}

fn message(text: impl AsRef<[u8]>) -> String {
    read(text).expect_err("an error").to_string()
}

fn faces(mesh: &TriMesh) -> Vec<[u32; 3]> {
    mesh.faces.iter().map(|f| f.map(|v| v.0)).collect()
}

fn labels<'m>(mesh: &'m TriMesh, name: &str) -> Vec<&'m str> {
    let layer = mesh.layer(name).expect("layer");
    let LayerValues::Label(values) = &layer.values else { panic!("{name} holds no labels") };
    layer.index.iter().map(|&i| values.get(i as usize).map_or("-", String::as_str)).collect()
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn every_way_to_write_a_line() {
    let text = "\u{feff}# comment with a \\\nv 0 0 0\r\nv\t1 0 0# x\r\n  v 1e0 +1. -0.0 1 # w\rv .0 1 0\n\
                s off\nf 1 2 \\\n  3\r\nf -4 -2 \\\r\n -1 #3\n\n f 1 3 4";
    let (mesh, warnings) = read(text).expect("read");
    assert_eq!(warnings, []);
    assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(faces(&mesh), [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    assert_eq!(mesh.layers, []);
}

#[test]
fn corners_in_every_form_keep_the_order_of_the_file() {
    let text = format!(
        "{CORNERS}vt 0.25 0.5\nvt 1\nvt 0 1 0\nvn 0 0 2\nvn 1 0 0\n\
         f 1 2 3\nf 1/3 3/-1 4/1\nf 1//2 2//-2 3//1\nf 1/1/1 2/2/2 3/3/-1\n"
    );
    let (mesh, warnings) = read(text).expect("read");
    assert_eq!(warnings, []);
    let texcoord = mesh.layer(Layer::TEXCOORD).expect("texcoord");
    let expected = vec![DVec2::new(0.25, 0.5), DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0)];
    assert_eq!(texcoord.values, LayerValues::Vec2(expected));
    let none = NO_VALUE;
    assert_eq!(texcoord.index, [none, none, none, 2, 2, 0, none, none, none, 0, 1, 2]);
    let normal = mesh.layer(Layer::NORMAL).expect("normal");
    assert_eq!(normal.values, LayerValues::Vec3(vec![DVec3::new(0.0, 0.0, 2.0), DVec3::X]));
    assert_eq!(normal.index, [none, none, none, none, none, none, 1, 0, 0, 0, 1, 1]);
    assert_eq!((texcoord.domain, mesh.check()), (Domain::Corner, Ok(())));
}

#[test]
fn colors_belong_to_the_vertices_that_have_them() {
    let (mesh, warnings) =
        read("v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0\nv 1 1 0 0 0 1\nf 1 2 3\n").expect("read");
    assert_eq!(warnings, []);
    let color = mesh.layer(Layer::COLOR).expect("color");
    assert_eq!(color.values, LayerValues::Vec3(vec![DVec3::new(1.0, 0.5, 0.0), DVec3::Z]));
    assert_eq!(color.index, [NO_VALUE, 0, NO_VALUE, 1]);
}

#[test]
fn groups_objects_and_materials_hold_until_the_next() {
    let text = format!(
        "{CORNERS}g never used\ng\nf 1 2 3\ng left side\nusemtl metal#2\nf 1 2 3 4\n\
         o thing\ng right\nf 1 2 3\ng left side\nusemtl\nf 1 2 3\n"
    );
    let (mesh, _) = read(&text).expect("read");
    assert_eq!(labels(&mesh, Layer::GROUP), ["-", "left side", "left side", "right", "left side"]);
    assert_eq!(labels(&mesh, Layer::OBJECT), ["-", "-", "-", "thing", "thing"]);
    assert_eq!(labels(&mesh, Layer::MATERIAL), ["-", "metal#2", "metal#2", "metal#2", "-"]);
    assert_eq!(mesh.positions.len(), 4);
    let (again, _) = read(written(&mesh)).expect("read");
    assert_eq!(again, mesh);
}

#[test]
fn faces_may_come_before_their_vertices() {
    let before = read(format!("f 1 2 3\n{CORNERS}f -4 3 -1\nf 5 4 3\nv 2 2 2\n")).expect("read");
    assert_eq!(faces(&before.0), [[0, 1, 2], [0, 2, 3], [4, 3, 2]]);
    assert_eq!(before.1, []);
    let error = message(format!("f 1 2 6\n{CORNERS}v 2 2 2\n"));
    assert_eq!(error, "line 1: found vertex 6, expected 1 to 5, as the file has no more vertices");
}

#[test]
fn what_is_left_out_is_said_once() {
    let text =
        format!("{CORNERS}f 1 2 3\nl 1 2\nl 2 3 4\np 1\ncurv 0 1 \\\n 2 3\nwhat 1\nvt 0 0 1\n");
    let (mesh, warnings) = read(text).expect("read");
    let said: Vec<String> = warnings.iter().map(Warning::to_string).collect();
    assert_eq!(
        said,
        [
            "line 6: lines (`l`) are left out (and 1 more like it)",
            "line 8: points (`p`) are left out",
            "line 9: free-form geometry is left out",
            "line 11: unknown statement `what` is left out",
            "line 12: the third texture coordinate is left out",
        ]
    );
    assert_eq!(faces(&mesh), [[0, 1, 2]]);
}

#[test]
fn errors_name_the_line_and_what_was_expected() {
    let at = |line: &str| message(format!("{CORNERS}# five\n{line}\n"));
    for (line, expected) in [
        ("v 1 2", "line 6: found the end of the line, expected 3 coordinates after `v`"),
        ("v 1 2 z", "line 6: found `z`, expected 3 coordinates after `v`"),
        (
            "v 1,5 2 3",
            "line 6: found `1,5`, expected 3 coordinates after `v`, with a point in place of the \
             comma",
        ),
        ("v 1 nan 3\nf 1 2 5", "line 6: found 1 NaN 3, expected finite numbers within ±1.8e308"),
        ("v 1 1e999 3\nf 1 2 -1", "line 6: found 1 inf 3, expected finite numbers within ±1.8e308"),
        ("v 1 2 3 red", "line 6: found `red`, expected a number or the end of the line"),
        ("vn 1 2", "line 6: found the end of the line, expected 3 numbers after `vn`"),
        ("f 1 2", "line 6: found a face of 2 vertices, expected 3 or more"),
        ("f 1 2 0", "line 6: found vertex 0, expected 1 to 4, as numbers begin at 1"),
        (
            "f 1 2 \\\n5",
            "line 7: found vertex 5, expected 1 to 4, as the file has no more vertices",
        ),
        ("f 1 2 -5", "line 6: found vertex -5, expected one of the vertices above that line"),
        (
            "f 1 2 99999999999999999999",
            "line 6: found vertex 9223372036854775807, expected 1 to 4, as the file has no more vertices",
        ),
        ("f 1 2 a", "line 6: found `a`, expected a corner v, v/vt, v//vn or v/vt/vn"),
        ("f 1 2 3.5", "line 6: found `3.5`, expected a corner v, v/vt, v//vn or v/vt/vn"),
        ("f 1///2 2 3", "line 6: found `1///2`, expected a corner v, v/vt, v//vn or v/vt/vn"),
        ("a\u{7}b 1", "line 6: not an OBJ file, which is text: it holds binary data"),
    ] {
        assert_eq!(at(line), expected, "{line}");
    }
    assert_eq!(message(""), "no vertices: is it an OBJ file?");
    assert_eq!(message("<html>\n"), "no vertices: is it an OBJ file?");
    assert!(message("ply\nformat").contains("PLY"));
    assert!(message("v 0 0 0\n\0\0").contains("binary"));
}

#[test]
fn normals_that_are_no_numbers_are_set_to_zero() {
    let (mesh, warnings) = read(format!("{CORNERS}vn nan 0 1\nf 1//1 2//1 3//1\n")).expect("read");
    assert_eq!(
        mesh.layer(Layer::NORMAL).expect("normal").values,
        LayerValues::Vec3(vec![DVec3::ZERO])
    );
    assert_eq!(warnings[0].to_string(), "line 5: a normal is not finite; it is set to 0");
}

#[test]
fn progress_never_falls_and_cancels() {
    let text = format!("f 1 2 3\n{}", CORNERS.repeat(200_000));
    let mut no_mtl = |_: &str| Err(io::Error::from(io::ErrorKind::NotFound));
    let seen = Mutex::new(Vec::new());
    let report = |part| {
        seen.lock().unwrap().push(part);
        ControlFlow::Continue(())
    };
    parse(text.as_bytes(), &mut no_mtl, Control::new(&report)).expect("read");
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() > 12 && seen.is_sorted() && seen.last() == Some(&1.0), "{seen:?}");
    let n_calls = AtomicUsize::new(0);
    let third = |_| match n_calls.fetch_add(1, Ordering::Relaxed) {
        2 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    let cancelled = parse(text.as_bytes(), &mut no_mtl, Control::new(&third));
    assert!(matches!(cancelled, Err(ObjError::Cancelled)) && n_calls.into_inner() == 3);
}

#[test]
fn files_with_materials_come_back_as_they_were() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("box.obj");
    let mtl = "# ours\nnewmtl red\nKd 1 0 0 # bright\nmap_Kd -s 1 1 1 my picture.png\n\nnewmtl blue\nillum 2\n";
    std::fs::write(folder.path().join("two words.mtl"), mtl).expect("write");
    let text = format!(
        "mtllib two words.mtl\nmtllib .\\gone.mtl\n{CORNERS}usemtl blue\nf 1 2 3\nusemtl x\nf 1 3 4\n"
    );
    std::fs::write(&path, text).expect("write");
    let (mesh, warnings) = load(&path, Control::none()).expect("load");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert_eq!(warnings[0].text, "texture my picture.png is not there");
    assert!(warnings[1].text.contains("./gone.mtl"), "{warnings:?}");
    assert_eq!(mesh.materials[0].statements[0], ("Kd".into(), "1 0 0 # bright".into()));
    assert_eq!(mesh.materials[1].name, "blue");
    let names =
        ["two words.mtl", "my picture.png", "two", "words.mtl", ".\\gone.mtl", "./gone.mtl"];
    assert_eq!(companions(&path), names.map(|name| folder.path().join(name)));

    let copy = folder.path().join("copy.obj");
    save(&mesh, &copy, Control::none()).expect("save");
    let names = ["copy.mtl", "my picture.png"];
    assert_eq!(companions(&copy), names.map(|name| folder.path().join(name)));
    let (again, warnings) = load(&copy, Control::none()).expect("load");
    assert_eq!(again, mesh);
    assert!(warnings[1].text.contains("no material file defines \"x\""), "{warnings:?}");
}

#[test]
fn a_mesh_that_cannot_be_said_leaves_both_files_alone() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a.obj");
    let (mut mesh, _) = read(format!("{CORNERS}f 1 2 3\n")).expect("read");
    mesh.materials.push(Default::default());
    save(&mesh, &path, Control::none()).expect("save");
    let before = std::fs::read(path.with_extension("mtl")).expect("read");
    mesh.materials[0].name = "new".to_owned();
    mesh.positions[1].x = f64::NAN;
    let error = save(&mesh, &path, Control::none()).expect_err("not a number").to_string();
    assert!(error.contains("a.obj: `v` 2 holds NaN"), "{error}");
    assert_eq!(std::fs::read(path.with_extension("mtl")).expect("read"), before);
    mesh.positions[1].x = 0.0;
    let error = save(&mesh, &path.with_extension("mtl"), Control::none())
        .expect_err("one name")
        .to_string();
    assert!(error.contains("name of the material file"), "{error}");
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().expect("folder");
    let load = |path: &std::path::Path| load(path, Control::none());
    let missing = load(&folder.path().join("no.obj")).expect_err("missing").to_string();
    assert!(missing.contains("no.obj") && missing.contains("check its name"), "{missing}");
    let is_folder = load(folder.path()).expect_err("a folder").to_string();
    assert!(is_folder.contains("name a file, not a folder"), "{is_folder}");
    assert_eq!(companions(folder.path()), Vec::<std::path::PathBuf>::new());
}

#[cfg(target_os = "linux")]
#[test]
fn endless_devices_are_refused_and_a_full_disk_is_reported() {
    let error = load("/dev/zero".as_ref(), Control::none()).expect_err("endless");
    assert!(error.to_string().contains("device"), "{error}");
    let (mesh, _) = read(format!("{CORNERS}f 1 2 3\n")).expect("read");
    let mut full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("open");
    let error = write_obj(&mesh, &mut full, None).expect_err("full");
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}

#[test]
fn numbers_read_back_exactly_and_infinite_ones_are_refused() {
    let values = [0.1, -0.0, 1e-310, f64::MAX, f64::MIN_POSITIVE, 1.0 / 3.0, 123456789.0, 1e22];
    let positions = values.iter().map(|&x| DVec3::new(x, -x, x / 7.0)).collect();
    let mut mesh = TriMesh::new(positions, Vec::new());
    let (again, _) = read(written(&mesh)).expect("read");
    let bits = |mesh: &TriMesh| -> Vec<[u64; 3]> {
        mesh.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
    };
    assert_eq!(bits(&again), bits(&mesh));
    assert!(written(&mesh).starts_with(b"v 0.1 -0.1 "));
    mesh.positions.push(DVec3::NAN);
    let error = write_obj(&mesh, &mut io::sink(), None).expect_err("not a number");
    assert_eq!(error.to_string(), "`v` 9 holds NaN, but OBJ has finite numbers only");
    mesh.faces.push([VertexId(77); 3]);
    let error = write_obj(&mesh, &mut io::sink(), None).expect_err("out of range");
    assert!(error.to_string().contains("names vertex 77"), "{error}");
}

#[test]
fn awkward_names_are_written_as_one_name() {
    let (mut mesh, _) = read(format!("{CORNERS}g a\nf 1 2 3\nf 1 3 4\n")).expect("read");
    let mut group = mesh.layer(Layer::GROUP).expect("group").clone();
    group.values = LayerValues::Label(vec![" a\nv 9 9 9 #b\\".to_owned()]);
    mesh.set_layer(group);
    let (again, warnings) = read(written(&mesh)).expect("read");
    assert_eq!((again.positions.len(), warnings.len()), (4, 0));
    assert_eq!(labels(&again, Layer::GROUP), ["a_v 9 9 9 #b\\"; 2]);
    assert_eq!(written(&again), written(&read(written(&again)).expect("read").0));
}

#[test]
fn a_writer_that_fails_midway_fails_the_save() {
    struct Small(usize);
    impl Write for Small {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let (mesh, _) = read(CORNERS.repeat(50_000)).expect("read");
    let error = write_obj(&mesh, &mut Small(1 << 20), None).expect_err("full");
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}
