//! The search of modules: by Tab, by a double click, or where a link is dropped.

use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{
    self, Align, Area, Frame, Id, Key, Layout, Order, Pos2, ScrollArea, TextEdit, Ui,
};
use mve_core::{Link, PortRef};

use super::gesture::End;
use super::shape::{Shapes, WIDTH};
use super::{Action, Scene, search_field};
use crate::catalog::{Fit, SearchHit};
use crate::document::Edit;

/// Most height of the list of modules, in points.
const HEIGHT: f32 = 320.0;

/// Letters that two names begin with in common if they are about the same thing.
const LIKE: usize = 4;

/// A search while it is open.
pub struct Search {
    /// Where on the screen it stands.
    screen: Pos2,
    /// Where on the canvas the module comes to stand.
    world: Pos2,
    /// The end of the link that was dropped here.
    end: Option<End>,
    query: String,
    chosen: usize,
    is_new: bool,
}

impl Search {
    /// Opens a search.
    pub fn new(screen: Pos2, world: Pos2, end: Option<End>) -> Self {
        Self { screen, world, end, query: String::new(), chosen: 0, is_new: true }
    }

    /// Shows the search; whether it is to be closed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        shapes: &Shapes,
        actions: &mut Vec<Action>,
    ) -> bool {
        let fit = self.end.as_ref().and_then(|end| fit_of(end, scene));
        let mut hits = scene.catalog.search(&self.query, fit.as_ref());
        if let Some(end) = &self.end {
            sort_ports(&mut hits, end, scene);
        }
        let (up, down, enter, escape) = ui.input_mut(|input| {
            let none = egui::Modifiers::NONE;
            (
                input.consume_key(none, Key::ArrowUp),
                input.consume_key(none, Key::ArrowDown),
                input.consume_key(none, Key::Enter),
                input.consume_key(none, Key::Escape),
            )
        });
        if down {
            self.chosen += 1;
        }
        self.chosen = self.chosen.saturating_sub(usize::from(up)).min(hits.len().saturating_sub(1));
        let mut taken = if enter { hits.get(self.chosen) } else { None };
        let area = Area::new(Id::new("module search")).order(Order::Foreground);
        // So high on the screen that the list has room below the field.
        let window = ui.ctx().content_rect();
        let lowest = (window.bottom() - HEIGHT - 70.0).max(window.top());
        let at = Pos2::new(self.screen.x, self.screen.y.min(lowest));
        let shown = area.fixed_pos(at).constrain(true).show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(340.0);
                let field = TextEdit::singleline(&mut self.query).id(search_field());
                let hint = match &self.end {
                    Some(_) => "search modules that fit",
                    None => "search modules",
                };
                let field = ui.add(field.hint_text(hint).desired_width(f32::INFINITY));
                ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("search modules"));
                if field.changed() {
                    self.chosen = 0;
                }
                field.request_focus();
                taken = self.list(ui, &hits, up || down).or(taken);
            });
        });
        let is_new = std::mem::take(&mut self.is_new);
        if let Some(hit) = taken {
            actions.push(Action::Edit(self.edits(hit, scene, shapes)));
            return true;
        }
        escape || (!is_new && shown.response.clicked_elsewhere())
    }

    /// The modules that were found; the one that was clicked.
    fn list<'h>(
        &self,
        ui: &mut Ui,
        hits: &'h [SearchHit],
        has_moved: bool,
    ) -> Option<&'h SearchHit> {
        let mut clicked = None;
        ScrollArea::vertical().max_height(HEIGHT).min_scrolled_height(HEIGHT).show(ui, |ui| {
            ui.with_layout(Layout::top_down_justified(Align::LEFT), |ui| {
                for (place, hit) in hits.iter().enumerate() {
                    let is_chosen = place == self.chosen;
                    let row = ui.selectable_label(is_chosen, text_of(hit, is_chosen, ui));
                    if has_moved && is_chosen {
                        row.scroll_to_me(None);
                    }
                    if row.clicked() {
                        clicked = Some(hit);
                    }
                }
            });
            if hits.is_empty() {
                ui.weak("No module fits these letters.");
            }
        });
        clicked
    }

    /// Adds the module, and links it to the end that was dropped.
    fn edits(&self, hit: &SearchHit, scene: &Scene, shapes: &Shapes) -> Vec<Edit> {
        let name = scene.document.free_name(hit.info.module.id);
        let module = hit.info.module.id.to_owned();
        let across = if matches!(self.end, Some(End::To(_))) { WIDTH } else { 0.0 };
        // Beside the pointer, so that what it says on hover does not cover the new node.
        let beside = if across > 0.0 { -12.0 } else { 12.0 };
        let at = shapes.free_place(self.world - egui::vec2(across - beside, 20.0));
        let at = [f64::from(at.x), f64::from(at.y)];
        let at = at.map(|x| if scene.settings.snaps { (x / 10.0).round() * 10.0 } else { x });
        let mut edits = vec![Edit::AddNode { module, name: Some(name.clone()), at }];
        if let (Some(end), Some(port)) = (&self.end, hit.port) {
            let port = PortRef { node: name, port: port.to_owned() };
            edits.push(Edit::Connect(match end {
                End::From(from) => Link { from: from.clone(), to: port },
                End::To(to) => Link { from: port, to: to.clone() },
            }));
        }
        edits
    }
}

