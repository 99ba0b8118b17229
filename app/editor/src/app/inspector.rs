//! The inspector: all about the selected node, drawn from the declaration of its module.

use eframe::egui::{self, RichText, Ui};
use indexmap::IndexMap;
use mve_core::{Link, NodeMode, PortRef, Problem, Value};
use serde_json::Map as JsonMap;

use super::commands::ASKS_FIRST;
use super::session::Session;
use super::{Wish, repeat};
use crate::canvas::Action;
use crate::document::{Edit, Item};
use crate::forms::{Form, FormEvent, each_text};
use crate::runner::{Part, Shared, Status, outermost};
use crate::views::brief_text;

/// Shows the inspector of what is selected.
pub fn show(ui: &mut Ui, session: &Session, shared: &Shared, wishes: &mut Vec<Wish>) {
    let selected: Vec<&String> = session
        .document
        .selection()
        .iter()
        .filter_map(|item| match item {
            Item::Node(name) => Some(name),
            _ => None,
        })
        .collect();
    match selected.as_slice() {
        [] => nothing(ui, session, wishes),
        [name] => node(ui, session, shared, name, wishes),
        many => several(ui, session, many, wishes),
    }
}

/// The parameters of several nodes, by module: what is set is set in all of one module.
fn several(ui: &mut Ui, session: &Session, names: &[&String], wishes: &mut Vec<Wish>) {
    ui.label(format!("{} nodes are selected.", names.len()));
    let map = session.document.map();
    let mut groups: IndexMap<&str, Vec<&String>> = IndexMap::new();
    for name in names {
        let Some(node) = map.nodes.get(*name) else { continue };
        groups.entry(node.module.as_str()).or_default().push(*name);
    }
    for (module, names) in groups {
        let Some(info) = session.runner.registry().find(module) else { continue };
        ui.separator();
        ui.heading(format!("{} {module}", names.len()));
        ui.weak(names.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", "));
        let params = |name: &&String| &map.nodes[*name].params;
        let same = |param: &str| {
            let mut given = names.iter().map(|name| params(name).get(param));
            given.next().filter(|first| given.all(|other| other == *first))
        };
        let linked = |param: &str| {
            let is_it = |link: &Link| names.contains(&&link.to.node) && link.to.port == param;
            map.links.iter().any(is_it)
        };
        let (mut given, mut differing) = (JsonMap::new(), Vec::new());
        for spec in info.module.params.iter().filter(|spec| !linked(spec.name)) {
            match same(spec.name) {
                Some(value) => {
                    given.extend(value.map(|value| (spec.name.to_owned(), value.clone())))
                }
                None => differing.push(spec.name.replace('_', " ")),
            }
        }
        if !differing.is_empty() {
            let text = format!("differ, and show the default: {}", differing.join(", "));
            ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
        }
        let from_link = |path: &str| linked(path).then(|| "from links".to_owned());
        let form = Form {
            id: module,
            given: &given,
            wants_focus: false,
            link_of: &from_link,
            counts: &[],
            folder: &session.folder(),
        };
        for event in form.show(ui, info.module.params) {
            wishes.push(Wish::Canvas(match event {
                FormEvent::Set { path, value } => {
                    let edit = |name: &&String| Edit::SetParam {
                        node: (*name).clone(),
                        path: path.clone(),
                        value: value.clone(),
                    };
                    Action::Edit(names.iter().map(edit).collect())
                }
                other => Action::Form(names[0].clone(), other),
            }));
        }
    }
}

