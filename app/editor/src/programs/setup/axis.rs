//! Parts of an axis's table: its head, the handles of its rows, and lists to be made.

use eframe::egui::{self, DragValue, Id, RichText, Ui};
use mve_core::{ParamSpec, ProgramSpec, chosen};
use serde_json::Value as Json;

use crate::forms::{halves, known_count};
use crate::programs::ProgramScene;
use crate::programs::setup::declare::{Declared, current, declared, paths, second};
use crate::programs::setup::edit::{Axis, ProgramEdit, axis_of, is_even, n_rows};
use crate::programs::setup::generate::{self, Progression, Range};
use crate::programs::widgets::{count, named, small_button};

/// Values of a new axis of what is counted in an input.
const N_HALVES: usize = 3;

/// A list to be made.
pub enum Draft {
    /// Numbers.
    Range(Range),
    /// Files of a folder.
    Files {
        /// The folder, relative to the map's file.
        folder: String,
        /// Names that match.
        pattern: String,
        /// The files, when they were looked for last.
        found: Result<Vec<Json>, String>,
    },
}

/// A row while it is dragged.
#[derive(Clone, Copy, PartialEq, Eq)]
struct DraggedRow {
    axis: usize,
    row: usize,
}

/// The edit that varies one more parameter, or gives one that is varied one more value.
pub fn vary(path: &str, scene: &ProgramScene, spec: &ProgramSpec) -> ProgramEdit {
    let declared = declared(scene.map, scene.registry, path);
    match axis_of(spec, path) {
        Some(axis) => add_value(scene, axis, &spec.axes[axis]),
        None => {
            let first = current(scene.map, scene.registry, path);
            let counts = scene.counts_at(path, declared.spec());
            let values = declared.spec().map_or(Vec::new(), |spec| fewer(spec, &first, &counts));
            if !values.is_empty() {
                return ProgramEdit::AddAxis { path: path.to_owned(), values };
            }
            let other = second(&declared, &first, &scene.folder);
            let values = if first == other { vec![first] } else { vec![first, other] };
            ProgramEdit::AddAxis { path: path.to_owned(), values }
        }
    }
}

/// Ever fewer of what a parameter counts, from its value on, or from half of what is there where
/// it is off or asks for more than that; none where it is not known what is there.
fn fewer(spec: &ParamSpec, first: &Json, counts: &[(&str, usize)]) -> Vec<Json> {
    let Some(n) = known_count(spec, counts) else { return Vec::new() };
    let Some(given) = first.as_f64().filter(|given| *given >= 1.0 && *given < n as f64) else {
        return halves(spec, counts, N_HALVES);
    };
    let mut values = vec![first.clone()];
    values.extend(halves(spec, &[(spec.unit, given as usize)], N_HALVES - 1));
    values.dedup();
    values
}

/// The edit that adds a row to an axis: a value that goes on from the last ones where that makes
/// sense, else the same once more.
pub fn add_value(scene: &ProgramScene, place: usize, axis: &Axis) -> ProgramEdit {
    let row = n_rows(axis).saturating_sub(1);
    let again = ProgramEdit::AddRow { axis: place, row };
    let Some((path, list)) = axis.first().filter(|_| axis.len() == 1) else { return again };
    let declared = declared(scene.map, scene.registry, path);
    let counts = scene.counts_at(path, declared.spec());
    let Some(value) = next_value(scene, (&declared, &counts), list) else { return again };
    let values = list.iter().cloned().chain([value]).collect();
    ProgramEdit::SetList { axis: place, path: path.clone(), values }
}

/// A value that goes on from a list and is not in it.
fn next_value(
    scene: &ProgramScene,
    (declared, counts): (&Declared, &[(&str, usize)]),
    list: &[Json],
) -> Option<Json> {
    let options = declared.options();
    if !options.is_empty() {
        let is_free = |id: &Json| list.iter().all(|known| !names(known, id));
        return options.iter().map(|option| Json::from(option.id)).find(is_free);
    }
    let last = list.last()?;
    let numbers: Vec<f64> = list.iter().rev().take(2).filter_map(Json::as_f64).collect();
    let next = match (numbers.as_slice(), declared.spec()) {
        ([y, x], Some(spec)) if x != y => {
            let is_geometric = x * y > 0.0 && !(0.7..1.5).contains(&(y / x));
            let next = if is_geometric { y * y / x } else { y + (y - x) };
            let range = Range { from: next, to: next, count: 1, spacing: Progression::Arithmetic };
            range.values(spec).pop()?
        }
        (_, spec) => {
            let fewer = spec.map_or(Vec::new(), |spec| fewer(spec, last, counts));
            let next = fewer.into_iter().find(|value| !list.contains(value));
            next.unwrap_or_else(|| second(declared, last, &scene.folder))
        }
    };
    (!list.contains(&next)).then_some(next)
}

/// The edit that lets a parameter advance with those of an axis.
pub fn join(scene: &ProgramScene, axis: usize, path: String) -> ProgramEdit {
    let value = current(scene.map, scene.registry, &path);
    ProgramEdit::JoinAxis { axis, path, value }
}

