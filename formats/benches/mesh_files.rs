//! Mesh files of a million faces, read from memory and written to it: binary PLY and STL, glTF and
//! Open Inventor. What the disk adds is no part of it.

use std::hint::black_box;
use std::io;

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use mve_core::Control;
use mve_formats::gltf::{Vertices, read_gltf, write_glb};
use mve_formats::iv::{read_iv, write_iv};
use mve_formats::ply::{Encoding, PlyOptions, Precision, read_ply, write_ply};
use mve_formats::stl::{StlEncoding, read_stl, write_stl};
use mve_mesh::data::TriMesh;
use mve_mesh::fixtures::torus;

/// Writes a mesh in a format.
type Writer = fn(&TriMesh, &mut dyn io::Write) -> io::Result<()>;
/// Reads one; how many faces it has.
type Reader = fn(&[u8]) -> usize;

fn ply(mesh: &TriMesh, out: &mut dyn io::Write) -> io::Result<()> {
    let options = PlyOptions { encoding: Encoding::Binary, precision: Precision::Float };
    write_ply(mesh, None, options, out, Control::none())
}

const FORMATS: [(&str, Writer, Reader); 4] = [
    ("ply", ply, |bytes| read_ply(bytes, Control::none()).map_or(0, |(m, _)| m.faces.len())),
    (
        "stl",
        |mesh, out| write_stl(mesh, StlEncoding::Binary, out, Control::none()),
        |bytes| read_stl(bytes, Control::none()).map_or(0, |(m, _)| m.faces.len()),
    ),
    (
        "glb",
        |mesh, out| write_glb(mesh, out, Control::none()).map(|_| ()),
        |bytes| {
            let read = read_gltf(bytes, Vertices::Welded, Control::none());
            read.map_or(0, |(m, _)| m.faces.len())
        },
    ),
    (
        "iv",
        |mesh, out| write_iv(mesh, &[], out, Control::none()).map(|_| ()),
        |bytes| read_iv(bytes, Control::none()).map_or(0, |(m, _)| m.faces.len()),
    ),
];

fn mesh_files(criterion: &mut Criterion) {
    let mesh = torus(2.0, 0.5, 708);
    let mut group = criterion.benchmark_group("mesh_files");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    for (name, write, read) in FORMATS {
        let mut bytes = Vec::new();
        write(&mesh, &mut bytes).expect("memory takes all");
        assert_eq!(read(&bytes), mesh.faces.len(), "{name}");
        group
            .bench_function(format!("{name}/read"), |bench| bench.iter(|| read(black_box(&bytes))));
        group.bench_function(format!("{name}/write"), |bench| {
            bench.iter(|| write(black_box(&mesh), &mut io::sink()));
        });
    }
    group.finish();
}

criterion_group!(benches, mesh_files);
criterion_main!(benches);
