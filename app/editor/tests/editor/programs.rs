//! The program panel, driven by the names that a screen reader says: a program is made for a map,
//! run into a folder, and its results are read.
//!
//! With `MVE_PICTURES=<folder>` the tests leave pictures of the panel there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{DragAndDrop, Theme, Ui, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use mve_core::{Map, Registry};
use mve_editor::drag::DraggedParam;
use mve_editor::programs::{ProgramAction, ProgramPanel, ProgramScene};
use serde_json::{Value as Json, json};

/// What a window would hold: the map, the panel, and what the panel asked for.
struct Bench {
    map: Arc<Map>,
    registry: Registry,
    output_folder: PathBuf,
    panel: ProgramPanel,
    asked: Vec<ProgramAction>,
}

impl Bench {
    fn new(programs: Json, output_folder: &Path) -> Self {
        let text = json!({
            "mve": 1,
            "nodes": {
                "make": {"module": "Box", "params": {"segments": 8}},
                "cut": {"module": "Simplificator", "params": {"target_faces": 100}},
                "info": {"module": "MeshInfo"},
                "compare": {"module": "MeshComparer"},
            },
            "links": [
                "make.mesh -> cut.mesh", "cut.mesh -> info.mesh",
                "make.mesh -> compare.original", "cut.mesh -> compare.simplified",
            ],
            "programs": programs,
        });
        Self {
            map: Arc::new(Map::parse(&text.to_string()).unwrap()),
            registry: mve_modules::registry(),
            output_folder: output_folder.to_owned(),
            panel: ProgramPanel::new(Arc::new(|| ())),
            asked: Vec::new(),
        }
    }

    fn show(&mut self, ui: &mut Ui) {
        self.ask(|panel, scene| panel.show(ui, scene));
    }

    /// Makes a parameter an axis, as dragging it does.
    fn vary(&mut self, node: &str, param: &str) {
        self.ask(|panel, scene| panel.vary(node, param, scene));
    }

    /// Does what the panel asks for, as a window would.
    fn ask(&mut self, ask: impl FnOnce(&mut ProgramPanel, &ProgramScene) -> Vec<ProgramAction>) {
        let scene = ProgramScene {
            map: &self.map,
            folder: self.output_folder.clone(),
            map_file: Some(Path::new("box.json")),
            registry: &self.registry,
            output_folder: &self.output_folder,
            allowed: &BTreeSet::new(),
            counts: Box::new(|_| Vec::new()),
        };
        let actions = ask(&mut self.panel, &scene);
        drop(scene);
        for action in &actions {
            let map = Arc::make_mut(&mut self.map);
            match action.clone() {
                ProgramAction::SetProgram { name, spec: Some(spec) } => {
                    map.programs.insert(name, spec);
                }
                ProgramAction::SetProgram { name, spec: None } => {
                    map.programs.shift_remove(&name);
                }
                ProgramAction::RenameProgram { name, to } => {
                    let spec = map.programs.shift_remove(&name).unwrap();
                    map.programs.insert(to, spec);
                }
                _ => {}
            }
        }
        self.asked.extend(actions);
    }
}

fn window(bench: Bench, theme: Theme) -> Harness<'static, Bench> {
    let builder = Harness::builder().with_size([1240.0, 780.0]).with_theme(theme).wgpu();
    builder.build_ui_state(|ui, bench: &mut Bench| bench.show(ui), bench)
}

