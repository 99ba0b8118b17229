//! What holds for every registered module: its declaration is whole, and no input makes it panic.

use std::cell::Cell;
use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use mve_core::testing::{Outputs, Trial, plan_options, run_options};
use mve_core::{
    Better, Control, Data, InputFileSpec, InputSpec, Module, ModuleError, ModuleInfo, Param,
    ParamSpec, Quantities, Quantity, Role, Settings, Stored, StoredWriter, Value,
};
use mve_modules::data::{
    DATA_TYPES, Domain, Image, Layer, LayerValues, Material, NO_VALUE, PixelKind, Texture,
    TextureImage, TextureRole, TriMesh, VertexId,
};
use mve_modules::geometry::generate::{BoxOptions, VaseOptions, subdivided_box, vase};
use mve_modules::geometry::surface::normals::{NormalWeight, vertex_normal_layer};
use mve_modules::mesh::fixtures::{mesh_of, tetrahedron};
use mve_modules::metric::METRICS;
use mve_modules::registry;
use serde_json::{Map as JsonMap, Value as Json, json};

/// Meshes that a module may meet, each with its name.
pub fn meshes() -> Vec<(&'static str, TriMesh)> {
    let mut nan = tetrahedron();
    nan.positions[1].x = f64::NAN;
    let mut infinite = tetrahedron();
    infinite.positions[2].y = f64::INFINITY;
    let mut huge = tetrahedron();
    huge.positions.iter_mut().for_each(|p| *p *= 1e200);
    let mut tiny = tetrahedron();
    tiny.positions.iter_mut().for_each(|p| *p *= 1e-200);
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    vec![
        ("a tetrahedron", tetrahedron()),
        ("nothing", TriMesh::default()),
        ("points without faces", mesh_of(&corners, &[])),
        ("one face", mesh_of(&corners, &[[0, 1, 2]])),
        ("a face that names a vertex twice", mesh_of(&corners, &[[0, 1, 1], [0, 1, 2]])),
        ("the same face twice and turned", mesh_of(&corners, &[[0, 1, 2], [0, 1, 2], [2, 1, 0]])),
        ("three faces at an edge", mesh_of(&corners, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]])),
        ("two triangles at a vertex", mesh_of(&corners, &[[0, 1, 2], [0, 3, 4]])),
        ("a flat face", mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]])),
        ("all vertices in one place", mesh_of(&[[1.0; 3]; 4], &[[0, 1, 2], [0, 2, 3]])),
        ("a coordinate that is not a number", nan),
        ("an infinite coordinate", infinite),
        ("huge coordinates", huge),
        ("tiny coordinates", tiny),
        ("layers of all kinds", with_layers()),
    ]
}

/// A box with seams, missing values, labels, fields and a textured material.
fn with_layers() -> TriMesh {
    let mut mesh = subdivided_box(&BoxOptions { segments: 2, ..BoxOptions::DEFAULT });
    let (n_vertices, n_faces) = (mesh.positions.len() as u32, mesh.faces.len() as u32);
    let texcoords = (0..3 * n_faces).map(|i| glam::DVec2::splat(f64::from(i))).collect();
    let mut corner_index: Vec<u32> = (0..3 * n_faces).collect();
    corner_index[5] = NO_VALUE;
    let mut put = |name: &str, domain, values, index| {
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    };
    put(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), corner_index);
    let names = LayerValues::Label(vec!["left".into(), "right".into()]);
    put(Layer::GROUP, Domain::Face, names, (0..n_faces).map(|f| f % 2).collect());
    let numbers = LayerValues::Number((0..n_vertices).map(f64::from).collect());
    let material = vec!["painted".to_owned(), "undefined".to_owned()];
    let index = (0..n_faces).map(|f| if f == 2 { NO_VALUE } else { f % 2 }).collect();
    put(Layer::MATERIAL, Domain::Face, LayerValues::Label(material), index);
    put("height", Domain::Vertex, numbers, (0..n_vertices).collect());
    let colors = LayerValues::Vec3(vec![DVec3::ONE, DVec3::ZERO]);
    put(Layer::COLOR, Domain::Vertex, colors, (0..n_vertices).map(|v| v % 2).collect());
    let picture = |name: &str, image: Option<TextureImage>| Texture {
        role: TextureRole::BaseColor,
        keyword: "map_Kd".to_owned(),
        options: "-clamp on ".to_owned(),
        name: name.to_owned(),
        place: 1,
        image: image.map(Arc::new),
    };
    let pixels = Image::filled("texture", [3, 2], PixelKind::Rgb, 99);
    mesh.materials = vec![Material {
        name: "painted".to_owned(),
        statements: vec![("Kd".to_owned(), "1 0 0".to_owned())],
        textures: vec![
            picture("a.png", Some(TextureImage::new(pixels))),
            picture("missing.png", None),
        ],
    }];
    mesh
}

