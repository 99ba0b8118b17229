//! What is under a pointer that rests, looked up on another thread.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui;
use mve_modules::data::TriMesh;

use super::pick::{Hit, pick};
use crate::views::background::{Progress, Task};
use crate::views::camera::Ray;

/// Seconds without a move after which a pointer rests.
const REST_SECS: f32 = 0.15;

/// The question that was asked last, and its answer.
#[derive(Default)]
pub struct Hover {
    asked: Option<(Arc<TriMesh>, Ray)>,
    task: Option<Task<Option<Hit>>>,
    hit: Option<Hit>,
}

impl Hover {
    /// The pointer is elsewhere.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// What the ray of the pointer meets, once that is known.
    pub fn at(&mut self, ui: &egui::Ui, mesh: &Arc<TriMesh>, ray: Ray) -> Option<Hit> {
        let is_asked = self
            .asked
            .as_ref()
            .is_some_and(|(known, asked)| Arc::ptr_eq(known, mesh) && *asked == ray);
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
            let asked = Arc::clone(mesh);
            self.task = Some(Task::spawn(ui.ctx(), move || pick(&asked, &ray)));
            self.asked = Some((Arc::clone(mesh), ray));
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
