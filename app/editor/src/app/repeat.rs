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
    until_form(ui, repeat, module, &mut set);
    for (param, values) in repeat.each.iter().flatten() {
        ui.label(format!("{param}: {values}")).on_hover_text(
            "One round for each value. The list is edited in the map's text: \"repeat\".",
        );
    }
}

/// Where a loop ends before its last round.
fn until_form(ui: &mut Ui, repeat: &Repeat, module: &Module, set: &mut impl FnMut(Option<Repeat>)) {
    let with = |until: Option<Until>| Some(Repeat { until, ..repeat.clone() });
    let Some(until) = &repeat.until else {
        let numbers = module.outputs.iter().filter(|output| output.data_type.id == "Number");
        let numbers: Vec<&str> = numbers.map(|output| output.name).collect();
        if !numbers.is_empty() {
            ui.menu_button("Until…", |ui| {
                for output in numbers.into_iter().filter(|output| ui.button(*output).clicked()) {
                    let output = output.to_owned();
                    set(with(Some(Until { output, below: Some(0.0), above: None })));
                }
            });
        }
        return;
    };
    ui.horizontal(|ui| {
        let (is_below, limit) = (until.below.is_some(), until.below.or(until.above));
        let mut limit = limit.unwrap_or(0.0);
        let to = |is_below: bool, limit: f64| {
            let (below, above) = (is_below.then_some(limit), (!is_below).then_some(limit));
            with(Some(Until { below, above, ..until.clone() }))
        };
        ui.label(format!("until {} is", until.output));
        let word = if is_below { "below" } else { "above" };
        if ui.button(word).on_hover_text("Below or above.").clicked() {
            set(to(!is_below, limit));
        }
        let speed = (limit.abs() * 0.02).max(1e-6);
        if ui.add(egui::DragValue::new(&mut limit).speed(speed)).changed() {
            set(to(is_below, limit));
        }
        if ui.button("\u{d7}").on_hover_text("Run all rounds.").clicked() {
            set(with(None));
        }
    });
}
