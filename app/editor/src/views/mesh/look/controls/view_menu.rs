//! The menu of views: directions, projection, what points up, and views that are kept by name.

use eframe::egui;

use super::{Offers, Wishes};
use crate::kept::{KeptEdit, Shelf};
use crate::views::camera::{Camera, Projection, StandardView, UpAxis};
use crate::views::mesh::look::named::NamedView;
use crate::views::mesh::look::settings::MeshSettings;

/// Names that are being typed.
#[derive(Default)]
pub struct NameFields {
    /// Of a view to be kept.
    new: String,
    /// The view that is being renamed, and its name to be.
    renamed: Option<(String, String)>,
}

/// Directions to look from, in pairs of opposites.
const DIRECTIONS: [[(StandardView, &str); 2]; 3] = [
    [(StandardView::Front, "Front (1)"), (StandardView::Back, "Back (Ctrl+1)")],
    [(StandardView::Side, "Right (3)"), (StandardView::Left, "Left (Ctrl+3)")],
    [(StandardView::Top, "Top (7)"), (StandardView::Bottom, "Bottom (Ctrl+7)")],
];

/// Shows the menu.
pub fn view_menu(
    ui: &mut egui::Ui,
    names: &mut NameFields,
    (settings, camera): (&mut MeshSettings, &mut Camera),
    offers: &Offers,
    wishes: &mut Wishes,
) {
    let mut look_from = |ui: &mut egui::Ui, (view, label): (StandardView, &str)| {
        if ui.button(label).clicked() {
            camera.look_from(view);
            wishes.is_fit = true;
        }
    };
    egui::Grid::new("directions").show(ui, |ui| {
        for pair in DIRECTIONS {
            pair.into_iter().for_each(|one| look_from(ui, one));
            ui.end_row();
        }
    });
    look_from(ui, (StandardView::Corner, "From a corner (0)"));
    ui.separator();
    ui.radio_value(&mut camera.projection, Projection::Perspective, "Perspective")
        .on_hover_text("What is near looks larger (5 switches)");
    ui.radio_value(&mut camera.projection, Projection::Orthographic, "Orthographic")
        .on_hover_text("Parallel lines stay parallel (5 switches)");
    ui.separator();
    let before = settings.up;
    ui.radio_value(&mut settings.up, None, "Up: as the model stands");
    ui.radio_value(&mut settings.up, Some(UpAxis::Y), "Y is up");
    ui.radio_value(&mut settings.up, Some(UpAxis::Z), "Z is up");
    wishes.is_fit |= settings.up != before;
    ui.separator();
    let number = ui.button("Element by number… (G)");
    if number.on_hover_text("Go to a vertex or a face by its number").clicked() {
        wishes.is_number = true;
        ui.close();
    }
    ui.separator();
    kept_views(ui, names, offers, wishes);
    keep_this(ui, names, (settings, camera), offers, wishes);
}

/// The views that are kept: each is looked from, renamed or removed.
fn kept_views(ui: &mut egui::Ui, names: &mut NameFields, offers: &Offers, wishes: &mut Wishes) {
    ui.label("Kept views");
    if offers.views.is_empty() {
        ui.weak("none yet");
    }
    let mut renamed = names.renamed.take();
    for (name, view) in &offers.views {
        ui.horizontal(|ui| {
            match &mut renamed {
                Some((of, to)) if of == name => {
                    let field = named_field(ui, to, &format!("new name of view {name}"));
                    if field.lost_focus() {
                        let is_entered = ui.input(|input| input.key_pressed(egui::Key::Enter));
                        let (name, to) = (name.clone(), to.trim().to_owned());
                        if is_entered && to != name {
                            let shelf = Shelf::Views;
                            wishes.kept.push(KeptEdit::Rename { shelf, name, to });
                        }
                        renamed = None;
                    } else {
                        field.request_focus();
                    }
                    return;
                }
                _ => {
                    let button = ui.button(name.as_str());
                    if button.on_hover_text("Look so: camera, colors, section").clicked() {
                        wishes.view = Some(view.clone());
                    }
                }
            }
            let rename = ui.small_button("Rename");
            set_name(&rename, &format!("Rename view {name}"));
            if rename.clicked() {
                renamed = Some((name.clone(), name.clone()));
            }
            let remove = ui.small_button("×");
            set_name(&remove, &format!("Remove view {name}"));
            if remove.on_hover_text("Keep it no longer (Ctrl+Z brings it back)").clicked() {
                wishes.kept.push(KeptEdit::Remove { shelf: Shelf::Views, name: name.clone() });
            }
        });
    }
    names.renamed = renamed;
}

/// What is seen, kept under a name.
fn keep_this(
    ui: &mut egui::Ui,
    names: &mut NameFields,
    (settings, camera): (&MeshSettings, &Camera),
    offers: &Offers,
    wishes: &mut Wishes,
) {
    ui.horizontal(|ui| {
        let field = named_field(ui, &mut names.new, "name of the view to keep");
        let name = names.new.trim().to_owned();
        let known = offers.views.iter().find(|(known, _)| *known == name);
        let label = if known.is_some() { "Replace view" } else { "Keep view" };
        let button = ui.add_enabled(!name.is_empty(), egui::Button::new(label));
        let button = button.on_hover_text("Keep camera, colors, range and section in the map");
        let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        if (button.clicked() || is_entered) && !name.is_empty() {
            let mut view = NamedView::of(settings, camera);
            // Its pictures stay as large as they are.
            view.picture = known.and_then(|(_, known)| known.picture);
            let content = view.to_json();
            wishes.kept.push(KeptEdit::Put { shelf: Shelf::Views, name, content });
            names.new.clear();
        }
    });
}

fn named_field(ui: &mut egui::Ui, text: &mut String, name: &str) -> egui::Response {
    let field = egui::TextEdit::singleline(text).desired_width(130.0).hint_text("name");
    let field = ui.add(field);
    ui.ctx().accesskit_node_builder(field.id, |node| node.set_label(name));
    field
}

fn set_name(button: &egui::Response, name: &str) {
    button.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, name));
}
