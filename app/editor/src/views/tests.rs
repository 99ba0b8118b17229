//! Tests of whole views, drawn by software: what is where in the picture.

mod looking;

use std::path::Path;
use std::sync::Arc;

use eframe::egui;
use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use glam::DVec3;
use image::RgbaImage;
use mve_modules::data::{
    Domain, Field, Image, Images, Layer, LayerValues, Material, Measure, Measures, PixelKind,
    Texture, TextureImage, TextureRole, TriMesh, VertexId,
};
use mve_modules::mesh::fixtures::{cube, mesh_of};

use super::*;

struct Shown {
    viewer: Viewer,
    pinned: Vec<Pinned>,
    action: Option<ViewerAction>,
}

fn pinned(title: &str, value: Value) -> Pinned {
    let state = PortState::Ready;
    Pinned { title: title.to_owned(), value: Some(value), state, mesh: None }
}

fn harness(pinned: Vec<Pinned>) -> Harness<'static, Shown> {
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    harness_with(pinned, render, egui::vec2(400.0, 300.0))
}

fn harness_with(
    pinned: Vec<Pinned>,
    render: RenderState,
    size: egui::Vec2,
) -> Harness<'static, Shown> {
    let renderer = WgpuTestRenderer::from_render_state(render.clone());
    let mut shown = Shown { viewer: Viewer::new(), pinned, action: None };
    // Most of the models here lie in the xy plane and are looked at from the front.
    shown.viewer.meshes.settings.up = Some(UpAxis::Y);
    let show = move |ui: &mut egui::Ui, shown: &mut Shown| {
        let actions = shown.viewer.show(ui, &shown.pinned, Some(&render));
        shown.action = actions.into_iter().next().or(shown.action.take());
    };
    let builder = Harness::builder().with_size(size).renderer(renderer);
    builder.build_ui_state(show, shown)
}