fn nothing(ui: &mut Ui, session: &Session, wishes: &mut Vec<Wish>) {
    let map = session.document.map();
    let id = ui.id().with("title");
    let mut title = ui.data(|data| data.get_temp(id)).unwrap_or_else(|| map.title.clone());
    // Long titles wrap; Enter leaves the field.
    let field = egui::TextEdit::multiline(&mut title).hint_text("What is this map for?");
    let field = ui.add(field.desired_rows(1).desired_width(f32::INFINITY).return_key(None));
    ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("title of the map"));
    if field.has_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
        field.surrender_focus();
    }
    if field.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, title));
    } else {
        if title != map.title {
            wishes.push(Wish::Canvas(Action::Edit(vec![Edit::SetTitle(title)])));
        }
        ui.data_mut(|data| data.remove::<String>(id));
    }
    let count = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    ui.weak(format!("{}, {}", count(map.nodes.len(), "node"), count(map.links.len(), "link")));
    let problems = session.runner.problems();
    if problems.is_empty() && !map.nodes.is_empty() {
        ui.weak("The map has no problems.");
    }
    if session.asks_first() {
        ui.weak(format!("Run {ASKS_FIRST}."));
    }
    for problem in problems {
        if problem_line(ui, session, problem)
            && let Some(node) = &problem.place.node
        {
            wishes.push(Wish::ShowNode(node.clone()));
        }
    }
    ui.add_space(8.0);
    ui.weak("Select a node to see its parameters.");
}

/// Shows a problem of the map, with its line where the file is as it is here; whether it was
/// clicked.
fn problem_line(ui: &mut Ui, session: &Session, problem: &Problem) -> bool {
    let color = match problem.is_error() {
        true => ui.visuals().error_fg_color,
        false => ui.visuals().warn_fg_color,
    };
    let document = &session.document;
    let is_file = document.path().is_some() && !document.is_dirty();
    let position = document.map().position_of(problem).filter(|_| is_file);
    let position =
        position.map(|at| format!(" (line {}, column {} of the file)", at.line, at.column));
    let text = problem.to_string() + &position.unwrap_or_default();
    let line = egui::Label::new(RichText::new(text).color(color)).wrap();
    ui.add(line.sense(egui::Sense::click())).clicked()
}

fn node(ui: &mut Ui, session: &Session, shared: &Shared, name: &str, wishes: &mut Vec<Wish>) {
    let Some(node) = session.document.map().nodes.get(name) else { return };
    ui.horizontal(|ui| {
        ui.heading(name);
        ui.weak(&node.module);
    });
    let status = session.runner.status(name);
    let color = crate::canvas::status_color(&status);
    ui.add(egui::Label::new(RichText::new(status.explanation()).color(color)).wrap());
    if node.mode != NodeMode::Active {
        let what = if node.mode == NodeMode::Muted {
            "muted: it does not run"
        } else {
            "bypassed: it passes its input through"
        };
        ui.label(format!("It is {what}."));
    }
    beforehand(ui, session, name);
    let Some(info) = session.runner.registry().of(node) else {
        ui.label("There is no module of this name. The node is kept as it stands.");
        return;
    };
    let module = info.module;
    ui.add(egui::Label::new(RichText::new(module.summary).weak()).wrap());
    ui.horizontal(|ui| {
        if ui.button("\u{25b6} Run up to here").clicked() {
            wishes.push(Wish::Canvas(Action::Run(Part::UpTo(vec![name.to_owned()]))));
        }
        repeat::button(ui, name, node, wishes);
    });
    if !module.params.is_empty() {
        ui.separator();
        let from_link = |path: &str| {
            let is_it = |link: &&mve_core::Link| link.to.node == name && link.to.port == path;
            let each = node.repeat.as_ref().and_then(|repeat| each_text(repeat, path));
            let link = session.document.map().links.iter().find(is_it);
            let link = link.map(|link| format!("from {}", link.from));
            each.map(|values| format!("{values}: one a round")).or(link)
        };
        let form = Form {
            id: name,
            given: &node.params,
            wants_focus: false,
            link_of: &from_link,
            counts: &session.counts(name),
            folder: &session.folder(),
        };
        let events = form.show(ui, module.params);
        wishes.extend(
            events.into_iter().map(|event| Wish::Canvas(Action::Form(name.to_owned(), event))),
        );
    }
    repeat::form(ui, name, node, module, wishes);
    ui.separator();
    port_table(ui, session, name, module, false, wishes);
    said(ui, session, shared, name, &status);
}