/// A value for an input of this type, made from a mesh.
fn value_of(type_id: &str, mesh: &TriMesh) -> Option<Value> {
    if let Some(entry) = DATA_TYPES.iter().find(|entry| entry.data_type.id == type_id) {
        return Some((entry.sample)(mesh));
    }
    Some(match type_id {
        "Any" => Value::new(mesh.clone()),
        "Number" => Value::new(mesh.positions.first().map_or(0.0, |position| position.x)),
        "Flag" => Value::new(true),
        "Text" => Value::new("text".to_owned()),
        "File" => Value::new(file_of(mesh)),
        _ => return None,
    })
}

/// A file with the positions of a mesh.
fn file_of(mesh: &TriMesh) -> Stored {
    let mut writer = StoredWriter::new().expect("a temporary file");
    for number in mesh.positions.iter().flat_map(|position| position.to_array()) {
        writer.write_all(&number.to_le_bytes()).expect("it can be written");
    }
    writer.finish().expect("it can be written")
}

/// A call of the module on a mesh, with what it needs, in a folder of its own.
pub fn trial(module: &'static Module, mesh: &TriMesh, folder: &Path) -> Trial {
    let mut trial = Trial::of(module);
    for input in module.inputs {
        let value = value_of(input.data_type.id, mesh)
            .unwrap_or_else(|| panic!("teach value_of the type {}", input.data_type.id));
        trial = trial.value(input.name, value);
    }
    for (name, value) in needed(module.id, module.params, folder) {
        trial = trial.set(&name, value);
    }
    trial
}

/// Values of the parameters without a default: files, made in a folder. Those that a choice's entry
/// needs come with the choice.
pub fn needed(of: &str, params: &[ParamSpec], folder: &Path) -> JsonMap<String, Json> {
    let value = |spec: &ParamSpec| {
        if let Some(file) = spec.output_file() {
            let extension = file.extensions.first().copied().unwrap_or("out");
            return Some(json!(folder.join(format!("{of}.{}.{extension}", spec.name))));
        }
        if let Some(file) = spec.input_file() {
            return Some(json!(example_file(&file, folder)));
        }
        if spec.command_line().is_some() {
            return Some(json!(["cp", "{in.mesh}", "{out.mesh}"]));
        }
        let choice = spec.choice().filter(|_| spec.default_setting().is_none())?;
        let entry = choice.list.find(choice.default)?;
        Some(json!({ choice.default: needed(of, entry.params, folder) }))
    };
    let named = |spec: &ParamSpec| Some((spec.name.to_owned(), value(spec)?));
    params.iter().filter_map(named).collect()
}

/// A file that a loader can read: the example that it declares, or `tests/data/example.*`, with
/// what it names. One that reads anything gets a mesh.
fn example_file(spec: &InputFileSpec, folder: &Path) -> PathBuf {
    let examples = mve_tests::root().join("tests/data");
    for file in std::fs::read_dir(&examples).expect("the folder is there") {
        let file = file.expect("a file");
        std::fs::copy(file.path(), folder.join(file.file_name())).expect("it can be copied");
    }
    let extension = spec.extensions.first().copied().unwrap_or("obj");
    let path = folder.join("example").with_extension(extension);
    if !spec.example.is_empty() {
        std::fs::write(&path, spec.example).expect("the folder can be written");
    }
    let examples = examples.display();
    assert!(path.is_file(), "declare an example, or put example.{extension} into {examples}");
    path
}

#[test]
fn an_example_that_is_declared_is_what_is_loaded() {
    let param = Param::input_file("path", "The file.", &["png"]).example(b"mine");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = example_file(&param.spec().input_file().expect("a file"), folder.path());
    assert_eq!(std::fs::read(path).expect("it is there"), b"mine");
}

