//! The element that is looked at: its mark in the picture, and all that is known of it.

use std::sync::Arc;

use eframe::egui::{self, Align2, Color32, Rect, Stroke, vec2};
use mve_modules::data::{Domain, TriMesh};

use super::Overlay;
use crate::views::background::{Progress, Task};
use crate::views::camera::Camera;
use crate::views::mesh::element::{Fact, facts, first_face_at, points_of};
use crate::views::mesh::hand::click::ClickSearch;
use crate::views::mesh::layout::Tile;
use crate::views::mesh::scene::{MeshScene, Screen};
use crate::views::picked::one_of;
use crate::views::{PickedElement, ViewerAction};

/// The overlay of the element, which a click picks.
#[derive(Default)]
pub struct Picked {
    search: ClickSearch,
    /// A face around this vertex, in the making.
    face: Option<(PickedElement, Task<Option<usize>>)>,
    /// Whether the number is to be typed at once.
    wants_focus: bool,
}

/// Width and height of a picture below which there is no room for what is known.
const LEAST: egui::Vec2 = vec2(150.0, 100.0);

/// Stands out from all color scales.
const MARK: Color32 = Color32::from_rgb(255, 235, 60);

impl Overlay for Picked {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        if scene.is_still {
            return;
        }
        if scene.settings.is_measuring {
            self.search = ClickSearch::default();
        } else if let Some(clicked) = self.search.take_in(ui, scene)
            && scene.picked != clicked.element.as_ref()
        {
            scene.actions.push(ViewerAction::Pick(clicked.element));
        }
        let shown = scene.picked.cloned().and_then(|picked| {
            let mesh = scene.meshes.iter().find(|mesh| mesh.title == picked.title)?;
            let is_its = |tile: &Tile| scene.meshes[tile.item].title == mesh.title;
            let (tile, viewpoint) =
                scene.tiles.iter().zip(scene.viewpoints).find(|(tile, _)| is_its(tile))?;
            let mesh = Arc::clone(&mesh.mesh);
            picked.is_in(&mesh).then_some((picked, mesh, tile.rect, viewpoint.camera))
        });
        self.wants_focus |= scene.is_number;
        match (shown, scene.meshes.first()) {
            (Some((picked, mesh, rect, camera)), _) => {
                paint_mark(ui, &Screen { rect }, &camera, (&mesh, &picked));
                // In a picture that is too small for it, it would hide all there is; and while
                // distances are measured, what to click next.
                let has_room = rect.width() >= LEAST.x && rect.height() >= LEAST.y;
                if has_room && !scene.settings.is_measuring {
                    self.read_out(ui, rect, scene, (&mesh, picked));
                }
            }
            (None, Some(first)) if scene.is_number && !first.mesh.positions.is_empty() => {
                let (title, domain) = (first.title.clone(), Domain::Vertex);
                let first = PickedElement { title, domain, index: 0 };
                scene.actions.push(ViewerAction::Pick(Some(first)));
                ui.ctx().request_repaint();
            }
            (None, _) => self.wants_focus &= scene.picked.is_none() && scene.is_number,
        }
        self.take_face(scene);
    }

    fn is_busy(&self) -> bool {
        self.search.is_busy() || self.face.is_some()
    }
}

/// A ring around a vertex, or the edges of a face.
fn paint_mark(
    ui: &egui::Ui,
    screen: &Screen,
    camera: &Camera,
    (mesh, picked): (&TriMesh, &PickedElement),
) {
    let painter = ui.painter_at(screen.rect);
    let place = |point| Some(screen.place(camera.project(point, screen.aspect())?));
    let places: Vec<_> = points_of(mesh, picked).into_iter().filter_map(place).collect();
    for (width, color) in [(4.0, Color32::from_black_alpha(160)), (2.0, MARK)] {
        let stroke = Stroke::new(width, color);
        match places.as_slice() {
            [at] => drop(painter.circle_stroke(*at, 6.0, stroke)),
            // Side by side: the joints of a closed line stand out far where an angle is small.
            &[a, b, c] => {
                for side in [[a, b], [b, c], [c, a]] {
                    painter.line_segment(side, stroke);
                }
            }
            _ => {}
        }
    }
}

