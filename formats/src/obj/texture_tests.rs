//! Textures: what statements say of them, where their files are found, and round trips.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use mve_core::Control;
use mve_mesh::data::{Image, PixelKind, Texture, TextureImage, TextureRole, TriMesh};

use super::bounds::Bounds;
use super::tests::read;
use super::textures::{Pictures, texture_folder, texture_of};
use super::*;
use crate::png::write_png;

/// A PNG file of one gray value.
pub(super) fn png(value: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let image = Image::filled("texture", [2, 3], PixelKind::Gray, value);
    write_png(&image, &mut bytes, Control::none()).expect("write");
    bytes
}

/// Writes files, each below the folder, and loads `mesh.obj`: a square with materials a and b from
/// `materials`.
fn load_with(
    folder: &Path,
    materials: (&str, &str),
    files: &[(&str, Vec<u8>)],
) -> (TriMesh, Vec<String>) {
    let (library, mtl) = materials;
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let faces = "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/4\n";
    let obj = format!("mtllib {library}\n{corners}{faces}").into_bytes();
    let own = [("mesh.obj", obj), (library, mtl.as_bytes().to_vec())];
    for (name, bytes) in own.iter().chain(files) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("folder");
        fs::write(path, bytes).expect("write");
    }
    let (mesh, warnings) = load(&folder.join("mesh.obj"), Control::none()).expect("load");
    (mesh, warnings.iter().map(Warning::to_string).collect())
}

fn texture(mesh: &TriMesh, material: usize) -> &Texture {
    &mesh.materials[material].textures[0]
}

