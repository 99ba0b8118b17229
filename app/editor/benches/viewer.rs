//! Milliseconds that the view of a mesh of 1 M faces takes, on the GPU that drivers offer first:
//! without one, on the processor (lavapipe).
//!
//! `cargo bench -p mve-editor --bench viewer -- [FACES]`. The view has 900 × 700 pixels. A frame is
//! layout, the drawing of the mesh, that of the window, and reading its picture back, which stands
//! in for showing it. What a person waits for while the mesh comes in is the longest frame; its
//! first part is the work of the window's own thread.

use std::time::{Duration, Instant};

use eframe::egui::{self, Pos2, Vec2};
use eframe::egui_wgpu::RendererOptions;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use mve_core::Value;
use mve_editor::views::{Pinned, PortState, Viewer};
use mve_modules::data::{Domain, Field};
use mve_modules::mesh::fixtures::torus;

/// What the window shows.
struct Shown {
    viewer: Viewer,
    pinned: Vec<Pinned>,
    /// Whether the table of elements is in the place of the mesh.
    is_sheet: bool,
}

/// The window's own part of a frame, and all of it.
#[derive(Clone, Copy, Default)]
struct Times {
    own: Duration,
    whole: Duration,
}

fn main() {
    let n_faces = std::env::args().skip(1).find_map(|arg| arg.parse().ok()).unwrap_or(1_000_000);
    // A ring of k × k squares has 2 k² faces.
    let side = (n_faces as f64 / 2.0).sqrt().round() as u32;
    let mesh = torus(3.0, 1.0, side);
    let values: Vec<f64> = (0..mesh.faces.len()).map(|face| (face as f64 * 1e-3).sin()).collect();
    let field =
        Field { name: "wave".to_owned(), unit: String::new(), domain: Domain::Face, values };
    let mesh = pin("ring.mesh", Value::new(mesh));
    let field = pin("ring.field", Value::new(field));
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let about = render.adapter.get_info();
    println!("{} ({:?}), {n_faces} faces", about.name, about.backend);
    let renderer = WgpuTestRenderer::from_render_state(render.clone());
    let show = move |ui: &mut egui::Ui, shown: &mut Shown| match shown.is_sheet {
        true => shown.viewer.show_sheet(ui, &shown.pinned),
        false => drop(shown.viewer.show(ui, &shown.pinned, Some(&render))),
    };
    let shown = Shown { viewer: Viewer::new(), pinned: Vec::new(), is_sheet: false };
    let builder = Harness::builder().with_size(Vec2::new(916.0, 760.0)).renderer(renderer);
    let mut harness = builder.build_ui_state(show, shown);
    frame(&mut harness);

    harness.state_mut().pinned = vec![mesh.clone()];
    measure(&mut harness, "plain");
    harness.state_mut().viewer.meshes.settings.lines.has_wire = true;
    measure(&mut harness, "wire");
    harness.state_mut().viewer.meshes.settings.lines.has_wire = false;
    measure_cut(&mut harness);
    harness.state_mut().pinned = vec![mesh, field];
    measure(&mut harness, "colored by faces");
    measure_sheet(&mut harness);
}

/// The table of all faces: scrolled by the wheel, then sorted.
fn measure_sheet(harness: &mut Harness<Shown>) {
    harness.state_mut().is_sheet = true;
    report("sheet: comes in", until_quiet(harness));
    harness.hover_at(Pos2::new(300.0, 400.0));
    let scroll = |harness: &mut Harness<Shown>| {
        let (unit, phase) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move);
        let (delta, modifiers) = (Vec2::new(0.0, -5000.0), egui::Modifiers::NONE);
        harness.event(egui::Event::MouseWheel { unit, delta, phase, modifiers });
        frame(harness)
    };
    report("sheet: scrolls", (0..40).map(|_| scroll(harness)).collect());
    harness.get_by_label("Sort by area").click();
    let start = Instant::now();
    let sorting = until_quiet(harness);
    report(&format!("sheet: sorted within {:.0?}", start.elapsed()), sorting);
    report("sheet: scrolls, sorted", (0..40).map(|_| scroll(harness)).collect());
}

fn pin(title: &str, value: Value) -> Pinned {
    let (title, state) = (title.to_owned(), PortState::Ready);
    Pinned { title, value: Some(value), state, mesh: None }
}

fn measure(harness: &mut Harness<Shown>, name: &str) {
    let start = Instant::now();
    let coming = until_quiet(harness);
    report(&format!("{name}: comes in, within {:.0?}", start.elapsed()), coming);
    let middle = Pos2::new(450.0, 400.0);
    harness.drag_at(middle);
    frame(harness);
    let mut dragging = Vec::new();
    for step in 0..40 {
        harness.hover_at(middle + Vec2::new(4.0 * step as f32, step as f32));
        dragging.push(frame(harness));
    }
    report(&format!("{name}: a drag"), dragging);
    harness.drop_at(middle + Vec2::new(160.0, 40.0));
    let start = Instant::now();
    let resting = until_quiet(harness);
    report(&format!("{name}: made well at rest, within {:.0?}", start.elapsed()), resting);
    report(&format!("{name}: nothing changes"), (0..10).map(|_| frame(harness)).collect());
}

/// A plane that moves through the mesh, with its outline.
fn measure_cut(harness: &mut Harness<Shown>) {
    let section = |harness: &mut Harness<Shown>, offset: f64| {
        let section = &mut harness.state_mut().viewer.meshes.settings.section;
        (section.is_on, section.normal, section.offset) = (true, glam::DVec3::Y, Some(offset));
    };
    section(harness, 0.0);
    report("cut: comes in", until_quiet(harness));
    let mut moving = Vec::new();
    for step in 0..40 {
        section(harness, 0.05 * f64::from(step));
        moving.push(frame(harness));
    }
    report("cut: the plane moves", moving);
    report("cut: at rest", until_quiet(harness));
    harness.state_mut().viewer.meshes.settings.section.is_on = false;
}

/// Draws until nothing is in the making.
fn until_quiet(harness: &mut Harness<Shown>) -> Vec<Times> {
    let mut times = Vec::new();
    for n_quiet in 0.. {
        times.push(frame(harness));
        std::thread::sleep(Duration::from_millis(2));
        if n_quiet > 4 && !harness.state().viewer.is_busy() {
            break;
        }
    }
    times
}

fn frame(harness: &mut Harness<Shown>) -> Times {
    let start = Instant::now();
    harness.step();
    let own = start.elapsed();
    harness.render().expect("there is a GPU, or software in its place");
    Times { own, whole: start.elapsed() }
}

fn report(what: &str, mut times: Vec<Times>) {
    let longest_own = times.iter().map(|times| times.own).max().unwrap_or_default();
    times.sort_by_key(|times| times.whole);
    let (median, worst) = (times[times.len() / 2].whole, times[times.len() - 1].whole);
    let n = times.len();
    println!(
        "{what}: {n} frames, median {median:.1?}, longest {worst:.1?} ({longest_own:.1?} its own)"
    );
}