/// Whole files, cut ones, ones with bytes changed, and noise.
fn damaged(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    // Marsaglia's xorshift, 2003.
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as usize
    };
    let cuts = (0..8).map(|part| bytes[..bytes.len() * part / 8].to_vec());
    let mut all: Vec<Vec<u8>> = cuts.collect();
    for n in 1..40 {
        let mut changed = bytes.to_vec();
        for _ in 0..n.min(9) {
            let place = random() % changed.len();
            changed[place] = random() as u8;
        }
        all.push(changed);
    }
    all.extend((0..8).map(|n| (0..n * 37).map(|_| random() as u8).collect()));
    all
}

#[test]
fn loaders_give_a_result_or_an_error_for_any_bytes() {
    let n_loaders = Cell::new(0);
    each_module(|info| {
        for spec in info.module.params {
            let Some(file) = spec.input_file() else { continue };
            n_loaders.set(n_loaders.get() + 1);
            let folder = tempfile::tempdir().expect("a temporary folder");
            let path = example_file(&file, folder.path());
            let example = std::fs::read(&path).expect("the example");
            let load = |bytes: &[u8]| {
                std::fs::write(&path, bytes).expect("the folder can be written");
                Trial::of(info.module).set(spec.name, json!(path)).run()
            };
            assert!(load(&example).is_ok(), "{} does not load its example", info.module.id);
            for (place, bytes) in damaged(&example).iter().enumerate() {
                if let Err(ModuleError::Bug(bug)) = load(bytes) {
                    panic!("{}, damaged file {place}: {bug}", info.module.id);
                }
            }
        }
    });
    assert!(n_loaders.get() >= 2);
}

fn run(module: &'static Module, mesh: &TriMesh) -> Result<Outputs, ModuleError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    trial(module, mesh, folder.path()).run()
}

fn bytes(outputs: &Outputs) -> Vec<(&'static str, Vec<u8>)> {
    outputs.iter().map(|(name, value)| (*name, value.encode().expect("plain data"))).collect()
}

fn each_module(check: impl Fn(&ModuleInfo)) {
    registry().modules().iter().for_each(check);
}

#[test]
fn declarations_are_whole() {
    let mut ids = HashSet::new();
    each_module(|info| {
        let module = info.module;
        let first = module.id.chars().next();
        assert!(first.is_some_and(char::is_uppercase), "{} is not CamelCase", module.id);
        assert!(is_sentence(module.summary), "{}: summary", module.id);
        let mut names = HashSet::new();
        for input in module.inputs {
            assert!(names.insert(input.name), "{}.{} twice", module.id, input.name);
            assert!(is_snake(input.name) && is_sentence(input.doc), "{}.{}", module.id, input.name);
        }
        check_params(module.id, module.params, module.inputs, &mut names);
        let mut outputs = HashSet::new();
        for output in module.outputs {
            assert!(outputs.insert(output.name), "{}.{} twice", module.id, output.name);
            assert!(is_snake(output.name) && is_sentence(output.doc), "{}.{}", module.id, {
                output.name
            });
        }
    });
    registry().modules().iter().for_each(|info| assert!(ids.insert(info.module.id)));
}

/// Whether a number of this name is one of those that are declared; `#` stands for digits.
fn is_declared(name: &str, declared: &[Quantity]) -> bool {
    let start = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let numbered = format!("{start}#");
    declared.iter().any(|quantity| quantity.name == name || quantity.name == numbered)
}

#[test]
fn metrics_give_what_they_declare() {
    let (mut mesh, mut other) = (vase(&VaseOptions::DEFAULT), subdivided_box(&BoxOptions::DEFAULT));
    for mesh in [&mut mesh, &mut other] {
        let layer = vertex_normal_layer(mesh, NormalWeight::Angle, Control::none()).unwrap();
        mesh.set_layer(layer);
    }
    for entry in METRICS.entries.iter().map(|listed| listed.item) {
        let settings = Settings::defaults(entry.params).unwrap();
        let metric = (entry.build.make)(&settings).unwrap();
        let compare = |other: &TriMesh| metric.compare(&mesh, other, Control::none());
        // One of meshes with the same faces refuses any other.
        let found = compare(&other).or_else(|_| compare(&mesh)).unwrap();
        let declared = entry.build.quantities;
        for measure in &found.scalars {
            assert!(is_declared(&measure.name, declared), "{}: {}", entry.id, measure.name);
        }
        let is_chief = |quantity: &&Quantity| quantity.role == Role::Chief;
        let mut chief = declared.iter().filter(is_chief).peekable();
        assert!(chief.peek().is_some(), "{}: no chief quantity", entry.id);
        assert!(chief.all(|quantity| quantity.better != Better::Neither), "{}", entry.id);
        assert!(declared.iter().all(|quantity| is_sentence(quantity.doc)), "{}", entry.id);
    }
}

