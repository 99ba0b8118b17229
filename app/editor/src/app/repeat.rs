//! How often a node runs, as the inspector shows and changes it.

use eframe::egui::{self, Ui};
use mve_core::{Module, Node, Repeat, Until};

use super::Wish;
use crate::canvas::Action;
use crate::document::Edit;

fn edit(node: &str, repeat: Option<Repeat>) -> Wish {
    Wish::Canvas(Action::Edit(vec![Edit::SetRepeat { node: node.to_owned(), repeat }]))
}

/// What has a node run more than once, where it runs once.
pub(super) fn button(ui: &mut Ui, name: &str, node: &Node, wishes: &mut Vec<Wish>) {
    let why = "Have the node run more than once, each time on what it gave before.";
    if node.repeat.is_none() && ui.button("Repeat…").on_hover_text(why).clicked() {
        wishes.push(edit(name, Some(Repeat { times: Some(3), ..Repeat::default() })));
    }
}

/// How often a node runs that runs more than once.
pub(super) fn form(ui: &mut Ui, name: &str, node: &Node, module: &Module, wishes: &mut Vec<Wish>) {
    let Some(repeat) = &node.repeat else { return };
    let mut set = |repeat: Option<Repeat>| wishes.push(edit(name, repeat));
    ui.separator();
    ui.horizontal(|ui| {
        ui.label("It repeats");
        if let Some(mut times) = repeat.times {
            let most = if repeat.until.is_some() { "at most" } else { "" };
            ui.label(most);
            let field = ui.add(egui::DragValue::new(&mut times).range(1..=10_000));
            ui.label("times");
            if field.changed() {
                set(Some(Repeat { times: Some(times), ..repeat.clone() }));
            }
        }
        if ui.button("Once only").clicked() {
            set(None);
        }
    });
    let numbers = module.outputs.iter().filter(|output| output.data_type.id == "Number");
    let numbers: Vec<&str> = numbers.map(|output| output.name).collect();
    match &repeat.until {
        Some(until) => {
            ui.horizontal(|ui| {
                let (word, limit) = match (until.below, until.above) {
                    (Some(limit), _) => ("below", limit),
                    (None, limit) => ("above", limit.unwrap_or(0.0)),
                };
                ui.label(format!("until {} is", until.output));
                let mut next = until.clone();
                if ui.button(word).on_hover_text("below or above").clicked() {
                    (next.below, next.above) = match word {
                        "below" => (None, Some(limit)),
                        _ => (Some(limit), None),
                    };
                    set(Some(Repeat { until: Some(next), ..repeat.clone() }));
                    return;
                }
                let mut number = limit;
                let speed = (limit.abs() * 0.02).max(1e-6);
                if ui.add(egui::DragValue::new(&mut number).speed(speed)).changed() {
                    let (below, above) = match word {
                        "below" => (Some(number), None),
                        _ => (None, Some(number)),
                    };
                    let next = Until { below, above, ..next };
                    set(Some(Repeat { until: Some(next), ..repeat.clone() }));
                }
                if ui.button("\u{d7}").on_hover_text("Run all rounds.").clicked() {
                    set(Some(Repeat { until: None, ..repeat.clone() }));
                }
            });
        }
        None if !numbers.is_empty() => {
            ui.menu_button("Until…", |ui| {
                for output in numbers {
                    if ui.button(output).clicked() {
                        let output = output.to_owned();
                        let until = Until { output, below: Some(0.0), above: None };
                        set(Some(Repeat { until: Some(until), ..repeat.clone() }));
                    }
                }
            });
        }
        None => {}
    }
    for (param, values) in repeat.each.iter().flatten() {
        ui.label(format!("{param}: {values}")).on_hover_text(
            "One round for each value. The list is edited in the map's text: \"repeat\".",
        );
    }
}