/// What a module must have to fit the end of a link.
fn fit_of(end: &End, scene: &Scene) -> Option<Fit> {
    let (port, is_output) = match end {
        End::From(port) => (port, true),
        End::To(port) => (port, false),
    };
    let node = scene.document.map().nodes.get(&port.node)?;
    let module = scene.registry.of(node)?.module;
    if is_output {
        let spec = module.outputs.iter().find(|spec| spec.name == port.port)?;
        return Some(Fit::Output(spec.data_type));
    }
    let input = module.inputs.iter().find(|spec| spec.name == port.port);
    let param = || module.params.iter().find(|spec| spec.name == port.port)?.link_type();
    input.map(|spec| spec.data_type).or_else(param).map(Fit::Input)
}

/// Of several ports of one module, puts first the one that is named like what the link comes from
/// or goes to: `simplified` for a link from `simplificator`.
fn sort_ports(hits: &mut [SearchHit], end: &End, scene: &Scene) {
    let node = &end.port().node;
    let module = scene.document.map().nodes.get(node).map_or("", |node| node.module.as_str());
    let likeness = |hit: &SearchHit| {
        let port = hit.port.unwrap_or_default();
        let alike = |name: &str| {
            let pairs = name.chars().zip(port.chars());
            pairs.take_while(|(a, b)| a.eq_ignore_ascii_case(b)).count()
        };
        [alike(node), alike(module)].into_iter().filter(|n| *n >= LIKE).max().unwrap_or(0)
    };
    for ports in hits.chunk_by_mut(|a, b| a.info.module.id == b.info.module.id) {
        ports.sort_by_key(|hit| std::cmp::Reverse(likeness(hit)));
    }
}

/// The module's id with the letters that were found, and its summary.
fn text_of(hit: &SearchHit, is_chosen: bool, ui: &Ui) -> LayoutJob {
    let visuals = ui.visuals();
    let body = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let mut job = LayoutJob::default();
    for (place, letter) in hit.info.module.id.chars().enumerate() {
        let is_found = hit.id_matches.contains(&(place as u32));
        let color = if is_found { visuals.warn_fg_color } else { visuals.strong_text_color() };
        job.append(&letter.to_string(), 0.0, TextFormat::simple(body.clone(), color));
    }
    let weak = match is_chosen {
        true => visuals.selection.stroke.color,
        false => visuals.weak_text_color(),
    };
    let weak = TextFormat::simple(small.clone(), weak);
    if let Some(port) = hit.port {
        let port = port.replace('_', " ");
        job.append(&format!("  {port}"), 0.0, TextFormat::simple(body, visuals.text_color()));
    }
    job.append(&format!("  {}", hit.info.category), 0.0, weak.clone());
    job.append(&format!("\n{}", hit.info.module.summary), 0.0, weak);
    job.wrap.max_width = 320.0;
    job
}
