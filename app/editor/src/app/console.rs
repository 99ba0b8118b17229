//! The console: what modules said, by node; and the table of all ports and their values.

use std::time::UNIX_EPOCH;

use eframe::egui::{self, RichText, ScrollArea, Ui};

use super::Wish;
use super::inspector::port_table;
use super::session::Session;
use crate::runner::Loudness;

/// What the console shows of the log.
#[derive(Default)]
pub struct Console {
    /// Only the lines of this node.
    node: Option<String>,
    /// Only lines that hold these letters.
    letters: String,
    /// Only trouble.
    is_trouble_only: bool,
}

impl Console {
    /// Shows the log.
    pub fn show(&mut self, ui: &mut Ui, session: &mut Session, wishes: &mut Vec<Wish>) {
        ui.horizontal(|ui| {
            let label = self.node.clone().unwrap_or_else(|| "all nodes".to_owned());
            let combo =
                egui::ComboBox::from_id_salt("log of").selected_text(&label).show_ui(ui, |ui| {
                    ui.selectable_value(&mut self.node, None, "all nodes");
                    for name in session.document.map().nodes.keys() {
                        ui.selectable_value(&mut self.node, Some(name.clone()), name);
                    }
                });
            let name = format!("log of {label}");
            combo
                .response
                .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &name));
            ui.checkbox(&mut self.is_trouble_only, "warnings and errors only");
            let filter = egui::TextEdit::singleline(&mut self.letters)
                .hint_text("filter")
                .desired_width(140.0);
            let filter = ui.add(filter);
            ui.ctx().accesskit_node_builder(filter.id, |node| node.set_label("filter the log"));
            if ui.button("Clear").clicked() {
                session.runner.log.clear();
            }
            ui.weak("times in UTC");
        });
        ui.separator();
        let letters = self.letters.to_lowercase();
        let is_shown = |line: &&crate::runner::Line| {
            self.node.as_ref().is_none_or(|node| line.node.as_ref() == Some(node))
                && (!self.is_trouble_only || line.loudness > Loudness::Note)
                && (letters.is_empty() || line.text.to_lowercase().contains(&letters))
        };
        let lines: Vec<_> = session.runner.log.lines().filter(is_shown).collect();
        if lines.is_empty() {
            ui.weak("Nothing was said yet. Run the map (F5).");
        }
        let height = ui.text_style_height(&egui::TextStyle::Monospace);
        let area = ScrollArea::vertical().auto_shrink(false).stick_to_bottom(true);
        area.show_rows(ui, height, lines.len(), |ui, rows| {
            for line in &lines[rows] {
                show_line(ui, line, wishes);
            }
        });
    }
}

fn show_line(ui: &mut Ui, line: &crate::runner::Line, wishes: &mut Vec<Wish>) {
    let seconds = line.at.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (h, m, s) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    let color = match line.loudness {
        Loudness::Note => ui.visuals().text_color(),
        Loudness::Warning => ui.visuals().warn_fg_color,
        Loudness::Error => ui.visuals().error_fg_color,
    };
    let node = line.node.as_deref().unwrap_or("mve");
    // A message of several lines is one row here, and whole on hover.
    let text = format!("{h:02}:{m:02}:{s:02}  {node:<14}  {}", line.text.replace('\n', " "));
    let label = egui::Label::new(RichText::new(text).monospace().color(color));
    let label = ui.add(label.truncate().sense(egui::Sense::click()));
    if label.on_hover_text(&line.text).clicked()
        && let Some(node) = &line.node
    {
        wishes.push(Wish::ShowNode(node.clone()));
    }
}

/// A table of the ports of the selected nodes, or of all, and their values.
pub fn values(ui: &mut Ui, session: &Session, wishes: &mut Vec<Wish>) {
    let selection = session.document.selection();
    let is_shown = |name: &String| {
        let item = crate::document::Item::Node(name.clone());
        selection.is_empty() || selection.contains(&item)
    };
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        for (name, node) in session.document.map().nodes.iter().filter(|(name, _)| is_shown(name)) {
            let Some(info) = session.runner.registry().of(node) else { continue };
            ui.horizontal(|ui| {
                ui.strong(name);
                ui.weak(session.runner.status(name).explanation());
            });
            port_table(ui, session, name, info.module, true, wishes);
            ui.add_space(6.0);
        }
    });
}