/// The gray value of a material's first texture.
fn gray(mesh: &TriMesh, material: usize) -> u8 {
    texture(mesh, material).image.as_ref().expect("a picture").pixels().expect("pixels").bytes[0]
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("folder");
    let name = |entry: io::Result<fs::DirEntry>| entry.expect("entry").file_name();
    let mut names: Vec<String> =
        entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn names_stand_behind_options_and_may_have_blanks() {
    let cases = [
        ("wood.png", "wood.png"),
        ("my wood.png", "my wood.png"),
        ("-s 1 1 1 my picture.png", "my picture.png"),
        ("-clamp on -o 0.5 -mm 0 1 a.png", "a.png"),
        ("-s 2 2 2.png", "2.png"),
        ("-s 1 2 3 4", "4"),
        ("-s 1 2", "2"),
        ("-bm  0.5\t7", "7"),
        ("-imfchan r -blendu off -cc on -texres 512 -type sphere C:\\a b\\c.jpg", "C:\\a b\\c.jpg"),
        ("-1.png", "-1.png"),
        ("-bm", "-bm"),
    ];
    for (text, name) in cases {
        let texture = texture_of("map_Kd", text, 0).expect(text);
        assert_eq!(texture.name, name, "{text}");
        assert_eq!(format!("{}{}", texture.options, texture.name), text);
    }
    assert_eq!(texture_of("map_Kd", "", 0), None);
    let roles = [
        ("MAP_KD", Some(TextureRole::BaseColor)),
        ("map_Bump", Some(TextureRole::Bump)),
        ("norm", Some(TextureRole::Normal)),
        ("map_Pr", Some(TextureRole::Roughness)),
        ("map_RMA", Some(TextureRole::Other)),
        ("map_aat", None),
        ("Kd", None),
    ];
    for (keyword, role) in roles {
        let texture = texture_of(keyword, "a.png", 0);
        assert_eq!(texture.map(|texture| texture.role), role, "{keyword}");
    }
}

#[test]
fn material_files_come_back_word_for_word() {
    let text = "newmtl a\nKd 1 0 0 # red\nmap_Kd -s 2 2 1  C:\\x\\my wood.png\nillum 2\nfoo bar\n\
                bump -bm 0.5 b.png\nNORM n.tga # from b\n\nnewmtl b\nmap_d a.png\nNs 10\n";
    let (materials, warnings) = parse_mtl(text.as_bytes());
    assert_eq!(warnings, []);
    let wood = materials[0].texture(TextureRole::BaseColor).expect("a texture");
    assert_eq!((wood.name.as_str(), wood.options.as_str()), ("C:\\x\\my wood.png", "-s 2 2 1  "));
    let mut written = Vec::new();
    write_mtl(&materials, &mut written).expect("write");
    assert_eq!(String::from_utf8(written).expect("text"), text);
}

#[test]
fn textures_are_saved_beside_the_mesh_byte_for_byte() {
    for (library, file) in [("in.mtl", "tex/skin.png"), ("sub/mat/in.mtl", "sub/mat/tex/skin.png")]
    {
        let folder = tempfile::tempdir().expect("folder");
        let (from, to) = (folder.path().join("from"), folder.path().join("to"));
        let mtl = "newmtl a\nKd 1 1 1\nmap_Kd -clamp on tex/skin.png\nNs 2\n\nnewmtl b\nKd 0 0 1\n";
        let (mesh, warnings) = load_with(&from, (library, mtl), &[(file, png(77))]);
        assert_eq!((warnings, gray(&mesh, 0)), (Vec::new(), 77));
        fs::create_dir(&to).expect("folder");
        save(&mesh, &to.join("my out.obj"), Control::none()).expect("save");
        assert_eq!(names_in(&to), ["my out-textures", "my out.mtl", "my out.obj"]);
        assert_eq!(fs::read(to.join("my out-textures/skin.png")).expect("read"), png(77));
        let text = fs::read_to_string(to.join("my out.mtl")).expect("read");
        assert_eq!(text, mtl.replace("tex/skin.png", "my out-textures/skin.png"));
        let (again, warnings) = load(&to.join("my out.obj"), Control::none()).expect("load");
        assert_eq!((again, warnings), (mesh, Vec::new()));
    }
}

#[test]
fn files_are_found_whatever_surrounds_their_names() {
    let names = [
        "tex\\skin.png",
        "./tex/skin.png",
        "\"tex/skin.png\"",
        "\"tex\\skin.png\" # brown",
        "tex/skin.png # brown",
        "tex/skin.png -bm 0.5",
    ];
    for name in names {
        let folder = tempfile::tempdir().expect("folder");
        let mtl = format!("newmtl a\nmap_Kd {name}\nnewmtl b\n");
        let (mesh, warnings) =
            load_with(folder.path(), ("in.mtl", &mtl), &[("tex/skin.png", png(5))]);
        assert_eq!((warnings, gray(&mesh, 0)), (Vec::new(), 5), "{name}");
        assert_eq!(texture(&mesh, 0).name, "skin.png");
    }
    // As it is written comes first.
    let folder = tempfile::tempdir().expect("folder");
    let files = [("a.png # 2", png(6)), ("a.png", png(5))];
    let mtl = "newmtl a\nmap_Kd a.png # 2\nnewmtl b\n";
    assert_eq!(gray(&load_with(folder.path(), ("in.mtl", mtl), &files).0, 0), 6);
}

#[test]
fn paths_of_other_machines_are_looked_for_beside_the_material_file() {
    for name in ["C:\\old work\\skin.png", "/nowhere/at all/skin.png", "../gone/skin.png"] {
        let folder = tempfile::tempdir().expect("folder");
        let mtl = format!("newmtl a\nmap_Kd {name}\nnewmtl b\n");
        let files = [("mat/skin.png", png(5)), ("skin.png", png(6))];
        let (mesh, warnings) = load_with(folder.path(), ("mat/in.mtl", &mtl), &files);
        assert_eq!((gray(&mesh, 0), warnings.len()), (5, 1));
        let [said] = warnings.as_slice() else { panic!("{warnings:?}") };
        assert!(said.starts_with(&format!("texture {name} is not there; ")), "{said}");
        assert!(said.ends_with("skin.png is taken") && said.contains("mat"), "{said}");
    }
    // An absolute path that leads to a file is taken where that is allowed.
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("away.png");
    fs::write(&path, png(9)).expect("write");
    let mtl = format!("newmtl a\nmap_Kd {}\nnewmtl b\n", path.display());
    let inner = folder.path().join("in");
    let (mesh, warnings) = load_with(&inner, ("in.mtl", &mtl), &[]);
    assert_eq!(texture(&mesh, 0).image, None);
    assert!(warnings[0].contains("lies outside of the folder of the mesh"), "{warnings:?}");
    let loaded = load_within(&inner.join("mesh.obj"), FileScope::Anywhere, Control::none());
    let (mesh, warnings) = loaded.expect("load");
    assert_eq!((gray(&mesh, 0), warnings), (9, Vec::new()));
    assert!(companions(&inner.join("mesh.obj")).contains(&path));
}

#[test]
fn broken_and_missing_pictures_are_named_and_keep_their_statements() {
    let folder = tempfile::tempdir().expect("folder");
    let mtl = "newmtl a\nmap_Kd -s 2 2 text.png\nmap_Ks tex/gone.png\nmap_Ke cut.png\n\
               map_d folder\n\n\
               newmtl b\nmap_Kd text.png\n";
    let files = [
        ("text.png", b"no picture".to_vec()),
        ("cut.png", png(5)[..20].to_vec()),
        ("folder/a.png", png(5)),
    ];
    let (mesh, warnings) = load_with(folder.path(), ("in.mtl", mtl), &files);
    let said = [
        "texture text.png is neither a PNG nor a JPEG file; it is kept as it is",
        "texture tex/gone.png is not there",
        "texture cut.png is no picture that can be read: ",
        "texture folder is not there",
    ];
    assert_eq!(warnings.len(), said.len(), "{warnings:?}");
    assert!(warnings.iter().zip(said).all(|(found, said)| found.starts_with(said)), "{warnings:?}");
    let out = folder.path().join("out.obj");
    save(&mesh, &out, Control::none()).expect("save");
    let written = fs::read_to_string(out.with_extension("mtl")).expect("read");
    assert_eq!(written.replace("out-textures/", ""), mtl);
    let kept = folder.path().join("out-textures");
    assert_eq!(names_in(&kept), ["cut.png", "text.png"]);
    assert_eq!(fs::read(kept.join("text.png")).expect("read"), b"no picture");
    assert_eq!(load(&out, Control::none()).expect("load").0, mesh);
}

#[test]
fn pictures_of_one_name_get_numbers_and_those_of_one_file_are_one() {
    let folder = tempfile::tempdir().expect("folder");
    let mtl = "newmtl a\nmap_Kd x/skin.png\nmap_Ka -s 1 1 1 x/skin.png\nmap_Ks skin-2.png\n\n\
               newmtl b\nmap_Kd y/SKIN.png\nmap_Ke ./x\\skin.png\n";
    let files =
        [("x/skin.png", png(1)), ("y/SKIN.png", png(2)), ("skin-2.png", png(3)), ("z.png", png(4))];
    let (mesh, _) = load_with(folder.path(), ("in.mtl", mtl), &files);
    let image = |m: usize, t: usize| mesh.materials[m].textures[t].image.as_ref().expect("read");
    assert!(Arc::ptr_eq(image(0, 0), image(0, 1)) && !Arc::ptr_eq(image(0, 0), image(1, 0)));
    let out = folder.path().join("out.obj");
    save(&mesh, &out, Control::none()).expect("save");
    let names = ["SKIN-3.png", "skin-2.png", "skin.png"];
    let found = names_in(&folder.path().join("out-textures"));
    assert!(found.len() >= 3 && names.iter().all(|name| found.contains(&(*name).to_owned())));
    let (again, warnings) = load(&out, Control::none()).expect("load");
    assert_eq!((warnings, gray(&again, 0), gray(&again, 1)), (Vec::new(), 1, 2));
    // From here on nothing changes.
    let third = folder.path().join("third/out.obj");
    fs::create_dir(folder.path().join("third")).expect("folder");
    save(&again, &third, Control::none()).expect("save");
    assert_eq!(load(&third, Control::none()).expect("load").0, again);
}

#[test]
fn a_picture_that_was_made_is_saved_as_png() {
    let folder = tempfile::tempdir().expect("folder");
    let mtl = "newmtl a\nmap_Kd skin.jpg\nnewmtl b\n";
    let (mut mesh, _) = load_with(folder.path(), ("in.mtl", mtl), &[("skin.jpg", png(1))]);
    let pixels = Image::filled("texture", [3, 5], PixelKind::Rgb, 200);
    mesh.materials[0].textures[0].image = Some(Arc::new(TextureImage::new(pixels.clone())));
    let out = folder.path().join("out.obj");
    save(&mesh, &out, Control::none()).expect("save");
    assert_eq!(names_in(&folder.path().join("out-textures")), ["skin.jpg.png"]);
    let (again, _) = load(&out, Control::none()).expect("load");
    assert_eq!(texture(&again, 0).image.as_ref().expect("read").pixels(), Some(&pixels));
}

/// The names of the files that pictures of these names get, read from such a file or made.
fn names_of_files(names: &[&str], encoded: Option<&[u8]>) -> Vec<String> {
    let material = |name: &&str| {
        let mut texture = texture_of("map_Kd", "a", 0).expect("a texture");
        let pixels = Image::filled("texture", [1, 1], PixelKind::Gray, 0);
        texture.name = (*name).to_owned();
        texture.image = Some(Arc::new(match encoded {
            Some(bytes) => TextureImage::of_file(pixels, bytes.to_vec()),
            None => TextureImage::new(pixels),
        }));
        Material { textures: vec![texture], ..Material::default() }
    };
    let materials: Vec<Material> = names.iter().map(material).collect();
    texture_folder(&materials, "t").files.into_iter().map(|(name, _)| name).collect()
}

#[test]
fn names_that_are_too_long_are_cut_before_their_extension() {
    // 255 bytes; a number does not fit, nor a half of the last letter.
    let long = "é".repeat(125) + "a.png";
    let numbered = "é".repeat(124) + "-2.png";
    assert_eq!(names_of_files(&[&long, &long], Some(b"")), [long.clone(), numbered.clone()]);
    let made = names_of_files(&[&"x".repeat(300), &("y.".to_owned() + &"z".repeat(300))], None);
    assert_eq!(made, ["x".repeat(251) + ".png", "y.".to_owned() + &"z".repeat(249) + ".png"]);
    assert_eq!(names_of_files(&[&("x".repeat(254) + " y")], Some(b"")), ["x".repeat(254)]);
    let folder = tempfile::tempdir().expect("folder");
    let mtl = format!("newmtl a\nmap_Kd x/{long}\n\nnewmtl b\nmap_Kd y/{long}\n");
    let files = [(format!("x/{long}"), png(1)), (format!("y/{long}"), png(2))];
    let files = files.each_ref().map(|(name, bytes)| (name.as_str(), bytes.clone()));
    let (mesh, _) = load_with(folder.path(), ("in.mtl", &mtl), &files);
    let out = folder.path().join("out.obj");
    save(&mesh, &out, Control::none()).expect("save");
    let (again, warnings) = load(&out, Control::none()).expect("load");
    assert_eq!((warnings, gray(&again, 0), gray(&again, 1)), (Vec::new(), 1, 2));
    assert_eq!([texture(&again, 0), texture(&again, 1)].map(|t| &t.name), [&long, &numbered]);
}

#[test]
fn names_of_devices_are_changed() {
    let names = ["CON.png", "aux.old.png", "Com1 .png", "LPT².png", "console.png", "com10.png"];
    let expected =
        ["_CON.png", "_aux.old.png", "_Com1 .png", "_LPT².png", "console.png", "com10.png"];
    assert_eq!(names_of_files(&names, Some(b"")), expected);
}

#[test]
fn names_that_look_like_options_and_comments_come_back() {
    for name in ["-s 1 b.obj", " b.obj", "a #1.obj", "#1.obj", "a -s 1.obj"] {
        let folder = tempfile::tempdir().expect("folder");
        let mtl = "newmtl a\nmap_Kd ./-s 1 c.png\n\nnewmtl b\nmap_Kd a #1.png\n";
        let files = [("-s 1 c.png", png(1)), ("a #1.png", png(2)), ("a", png(3))];
        let (mesh, warnings) = load_with(folder.path(), ("in.mtl", mtl), &files);
        assert_eq!((warnings, gray(&mesh, 0), gray(&mesh, 1)), (Vec::new(), 1, 2));
        let out = folder.path().join("out");
        fs::create_dir(&out).expect("folder");
        save(&mesh, &out.join(name), Control::none()).expect("save");
        let (again, warnings) = load(&out.join(name), Control::none()).expect("load");
        assert_eq!((&again, warnings), (&mesh, Vec::new()), "{name}");
        assert_eq!(texture(&again, 0).name, "-s 1 c.png");
        assert_eq!(companions(&out.join(name)).iter().filter(|path| path.is_file()).count(), 3);
    }
}

#[test]
fn files_count_beside_pixels() {
    let folder = tempfile::tempdir().expect("folder");
    let (first, second) = (png(1), png(2));
    // Each has 2 × 3 pixels of a byte.
    let n_bytes = (first.len() + second.len() + 2 * 6) as u64;
    fs::write(folder.path().join("a.png"), first).expect("write");
    fs::write(folder.path().join("b.png"), second).expect("write");
    for (n_most, said) in [(n_bytes, &[][..]), (n_bytes - 1, &["b.png is too large together"])] {
        let mut materials = parse_mtl(b"newmtl a\nmap_Kd a.png\nmap_Ks b.png\n").0;
        let mut warnings = Warnings::default();
        let folders = [folder.path().to_owned()];
        let mut pictures = Pictures::of_at_most(n_most);
        let bounds = Bounds::new(folder.path(), FileScope::Folder);
        let control = Control::none();
        pictures.read_all(&mut materials, &folders, &bounds, &mut warnings, control);
        let warnings = warnings.into_list();
        assert_eq!(warnings.len(), said.len(), "{warnings:?}");
        assert!(warnings.iter().zip(said).all(|(found, said)| found.text.contains(said)));
    }
}

#[test]
fn names_in_latin_1_are_read_and_found() {
    let mut names = vec![std::ffi::OsString::from("häuser.png")];
    // As the system that wrote the material file had it. Other systems than Linux refuse it.
    #[cfg(target_os = "linux")]
    names.push(std::os::unix::ffi::OsStringExt::from_vec(b"h\xe4user.png".to_vec()));
    for name in names {
        let folder = tempfile::tempdir().expect("folder");
        load_with(folder.path(), ("in.mtl", ""), &[]);
        fs::write(folder.path().join("in.mtl"), b"newmtl a\nmap_Kd h\xe4user.png\nnewmtl b\n")
            .expect("write");
        fs::write(folder.path().join(&name), png(5)).expect("write");
        let path = folder.path().join("mesh.obj");
        assert!(companions(&path).contains(&folder.path().join(&name)));
        let (mesh, warnings) = load(&path, Control::none()).expect("load");
        assert_eq!((warnings, gray(&mesh, 0)), (Vec::new(), 5));
        assert_eq!(mve_mesh::data::name_to_file(&texture(&mesh, 0).name), name);
        let out = folder.path().join("out.obj");
        save(&mesh, &out, Control::none()).expect("save");
        assert!(folder.path().join("out-textures").join(&name).is_file());
        assert_eq!(load(&out, Control::none()).expect("load").0, mesh);
    }
}

#[test]
fn textures_may_be_named_where_they_lie() {
    let folder = tempfile::tempdir().expect("folder");
    let mtl = "newmtl a\nmap_Kd -s 2 2 tex/skin.png\n\nnewmtl b\nmap_Kd gone.png\n";
    let (mesh, _) = load_with(folder.path(), ("in.mtl", mtl), &[("tex/skin.png", png(5))]);
    let out = folder.path().join("out/a/out.obj");
    fs::create_dir_all(out.parent().expect("a folder")).expect("folder");
    save_naming(&mesh, &out, "../../tex", Control::none()).expect("save");
    let text = fs::read_to_string(out.with_extension("mtl")).expect("read");
    assert_eq!(text, mtl.replace("tex/skin.png", "../../tex/skin.png"));
    assert!(!out.with_file_name("out-textures").exists());
    let (again, _) = load_within(&out, FileScope::Anywhere, Control::none()).expect("load");
    assert_eq!(gray(&again, 0), 5);
}

#[test]
fn companions_are_material_files_and_their_pictures() {
    let folder = tempfile::tempdir().expect("folder");
    let mtl = "newmtl a\nmap_Kd C:\\old\\skin.png\nmap_Ks gone.png\nnewmtl b\nmap_Kd skin.png\n";
    load_with(folder.path(), ("mat/in.mtl", mtl), &[("skin.png", png(1))]);
    let found = companions(&folder.path().join("mesh.obj"));
    let names = ["mat/in.mtl", "skin.png", "mat/gone.png"];
    assert_eq!(found, names.map(|name| folder.path().join(name)));
}

#[test]
fn a_cancel_is_heard_before_the_pictures() {
    let folder = tempfile::tempdir().expect("folder");
    let mtl = "newmtl a\nmap_Kd skin.png\nnewmtl b\n";
    let (mesh, _) = load_with(folder.path(), ("in.mtl", mtl), &[("skin.png", png(1))]);
    let report = |_| std::ops::ControlFlow::Break(());
    let error = save(&mesh, &folder.path().join("out.obj"), Control::new(&report));
    assert!(error.expect_err("cancelled").is_cancelled());
    assert!(!folder.path().join("out-textures").exists());
    assert!(read("v 0 0 0\n").is_ok());
}