#[test]
fn rows_of_measures_hold_what_is_declared() {
    each_module(|info| {
        let Ok(outputs) = run(info.module, &tetrahedron()) else { return };
        for output in info.module.outputs {
            let cells = outputs[output.name].cells();
            match output.quantities {
                Quantities::Row(row) => {
                    assert!(cells.iter().all(|(name, _)| is_declared(name, row)), "{cells:?}");
                }
                Quantities::Plain => assert!(cells.is_empty(), "{}: undeclared", info.module.id),
                _ => {}
            }
        }
    });
}

fn is_snake(name: &str) -> bool {
    let is_good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    !name.is_empty() && name.chars().all(is_good)
}

fn is_sentence(text: &str) -> bool {
    text.len() > 5 && text.ends_with('.') && !text.contains("  ")
}

fn check_params(
    of: &str,
    params: &'static [ParamSpec],
    inputs: &[InputSpec],
    names: &mut HashSet<&'static str>,
) {
    for spec in params {
        let name = format!("{of}.{}", spec.name);
        assert!(names.insert(spec.name), "{name} twice, among inputs and parameters");
        assert!(is_snake(spec.name) && is_sentence(spec.doc), "{name}");
        assert_ne!(spec.name, mve_core::MODULE, "{name}: the word stands for the node's module");
        assert_eq!(spec.fault(inputs), None, "{of}");
        if let Some(default) = spec.default_json().filter(|_| spec.choice().is_none()) {
            assert!(spec.read(&default).is_ok(), "{name}: the default {default} does not fit");
        }
        for option in spec.options() {
            assert!(is_sentence(option.summary), "{name}: {}", option.id);
            let of = format!("{name}.{}", option.id);
            check_params(&of, option.params, inputs, &mut HashSet::new());
        }
    }
}

#[test]
fn any_mesh_gives_a_result_or_an_error() {
    each_module(|info| {
        for (name, mesh) in meshes() {
            match run(info.module, &mesh) {
                Err(ModuleError::Bug(bug)) => panic!("{} on {name}: {bug}", info.module.id),
                Err(error) => assert!(error.to_string().len() > 10, "{error}"),
                Ok(outputs) => {
                    for (output, value) in outputs {
                        if let Some(mesh) = value.get::<TriMesh>() {
                            let fault = TriMesh::check(&mesh);
                            assert_eq!(fault, Ok(()), "{}.{output} on {name}", info.module.id);
                        }
                    }
                }
            }
        }
    });
}

#[test]
fn ends_of_ranges_give_a_result_or_an_error() {
    // At their upper ends generators fill the memory and metrics take hours; there the slider ends.
    each_module(|info| {
        for spec in info.module.params {
            let folder = tempfile::tempdir().expect("a temporary folder");
            for value in ends(spec, folder.path()) {
                let trial = trial(info.module, &with_layers(), folder.path());
                if let Err(ModuleError::Bug(bug)) = trial.set(spec.name, value.clone()).run() {
                    panic!("{}.{} = {value}: {bug}", info.module.id, spec.name);
                }
            }
        }
    });
}

/// Values at the ends of a parameter's range, and one of every choice and name; an entry that needs
/// files gets them.
pub fn ends(spec: &ParamSpec, folder: &Path) -> Vec<Json> {
    let Some(choice) = spec.choice() else { return spec.examples() };
    let entry = |entry: mve_core::EntrySpec| {
        let params = needed(entry.id, entry.params, folder);
        if params.is_empty() { json!(entry.id) } else { json!({ entry.id: params }) }
    };
    choice.entries().map(entry).collect()
}

#[test]
fn runs_and_thread_counts_agree_to_the_last_bit() {
    let mesh = vase(&VaseOptions { segments: 24, profile_segments: 30, ..VaseOptions::DEFAULT });
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
    let (one, many) = (pool(1), pool(5));
    each_module(|info| {
        let outcome = |pool: &rayon::ThreadPool| {
            pool.install(|| run(info.module, &mesh).map(|outputs| bytes(&outputs)))
        };
        let first = outcome(&one);
        assert!(first == outcome(&one), "{}: two runs differ", info.module.id);
        assert!(first == outcome(&many), "{}: thread counts differ", info.module.id);
    });
}