/// A menu of the parameters that a program does not vary yet, node by node.
pub fn pick_path(ui: &mut Ui, scene: &ProgramScene, spec: &ProgramSpec) -> Option<String> {
    let mut picked = None;
    let all = paths(scene.map, scene.registry);
    for node in scene.map.nodes.keys() {
        let of_node = |path: &&String| path.split_once('.').is_some_and(|(name, _)| name == node);
        let of_node: Vec<_> = all.iter().filter(of_node).collect();
        if of_node.is_empty() {
            continue;
        }
        let menu = ui.menu_button(node.as_str(), |ui| {
            egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for path in of_node {
                    let is_free = axis_of(spec, path).is_none();
                    let name = path.split_once('.').map_or(path.as_str(), |(_, param)| param);
                    let response = ui.add_enabled(is_free, egui::Button::new(name));
                    let declared = declared(scene.map, scene.registry, path);
                    let doc = declared.spec().map_or("", |spec| spec.doc);
                    let response = response.on_disabled_hover_text("is varied already");
                    if response.on_hover_text(doc).clicked() {
                        picked = Some(path.clone());
                        ui.close();
                    }
                }
            });
        });
        named(menu.response, &format!("Parameters of {node}"));
    }
    if all.is_empty() {
        ui.weak("The map has no parameters.");
    }
    picked
}

/// The line above an axis's table.
pub fn show_head(
    ui: &mut Ui,
    place: usize,
    axis: &Axis,
    n_axes: usize,
    edits: &mut Vec<ProgramEdit>,
) {
    ui.horizontal(|ui| {
        ui.strong(format!("Axis {}", place + 1));
        ui.weak(count(n_rows(axis), "value"));
        if !is_even(axis) {
            ui.colored_label(ui.visuals().error_fg_color, "lists differ in length");
            let even_out =
                named(ui.small_button("Even out"), &format!("Even out axis {}", place + 1));
            if even_out.on_hover_text("short lists repeat their last value").clicked() {
                edits.push(ProgramEdit::EvenOut { axis: place });
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if small_button(ui, "\u{1f5d1}", &format!("Remove axis {}", place + 1)).clicked() {
                edits.push(ProgramEdit::RemoveAxis { axis: place });
            }
            let is_last = place + 1 == n_axes;
            ui.add_enabled_ui(!is_last, |ui| {
                let name = format!("Move axis {} down: it varies faster", place + 1);
                if small_button(ui, "\u{2b07}", &name).clicked() {
                    edits.push(ProgramEdit::MoveAxis { from: place, to: place + 1 });
                }
            });
            ui.add_enabled_ui(place > 0, |ui| {
                let name = format!("Move axis {} up: it varies more slowly", place + 1);
                if small_button(ui, "\u{2b06}", &name).clicked() {
                    edits.push(ProgramEdit::MoveAxis { from: place, to: place - 1 });
                }
            });
        });
    });
}

/// What a row is dragged by; another row that is dropped on it takes its place.
pub fn show_handle(ui: &mut Ui, axis: usize, row: usize, edits: &mut Vec<ProgramEdit>) {
    let id = Id::new(("row", axis, row));
    let dragged = DraggedRow { axis, row };
    let handle = ui.dnd_drag_source(id, dragged, |ui| {
        ui.add(egui::Label::new(RichText::new(format!("{:>2}", row + 1)).monospace().weak()))
    });
    let response = handle.response.on_hover_text("drag to move this value");
    let rect = response.rect;
    let over = response.dnd_hover_payload::<DraggedRow>().filter(|over| over.axis == axis);
    if over.is_some_and(|over| over.row != row) {
        let stroke = ui.visuals().selection.stroke;
        ui.painter().hline(rect.x_range(), rect.top(), stroke);
    }
    // A row of another axis is put back for that one to take.
    let released = response.dnd_hover_payload::<DraggedRow>().is_some_and(|over| over.axis == axis);
    if released
        && let Some(dropped) = response.dnd_release_payload::<DraggedRow>()
        && dropped.row != row
    {
        edits.push(ProgramEdit::MoveRow { axis, from: dropped.row, to: row });
    }
}

/// The buttons behind a row.
pub fn show_row_buttons(
    ui: &mut Ui,
    axis: usize,
    row: usize,
    n: usize,
    edits: &mut Vec<ProgramEdit>,
) {
    let of = format!("value {} of axis {}", row + 1, axis + 1);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.add_enabled_ui(row > 0, |ui| {
            if small_button(ui, "\u{2b06}", &format!("Move {of} up")).clicked() {
                edits.push(ProgramEdit::MoveRow { axis, from: row, to: row - 1 });
            }
        });
        ui.add_enabled_ui(row + 1 < n, |ui| {
            if small_button(ui, "\u{2b07}", &format!("Move {of} down")).clicked() {
                edits.push(ProgramEdit::MoveRow { axis, from: row, to: row + 1 });
            }
        });
        if small_button(ui, "\u{2716}", &format!("Remove {of}")).clicked() {
            edits.push(ProgramEdit::RemoveRow { axis, row });
        }
    });
}