/// Lets frames pass until something is so.
fn wait(harness: &mut Harness<Bench>, what: &str, is_so: impl Fn(&Harness<Bench>) -> bool) {
    let start = Instant::now();
    while !is_so(harness) {
        assert!(start.elapsed() < Duration::from_secs(120), "{what} does not happen");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
    harness.run_steps(3);
}

fn can_press(harness: &Harness<Bench>, name: &str) -> bool {
    harness.query_by_label(name).is_some_and(|node| !node.accesskit_node().is_disabled())
}

fn press(harness: &mut Harness<Bench>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(3);
}

fn picture(harness: &mut Harness<Bench>, name: &str) {
    if let Some(folder) = std::env::var_os("MVE_PICTURES") {
        let image = harness.render().unwrap();
        image.save(Path::new(&folder).join(format!("{name}.png"))).unwrap();
    }
}

fn program(harness: &Harness<Bench>, name: &str) -> Json {
    json!(harness.state().map.programs.get(name))
}

#[test]
fn a_program_is_made_run_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(Bench::new(json!({}), folder.path()), Theme::Dark);
    press(&mut harness, "New program");
    harness.state_mut().vary("make", "segments");
    harness.run_steps(3);
    press(&mut harness, "Add axis");
    press(&mut harness, "Parameters of cut");
    press(&mut harness, "cost");
    let axes = json!([{"make.segments": [8, 16]}, {"cut.cost": ["Quadric", "QuadricArea"]}]);
    let made = program(&harness, "sweep");
    assert_eq!(made["axes"][0], axes[0]);
    assert_eq!(made["axes"][1]["cut.cost"].as_array().map(Vec::len), Some(2));
    wait(&mut harness, "the check", |harness| can_press(harness, "Run steps"));
    assert!(harness.query_by_label("4 steps").is_some());
    // What stands below the head stays where it is, so that no click goes astray.
    let below = |harness: &Harness<Bench>| harness.get_by_label("Add axis").rect().top();
    let before = below(&harness);
    harness.get_by_label("Run steps").click();
    harness.step();
    while harness.state().panel.is_running() {
        harness.step();
        assert_eq!(below(&harness), before);
    }
    harness.step();
    assert_eq!(below(&harness), before);
    wait(&mut harness, "the table", |harness| {
        harness.query_all_by_label_contains("status done").count() == 4
    });
    let said = harness.state_mut().panel.take_messages();
    let [(false, text)] = said.as_slice() else { panic!("{said:?}") };
    assert!(text.starts_with("program sweep: 4 steps run in "), "{text}");
    let row = harness.get_by_label_contains("make.segments 16, cut.cost Quadric,");
    let said = row.accesskit_node().label().unwrap();
    // What modules declare as chief or as a size; of a box all else is a detail.
    assert!(said.contains("status done") && said.contains("info.faces "), "{said}");
    assert!(said.contains("compare.max_relative ") && !said.contains("info.volume"), "{said}");
    row.click();
    harness.run_steps(3);
    press(&mut harness, "Load selected step into the map");
    let loaded = harness.state().asked.iter().find_map(|action| match action {
        ProgramAction::LoadStep(params) => Some(params.clone()),
        _ => None,
    });
    let loaded = loaded.unwrap();
    assert_eq!(loaded[0], ("make".to_owned(), "segments".to_owned(), json!(16)));
    assert!(folder.path().join("box-sweep/report.html").is_file());
    assert!(folder.path().join("box-sweep/results.csv").is_file());
    press(&mut harness, "Open report");
    wait(&mut harness, "the report", |harness| {
        harness.state().asked.iter().any(|action| matches!(action, ProgramAction::OpenFile(_)))
    });
    // Another window finds what is in the store.
    let programs = json!(harness.state().map.programs);
    let mut other = window(Bench::new(programs, folder.path()), Theme::Light);
    wait(&mut other, "the look into the store", |harness| {
        harness.query_all_by_label_contains("status done").count() == 4
    });
    assert!(!can_press(&other, "Run steps"), "all steps are done");
}

#[test]
fn failed_steps_say_why_and_can_be_loaded() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("good.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(folder.path().join("bad.obj"), "v 0 0 0\nf 1 2 nine\n").unwrap();
    let loader = |path: &str| json!({"ObjLoader": {"path": path}});
    let axis = json!({"make.module": ["Box", loader("good.obj"), loader("bad.obj")]});
    let programs = json!({"inputs": {"axes": [axis], "note": "kept"}});
    let mut harness = window(Bench::new(programs.clone(), folder.path()), Theme::Light);
    wait(&mut harness, "the check", |harness| can_press(harness, "Run steps"));
    press(&mut harness, "Run steps");
    wait(&mut harness, "the end", |harness| !harness.state().panel.is_running());
    wait(&mut harness, "the failure", |harness| {
        harness.query_by_label("Load failed step into the map").is_some()
    });
    picture(&mut harness, "programs-failed-light");
    press(&mut harness, "Load failed step into the map");
    let last = harness.state().asked.last().cloned().unwrap();
    let expected = ("make".to_owned(), "module".to_owned(), loader("bad.obj"));
    assert_eq!(last, ProgramAction::LoadStep(vec![expected]));
    assert_eq!(program(&harness, "inputs"), programs["inputs"]);
    assert!(can_press(&harness, "Run failed steps again"));
}

#[test]
fn values_are_edited_and_the_rest_stays() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = json!({"axes": [{"make.segments": [2, 4, 8]}], "repeats": 2, "note": "kept"});
    let mut harness = window(Bench::new(json!({"sizes": sizes}), folder.path()), Theme::Dark);
    harness.run_steps(3);
    press(&mut harness, "Move value 1 of axis 1 down");
    press(&mut harness, "Remove value 3 of axis 1");
    press(&mut harness, "Add value to axis 1");
    let segments =
        |harness: &Harness<Bench>| program(harness, "sizes")["axes"][0]["make.segments"].clone();
    assert_eq!(segments(&harness), json!([4, 2, 1]), "a value that goes on from the others");
    press(&mut harness, "Make values of make.segments");
    press(&mut harness, "Set values");
    assert_eq!(segments(&harness), json!([4, 3, 2, 1]));
    let made = program(&harness, "sizes");
    assert_eq!((&made["repeats"], &made["note"]), (&json!(2), &json!("kept")));
    press(&mut harness, "Duplicate program");
    assert_eq!(program(&harness, "sizes 2"), made);
    press(&mut harness, "Remove program");
    assert_eq!(program(&harness, "sizes 2"), json!(null));
}

