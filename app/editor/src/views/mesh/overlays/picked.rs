//! The element that is looked at: picked by a click, and marked in the picture of its mesh.

use std::sync::Arc;

use eframe::egui::{self, Color32, Pos2, Shape, Stroke};
use mve_modules::data::{Domain, TriMesh};

use super::Overlay;
use crate::views::background::{Progress, Task};
use crate::views::mesh::hand::pick::{Hit, pick};
use crate::views::mesh::layout::part_of;
use crate::views::mesh::scene::{MeshScene, Screen};
use crate::views::{PickedElement, ViewerAction};

/// The overlay of the picked element.
#[derive(Default)]
pub struct Picked {
    /// What a click met, while it is looked for: the title of the mesh, and the face.
    task: Option<(String, Task<Option<Hit>>)>,
}

/// A color that neither surfaces nor scales have.
const COLOR: Color32 = Color32::from_rgb(255, 40, 200);
const SHADOW: Color32 = Color32::from_black_alpha(160);

impl Overlay for Picked {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        self.answer(scene);
        self.ask(ui, scene);
        let Some(picked) = scene.picked else { return };
        for (at, tile) in scene.tiles.iter().enumerate() {
            let input = &scene.meshes[tile.item];
            if input.title == picked.title && picked.is_in(&input.mesh) {
                let (clip, _) = part_of(tile.rect, scene.settings, at, scene.tiles.len());
                let screen = Screen { rect: tile.rect };
                mark(&ui.painter_at(clip), &screen, scene, (picked, &input.mesh));
            }
        }
    }
}

impl Picked {
    /// Looks for what a click met. A click that ends a drag is none.
    fn ask(&mut self, ui: &egui::Ui, scene: &MeshScene) {
        let Some(bounds) = scene.bounds.as_ref().filter(|_| !scene.is_still) else { return };
        let click = scene.responses.iter().enumerate().find_map(|(at, response)| {
            Some((at, response.interact_pointer_pos().filter(|_| response.clicked())?))
        });
        let Some((at, place)) = click else { return };
        let item = scene.visible_item(at, place);
        let is_it = |input: &&crate::views::mesh::scene::MeshInput| Arc::ptr_eq(&input.mesh, &item.mesh);
        let Some(input) = scene.meshes.iter().find(is_it) else { return };
        let screen = Screen { rect: scene.responses[at].rect };
        let ray = scene.camera.ray(screen.normalized(place), screen.aspect(), bounds);
        let mesh = Arc::clone(&item.mesh);
        let task = Task::spawn(ui.ctx(), move || pick(&mesh, &ray));
        self.task = Some((input.title.clone(), task));
    }

    fn answer(&mut self, scene: &mut MeshScene) {
        let Some((title, task)) = self.task.take() else { return };
        match task.poll() {
            Progress::Running => self.task = Some((title, task)),
            Progress::Lost => {}
            Progress::Done(hit) => {
                let picked = hit.map(|hit| {
                    let index = 3 * hit.face + hit.corner;
                    PickedElement { title, domain: Domain::Corner, index }
                });
                scene.actions.push(ViewerAction::Pick(picked));
            }
        }
    }
}

/// Draws the outline of a face and a dot at a vertex, over what hides them.
fn mark(
    painter: &egui::Painter,
    screen: &Screen,
    scene: &MeshScene,
    (picked, mesh): (&PickedElement, &TriMesh),
) {
    let aspect = screen.aspect();
    let place = |point| scene.camera.project(point, aspect).map(|at| screen.place(at));
    let places: Option<Vec<Pos2>> = picked.points(mesh).into_iter().map(place).collect();
    if let Some(places) = places.filter(|places| places.len() == 3) {
        let fill = COLOR.gamma_multiply(0.25);
        painter.add(Shape::convex_polygon(places.clone(), fill, Stroke::NONE));
        // Side by side: the joints of a closed line stand out far where an angle is small.
        for stroke in [Stroke::new(4.0, SHADOW), Stroke::new(2.0, COLOR)] {
            for k in 0..3 {
                painter.line_segment([places[k], places[(k + 1) % 3]], stroke);
            }
        }
    }
    // A face may be too small to be seen.
    let center = || {
        let points = picked.points(mesh);
        points.iter().copied().reduce(|a, b| a + b).map(|sum| sum / points.len() as f64)
    };
    if let Some(at) = picked.point(mesh).or_else(center).and_then(place) {
        let radius = if picked.domain == Domain::Face { 2.5 } else { 4.5 };
        painter.circle(at, radius, COLOR, Stroke::new(1.5, SHADOW));
    }
}