/// Whether a list of a parameter's values can be made.
pub fn can_generate(declared: &Declared) -> bool {
    declared.spec().is_some_and(|spec| {
        spec.range().is_some() || spec.input_file().is_some() || !spec.options().is_empty()
    })
}

/// Whether a value names the option of this id.
fn names(value: &Json, id: &Json) -> bool {
    chosen(value).is_some_and(|(named, _)| id.as_str() == Some(named))
}

/// Every name that a value may have, those that are there already first and as they are.
pub fn every(declared: &Declared, list: &[Json]) -> Vec<Json> {
    let options = declared.options();
    let missing = options
        .iter()
        .map(|option| Json::from(option.id))
        .filter(|id| list.iter().all(|known| !names(known, id)));
    list.iter().cloned().chain(missing).collect()
}

/// A range from the first to the last of some values; where there is no second one, down from half
/// of what is known to be there of what the parameter counts.
pub fn range_of(list: &[Json], spec: &ParamSpec, counts: &[(&str, usize)]) -> Range {
    let numbers: Vec<f64> = list.iter().filter_map(Json::as_f64).collect();
    if let Some(n) = known_count(spec, counts).filter(|_| numbers.len() < 2) {
        let half = (0.5 * n as f64).round();
        let (count, spacing) = (5, Progression::Geometric);
        return Range { from: half, to: (half / 16.0).round().max(1.0), count, spacing };
    }
    let from = numbers.first().copied().unwrap_or(1.0);
    let to = numbers.last().copied().filter(|to| *to != from).unwrap_or(from * 10.0);
    let spacing = match from * to > 0.0 && (to / from > 3.0 || from / to > 3.0) {
        true => Progression::Geometric,
        false => Progression::Arithmetic,
    };
    Range { from, to, count: numbers.len().max(5), spacing }
}

impl Draft {
    /// Shows the form of a list to be made; its values, once they are wanted.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        spec: &ParamSpec,
    ) -> Option<Vec<Json>> {
        let values = match self {
            Self::Range(range) => {
                show_range(ui, range);
                Ok(range.values(spec))
            }
            Self::Files { folder, pattern, found } => {
                let mut is_changed = false;
                ui.horizontal_wrapped(|ui| {
                    let mut line = |ui: &mut Ui, text: &mut String, name: &str, width: f32| {
                        ui.label(name.to_lowercase());
                        let field = egui::TextEdit::singleline(text).desired_width(width);
                        is_changed |= named(ui.add(field), name).changed();
                    };
                    line(ui, folder, "Folder", 160.0);
                    line(ui, pattern, "Names", 110.0);
                });
                if is_changed {
                    *found = generate::files(&scene.folder, folder, pattern);
                }
                found.clone()
            }
        };
        let mut is_wanted = false;
        ui.horizontal_wrapped(|ui| match &values {
            Err(error) => {
                ui.colored_label(ui.visuals().error_fg_color, error);
            }
            Ok(values) => {
                let button = ui.add_enabled(!values.is_empty(), egui::Button::new("Set values"));
                is_wanted = named(button, "Set values").clicked();
                let some = values.iter().take(8).map(mve_core::brief_value);
                let more = if values.len() > 8 { ", \u{2026}" } else { "" };
                let some = some.collect::<Vec<_>>().join(", ");
                ui.weak(format!("{}: {some}{more}", count(values.len(), "value")));
            }
        });
        values.ok().filter(|_| is_wanted)
    }
}

fn show_range(ui: &mut Ui, range: &mut Range) {
    ui.horizontal_wrapped(|ui| {
        let number = |ui: &mut Ui, number: &mut f64, name: &str| {
            let speed = (number.abs() / 100.0).max(1e-3);
            ui.label(name.to_lowercase());
            named(ui.add(DragValue::new(number).speed(speed).max_decimals(12)), name);
        };
        number(ui, &mut range.from, "From");
        number(ui, &mut range.to, "To");
        ui.label("in");
        let steps = DragValue::new(&mut range.count).range(1..=generate::MOST_VALUES).speed(0.1);
        named(ui.add(steps), "How many");
        ui.label("values");
        let mut spacing = |spacing: Progression, name: &str, about: &str| {
            let choice = ui.selectable_label(range.spacing == spacing, name);
            if choice.on_hover_text(about).clicked() {
                range.spacing = spacing;
            }
        };
        spacing(Progression::Arithmetic, "linear", "equal differences");
        spacing(Progression::Geometric, "geometric", "equal quotients; ends of one sign");
    });
}

/// The title of what is open below a table; whether it stays open.
pub fn show_title(ui: &mut Ui, title: &str) -> bool {
    ui.horizontal(|ui| {
        ui.strong(title);
        let close = ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            small_button(ui, "\u{2716}", &format!("Close {title}")).clicked()
        });
        !close.inner
    })
    .inner
}
