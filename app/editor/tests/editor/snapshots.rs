//! A few pictures of the window, compared with those in `tests/snapshots/`.
//!
//! They are drawn by one rasterizer only, Mesa's lavapipe, so that no GPU and no driver of a
//! machine decides. Where it is not there the tests say so and end; where `MVE_SNAPSHOTS=required`
//! they fail. `UPDATE_SNAPSHOTS=1 cargo test -p mve-editor snapshots` makes the pictures anew: look
//! at them before they go in.
//!
//! The tolerance is for another version of Mesa, which may round coverage and colors in another
//! way: see [`tolerance`].

use std::sync::Arc;

use crate::hand::Hand;
use eframe::egui::{self, Theme, Vec2};
use eframe::egui_wgpu::{RenderState, RendererOptions, WgpuSetup};
use eframe::wgpu;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use egui_kittest::{Harness, SnapshotOptions};
use mve_core::Value;
use mve_editor::views::{Arrangement, Distance, Pinned, PortState, StandardView, Viewer};
use mve_modules::data::{Domain, Field, TriMesh};
use mve_modules::mesh::fixtures::torus;

fn is_lavapipe(adapter: &wgpu::Adapter) -> bool {
    let info = adapter.get_info();
    info.backend == wgpu::Backend::Vulkan && info.driver == "llvmpipe"
}

/// The rasterizer that the pictures are made with; `None`, and a line that says so, without it.
fn rasterizer() -> Option<RenderState> {
    let WgpuSetup::CreateNew(mut setup) = default_wgpu_setup() else { return None };
    setup.instance_descriptor.backends = wgpu::Backends::VULKAN;
    setup.native_adapter_selector = Some(Arc::new(|adapters, _| {
        let found = adapters.iter().find(|adapter| is_lavapipe(adapter));
        found.cloned().ok_or_else(|| "lavapipe is not there".to_owned())
    }));
    let setup = WgpuSetup::CreateNew(setup);
    let instance = pollster::block_on(setup.new_instance());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    match adapters.iter().find(|adapter| is_lavapipe(adapter)) {
        Some(adapter) => println!("drawn by {}", adapter.get_info().driver_info),
        None => {
            let is_required = std::env::var("MVE_SNAPSHOTS").is_ok_and(|text| text == "required");
            assert!(!is_required, "lavapipe is not there: install mesa-vulkan-drivers");
            println!(
                "SKIPPED: lavapipe is not there (mesa-vulkan-drivers), no picture is compared"
            );
            return None;
        }
    }
    Some(create_render_state(setup, RendererOptions::PREDICTABLE))
}

/// A pixel may differ by a step that an eye hardly sees, and so many pixels by more. Text and
/// panels have whole pixels and hardly depend on a rasterizer, so few of theirs may; edges of a
/// mesh and lines do. The numbers are a judgement, and were tried the other way round: a patch of
/// 12 × 6 pixels of another color fails the canvas and the dialog, another hue or brightness the
/// meshes.
fn tolerance(n_pixels: usize) -> SnapshotOptions {
    SnapshotOptions::new().threshold(1.0).max_failed_pixels(n_pixels)
}

fn pin(title: &str, value: Value) -> Pinned {
    let (title, state) = (title.to_owned(), PortState::Ready);
    Pinned { title, value: Some(value), state, mesh: None }
}

/// A view by itself, once everything in it is made.
fn viewer(
    pinned: Vec<Pinned>,
    theme: Theme,
    set: impl Fn(&mut Viewer),
) -> Option<Harness<'static, Viewer>> {
    let render = rasterizer()?;
    let renderer = WgpuTestRenderer::from_render_state(render.clone());
    let show = move |ui: &mut egui::Ui, viewer: &mut Viewer| {
        viewer.show(ui, &pinned, Some(&render));
    };
    let builder = Harness::builder().with_size(Vec2::new(480.0, 360.0)).with_theme(theme);
    let mut viewer = Viewer::new();
    set(&mut viewer);
    let mut harness = builder.renderer(renderer).build_ui_state(show, viewer);
    for _ in 0..5 {
        harness.step();
        while harness.state().is_busy() {
            std::thread::sleep(std::time::Duration::from_millis(5));
            harness.step();
        }
    }
    Some(harness)
}

fn ring() -> TriMesh {
    torus(3.0, 1.2, 24)
}

#[test]
fn a_field_has_colors_and_a_bar() {
    let mesh = ring();
    let values = mesh.positions.iter().map(|point| point.x).collect();
    let unit = "mm".to_owned();
    let field = Field { name: "to the right".to_owned(), unit, domain: Domain::Vertex, values };
    let pinned = vec![pin("ring.mesh", Value::new(mesh)), pin("ring.field", Value::new(field))];
    let harness = viewer(pinned, Theme::Dark, |viewer| viewer.meshes.settings.has_box = true);
    let Some(mut harness) = harness else { return };
    harness.snapshot_options("field", &tolerance(300));
}

#[test]
fn a_wire_lies_over_the_surface() {
    let mut mesh = ring();
    // A gap, with a border.
    mesh.faces.drain(..100);
    let pinned = vec![pin("ring.mesh", Value::new(mesh))];
    let harness = viewer(pinned, Theme::Light, |viewer| {
        viewer.meshes.settings.lines.has_wire = true;
        viewer.meshes.settings.lines.has_border = true;
        viewer.meshes.camera.look_from(StandardView::Top);
        viewer.meshes.camera.pitch_rad = 0.7;
    });
    let Some(mut harness) = harness else { return };
    harness.snapshot_options("wire", &tolerance(600));
}

#[test]
fn a_section_shows_the_outlines_of_two_meshes() {
    let rings = [24, 8].map(|n| pin(&format!("ring-{n}.mesh"), Value::new(torus(3.0, 1.2, n))));
    let harness = viewer(rings.to_vec(), Theme::Dark, |viewer| {
        let meshes = &mut viewer.meshes;
        meshes.settings.arrangement = Arrangement::Wipe;
        (meshes.settings.section.is_on, meshes.settings.section.normal) = (true, glam::DVec3::Z);
        let ends = [[3.0, 0.0, 0.0], [-3.0, 0.0, 0.0]].map(glam::DVec3::from);
        let distance = Distance { name: "distance 1".to_owned(), of: None, ends };
        meshes.settings.distances = vec![distance];
        meshes.camera.look_from(StandardView::Top);
        meshes.camera.pitch_rad = 1.0;
    });
    let Some(mut harness) = harness else { return };
    harness.snapshot_options("section", &tolerance(600));
}

/// A window on the example, checked; its savers would write to the folder.
fn example(folder: &std::path::Path) -> Option<Hand> {
    let mut hand = Hand::with_example(folder, rasterizer()?, Vec2::new(1000.0, 640.0));
    assert_eq!(hand.problems(), Vec::<String>::new());
    Some(hand)
}

#[test]
fn the_canvas_shows_the_example() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let Some(mut hand) = example(folder.path()) else { return };
    hand.click_at("node simplify", 0.5, 0.05);
    hand.snapshot("canvas", &tolerance(60));
}

#[test]
fn a_dialog_lists_the_keys() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let Some(mut hand) = example(folder.path()) else { return };
    hand.press(egui::Key::F1);
    hand.step();
    hand.snapshot("keys", &tolerance(60));
}