/// Runs frames until nothing is in the making, and three more.
fn settle(harness: &mut Harness<Shown>) {
    for _ in 0..2000 {
        harness.step();
        if !harness.state().viewer.is_busy() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    for _ in 0..3 {
        harness.step();
    }
}

fn picture(harness: &mut Harness<Shown>) -> RgbaImage {
    settle(harness);
    let image = harness.render().unwrap();
    if let Ok(folder) = std::env::var("MVE_TEST_PICTURES") {
        let name = std::thread::current().name().unwrap_or("test").replace("::", "-");
        image.save(Path::new(&folder).join(name + ".png")).unwrap();
    }
    image
}

/// The panel of the mesh: below the row of controls, without caption and axes.
fn color_at(image: &RgbaImage, x: f32, y: f32) -> [i32; 3] {
    let (width, height) = (image.width() as f32, image.height() as f32);
    let [r, g, b, _] = image.get_pixel((x * width) as u32, (y * height) as u32).0;
    [r, g, b].map(i32::from)
}

fn brightness([r, g, b]: [i32; 3]) -> i32 {
    (r + g + b) / 3
}

#[test]
fn a_box_is_in_the_middle_of_a_quiet_background() {
    let mesh = Value::new(cube(DVec3::splat(1.0)));
    let mut harness = harness(vec![pinned("box.mesh", mesh)]);
    let image = picture(&mut harness);
    let middle = color_at(&image, 0.5, 0.55);
    let corners = [(0.97, 0.3), (0.97, 0.97), (0.03, 0.35)];
    for (x, y) in corners {
        let corner = color_at(&image, x, y);
        let apart = (brightness(middle) - brightness(corner)).abs();
        assert!(apart > 25, "middle {middle:?}, corner {corner:?}");
    }
    let [r, g, b] = middle;
    assert!((r - g).abs() < 12 && (g - b).abs() < 12, "neutral: {middle:?}");
    harness.get_by_label_contains("box.mesh: 12 faces, 8 vertices, closed");
}

/// Two squares, the first at z = 1 and smaller, the second at 0.
fn squares(near_color: DVec3, far_color: DVec3) -> TriMesh {
    let square = |half: f64, z: f64| {
        [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]]
    };
    let positions = [square(0.5, 1.0), square(1.0, 0.0)].concat();
    // The far one is drawn last.
    let mut mesh = mesh_of(&positions, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    mesh.set_layer(mve_modules::data::Layer {
        name: mve_modules::data::Layer::COLOR.to_owned(),
        domain: Domain::Face,
        values: mve_modules::data::LayerValues::Vec3(vec![near_color, far_color]),
        index: vec![0, 0, 1, 1],
    });
    mesh
}

#[test]
fn the_nearer_of_two_squares_hides_the_other() {
    let mesh = squares(DVec3::new(0.0, 1.0, 0.0), DVec3::new(1.0, 0.0, 0.0));
    let mut harness = harness(vec![pinned("squares.mesh", Value::new(mesh))]);
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    let image = picture(&mut harness);
    let [r, g, _] = color_at(&image, 0.5, 0.58);
    assert!(g > 100 && r < 60, "front: {r} {g}");
    // From behind, the far square is the nearer one.
    harness.state_mut().viewer.meshes.camera.yaw_rad = std::f64::consts::PI;
    harness.state_mut().viewer.meshes.settings.back_faces = BackFaces::Same;
    let image = picture(&mut harness);
    let [r, g, _] = color_at(&image, 0.5, 0.58);
    assert!(r > 100 && g < 60, "behind: {r} {g}");
    harness.state_mut().viewer.meshes.settings.back_faces = BackFaces::Hidden;
    let image = picture(&mut harness);
    let [r, g, b] = color_at(&image, 0.5, 0.58);
    assert!((r - g).abs() < 25 && (g - b).abs() < 25, "culled: {r} {g} {b}");
}

#[test]
fn a_wire_darkens_the_surface_along_edges_only() {
    let mesh = squares(DVec3::ONE, DVec3::ONE);
    let mut harness = harness(vec![pinned("squares.mesh", Value::new(mesh))]);
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    let dark_on = |image: &RgbaImage, y: f32| {
        let row = (0..100).map(|i| brightness(color_at(image, 0.4 + 0.002 * i as f32, y)));
        row.filter(|&value| value < 170).count()
    };
    let plain = picture(&mut harness);
    harness.state_mut().viewer.meshes.settings.lines.has_wire = true;
    let wired = picture(&mut harness);
    for y in [0.5, 0.55, 0.65] {
        assert_eq!(dark_on(&plain, y), 0);
        let dark = dark_on(&wired, y);
        assert!((1..=12).contains(&dark), "a diagonal, one pixel wide: {dark}");
    }
}

#[test]
fn a_pinned_field_colors_its_mesh_and_has_a_bar() {
    let mesh = squares(DVec3::ONE, DVec3::ONE);
    let field = Field {
        name: "depth".to_owned(),
        unit: "mm".to_owned(),
        domain: Domain::Face,
        values: vec![1.0, 1.0, 0.0, 0.0],
    };
    let list = vec![pinned("a.mesh", Value::new(mesh)), pinned("a.field", Value::new(field))];
    let mut harness = harness(list);
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    let image = picture(&mut harness);
    // Viridis ends in yellow, and begins in a dark violet.
    let [r, g, b] = color_at(&image, 0.36, 0.6);
    assert!(r > 140 && g > 130 && b < 90, "{r} {g} {b}");
    let bar = color_at(&image, 0.74 + 0.09, 0.9);
    assert!(bar[1] < 80, "the low end of the bar: {bar:?}");
}

#[test]
fn a_field_that_waits_for_its_new_values_stays_beside_its_new_mesh() {
    let domain = Domain::Vertex;
    let (name, unit, values) = ("depth".to_owned(), String::new(), vec![0.5; 8]);
    let field = Value::new(Field { name, unit, domain, values });
    let list = vec![pinned("a.mesh", Value::new(cube(DVec3::ONE))), pinned("a.field", field)];
    let mut harness = harness(list);
    settle(&mut harness);
    let is_table = |harness: &Harness<Shown>| harness.query_all_by_label("median").next().is_some();
    let waits = |harness: &Harness<Shown>| {
        harness.query_all_by_label("from an earlier run").next().is_some()
    };
    assert!(!is_table(&harness) && !waits(&harness));
    // A mesh of other counts is there, the field is on its way.
    let pinned = &mut harness.state_mut().pinned;
    let triangle = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    pinned[0].value = Some(Value::new(triangle));
    pinned[1].state = PortState::Outdated;
    settle(&mut harness);
    assert!(!is_table(&harness) && waits(&harness));
    // The run has ended, and the field is of no mesh here.
    harness.state_mut().pinned[1].state = PortState::Ready;
    settle(&mut harness);
    assert!(is_table(&harness) && !waits(&harness));
}

#[test]
fn tables_of_two_fields_have_ids_of_their_own() {
    let field = |name: &str| {
        let (name, unit, domain) = (name.to_owned(), String::new(), Domain::Vertex);
        Value::new(Field { name, unit, domain, values: vec![1.0, 2.0, 4.0] })
    };
    let list = vec![pinned("a.one", field("one")), pinned("a.two", field("two"))];
    let mut harness = harness(list);
    settle(&mut harness);
    assert_eq!(harness.query_all_by_label("median").count(), 2);
    let image = picture(&mut harness);
    // Bars have a red of their own.
    let is_red = |pixel: &&image::Rgba<u8>| matches!(pixel.0, [240..=255, 0..=20, 0..=20, _]);
    assert_eq!(image.pixels().filter(is_red).count(), 0, "egui warns of ids in red");
}

#[test]
fn nothing_is_drawn_anew_while_nothing_changes() {
    let mut harness = harness(vec![pinned("box.mesh", Value::new(cube(DVec3::ONE)))]);
    settle(&mut harness);
    let n_drawn = harness.state().viewer.meshes.n_drawn();
    for _ in 0..5 {
        harness.step();
    }
    assert_eq!(harness.state().viewer.meshes.n_drawn(), n_drawn);
    harness.state_mut().viewer.meshes.camera.yaw_rad += 0.1;
    harness.step();
    assert_eq!(harness.state().viewer.meshes.n_drawn(), n_drawn + 1);
}

#[test]
fn meshes_over_each_other_and_side_by_side() {
    let red = squares(DVec3::X, DVec3::X);
    let green = squares(DVec3::Y, DVec3::Y);
    let list = vec![pinned("a.mesh", Value::new(red)), pinned("b.mesh", Value::new(green))];
    let mut harness = harness(list);
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    harness.state_mut().viewer.meshes.settings.arrangement = Arrangement::Wipe;
    let is_red = |[r, g, _]: [i32; 3]| r > 100 && g < 60;
    let is_green = |[r, g, _]: [i32; 3]| g > 100 && r < 60;
    let image = picture(&mut harness);
    assert!(is_red(color_at(&image, 0.45, 0.6)) && is_green(color_at(&image, 0.55, 0.6)));
    harness.state_mut().viewer.meshes.settings.arrangement = Arrangement::Blend;
    let [r, g, _] = color_at(&picture(&mut harness), 0.5, 0.6);
    assert!((r - g).abs() < 20 && r > 60, "half of each: {r} {g}");
    harness.state_mut().viewer.meshes.settings.arrangement = Arrangement::SideBySide;
    let image = picture(&mut harness);
    assert!(is_red(color_at(&image, 0.25, 0.6)) && is_green(color_at(&image, 0.75, 0.6)));
    harness.get_by_label("Unpin b.mesh").click();
    settle(&mut harness);
    assert_eq!(harness.state().action, Some(ViewerAction::Unpin(1)));
}

#[test]
fn keys_and_pointer_move_the_camera() {
    let mut harness = harness(vec![pinned("box.mesh", Value::new(cube(DVec3::ONE)))]);
    settle(&mut harness);
    let fitted = harness.state().viewer.meshes.camera;
    let at = egui::pos2(200.0, 180.0);
    harness.drag_at(at);
    harness.step();
    harness.hover_at(at + egui::vec2(60.0, 20.0));
    harness.step();
    harness.drop_at(at + egui::vec2(60.0, 20.0));
    settle(&mut harness);
    let turned = harness.state().viewer.meshes.camera;
    assert!(turned.yaw_rad != fitted.yaw_rad && turned.pitch_rad > fitted.pitch_rad);
    assert_eq!(turned.distance, fitted.distance);
    harness.key_press(egui::Key::Num1);
    settle(&mut harness);
    let front = harness.state().viewer.meshes.camera;
    assert_eq!((front.yaw_rad, front.pitch_rad), (0.0, 0.0));
    harness.key_press(egui::Key::W);
    settle(&mut harness);
    assert!(harness.state().viewer.meshes.settings.lines.has_wire);
}

#[test]
fn strange_meshes_and_sizes_are_shown_or_explained() {
    let mut broken = cube(DVec3::ONE);
    broken.positions[0].x = f64::NAN;
    broken.faces.push([VertexId(7), VertexId(7), VertexId(99)]);
    let point = mesh_of(&[[5.0; 3]; 3], &[[0, 1, 2]]);
    let huge = mesh_of(&[[1e300, 0.0, 0.0], [0.0, -1e300, 0.0], [0.0, 0.0, 1e300]], &[[0, 1, 2]]);
    let list = vec![
        pinned("empty.mesh", Value::new(TriMesh::default())),
        pinned("broken.mesh", Value::new(broken)),
        pinned("point.mesh", Value::new(point)),
        pinned("huge.mesh", Value::new(huge)),
    ];
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    for size in [egui::vec2(500.0, 400.0), egui::vec2(3.0, 300.0), egui::vec2(40.0, 1.0)] {
        let render = match size.x as i32 {
            500 => render.clone(),
            _ => create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE),
        };
        let mut harness = harness_with(list.clone(), render, size);
        harness.state_mut().viewer.meshes.settings.lines.has_wire = true;
        harness.state_mut().viewer.meshes.settings.has_box = true;
        let section = &mut harness.state_mut().viewer.meshes.settings.section;
        (section.is_on, section.normal) = (true, DVec3::Z);
        for arrangement in [Arrangement::SideBySide, Arrangement::Wipe] {
            harness.state_mut().viewer.meshes.settings.arrangement = arrangement;
            settle(&mut harness);
        }
        if size.x > 400.0 {
            harness.state_mut().viewer.meshes.settings.arrangement = Arrangement::SideBySide;
            settle(&mut harness);
            harness.get_by_label_contains("nothing to draw");
            harness.get_by_label_contains("faces not drawn");
        }
    }
}