impl Picked {
    /// What is known of the element, in the lower right corner.
    fn read_out(
        &mut self,
        ui: &egui::Ui,
        rect: Rect,
        scene: &mut MeshScene,
        (mesh, picked): (&Arc<TriMesh>, PickedElement),
    ) {
        let facts = facts(mesh, &picked, scene.fields);
        let area = egui::Area::new(ui.id().with("picked element")).order(egui::Order::Middle);
        let area = area.pivot(Align2::RIGHT_BOTTOM).fixed_pos(rect.right_bottom() - vec2(8.0, 8.0));
        area.show(ui.ctx(), |ui| {
            // Some of the picture stays in sight, and all that is beside it.
            ui.set_clip_rect(ui.clip_rect().intersect(rect));
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                let room = (rect.size() - vec2(32.0, 16.0)) * vec2(1.0, 0.6);
                ui.set_max_width(room.x.min(420.0));
                let all = egui::ScrollArea::both().max_height(room.y.min(300.0));
                let all = all.max_width(room.x.min(420.0)).min_scrolled_height(20.0);
                all.show(ui, |ui| {
                    ui.horizontal_wrapped(|ui| self.naming(ui, scene, mesh, &picked));
                    ui.horizontal_wrapped(|ui| buttons(ui, scene, (mesh, &picked), &facts));
                    egui::Grid::new("facts").num_columns(2).show(ui, |ui| {
                        for fact in &facts {
                            ui.weak(&fact.name);
                            ui.label(&fact.brief);
                            ui.end_row();
                        }
                    });
                });
            });
        });
    }

    /// Which element it is, to be changed.
    fn naming(
        &mut self,
        ui: &mut egui::Ui,
        scene: &mut MeshScene,
        mesh: &Arc<TriMesh>,
        picked: &PickedElement,
    ) {
        let mut new = picked.clone();
        for domain in [Domain::Vertex, Domain::Corner, Domain::Face] {
            let is_offered = domain != Domain::Corner || picked.domain == domain;
            if !is_offered || mesh.n_elements(domain) == 0 {
                continue;
            }
            if ui.selectable_label(picked.domain == domain, one_of(domain)).clicked() {
                match picked.seen_as(domain, mesh) {
                    Some(seen) => new = seen,
                    None => {
                        let (job, vertex) = (Arc::clone(mesh), picked.index);
                        let task = Task::spawn(ui.ctx(), move || first_face_at(&job, vertex));
                        self.face = Some((picked.clone(), task));
                    }
                }
            }
        }
        let is_another_kind = new.domain != picked.domain;
        let most = mesh.n_elements(new.domain).saturating_sub(1);
        let field = egui::DragValue::new(&mut new.index).range(0..=most);
        let field = ui.add(field.update_while_editing(false));
        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("number of the element"));
        if std::mem::take(&mut self.wants_focus) {
            field.request_focus();
        }
        ui.label(format!("of {}", picked.title));
        if new != *picked {
            // A number that is typed is gone to; while one is dragged the view stays.
            if !field.dragged() && !is_another_kind {
                scene.look_at = Some((new.clone(), Arc::clone(mesh)));
            }
            scene.actions.push(ViewerAction::Pick(Some(new)));
        }
    }

    /// Picks the face around a vertex, once it is found.
    fn take_face(&mut self, scene: &mut MeshScene) {
        let Some((vertex, task)) = &self.face else { return };
        let found = match task.poll() {
            Progress::Running => return,
            Progress::Done(found) => found,
            Progress::Lost => None,
        };
        if scene.picked == Some(vertex) {
            scene.actions.push(match found {
                Some(index) => {
                    let (title, domain) = (vertex.title.clone(), Domain::Face);
                    ViewerAction::Pick(Some(PickedElement { title, domain, index }))
                }
                None => ViewerAction::Say(format!("vertex {} is in no face", vertex.index)),
            });
        }
        self.face = None;
    }
}

fn buttons(
    ui: &mut egui::Ui,
    scene: &mut MeshScene,
    (mesh, picked): (&Arc<TriMesh>, &PickedElement),
    facts: &[Fact],
) {
    if ui.button("Go to it").on_hover_text("Turn it to the middle and the front").clicked() {
        scene.look_at = Some((picked.clone(), Arc::clone(mesh)));
    }
    if ui.button("Copy values").on_hover_text("All of it, with tabs between").clicked() {
        let first = format!("{}\t{}\t{}", one_of(picked.domain), picked.index, picked.title);
        let lines = facts.iter().map(|fact| format!("{}\t{}", fact.name, fact.exact));
        let lines: Vec<String> = std::iter::once(first).chain(lines).collect();
        ui.ctx().copy_text(lines.join("\n"));
    }
    let close = ui.button("×").on_hover_text("Look at no element");
    close.widget_info(|| {
        egui::WidgetInfo::labeled(egui::WidgetType::Button, true, "Look at no element")
    });
    if close.clicked() {
        scene.actions.push(ViewerAction::Pick(None));
    }
}
