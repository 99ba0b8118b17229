//! Milliseconds of one frame of the canvas, without a window: layout, painting and tessellation.
//!
//! `cargo bench -p mve-editor --bench canvas`. The same nodes in an `egui::Scene`, with a widget
//! for each parameter, are timed beside it: it is what the canvas was chosen over.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use eframe::egui::{self, Context, Pos2, RawInput, Rect, Ui, Vec2};
use mve_core::{Link, Map, Node, PortRef};
use mve_editor::canvas::{Canvas, CanvasSettings, Scene};
use mve_editor::catalog::Catalog;
use mve_editor::document::Document;
use mve_editor::runner::{Runner, Shared};

/// A chain of simplifications in rows of twenty, each compared with the one before it.
fn map_of(n_nodes: usize) -> Map {
    let mut map = Map::parse("{\"mve\": 1}").expect("is a map");
    let port = |node: &str, port: &str| PortRef { node: node.to_owned(), port: port.to_owned() };
    for place in 0..n_nodes {
        let name = format!("n{place}");
        let module = if place % 2 == 0 { "Simplificator" } else { "MeshComparer" };
        let node = Node { module: module.to_owned(), ..Node::default() };
        map.nodes.insert(name.clone(), node);
        let at = [(place % 20) as f64 * 260.0, (place / 20) as f64 * 360.0];
        map.layout.insert(name.clone(), at);
        let before = |back: usize| format!("n{}", place - back);
        if place % 2 == 1 {
            let link = Link { from: port(&before(1), "mesh"), to: port(&name, "simplified") };
            map.links.push(link);
            if place > 2 {
                let link = Link { from: port(&before(3), "mesh"), to: port(&name, "original") };
                map.links.push(link);
            }
        } else if place > 0 {
            map.links.push(Link { from: port(&before(2), "mesh"), to: port(&name, "mesh") });
        }
    }
    map
}

fn frame(ctx: &Context, mut draw: impl FnMut(&mut Ui)) -> usize {
    let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(1600.0, 1000.0));
    let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
    let mut output = ctx.run_ui(input, |ui| draw(ui));
    // Nobody draws it.
    output.textures_delta.clear();
    ctx.tessellate(output.shapes, output.pixels_per_point).len()
}

fn canvas(c: &mut Criterion) {
    let mut group = c.benchmark_group("frame");
    group.sample_size(30);
    for n_nodes in [200, 1000] {
        let shared = Shared::new(mve_modules::registry(), 1 << 20, Box::new(|| {}), None);
        let catalog = Catalog::new(&shared.registry);
        let document = Document::from_text(&map_of(n_nodes).to_text()).expect("is a map");
        let runner = Runner::new(&shared);
        let settings = CanvasSettings::default();
        let scene = Scene {
            document: &document,
            runner: &runner,
            registry: &shared.registry,
            catalog: &catalog,
            settings: &settings,
            pinned: &[],
        };
        // All nodes in sight, as after a zoom to fit; and at full size, where most are out of it.
        for (name, is_close) in [("all in sight", false), ("full size", true)] {
            let ctx = Context::default();
            let mut canvas = Canvas::default();
            frame(&ctx, |ui| drop(canvas.show(ui, &scene)));
            if is_close {
                canvas.zoom_to(1.0);
            }
            group.bench_function(BenchmarkId::new(name, n_nodes), |bencher| {
                bencher.iter(|| black_box(frame(&ctx, |ui| drop(canvas.show(ui, &scene)))));
            });
        }
        let ctx = Context::default();
        let map = Arc::clone(document.map());
        let mut seen = Rect::from_min_size(Pos2::ZERO, Vec2::new(5200.0, 3600.0));
        group.bench_function(BenchmarkId::new("egui::Scene, all in sight", n_nodes), |bencher| {
            bencher.iter(|| black_box(frame(&ctx, |ui| in_scene(ui, &map, &shared, &mut seen))));
        });
    }
}

/// The nodes of a map as widgets in a scene that egui scales.
fn in_scene(ui: &mut Ui, map: &Map, shared: &Shared, seen: &mut Rect) {
    egui::Scene::new().zoom_range(0.05..=2.0).show(ui, seen, |ui| {
        for (name, node) in &map.nodes {
            let Some([x, y]) = map.layout.get(name).copied() else { continue };
            let Some(info) = shared.registry.find(&node.module) else { continue };
            let rect = Rect::from_min_size(Pos2::new(x as f32, y as f32), Vec2::new(220.0, 300.0));
            let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(rect).id_salt(name));
            egui::Frame::window(ui.style()).show(&mut ui, |ui| {
                ui.strong(name);
                info.module.inputs.iter().for_each(|input| drop(ui.label(input.name)));
                for param in info.module.params {
                    ui.horizontal(|ui| {
                        ui.label(param.name);
                        let mut number = 1.0;
                        ui.add(egui::DragValue::new(&mut number));
                    });
                }
            });
        }
    });
}

criterion_group!(benches, canvas);
criterion_main!(benches);
