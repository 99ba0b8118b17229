//! The element that is looked at: its mark in the picture, and all that is known of it.

use eframe::egui::{self, Align2, Color32, Rect, Stroke, vec2};
use mve_modules::data::{Domain, TriMesh};

use super::Overlay;
use crate::views::mesh::element::{Fact, facts, place_of, points_of};
use crate::views::mesh::hand::click::ClickSearch;
use crate::views::mesh::scene::{MeshScene, Screen};
use crate::views::picked::{n_elements, one_of};
use crate::views::{PickedElement, ViewerAction};

/// The overlay of the element, which a click picks.
#[derive(Default)]
pub struct Picked {
    search: ClickSearch,
    /// Whether the number is to be typed at once.
    wants_focus: bool,
}

/// Stands out from all color scales.
const MARK: Color32 = Color32::from_rgb(255, 235, 60);

impl Overlay for Picked {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        if scene.is_still {
            return;
        }
        if !scene.settings.is_measuring
            && let Some(clicked) = self.search.take_in(ui, scene)
            && scene.picked != clicked.element.as_ref()
        {
            scene.actions.push(ViewerAction::Pick(clicked.element));
        }
        let shown = scene.picked.cloned().and_then(|picked| {
            let mesh = scene.meshes.iter().find(|mesh| mesh.title == picked.title)?;
            let tile =
                scene.tiles.iter().find(|tile| scene.meshes[tile.item].title == mesh.title)?;
            picked.is_in(&mesh.mesh).then(|| (picked, mesh.mesh.clone(), tile.rect))
        });
        self.wants_focus |= scene.is_number;
        match (shown, scene.meshes.first()) {
            (Some((picked, mesh, rect)), _) => {
                paint_mark(ui, &Screen { rect }, scene, (&mesh, &picked));
                self.read_out(ui, rect, scene, (&mesh, picked));
            }
            (None, Some(first)) if scene.is_number && !first.mesh.positions.is_empty() => {
                let (title, domain) = (first.title.clone(), Domain::Vertex);
                let first = PickedElement { title, domain, index: 0 };
                scene.actions.push(ViewerAction::Pick(Some(first)));
                ui.ctx().request_repaint();
            }
            (None, _) => self.wants_focus &= scene.picked.is_none() && scene.is_number,
        }
    }
}

/// A ring around a vertex, or the edges of a face.
fn paint_mark(
    ui: &egui::Ui,
    screen: &Screen,
    scene: &MeshScene,
    (mesh, picked): (&TriMesh, &PickedElement),
) {
    let painter = ui.painter_at(screen.rect);
    let place = |point| Some(screen.place(scene.camera.project(point, screen.aspect())?));
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
        (mesh, picked): (&TriMesh, PickedElement),
    ) {
        let facts = facts(mesh, &picked, scene.fields);
        let area = egui::Area::new(ui.id().with("picked element")).order(egui::Order::Middle);
        let area = area.pivot(Align2::RIGHT_BOTTOM).fixed_pos(rect.right_bottom() - vec2(8.0, 8.0));
        area.show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width((rect.width() - 32.0).clamp(120.0, 420.0));
                ui.horizontal_wrapped(|ui| self.naming(ui, scene, mesh, &picked));
                ui.horizontal_wrapped(|ui| buttons(ui, scene, (mesh, &picked), &facts));
                let room = (rect.height() - 110.0).clamp(40.0, 220.0);
                egui::ScrollArea::vertical().max_height(room).show(ui, |ui| {
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
        mesh: &TriMesh,
        picked: &PickedElement,
    ) {
        let mut new = picked.clone();
        for (domain, label) in [(Domain::Vertex, "vertex"), (Domain::Face, "face")] {
            if n_elements(mesh, domain) > 0 {
                ui.selectable_value(&mut new.domain, domain, label);
            }
        }
        if new.domain != picked.domain {
            new.index = new.index.min(n_elements(mesh, new.domain) - 1);
        }
        let most = n_elements(mesh, new.domain).saturating_sub(1);
        let field = egui::DragValue::new(&mut new.index).range(0..=most);
        let field = ui.add(field.update_while_editing(false));
        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("number of the element"));
        if std::mem::take(&mut self.wants_focus) {
            field.request_focus();
        }
        ui.label(format!("of {}", picked.title));
        if new != *picked {
            // A number that is typed is gone to; while one is dragged the view stays.
            if !field.dragged() && new.index != picked.index {
                scene.look_at = place_of(mesh, &new);
            }
            scene.actions.push(ViewerAction::Pick(Some(new)));
        }
    }
}

fn buttons(
    ui: &mut egui::Ui,
    scene: &mut MeshScene,
    (mesh, picked): (&TriMesh, &PickedElement),
    facts: &[Fact],
) {
    if ui.button("Go to it").on_hover_text("Turn it to the middle and the front").clicked() {
        scene.look_at = place_of(mesh, picked);
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
