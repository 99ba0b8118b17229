//! The table of a program's axes: each one or more parameters whose values advance together.

pub mod axis;
pub mod declare;
pub mod edit;
mod generate;
mod steps;
mod value;

use eframe::egui::{self, Frame, Grid, Id, RichText, ScrollArea, Ui};
use mve_core::ProgramSpec;
use serde_json::Value as Json;

use crate::programs::setup::axis::{
    Draft, add_value, can_generate, every, join, pick_path, range_of, show_handle, show_head,
    show_row_buttons, show_title, vary,
};
use crate::programs::setup::declare::{Declared, declared};
use crate::programs::setup::edit::{Axis, ProgramEdit, axis_of, n_rows};
use crate::programs::widgets::{drop_zone, icon_button, named, small_button};
use crate::programs::{ProgramAction, ProgramScene};

/// Rows of an axis beyond which it scrolls by itself.
const MOST_ROWS: usize = 14;
/// Height of a row, in points.
const ROW_HEIGHT: f32 = 22.0;

/// What the tables remember from frame to frame.
#[derive(Default)]
pub struct SetupState {
    /// What is open below the table of an axis.
    opened: Option<Opened>,
}

/// What is open below the table of an axis.
enum Opened {
    /// The parameters of the entry that a value names.
    Nested { axis: usize, path: String, row: usize },
    /// A list to be made.
    Generator { axis: usize, path: String, draft: Draft },
}

