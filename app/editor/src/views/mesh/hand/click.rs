//! What a click in a picture meets, looked for on another thread.

use std::sync::Arc;

use eframe::egui::{self, Pos2};
use glam::DVec3;
use mve_modules::data::{Domain, TriMesh};
use rayon::prelude::*;

use super::pick::{Hit, pick};
use crate::views::PickedElement;
use crate::views::background::{Progress, Task};
use crate::views::camera::Camera;
use crate::views::mesh::scene::{MeshScene, Screen};
use crate::views::mesh::section::Plane;
use crate::views::mesh::viewpoint::Viewpoint;

/// How near to a vertex a click has to be to mean it, in points.
const NEAR: f32 = 9.0;

/// A click whose answer is awaited.
struct Question {
    title: String,
    mesh: Arc<TriMesh>,
    camera: Camera,
    screen: Screen,
    plane: Option<Plane>,
    place: Pos2,
    task: Task<Option<Hit>>,
}

/// The last click.
#[derive(Default)]
pub struct ClickSearch(Option<Question>);

/// What a click has met.
#[derive(Clone, Debug, PartialEq)]
pub struct Clicked {
    /// The element; `None` beside all meshes.
    pub element: Option<PickedElement>,
    /// Where: a vertex, where that is meant, or a point of a face.
    pub point: DVec3,
}

impl ClickSearch {
    /// Whether a click waits for its answer.
    pub fn is_busy(&self) -> bool {
        self.0.is_some()
    }

    /// Takes in clicks, and gives what one has met once that is known.
    pub fn take_in(&mut self, ui: &egui::Ui, scene: &MeshScene) -> Option<Clicked> {
        if let Some(question) = Self::asked(ui, scene) {
            self.0 = Some(question);
        }
        let question = self.0.take()?;
        match question.task.poll() {
            Progress::Running => {
                self.0 = Some(question);
                None
            }
            Progress::Done(hit) => Some(question.answer(hit)),
            Progress::Lost => None,
        }
    }

    fn asked(ui: &egui::Ui, scene: &MeshScene) -> Option<Question> {
        let clicked = scene.responses.iter().enumerate().find(|(_, one)| one.clicked())?;
        // A key that clicks has no place.
        let (tile, place) = (clicked.0, clicked.1.interact_pointer_pos()?);
        let at = scene.visible_mesh(tile, place);
        let screen = Screen { rect: clicked.1.rect };
        let Viewpoint { camera, bounds } = *scene.viewpoints.get(tile)?;
        let ray = camera.ray(screen.normalized(place), screen.aspect(), &bounds);
        let mesh = Arc::clone(&scene.items[at].mesh);
        let (job, plane) = (Arc::clone(&mesh), scene.plane);
        let task = Task::spawn(ui.ctx(), move || {
            let hit = pick(&job, &ray, plane.as_ref());
            hit.or_else(|| corner_near(&job, (&camera, &screen), place, plane.as_ref()))
        });
        let title = scene.meshes[at].title.clone();
        Some(Question { title, mesh, camera, screen, plane, place, task })
    }
}

/// The corner that is seen nearest to a place where nothing is hit: beside a tip or a border it is
/// meant. O(n).
fn corner_near(
    mesh: &TriMesh,
    (camera, screen): (&Camera, &Screen),
    place: Pos2,
    plane: Option<&Plane>,
) -> Option<Hit> {
    let of_corner = |at: usize| {
        let (face, corner) = (at / 3, at % 3);
        let point = *mesh.positions.get(mesh.faces[face][corner].idx())?;
        if plane.is_some_and(|plane| plane.height(point) > 0.0) {
            return None;
        }
        let seen = screen.place(camera.project(point, screen.aspect())?);
        let away = seen.distance(place);
        let distance = camera.eye().distance(point);
        (away <= NEAR).then_some((away, Hit { face, corner, point, distance }))
    };
    let near = (0..3 * mesh.faces.len()).into_par_iter().with_min_len(1 << 14);
    near.filter_map(of_corner)
        .min_by(|(a, of_a), (b, of_b)| {
            let is_nearer = a.total_cmp(b).then(of_a.distance.total_cmp(&of_b.distance));
            is_nearer.then((of_a.face, of_a.corner).cmp(&(of_b.face, of_b.corner)))
        })
        .map(|(_, hit)| hit)
}

impl Question {
    fn answer(self, hit: Option<Hit>) -> Clicked {
        let Self { title, mesh, camera, screen, plane, place, .. } = self;
        let Some(hit) = hit else { return Clicked { element: None, point: DVec3::ZERO } };
        let vertex = mesh.faces[hit.face][hit.corner].idx();
        let corner = mesh.positions[vertex];
        // A corner that is cut away is not seen, however near it is.
        let is_cut = plane.is_some_and(|plane| plane.height(corner) > 0.0);
        let seen = camera.project(corner, screen.aspect()).filter(|_| !is_cut);
        let seen = seen.map(|at| screen.place(at));
        let (domain, index, point) = match seen.is_some_and(|at| at.distance(place) <= NEAR) {
            true => (Domain::Vertex, vertex, corner),
            false => (Domain::Face, hit.face, hit.point),
        };
        Clicked { element: Some(PickedElement { title, domain, index }), point }
    }
}