#[test]
fn values_of_other_types_are_shown() {
    let images = Images(vec![
        Image::filled("camera 0", [40, 30], PixelKind::Gray, 200),
        Image::filled("camera 1", [20_000, 3], PixelKind::Rgb, 90),
    ]);
    let largest = mve_core::Quantity::new("max", "The largest distance.");
    let measures = Measures(vec![Measure::of(&largest, 0.25)]);
    let field = Field {
        name: "distance".to_owned(),
        unit: String::new(),
        domain: Domain::Vertex,
        values: vec![0.0, 1.0, f64::NAN],
    };
    let absent = Pinned {
        title: "save.file".to_owned(),
        value: None,
        state: PortState::Absent("not run yet".to_owned()),
        mesh: None,
    };
    let list = vec![
        pinned("count.number", Value::new(1234.5)),
        pinned("name.text", Value::new("cow".to_owned())),
        pinned("render.images", Value::new(images.clone())),
        pinned("other.images", Value::new(images)),
        pinned("compare.measures", Value::new(measures)),
        pinned("compare.field", Value::new(field)),
        absent,
    ];
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let mut harness = harness_with(list, render, egui::vec2(1000.0, 700.0));
    let image = picture(&mut harness);
    assert_eq!(image.width(), 1000);
    harness.get_by_label("1234.5");
    harness.get_by_label("not run yet");
    harness.get_by_label("The largest distance.");
    harness.get_by_label("Show camera 1").click();
    settle(&mut harness);
    harness.get_by_label("Difference").click();
    settle(&mut harness);
    harness.get_by_label_contains("Picture difference × 4");
    harness.get_by_label("Sort by measure").click();
    settle(&mut harness);
}