impl SetupState {
    /// Shows the axes and steps of a program; what a person changed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        spec: &ProgramSpec,
        actions: &mut Vec<ProgramAction>,
    ) -> Vec<ProgramEdit> {
        let mut edits = Vec::new();
        let frame = Frame::new().inner_margin(4);
        let dropped = drop_zone(ui, frame, |ui| {
            ui.set_min_width(ui.available_width());
            for (place, axis) in spec.axes.iter().enumerate() {
                self.show_axis(ui, scene, spec, (place, axis), &mut edits, actions);
                ui.add_space(6.0);
            }
            ui.horizontal_wrapped(|ui| {
                let button = ui.menu_button("\u{2795} Axis", |ui| {
                    if let Some(path) = pick_path(ui, scene, spec) {
                        edits.push(vary(&path, scene, spec));
                    }
                });
                named(button.response, "Add axis").on_hover_text("vary a parameter");
                ui.weak("or drag a parameter here from a node");
            });
            steps::show(ui, scene, spec, &mut edits);
            steps::show_limits(ui, spec, &mut edits);
        });
        if let Some(dragged) = dropped {
            let path = format!("{}.{}", dragged.node, dragged.param);
            edits.push(vary(&path, scene, spec));
        }
        edits
    }

    fn show_axis(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        spec: &ProgramSpec,
        (place, axis): (usize, &Axis),
        edits: &mut Vec<ProgramEdit>,
        actions: &mut Vec<ProgramAction>,
    ) {
        let frame = Frame::group(ui.style()).inner_margin(6);
        let dropped = drop_zone(ui, frame, |ui| {
            ui.set_min_width(ui.available_width());
            show_head(ui, place, axis, spec.axes.len(), edits);
            let is_long = n_rows(axis) > MOST_ROWS;
            let height = if is_long { 25.0 * MOST_ROWS as f32 } else { f32::INFINITY };
            let scroll = ScrollArea::both().id_salt(("axis", place)).max_height(height);
            let scroll = scroll.auto_shrink([false, true]);
            // The names are the first row; only rows that are seen are drawn.
            scroll.show_rows(ui, ROW_HEIGHT, n_rows(axis) + 1, |ui, seen| {
                let grid = Grid::new(("axis", place)).striped(true).start_row(seen.start);
                grid.min_row_height(ROW_HEIGHT).show(ui, |ui| {
                    for row in seen {
                        match row.checked_sub(1) {
                            None => self.show_names(ui, scene, (place, axis), edits, actions),
                            Some(row) => self.show_row(ui, scene, (place, axis), row, edits),
                        }
                    }
                });
            });
            self.show_opened(ui, scene, (place, axis), edits);
            ui.horizontal(|ui| {
                let name = format!("Add value to axis {}", place + 1);
                if icon_button(ui, "\u{2795} Value", &name).clicked() {
                    edits.push(add_value(scene, place, axis));
                }
                let button = ui.menu_button("\u{2795} Parameter", |ui| {
                    if let Some(path) = pick_path(ui, scene, spec) {
                        edits.push(join(scene, place, path));
                    }
                });
                let name = format!("Add parameter to axis {}", place + 1);
                named(button.response, &name)
                    .on_hover_text("a parameter that advances together with those of this axis");
            });
        });
        if let Some(dragged) = dropped {
            let path = format!("{}.{}", dragged.node, dragged.param);
            match axis_of(spec, &path) {
                Some(_) => edits.push(vary(&path, scene, spec)),
                None => edits.push(join(scene, place, path)),
            }
        }
    }

    /// The row of names above the values.
    fn show_names(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        (place, axis): (usize, &Axis),
        edits: &mut Vec<ProgramEdit>,
        actions: &mut Vec<ProgramAction>,
    ) {
        ui.label("");
        for (path, list) in axis {
            let declared = declared(scene.map, scene.registry, path);
            ui.horizontal(|ui| {
                let is_known = !matches!(declared, Declared::Unknown);
                let color = match is_known {
                    true => ui.visuals().strong_text_color(),
                    false => ui.visuals().warn_fg_color,
                };
                let label = egui::Link::new(RichText::new(path).color(color));
                let doc = declared.spec().map_or("no such parameter in the map", |spec| spec.doc);
                let doc =
                    if matches!(declared, Declared::Module(_)) { "the module itself" } else { doc };
                if ui.add(label).on_hover_text(doc).clicked() {
                    let node = path.split('.').next().unwrap_or_default();
                    actions.push(ProgramAction::ShowNode(node.to_owned()));
                }
                let name = format!("Make values of {path}");
                if can_generate(&declared) && small_button(ui, "\u{2699}", &name).clicked() {
                    self.open_generator(scene, place, path, &declared, list, edits);
                }
                let name = format!("Remove {path} from the axis");
                if axis.len() > 1 && small_button(ui, "\u{2716}", &name).clicked() {
                    edits.push(ProgramEdit::RemoveParam { axis: place, path: path.clone() });
                }
            });
        }
        ui.end_row();
    }

    /// One value of each parameter of an axis.
    fn show_row(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        (place, axis): (usize, &Axis),
        row: usize,
        edits: &mut Vec<ProgramEdit>,
    ) {
        show_handle(ui, place, row, edits);
        for (path, list) in axis {
            let Some(json) = list.get(row) else {
                ui.weak("\u{2013}").on_hover_text("this list is shorter than the others");
                continue;
            };
            let declared = declared(scene.map, scene.registry, path);
            let name = format!("{path}, value {}", row + 1);
            ui.horizontal(|ui| {
                let id = Id::new(("value", place, path, row));
                let counts = scene.counts_at(path, declared.spec());
                let edited = value::field(ui, id, &name, (&declared, &counts), json);
                if let Some(value) = edited {
                    edits.push(ProgramEdit::SetValue {
                        axis: place,
                        path: path.clone(),
                        row,
                        value,
                    });
                }
                let more = format!("Parameters of {name}");
                if !declared.nested(json).is_empty()
                    && small_button(ui, "\u{2026}", &more).clicked()
                {
                    let same = matches!(
                        &self.opened,
                        Some(Opened::Nested { axis: a, path: p, row: r })
                            if (*a, p, *r) == (place, path, row)
                    );
                    let opened = Opened::Nested { axis: place, path: path.clone(), row };
                    self.opened = (!same).then_some(opened);
                }
            });
        }
        show_row_buttons(ui, place, row, n_rows(axis), edits);
        ui.end_row();
    }

    fn open_generator(
        &mut self,
        scene: &ProgramScene,
        axis: usize,
        path: &str,
        declared: &Declared,
        list: &[Json],
        edits: &mut Vec<ProgramEdit>,
    ) {
        let Some(spec) = declared.spec() else { return };
        if !spec.options().is_empty() {
            // There is nothing to ask: all names, those that are there already as they are.
            let values = every(declared, list);
            edits.push(ProgramEdit::SetList { axis, path: path.to_owned(), values });
            return;
        }
        let draft = if spec.input_file().is_some() {
            let first = list.first().and_then(Json::as_str).unwrap_or_default();
            let folder = first.rsplit_once('/').map_or(".", |(folder, _)| folder).to_owned();
            let pattern = generate::pattern_of(spec);
            let found = generate::files(&scene.folder, &folder, &pattern);
            Draft::Files { folder, pattern, found }
        } else {
            Draft::Range(range_of(list, spec, &scene.counts_at(path, Some(spec))))
        };
        let is_open = matches!(&self.opened, Some(Opened::Generator { axis: a, path: p, .. })
            if (*a, p.as_str()) == (axis, path));
        let opened = Opened::Generator { axis, path: path.to_owned(), draft };
        self.opened = (!is_open).then_some(opened);
    }

    /// What is open below the table of an axis.
    fn show_opened(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        (place, axis): (usize, &Axis),
        edits: &mut Vec<ProgramEdit>,
    ) {
        let is_here = match &self.opened {
            Some(Opened::Nested { axis, .. } | Opened::Generator { axis, .. }) => *axis == place,
            None => false,
        };
        let Some(mut opened) = is_here.then(|| self.opened.take()).flatten() else { return };
        let frame =
            Frame::new().fill(ui.visuals().extreme_bg_color).inner_margin(6).corner_radius(4);
        let stays = frame.show(ui, |ui| match &mut opened {
            Opened::Nested { path, row, .. } => {
                let list = axis.get(path);
                let Some(json) = list.and_then(|list| list.get(*row)) else { return false };
                let declared = declared(scene.map, scene.registry, path);
                let name = format!("{path}, value {}", *row + 1);
                let stays = show_title(ui, &name);
                let id = Id::new(("nested", place, &*path, *row));
                if let Some(value) = value::nested(ui, id, &name, &declared, json) {
                    let (path, row) = (path.clone(), *row);
                    edits.push(ProgramEdit::SetValue { axis: place, path, row, value });
                }
                stays
            }
            Opened::Generator { path, draft, .. } => {
                let stays = show_title(ui, &format!("Values of {path}"));
                let declared = declared(scene.map, scene.registry, path);
                let Some(spec) = declared.spec() else { return false };
                let Some(values) = draft.show(ui, scene, spec) else { return stays };
                edits.push(ProgramEdit::SetList { axis: place, path: path.clone(), values });
                false
            }
        });
        if stays.inner {
            self.opened = Some(opened);
        }
    }
}