#[test]
fn problems_are_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let uneven = json!({"axes": [{"make.segments": [2, 4], "cut.cost": ["Quadric"]}]});
    let mut harness = window(Bench::new(json!({"uneven": uneven}), folder.path()), Theme::Dark);
    wait(&mut harness, "the check", |harness| {
        harness.query_all_by_label_contains("equally long").next().is_some()
    });
    assert!(!can_press(&harness, "Run steps"));
    press(&mut harness, "Even out axis 1");
    wait(&mut harness, "the check", |harness| can_press(harness, "Run steps"));
}

#[test]
fn parameters_are_dragged_into_axes_and_nested_ones_edited() {
    let folder = tempfile::tempdir().unwrap();
    let costs = json!({"axes": [{"cut.cost": ["EdgeLength", "Quadric"]}, {"make.segments": [4]}]});
    let mut harness = window(Bench::new(json!({"costs": costs}), folder.path()), Theme::Dark);
    harness.run_steps(3);
    press(&mut harness, "Parameters of cut.cost, value 2");
    press(&mut harness, "Make values of make.segments");
    picture(&mut harness, "programs-generator-dark");
    press(&mut harness, "Set values");
    assert_eq!(program(&harness, "costs")["axes"][1]["make.segments"][0], json!(4));
    let dragged = DraggedParam { node: "make".to_owned(), param: "size_x".to_owned() };
    DragAndDrop::set_payload(&harness.ctx, dragged);
    let below = harness.get_by_label("Add axis").rect().right_center() + vec2(20.0, 0.0);
    harness.drag_at(below);
    harness.run_steps(2);
    harness.drop_at(below);
    harness.run_steps(3);
    assert_eq!(program(&harness, "costs")["axes"][2], json!({"make.size_x": [1.0, 2.0]}));
    press(&mut harness, "Explicit steps");
    harness.run_steps(6);
    press(&mut harness, "Add step");
    let step = &program(&harness, "costs")["steps"][0];
    assert_eq!(step["make.size_x"], json!(1.0), "{step}");
}

/// A program that takes a while can be paused and goes on; its picture shows it at work.
#[test]
fn a_paused_program_starts_no_step() {
    let folder = tempfile::tempdir().unwrap();
    let faces: Vec<u32> = vec![3000, 2000, 1000, 500, 250, 120, 60];
    let costs = json!(["EdgeLength", "Quadric"]);
    let models = json!([{"Vase": {"segments": 24}}, {"Vase": {"segments": 40}}]);
    let axes = json!([{"make.module": models}, {"cut.cost": costs}, {"cut.target_faces": faces}]);
    let measures = json!([{"column": "compare.rms"}, {"column": "compare.max"}]);
    let report = json!({"measures": measures, "against": ["info.faces"]});
    let programs = json!({"costs": {"axes": axes, "report": report}});
    let mut harness = window(Bench::new(programs, folder.path()), Theme::Dark);
    wait(&mut harness, "the check", |harness| can_press(harness, "Run steps"));
    press(&mut harness, "Run steps");
    wait(&mut harness, "the first steps", |harness| {
        harness.query_all_by_label_contains("status done").count() >= 2
            || !harness.state().panel.is_running()
    });
    if harness.query_by_label("Pause").is_some() {
        press(&mut harness, "Pause");
        picture(&mut harness, "programs-paused-dark");
        std::thread::sleep(Duration::from_millis(300));
        harness.run_steps(3);
        press(&mut harness, "Resume");
    }
    wait(&mut harness, "the end", |harness| !harness.state().panel.is_running());
    wait(&mut harness, "the table", |harness| harness.query_by_label_contains("28 done").is_some());
    picture(&mut harness, "programs-dark");
    let programs = json!(harness.state().map.programs);
    let mut other = window(Bench::new(programs, folder.path()), Theme::Light);
    wait(&mut other, "the look into the store", |harness| {
        harness.query_by_label_contains("28 done").is_some()
    });
    picture(&mut other, "programs-light");
}

/// The window does not wait for a large program to be checked, and draws only rows that are seen.
#[test]
fn ten_thousand_steps_leave_the_window_quick() {
    let folder = tempfile::tempdir().unwrap();
    let segments: Vec<u32> = (1..=100).collect();
    let sizes: Vec<f64> = segments.iter().map(|n| f64::from(*n) / 10.0).collect();
    let axes = json!([{"make.segments": segments}, {"make.size_x": sizes}]);
    let bench = Bench::new(json!({"large": {"axes": axes}}), folder.path());
    let mut harness = window(bench, Theme::Dark);
    wait(&mut harness, "the check", |harness| harness.query_by_label("10000 steps").is_some());
    let start = Instant::now();
    harness.run_steps(20);
    let frame = start.elapsed() / 20;
    println!("a frame of a program of 10,000 steps: {frame:?}");
    let n_rows = harness.query_all_by_label_contains("status to do").count();
    assert!(n_rows > 0 && n_rows < 60, "{n_rows} rows drawn");
}
