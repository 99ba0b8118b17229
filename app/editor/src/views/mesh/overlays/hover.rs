//! What is under a pointer that rests, looked up on another thread and said beside it.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui;
use mve_modules::data::TriMesh;

use super::Overlay;
use crate::views::background::{Progress, Task};
use crate::views::camera::Ray;
use crate::views::mesh::hand::pick::{Hit, describe, pick};
use crate::views::mesh::scene::{MeshScene, Screen};
use crate::views::mesh::section::Plane;
use crate::views::mesh::viewpoint::Viewpoint;

/// Seconds without a move after which a pointer rests.
const REST_SECS: f32 = 0.15;

/// Where the pointer looks, and what is cut away from before it.
type Sight = (Ray, Option<Plane>);

/// The question that was asked last, and its answer.
#[derive(Default)]
pub struct Hover {
    question: Option<(Arc<TriMesh>, Sight)>,
    task: Option<Task<Option<Hit>>>,
    hit: Option<Hit>,
}

impl Overlay for Hover {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        let is_covered = ui.ctx().memory(|memory| memory.top_modal_layer().is_some());
        let place = scene.responses.iter().enumerate().find_map(|(at, response)| {
            let place = response.hover_pos().filter(|_| response.hovered() && !is_covered)?;
            Some((at, place))
        });
        let seen = place.and_then(|(at, place)| Some((at, place, scene.viewpoints.get(at)?)));
        let Some((at, place, Viewpoint { camera, bounds })) = seen else {
            self.forget();
            return;
        };
        let item = &scene.items[scene.visible_mesh(at, place)];
        let screen = Screen { rect: scene.responses[at].rect };
        let ray = camera.ray(screen.normalized(place), screen.aspect(), bounds);
        let Some(hit) = self.at(ui, &item.mesh, (ray, scene.plane)) else { return };
        let text = describe(&item.mesh, &hit, item.values().as_deref());
        let (id, anchor) = (scene.responses[at].id.with("read-out"), egui::PopupAnchor::Pointer);
        egui::Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), id, anchor)
            .gap(14.0)
            .show(|ui| ui.label(text));
    }

    fn is_busy(&self) -> bool {
        self.task.is_some()
    }
}

impl Hover {
    /// The pointer is elsewhere.
    fn forget(&mut self) {
        *self = Self::default();
    }

    /// What the ray of the pointer meets, once that is known.
    fn at(&mut self, ui: &egui::Ui, mesh: &Arc<TriMesh>, (ray, plane): Sight) -> Option<Hit> {
        let is_asked = self.question.as_ref().is_some_and(|(known, known_ray)| {
            Arc::ptr_eq(known, mesh) && *known_ray == (ray, plane)
        });
        if !is_asked {
            self.hit = None;
            let is_resting = ui.input(|input| {
                !input.pointer.any_down() && input.pointer.time_since_last_movement() > REST_SECS
            });
            if !is_resting {
                ui.ctx().request_repaint_after(Duration::from_secs_f32(REST_SECS + 0.01));
                return None;
            }
            // One at a time: the pointer may move faster than a large mesh is searched.
            if self.task.as_ref().is_some_and(|task| matches!(task.poll(), Progress::Running)) {
                return None;
            }
            let job = Arc::clone(mesh);
            self.task = Some(Task::spawn(ui.ctx(), move || pick(&job, &ray, plane.as_ref())));
            self.question = Some((Arc::clone(mesh), (ray, plane)));
        }
        if let Some(task) = &self.task {
            match task.poll() {
                Progress::Running => return None,
                Progress::Done(hit) => (self.hit, self.task) = (hit, None),
                Progress::Lost => self.task = None,
            }
        }
        self.hit
    }
}