/// The near square with a texture, the far one, which is seen around it, with a color.
fn textured(image: Option<Arc<TextureImage>>) -> TriMesh {
    let mut mesh = squares(DVec3::ONE, DVec3::ONE);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(glam::DVec2::from);
    let index = [0, 1, 2, 0, 2, 3].repeat(2);
    let texture = Texture {
        role: TextureRole::BaseColor,
        keyword: "map_Kd".to_owned(),
        options: String::new(),
        name: "half.jpg".to_owned(),
        place: 0,
        image,
    };
    let (front, back) = ("front".to_owned(), "back".to_owned());
    let statements = vec![("Kd".to_owned(), "0 0 1".to_owned())];
    mesh.materials = vec![
        Material { name: front, textures: vec![texture], ..Material::default() },
        Material { name: back, statements, ..Material::default() },
    ];
    let names = vec!["front".to_owned(), "back".to_owned()];
    for (name, domain, values, index) in [
        (Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(corners.to_vec()), index),
        (Layer::MATERIAL, Domain::Face, LayerValues::Label(names), vec![0, 0, 1, 1]),
    ] {
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    }
    mesh
}

#[test]
fn a_mesh_has_the_texture_that_its_material_names() {
    // Red above, green below.
    let mut half = Image::filled("texture", [16, 16], PixelKind::Rgb, 20);
    for (place, pixel) in half.bytes.chunks_exact_mut(3).enumerate() {
        pixel[usize::from(place >= 8 * 16)] = 220;
    }
    let half = Arc::new(TextureImage::new(half));
    let show = |image: Option<Arc<TextureImage>>| {
        let mesh = pinned("squares.mesh", Value::new(textured(image)));
        let mut harness = harness(vec![mesh]);
        harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
        let image = picture(&mut harness);
        (harness, image)
    };
    let (_, image) = show(Some(half));
    let [r, g, b] = color_at(&image, 0.5, 0.5);
    assert!(r > 130 && g < 70 && b < 70, "above: {r} {g} {b}");
    let [r, g, b] = color_at(&image, 0.5, 0.65);
    assert!(g > 130 && r < 70 && b < 70, "below: {r} {g} {b}");
    let [r, g, b] = color_at(&image, 0.5, 0.8);
    assert!(b > 130 && r < 70 && g < 70, "the color of a material without a texture: {r} {g} {b}");
    let (harness, image) = show(None);
    harness.get_by_label_contains("texture half.jpg is not there");
    let [r, g, b] = color_at(&image, 0.5, 0.6);
    assert!(r > 100 && (r - g).abs() < 25 && (g - b).abs() < 25, "plain: {r} {g} {b}");
}