#[test]
fn values_come_back_from_the_disk_cache_as_they_were() {
    let (cache_folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let map = r#"{"mve": 1, "nodes": {
        "a": {"module": "Vase", "params": {"segments": 256, "profile_segments": 256}},
        "s": {"module": "Simplificator"}, "n": {"module": "NormalComputer"}},
        "links": ["a.mesh -> s.mesh", "s.mesh -> n.mesh"]}"#;
    let map = mve_core::Map::parse(map).unwrap();
    let files = mve_core::FileHashes::new();
    let options = plan_options(Path::new("/"), &files);
    let plan = mve_core::Plan::new(&map, &registry(), &options).unwrap();
    let outcome = || {
        let disk = mve_core::DiskCache::open(cache_folder.path(), 1 << 30).unwrap();
        let cache = mve_core::Cache::new(1 << 30, Some(disk));
        let (cache, keep) = (Some(&cache), mve_core::Keep::All);
        let cancel = mve_core::CancelToken::new();
        let options = mve_core::RunOptions { cache, keep, ..run_options(out.path(), &cancel) };
        mve_core::run(&plan, &options)
    };
    let (first, second) = (outcome(), outcome());
    let simplified = |outcome: &mve_core::RunOutcome| {
        outcome.nodes["s"].outputs["mesh"].get::<TriMesh>().unwrap()
    };
    assert_eq!(second.nodes["s"].record.cached, Some(mve_core::CacheUse::Disk));
    assert_eq!(simplified(&first), simplified(&second));
}

#[test]
fn shuffled_vertices_give_the_same_surface() {
    let mesh = vase(&VaseOptions { segments: 24, profile_segments: 30, ..VaseOptions::DEFAULT });
    let shuffled = shuffle(&mesh);
    each_module(|info| {
        let (Ok(one), Ok(two)) = (run(info.module, &mesh), run(info.module, &shuffled)) else {
            return;
        };
        for (name, value) in &one {
            let place = format!("{}.{name}", info.module.id);
            if let (Some(a), Some(b)) = (value.get::<TriMesh>(), two[name].get::<TriMesh>()) {
                assert_eq!(a.faces.len(), b.faces.len(), "{place}");
                assert!(is_close(a.area(), b.area(), 1e-9), "{place}: area");
                assert!(is_close(a.signed_volume(), b.signed_volume(), 1e-9), "{place}: volume");
            }
            if let (Some(a), Some(b)) = (value.get::<f64>(), two[name].get::<f64>()) {
                assert!(is_close(*a, *b, 1e-6) || (a.is_nan() && b.is_nan()), "{place}: {a} {b}");
            }
        }
    });
}

fn is_close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1e-12)
}

/// The same surface with vertices in another order, faces too. Each face begins at
/// the corner that it began at: another one rounds its plane another way, and on a symmetric mesh
/// that decides between collapses of equal price.
fn shuffle(mesh: &TriMesh) -> TriMesh {
    let n = mesh.positions.len();
    // 7919 is prime and no factor of any count here, so this visits every vertex once.
    let old_of_new: Vec<usize> = (0..n).map(|i| (i * 7919 + 13) % n).collect();
    let mut new_of_old = vec![0; n];
    old_of_new.iter().enumerate().for_each(|(new, &old)| new_of_old[old] = new as u32);
    let positions = old_of_new.iter().map(|&old| mesh.positions[old]).collect();
    let mut faces: Vec<_> =
        mesh.faces.iter().map(|face| face.map(|v| VertexId(new_of_old[v.idx()]))).collect();
    faces.reverse();
    TriMesh::new(positions, faces)
}

#[test]
fn data_types_have_ids_of_their_own() {
    let of_core = [f64::TYPE, bool::TYPE, String::TYPE, Stored::TYPE];
    let types: Vec<_> = DATA_TYPES.iter().map(|entry| entry.data_type).chain(of_core).collect();
    let ids: HashSet<_> = types.iter().map(|data_type| data_type.id).collect();
    assert_eq!(ids.len(), types.len());
    assert!(types.iter().all(|data_type| is_sentence(data_type.doc)));
    for entry in DATA_TYPES {
        let sample = (entry.sample)(&tetrahedron());
        assert_eq!(sample.data_type(), entry.data_type);
    }
}
