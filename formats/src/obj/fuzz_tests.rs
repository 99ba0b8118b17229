//! Noise: whatever the bytes, reading ends soon, with a sound mesh or an error.

use proptest::prelude::*;

use super::tests::{read, written};
use super::*;

/// Files that use everything the reader knows.
const SEEDS: [&str; 4] = [
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3//1\nf -4 -3 -2 -1\n",
    "mtllib a b.mtl\r\no x\r\ng y z\r\nusemtl m\r\nv 1e1 -2.5 .5 1 0 0.5\r\nv 0 0 1\r\nv 0 1 0 1\r\nf 1 2 3\r\nusemtl\r\n",
    "f 1 2 3 4 5 6\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 1 0\nv 0 2 0\nv 0 1 0\ncurv 1 \\\n 2\nl 1 2\n# end\\\n",
    "\u{feff}v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 \\\r 2 3 # c\rvp 1\rs off\rfoo bar\r",
];

/// What must hold of any input.
fn assert_stood(bytes: &[u8]) {
    match read(bytes) {
        Ok((mesh, warnings)) => {
            assert_eq!(mesh.check(), Ok(()));
            assert!(mesh.positions.iter().all(|p| p.is_finite()));
            assert!(warnings.len() <= Warnings::MOST);
            let text = written(&mesh);
            let (again, _) = read(&text).expect("what was written can be read");
            assert_eq!(again.positions, mesh.positions);
            assert_eq!(again.faces, mesh.faces);
            assert_eq!(again.layers, mesh.layers);
            assert_eq!(written(&again), text);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    parse_mtl(bytes);
}

/// Every byte of every seed replaced, left out and doubled, by bytes that mean something.
#[test]
fn every_single_change_is_stood() {
    const BYTES: &[u8] = b"\0\t\n\r \"#+-./059\\efglnotuvx\x80\xff";
    for seed in SEEDS {
        let bytes = seed.as_bytes();
        assert_stood(bytes);
        for i in 0..bytes.len() {
            assert_stood(&bytes[..i]);
            let mut shorter = bytes.to_vec();
            shorter.remove(i);
            assert_stood(&shorter);
            for &byte in BYTES {
                let mut changed = bytes.to_vec();
                changed[i] = byte;
                assert_stood(&changed);
                changed.insert(i, bytes[i]);
                assert_stood(&changed);
            }
        }
    }
}

#[test]
fn long_lines_and_large_polygons_end_soon() {
    let circle: String = (0..3000)
        .map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / 3000.0;
            format!("v {} {} {}\n", angle.cos(), angle.sin(), f64::from(i % 7))
        })
        .collect();
    let all: String = (1..=3000).map(|i| format!(" {i}")).collect();
    let (mesh, _) = read(format!("{circle}f{all}\n")).expect("read");
    assert_eq!(mesh.faces.len(), 2998);
    let digits = "1".repeat(1 << 20);
    let error = read(format!("v {digits} 0 0\nf 1 1 1\n")).expect_err("too large").to_string();
    assert!(error.len() < 200, "{error}");
    read(format!("v 0.{digits} 0 0\n#{digits}\\\n{}", " \\\n".repeat(1 << 18))).expect("read");
    let error = read(digits).expect_err("no vertices").to_string();
    assert!(error.len() < 200, "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn random_bytes_are_stood(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        assert_stood(&bytes);
    }

    #[test]
    fn random_statements_are_stood(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "v", "vt", "vn", "f", "g", "o", "usemtl", "mtllib", "l", "1", "2", "-1", "0.5",
                "1/1", "2//1", "3/2/1", "nan", "1e400", "\n", "\n", "\\\n", "#", "v 0 0 1\n",
                "v 1 0 0\n", "v 0 1 0 1 1 1\n", "f 1 2 3\n", "f 1 2 3 1 2\n",
            ]),
            0..60,
        ),
    ) {
        assert_stood(words.join(" ").as_bytes());
    }

    /// Whatever stands in a material file and in the pictures that it names, what was read is saved
    /// and comes back.
    #[test]
    fn random_materials_and_pictures_are_stood(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "newmtl", "newmtl b", "map_Kd", "bump", "norm", "-s 1", "-bm", "t.png", "u.png",
                "\"t.png\"", "C:\\u.png", "/", "..", "#", "\\", "\n", "\nmap_Ks", "\nKd 1 0 0\n",
            ]),
            0..30,
        ),
        noise in prop::collection::vec(any::<u8>(), 0..60),
        place in any::<prop::sample::Index>(),
        byte in any::<u8>(),
    ) {
        let folder = tempfile::tempdir().expect("folder");
        let mut picture = super::texture_tests::png(9);
        let at = place.index(picture.len());
        picture[at] = byte;
        let mut mtl = b"newmtl a\nmap_Kd t.png\n".to_vec();
        mtl.extend(words.join(" ").bytes());
        mtl.extend(&noise);
        let obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec();
        let files = [("a.obj", obj), ("a.mtl", mtl), ("t.png", picture), ("u.png", noise)];
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).expect("write");
        }
        let path = folder.path().join("a.obj");
        let (mesh, _) = load(&path, mve_core::Control::none()).expect("load");
        prop_assert_eq!(mesh.check(), Ok(()));
        companions(&path);
        let out = folder.path().join("out.obj");
        save(&mesh, &out, mve_core::Control::none()).expect("save");
        let (again, _) = load(&out, mve_core::Control::none()).expect("load");
        let pictures = |mesh: &mve_mesh::data::TriMesh| -> Vec<_> {
            let textures = mesh.materials.iter().flat_map(|material| &material.textures);
            textures.filter_map(|texture| texture.image.clone()).collect()
        };
        // A name that is only a backslash cannot be written; and one that loses the backslash at
        // its end may be found.
        let mut after = pictures(&again).into_iter();
        prop_assert!(pictures(&mesh).iter().all(|picture| after.any(|found| found == *picture)));
    }

    #[test]
    fn several_changes_are_stood(
        seed in 0..SEEDS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut bytes = SEEDS[seed].as_bytes().to_vec();
        for (at, byte) in changes {
            let i = at.index(bytes.len());
            bytes[i] = byte;
        }
        assert_stood(&bytes);
    }
}
