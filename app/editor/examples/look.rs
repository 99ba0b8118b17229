//! Looks at files: meshes (OBJ) and pictures (PNG) in one viewer.
//!
//! `look a.obj b.obj` opens a window; `look --png out.png a.obj` draws one picture without a
//! window; `look --time a.obj` says how long frames take.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use eframe::egui;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use mve_core::Control;
use mve_core::Value;
use mve_editor::views::{Arrangement, Pinned, Viewer, ViewerAction};
use mve_modules::data::{Domain, Field, Images, TriMesh};
use mve_modules::formats::{obj, png::read_png};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("look: {message}");
            ExitCode::FAILURE
        }
    }
}

/// What the command line asks for.
#[derive(Default)]
struct Order {
    png: Option<PathBuf>,
    is_timed: bool,
    has_wire: bool,
    has_box: bool,
    has_height: bool,
    is_light: bool,
    arrangement: Arrangement,
    files: Vec<PathBuf>,
    /// Times that meshes are subdivided, four faces for one each time.
    n_subdivisions: u32,
}

fn order() -> Result<Order, String> {
    let mut order = Order::default();
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--png" => order.png = args.next().map(PathBuf::from),
            "--time" => order.is_timed = true,
            "--wire" => order.has_wire = true,
            "--box" => order.has_box = true,
            "--height" => order.has_height = true,
            "--light" => order.is_light = true,
            "--wipe" => order.arrangement = Arrangement::Wipe,
            "--blend" => order.arrangement = Arrangement::Blend,
            "--subdivide" => order.n_subdivisions += 1,
            option if option.starts_with("--") => return Err(format!("no option {option}")),
            file => order.files.push(PathBuf::from(file)),
        }
    }
    if order.files.is_empty() {
        return Err("name OBJ or PNG files".to_owned());
    }
    Ok(order)
}

fn run() -> Result<(), String> {
    let order = order()?;
    let mut pinned = Vec::new();
    for file in &order.files {
        load(file, &order, &mut pinned)?;
    }
    let mut viewer = Viewer::new();
    viewer.meshes.settings.lines.has_wire = order.has_wire;
    viewer.meshes.settings.has_box = order.has_box;
    viewer.meshes.settings.arrangement = order.arrangement;
    if order.is_timed || order.png.is_some() {
        return without_window(viewer, pinned, &order);
    }
    let app = App { viewer, pinned };
    let options = eframe::NativeOptions { renderer: eframe::Renderer::Wgpu, ..Default::default() };
    eframe::run_native("look", options, Box::new(|_| Ok(Box::new(app))))
        .map_err(|error| error.to_string())
}

fn load(path: &Path, order: &Order, pinned: &mut Vec<Pinned>) -> Result<(), String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let message = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let pin =
        |title: String, value: Value| Pinned { title, value: Some(value), ..Pinned::default() };
    if path.extension().is_some_and(|extension| extension == "png") {
        let bytes = std::fs::read(path).map_err(|error| message(&error))?;
        let image = read_png(&bytes, &name).map_err(|error| message(&error))?;
        pinned.push(pin(format!("{name}.images"), Value::new(Images(vec![image]))));
        return Ok(());
    }
    let (mut mesh, _) = obj::load(path, Control::none()).map_err(|error| message(&error))?;
    for _ in 0..order.n_subdivisions {
        mesh = subdivided(&mesh);
    }
    if order.has_height {
        let values = mesh.positions.iter().map(|point| point.y).collect();
        let (name, unit) = ("height".to_owned(), "model units".to_owned());
        let field = Field { name, unit, domain: Domain::Vertex, values };
        pinned.push(pin("look.height".to_owned(), Value::new(field)));
    }
    pinned.push(pin(format!("{name}.mesh"), Value::new(mesh)));
    Ok(())
}

/// Each face as four, with a point in the middle of each side; neighbors do not share it.
fn subdivided(mesh: &TriMesh) -> TriMesh {
    let mut made = TriMesh { positions: mesh.positions.clone(), ..TriMesh::default() };
    for face in &mesh.faces {
        let first = made.positions.len() as u32;
        let points = face.map(|vertex| mesh.positions[vertex.idx()]);
        made.positions.extend((0..3).map(|k| (points[k] + points[(k + 1) % 3]) / 2.0));
        let [ab, bc, ca] = [0, 1, 2].map(|k| mve_modules::data::VertexId(first + k));
        let [a, b, c] = *face;
        made.faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    made
}

struct App {
    viewer: Viewer,
    pinned: Vec<Pinned>,
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let actions = self.viewer.show(ui, &self.pinned, frame.wgpu_render_state());
        // One a frame: the places of the others change with it.
        if let Some(ViewerAction::Unpin(at)) = actions.first() {
            self.pinned.remove(*at);
        }
    }
}

fn without_window(viewer: Viewer, pinned: Vec<Pinned>, order: &Order) -> Result<(), String> {
    let options = eframe::egui_wgpu::RendererOptions::PREDICTABLE;
    let render = create_render_state(default_wgpu_setup(), options);
    let renderer = WgpuTestRenderer::from_render_state(render.clone());
    let theme = if order.is_light { egui::Theme::Light } else { egui::Theme::Dark };
    let show = move |ui: &mut egui::Ui, viewer: &mut Viewer| {
        viewer.show(ui, &pinned, Some(&render));
    };
    let builder = egui_kittest::Harness::builder().with_size(egui::vec2(1200.0, 800.0));
    let builder = builder.with_theme(theme).renderer(renderer);
    let mut harness = builder.build_ui_state(show, viewer);
    let start = Instant::now();
    let mut longest = Duration::ZERO;
    loop {
        let frame = Instant::now();
        harness.step();
        longest = longest.max(frame.elapsed());
        if !harness.state().is_busy() {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    println!("prepared in {:.0?}, longest frame {longest:.1?}", start.elapsed());
    for _ in 0..3 {
        harness.step();
    }
    if order.is_timed {
        let frame = Instant::now();
        harness.state_mut().meshes.camera.yaw_rad += 0.05;
        harness.step();
        harness.render()?;
        println!("a frame after a move: {:.1?}", frame.elapsed());
        let mut times = Vec::new();
        harness.drag_at(egui::pos2(500.0, 400.0));
        harness.step();
        for step in 0..10 {
            let frame = Instant::now();
            harness.hover_at(egui::pos2(510.0 + 10.0 * step as f32, 400.0));
            harness.step();
            harness.render()?;
            times.push(frame.elapsed());
        }
        harness.drop_at(egui::pos2(610.0, 400.0));
        times.sort();
        println!("a frame while dragging: median {:.1?}, worst {:.1?}", times[5], times[9]);
        for _ in 0..30 {
            harness.step();
        }
        harness.render()?;
        let frame = Instant::now();
        harness.step();
        harness.render()?;
        println!("a frame without a change: {:.1?}", frame.elapsed());
    }
    if let Some(path) = &order.png {
        let image = harness.render()?;
        image.save(path).map_err(|error| error.to_string())?;
    }
    Ok(())
}
