//! Files of `tests/data` that other programs wrote, and what these programs say of them.
//!
//! `trimesh.glb`: trimesh 4, a scene of a colored ball and a box that is turned. `gltfpack.glb`:
//! gltfpack 1.0 with `-c`, which quantizes and packs, of a sphere with a picture. `open3d.glb`:
//! Open3D 0.20, a torus. `vtk_exporter.iv` and `vtk_writer.iv`: VTK 9.7, half a sphere high, as
//! triangle strips with a transform and as polygons. `coin.iv`: Coin 4, boxes that are used again
//! under all kinds of transforms, and strips.

use mve_core::Control;
use mve_modules::data::{Domain, Layer, LayerValues, TriMesh};
use mve_modules::formats::mesh_file;
use mve_modules::formats::obj::FileScope;
use mve_tests::root;

/// The mesh of a file that is read without a warning.
fn load(name: &str) -> TriMesh {
    let path = root().join("tests/data").join(name);
    let (mesh, warnings) = mesh_file::load(&path, FileScope::Folder, Control::none()).unwrap();
    assert_eq!(warnings, [], "{name}");
    mesh
}

fn values<'m>(mesh: &'m TriMesh, name: &str) -> (Domain, &'m [u32], &'m LayerValues) {
    let layer = mesh.layer(name).unwrap_or_else(|| panic!("no {name}"));
    (layer.domain, &layer.index, &layer.values)
}

fn is_close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-6 * expected.abs()
}

#[test]
fn counts_and_areas_are_those_of_the_programs() {
    // Triangles, area and volume as trimesh, Open3D, VTK and Coin give them.
    let expected = [
        ("trimesh.glb", 92, 33.665_931_3, Some(9.658_712_2)),
        ("open3d.glb", 96, 14.141_170_45, Some(2.351_510_15)),
        ("vtk_exporter.iv", 64, 4.826_768_9, Some(0.852_778_84)),
        ("vtk_writer.iv", 64, 2.836_184_4, Some(0.426_389_41)),
        // Coin leaves what is mirrored inside out, so it has another volume.
        ("coin.iv", 70, 231.903_961, None),
    ];
    for (name, n_faces, area, volume) in expected {
        let mesh = load(name);
        assert_eq!(mesh.faces.len(), n_faces, "{name}");
        assert!(is_close(mesh.area(), area), "{name}: {}", mesh.area());
        let found = mesh.signed_volume();
        assert!(volume.is_none_or(|volume| is_close(found, volume)), "{name}: {found}");
    }
}

#[test]
fn quantized_and_packed_numbers_are_those_before() {
    let mesh = load("gltfpack.glb");
    // trimesh says 11.52575 and 3.51861 of the file before; 14 bits were kept.
    assert!((mesh.area() - 11.525_754).abs() < 2e-3, "{}", mesh.area());
    assert!((mesh.signed_volume() - 3.518_611).abs() < 1e-3, "{}", mesh.signed_volume());
    let (_, index, LayerValues::Vec2(uvs)) = values(&mesh, Layer::TEXCOORD) else {
        panic!("texture coordinates")
    };
    // The picture lies once around the axis, and from pole to pole.
    for (corner, vertex) in mesh.faces.iter().flatten().enumerate() {
        let (uv, p) = (uvs[index[corner] as usize], mesh.positions[vertex.idx()]);
        assert!((uv.y - p.z.clamp(-1.0, 1.0).acos() / std::f64::consts::PI).abs() < 2e-3);
        let is_pole = p.z.abs() > 0.999;
        let angle = p.y.atan2(p.x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        let apart = (uv.x - angle).rem_euclid(1.0);
        assert!(is_pole || !(2e-3..1.0 - 2e-3).contains(&apart), "{uv} at {p}");
    }
    assert!(mesh.materials[0].textures[0].image.is_some());
}

#[test]
fn colors_are_those_of_the_programs() {
    let mesh = load("vtk_exporter.iv");
    let (Domain::Vertex, index, LayerValues::Vec3(colors)) = values(&mesh, Layer::COLOR) else {
        panic!("colors of vertices")
    };
    // From red below to blue above, in the frame of the sphere, which is turned by 30° around x.
    let top = mesh.positions.iter().position(|p| p.z > 0.43 && p.y.abs() < 0.26).unwrap();
    assert!(colors[index[top] as usize].z > 0.9, "{}", colors[index[top] as usize]);
    let mesh = load("open3d.glb");
    let (Domain::Vertex, _, LayerValues::Vec3(colors)) = values(&mesh, Layer::COLOR) else {
        panic!("colors of vertices")
    };
    // Written as they are, though the format has amounts of light: 0.2 is 0.4845 as sRGB.
    assert!(colors.len() == 1 && (colors[0].z - 0.4845).abs() < 3e-3, "{colors:?}");
}
