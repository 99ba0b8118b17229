//! How the camera came to stand where it stands: fitted to a scene, moved by a hand, or on its way
//! to an element.

use std::sync::Arc;

use eframe::egui;
use glam::DVec3;
use mve_modules::data::TriMesh;

use super::element::place_of;
use crate::views::PickedElement;
use crate::views::background::{Progress, Task};
use crate::views::camera::{Bounds, Camera};

/// A point, and what points from it to the viewer.
type Place = (DVec3, DVec3);

/// What is remembered of the place of the camera.
#[derive(Default)]
pub struct Placing {
    /// What was fitted last into which aspect.
    fitted: Option<(Bounds, f64)>,
    /// Whether a hand has moved since.
    pub has_moved: bool,
    /// The element to look at next, once its place is found.
    going: Option<(PickedElement, Task<Option<Place>>)>,
}

impl Placing {
    /// The place of a camera for another view of the same; one that no hand has placed, nor was
    /// kept, fits all into the other form.
    pub fn for_still(&self, is_kept: bool) -> Self {
        let fitted = self.fitted.filter(|_| self.has_moved || is_kept);
        Self { fitted, has_moved: self.has_moved, going: None }
    }

    /// Looks at all of a box.
    pub fn fit(&mut self, camera: &mut Camera, bounds: &Bounds, aspect: f64) {
        camera.fit(bounds, aspect);
        self.fitted = Some((*bounds, aspect));
        self.has_moved = false;
    }

    /// Whether what is shown is too different from what was fitted for the camera to stay. One
    /// that the user has placed stays for results of another run.
    pub fn is_other_scene(&self, bounds: &Bounds, aspect: f64) -> bool {
        let Some((fitted, fitted_aspect)) = &self.fitted else { return true };
        if !self.has_moved {
            return fitted != bounds || *fitted_aspect != aspect;
        }
        let (old, new) = (fitted.radius(), bounds.radius());
        let moved = (fitted.center() - bounds.center()).abs().max_element();
        moved > old || new > 2.0 * old || old > 2.0 * new
    }

    /// Begins to look for the place of an element.
    pub fn go_to(&mut self, context: &egui::Context, element: PickedElement, mesh: Arc<TriMesh>) {
        let sought = element.clone();
        self.going = Some((element, Task::spawn(context, move || place_of(&mesh, &sought))));
    }

    /// The element that was looked for and its place, once that is found.
    pub fn arrived(&mut self) -> Option<(PickedElement, Place)> {
        let (element, task) = self.going.take()?;
        match task.poll() {
            Progress::Running => {
                self.going = Some((element, task));
                None
            }
            Progress::Done(place) => Some((element, place?)),
            Progress::Lost => None,
        }
    }

    /// Whether an element is looked for.
    pub fn is_busy(&self) -> bool {
        self.going.is_some()
    }
}
