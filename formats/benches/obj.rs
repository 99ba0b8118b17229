//! Reading and writing OBJ text in memory, beside the crate tobj and beside std's number parser.
//!
//! On the Stanford bunny, where it is found, and on a generated sheet with texture coordinates and
//! normals; and polygons that are hard to cut, combs whose teeth are long, slanting and of random
//! length.

use std::hint::black_box;
use std::io;
use std::path::Path;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use mve_core::Control;
use mve_formats::obj;
use mve_mesh::data::TriMesh;
use mve_mesh::random::IndexedRandom;
use mve_mesh::testing;

fn read(bytes: &[u8]) -> TriMesh {
    let mut no_mtl = |_: &str| Err(io::Error::from(io::ErrorKind::NotFound));
    obj::parse(bytes, &mut no_mtl, Control::none()).expect("an OBJ file").0
}

fn read_tobj(mut bytes: &[u8]) -> Vec<tobj::Model> {
    let options =
        tobj::LoadOptions { triangulate: true, single_index: false, ..Default::default() };
    let no_mtl = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    tobj::load_obj_buf(&mut bytes, &options, no_mtl).expect("an OBJ file").0
}

/// A wavy sheet of `2 n²` triangles, each corner as `v/vt/vn`.
fn sheet(n: usize) -> Vec<u8> {
    let mut text = String::new();
    for i in 0..=n {
        for j in 0..=n {
            let (x, y) = (i as f64 / n as f64, j as f64 / n as f64);
            let z = (7.0 * x).sin() * (5.0 * y).cos();
            text += &format!("v {x} {y} {z}\nvt {x:.6} {y:.6}\nvn {:.6} {:.6} 0.5\n", -z, z * x);
        }
    }
    for i in 0..n {
        for j in 0..n {
            let a = i * (n + 1) + j + 1;
            let (b, c, d) = (a + n + 1, a + n + 2, a + 1);
            text += &format!("f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\n");
            text += &format!("f {a}/{a}/{a} {c}/{c}/{c} {d}/{d}/{d}\n");
        }
    }
    text.into_bytes()
}

/// One polygon: a strip with a tooth a unit, each a triangle with its tip moved aside by 0.7 of its
/// height, which is a random part of the number of teeth.
fn comb(n_teeth: u64) -> Vec<u8> {
    let random = IndexedRandom::new(3);
    let mut text = String::new();
    for k in 0..n_teeth {
        let (x, y) = (k as f64, n_teeth as f64 * random.unit(k));
        text += &format!("v {x} 0 0\nv {} {y} 0\n", x + 0.5 + 0.7 * y);
    }
    text += &format!("v {n_teeth} 0 0\nv {n_teeth} -1 0\nv 0 -1 0\nf");
    (1..=2 * n_teeth + 3).for_each(|corner| text += &format!(" {corner}"));
    text.into_bytes()
}

/// Ten samples of one reading each, as the largest takes seconds.
fn comb_benches(criterion: &mut Criterion) {
    for n_teeth in [200_000, 400_000] {
        let bytes = comb(n_teeth);
        let mut group = criterion.benchmark_group("obj/comb");
        group.sample_size(10).sampling_mode(SamplingMode::Flat);
        group.bench_function(format!("{n_teeth} teeth"), |b| b.iter(|| read(black_box(&bytes))));
        group.finish();
    }
}

fn bunny() -> Option<Vec<u8>> {
    std::fs::read(testing::model("stanford-bunny.obj")?).ok()
}

fn obj_benches(criterion: &mut Criterion) {
    let mut files = vec![("sheet", sheet(180))];
    files.extend(bunny().map(|bytes| ("bunny", bytes)));
    for (name, bytes) in &files {
        let mut group = criterion.benchmark_group(format!("obj/{name}"));
        group.sample_size(30).throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function("read", |b| b.iter(|| read(black_box(bytes))));
        group.bench_function("read_tobj", |b| b.iter(|| read_tobj(black_box(bytes))));
        let mesh = read(bytes);
        group.bench_function("write", |b| {
            b.iter(|| {
                let mut text = Vec::with_capacity(bytes.len());
                obj::write_obj(black_box(&mesh), &mut text, None).expect("memory");
                text
            });
        });
        group.finish();
        number_benches(criterion, name, &mesh, bytes);
    }
}

/// The number crates against std, on the numbers of the file: the reason for having them.
fn number_benches(criterion: &mut Criterion, name: &str, mesh: &TriMesh, bytes: &[u8]) {
    let text = std::str::from_utf8(bytes).expect("text");
    let vertices = text.lines().filter(|line| line.starts_with("v "));
    let words: Vec<&str> = vertices.flat_map(|line| line.split_whitespace().skip(1)).collect();
    let mut group = criterion.benchmark_group(format!("number/{name}"));
    group.sample_size(30);
    group.bench_function("parse_fast_float2", |b| {
        let number =
            |w: &&str| fast_float2::parse_partial::<f64, _>(w.as_bytes()).expect("number").0;
        b.iter(|| words.iter().map(number).sum::<f64>());
    });
    // A reader of bytes has to make text of them first.
    group.bench_function("parse_std", |b| {
        let number = |w: &&str| {
            let word = std::str::from_utf8(black_box(w.as_bytes())).expect("text");
            word.parse::<f64>().expect("number")
        };
        b.iter(|| words.iter().map(number).sum::<f64>());
    });
    let numbers: Vec<f64> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
    group.bench_function("write_zmij", |b| {
        let mut buffer = zmij::Buffer::new();
        b.iter(|| numbers.iter().map(|&x| buffer.format_finite(x).len()).sum::<usize>());
    });
    group.bench_function("write_std", |b| {
        use std::io::Write;
        let mut buffer = Vec::new();
        b.iter(|| {
            buffer.clear();
            numbers.iter().try_for_each(|x| write!(buffer, "{x} ")).expect("memory");
            buffer.len()
        });
    });
    group.finish();
}

criterion_group!(benches, obj_benches, comb_benches);
criterion_main!(benches);