/// What is known of a node before it runs: what is asked, and what is odd about it.
fn beforehand(ui: &mut Ui, session: &Session, name: &str) {
    let unasked = &session.runner.checked().unasked;
    for (_, line) in unasked.iter().filter(|(node, _)| outermost(node) == name) {
        let text = format!("Run {ASKS_FIRST}: {}", mve_core::printable(line));
        ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
    }
    let warnings = session
        .runner
        .problems()
        .iter()
        .filter(|problem| !problem.is_error() && problem.place.node.as_deref() == Some(name));
    for warning in warnings {
        problem_line(ui, session, warning);
    }
}

/// A value in a line, cut where there is no room for it, with all its digits on hover.
fn value_label(ui: &mut Ui, value: &Value, is_whole: bool) -> egui::Response {
    let label = egui::Label::new(brief_text(value));
    let label = if is_whole { label.extend() } else { label.truncate() };
    ui.add(label).on_hover_text(value.summary())
}

/// The values of a node's ports.
pub fn port_table(
    ui: &mut Ui,
    session: &Session,
    name: &str,
    module: &mve_core::Module,
    is_whole: bool,
    wishes: &mut Vec<Wish>,
) {
    let links = &session.document.map().links;
    egui::Grid::new(("ports", name)).num_columns(3).striped(true).show(ui, |ui| {
        for input in module.inputs {
            let mut all =
                links.iter().filter(|link| link.to.node == name && link.to.port == input.name);
            let (link, n_others) = (all.next(), all.count());
            ui.label(format!("in: {}", input.name)).on_hover_text(input.doc);
            ui.weak(input.data_type.id);
            let value = link.and_then(|link| session.value_out_of(&link.from));
            match (link, value) {
                (_, _) if n_others > 0 => ui.weak(format!("{} links", n_others + 1)),
                (_, Some(value)) => value_label(ui, &value, is_whole),
                (Some(link), None) => ui.weak(format!("from {}", link.from)),
                (None, None) if input.is_required => {
                    ui.colored_label(ui.visuals().error_fg_color, "not linked")
                }
                (None, None) => ui.weak("not linked"),
            };
            ui.end_row();
        }
        for output in module.outputs {
            let port = PortRef { node: name.to_owned(), port: output.name.to_owned() };
            let is_pinned = session.pinned.contains(&port);
            let value = session.value_out_of(&port);
            let toggle = ui.selectable_label(is_pinned, format!("out: {}", output.name));
            if toggle.on_hover_text(format!("{}\nClick to look at it.", output.doc)).clicked() {
                wishes.push(Wish::Canvas(Action::Pin(port)));
            }
            ui.weak(output.data_type.id);
            match value {
                Some(value) if session.viewer.is_empty(&value) => ui.weak(value.summary()),
                Some(value) => value_label(ui, &value, is_whole),
                None => ui.weak("no value yet"),
            };
            ui.end_row();
        }
    });
}

/// What the node's module said when it ran last, and its files.
fn said(ui: &mut Ui, session: &Session, shared: &Shared, name: &str, status: &Status) {
    let Some(ended) = session.runner.ended(name) else { return };
    // What a node that does not run said once is of no use now.
    let node = session.document.map().nodes.get(name);
    let is_active = node.is_some_and(|node| node.mode.is_active());
    if !is_active || matches!(status, Status::Running(_) | Status::Waiting) {
        return;
    }
    for (phase, seconds) in &ended.record.phases {
        ui.weak(format!("{}: {}", phase.replace('_', " "), crate::runner::seconds_text(*seconds)));
    }
    for line in &ended.record.log {
        let color =
            if line.is_warning { ui.visuals().warn_fg_color } else { ui.visuals().text_color() };
        ui.add(egui::Label::new(RichText::new(&line.text).color(color)).wrap());
    }
    for file in &ended.record.files {
        let file = shared.output_folder.join(file);
        let file = std::path::absolute(&file).unwrap_or(file);
        ui.add(egui::Label::new(format!("wrote {}", file.display())).wrap());
    }
}
