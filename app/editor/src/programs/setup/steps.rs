//! The table of a program's explicit steps, and what holds for all steps: repeats and time limit.

use eframe::egui::{CollapsingHeader, DragValue, Grid, Id, ScrollArea, Ui};
use indexmap::{IndexMap, IndexSet};
use mve_core::ProgramSpec;
use serde_json::Value as Json;

use crate::programs::ProgramScene;
use crate::programs::setup::declare::{current, declared, paths};
use crate::programs::setup::edit::ProgramEdit;
use crate::programs::setup::value;
use crate::programs::widgets::{count, icon_button, named, small_button};

/// Seconds that a limit begins with when it is switched on.
const FIRST_LIMIT: f64 = 60.0;

/// Shows the explicit steps: a row each, a column for each parameter that some step sets.
pub fn show(ui: &mut Ui, scene: &ProgramScene, spec: &ProgramSpec, edits: &mut Vec<ProgramEdit>) {
    let title = match spec.steps.len() {
        0 => "Explicit steps".to_owned(),
        n => format!("{} besides the axes", count(n, "explicit step")),
    };
    let header = CollapsingHeader::new(title).id_salt("steps").default_open(!spec.steps.is_empty());
    header.show(ui, |ui| {
        let columns: IndexSet<&String> = spec.steps.iter().flat_map(IndexMap::keys).collect();
        ScrollArea::horizontal().id_salt("steps").show(ui, |ui| {
            Grid::new("steps").striped(true).min_row_height(22.0).show(ui, |ui| {
                ui.label("");
                for path in &columns {
                    ui.strong(path.as_str());
                }
                if !spec.steps.is_empty() {
                    ui.end_row();
                }
                for (place, step) in spec.steps.iter().enumerate() {
                    show_step(ui, scene, &columns, (place, step), spec.steps.len(), edits);
                }
            });
        });
        if icon_button(ui, "\u{2795} Step", "Add step").clicked() {
            edits.push(ProgramEdit::AddStep { step: next_step(scene, spec) });
        }
    });
}

/// What a new step sets: what the last one did, or the first value of every axis.
fn next_step(scene: &ProgramScene, spec: &ProgramSpec) -> IndexMap<String, Json> {
    if let Some(last) = spec.steps.last() {
        return last.clone();
    }
    let of_axes = spec.axes.iter().flatten();
    let first =
        of_axes.map(|(path, list)| (path.clone(), list.first().cloned().unwrap_or_default()));
    let step: IndexMap<String, Json> = first.collect();
    if !step.is_empty() {
        return step;
    }
    let path = paths(scene.map, scene.registry).into_iter().next();
    let value = |path: String| (path.clone(), current(scene.map, scene.registry, &path));
    path.map(value).into_iter().collect()
}

fn show_step(
    ui: &mut Ui,
    scene: &ProgramScene,
    columns: &IndexSet<&String>,
    (place, step): (usize, &IndexMap<String, Json>),
    n_steps: usize,
    edits: &mut Vec<ProgramEdit>,
) {
    ui.weak(format!("{}", place + 1));
    for path in columns.iter().map(|path| (*path).clone()) {
        let name = format!("{path}, step {}", place + 1);
        ui.horizontal(|ui| match step.get(&path) {
            Some(json) => {
                let declared = declared(scene.map, scene.registry, &path);
                let id = Id::new(("step", place, &path));
                let counts = scene.counts_at(&path, declared.spec());
                let edited = value::field(ui, id, &name, (&declared, &counts), json);
                if let Some(value) = edited {
                    edits.push(ProgramEdit::SetInStep { step: place, path: path.clone(), value });
                }
                let leave = format!("Leave {name} as the map has it");
                if step.len() > 1 && small_button(ui, "\u{2716}", &leave).clicked() {
                    edits.push(ProgramEdit::LeaveInStep { step: place, path });
                }
            }
            None => {
                if small_button(ui, "as the map", &format!("Set {name}")).clicked() {
                    let value = current(scene.map, scene.registry, &path);
                    edits.push(ProgramEdit::SetInStep { step: place, path, value });
                }
            }
        });
    }
    show_buttons(ui, scene, step, place, n_steps, edits);
    ui.end_row();
}

fn show_buttons(
    ui: &mut Ui,
    scene: &ProgramScene,
    step: &IndexMap<String, Json>,
    place: usize,
    n_steps: usize,
    edits: &mut Vec<ProgramEdit>,
) {
    let of = format!("step {}", place + 1);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let button = ui.menu_button("\u{2795}", |ui| {
            for path in paths(scene.map, scene.registry) {
                if !step.contains_key(&path) && ui.button(path.as_str()).clicked() {
                    let value = current(scene.map, scene.registry, &path);
                    edits.push(ProgramEdit::SetInStep { step: place, path, value });
                }
            }
        });
        named(button.response, &format!("Set another parameter in {of}"));
        ui.add_enabled_ui(place > 0, |ui| {
            if small_button(ui, "\u{2b06}", &format!("Move {of} up")).clicked() {
                edits.push(ProgramEdit::MoveStep { from: place, to: place - 1 });
            }
        });
        ui.add_enabled_ui(place + 1 < n_steps, |ui| {
            if small_button(ui, "\u{2b07}", &format!("Move {of} down")).clicked() {
                edits.push(ProgramEdit::MoveStep { from: place, to: place + 1 });
            }
        });
        if small_button(ui, "\u{2716}", &format!("Remove {of}")).clicked() {
            edits.push(ProgramEdit::RemoveStep { step: place });
        }
    });
}

/// Shows what holds for all steps.
pub fn show_limits(ui: &mut Ui, spec: &ProgramSpec, edits: &mut Vec<ProgramEdit>) {
    ui.horizontal_wrapped(|ui| {
        ui.label("repeats").on_hover_text("how often each step runs, with seeds that differ");
        let before = spec.repeats.unwrap_or(1);
        let mut repeats = before;
        let drag = DragValue::new(&mut repeats).range(1..=10_000).clamp_existing_to_range(false);
        named(ui.add(drag.speed(0.05)), "Repeats");
        if repeats != before {
            edits.push(ProgramEdit::SetRepeats { repeats });
        }
        ui.add_space(12.0);
        let mut is_limited = spec.time_limit.is_some();
        let switch = ui.checkbox(&mut is_limited, "time limit");
        if switch
            .on_hover_text("a step that takes longer is stopped and counts as failed")
            .changed()
        {
            edits.push(ProgramEdit::SetTimeLimit { seconds: is_limited.then_some(FIRST_LIMIT) });
        }
        let Some(before) = spec.time_limit else { return };
        let mut seconds = before;
        let drag = DragValue::new(&mut seconds).range(0.001..=1e8).clamp_existing_to_range(false);
        named(ui.add(drag.speed((before / 50.0).max(0.01)).suffix(" s")), "Time limit in seconds");
        if seconds.to_bits() != before.to_bits() {
            edits.push(ProgramEdit::SetTimeLimit { seconds: Some(seconds) });
        }
    });
}
