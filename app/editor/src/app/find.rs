//! The search for a node of the map that is shown.

use eframe::egui::{Key, Modal, ScrollArea, TextEdit, Ui};

use super::{Editor, Wish};

/// Most nodes that are listed.
const MOST: usize = 12;

impl Editor {
    /// Asks for letters of a node's name or module; `None` once one was chosen or none is wanted.
    pub(super) fn find_box(
        &mut self,
        ui: &mut Ui,
        mut letters: String,
        wishes: &mut Vec<Wish>,
    ) -> Option<String> {
        let wanted = letters.to_lowercase();
        let nodes = &self.session().document.map().nodes;
        let is_found = |text: &str| text.to_lowercase().contains(&wanted);
        let found: Vec<(&String, &String)> = nodes
            .iter()
            .filter(|(name, node)| is_found(name) || is_found(&node.module))
            .map(|(name, node)| (name, &node.module))
            .collect();
        let mut chosen = None;
        let shown = Modal::new("find a node".into()).show(ui.ctx(), |ui| {
            ui.set_width(360.0);
            ui.heading("Find a node");
            let field = ui.add(TextEdit::singleline(&mut letters).desired_width(f32::INFINITY));
            ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("find a node"));
            if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                chosen = found.first().map(|(name, _)| (*name).clone());
            }
            field.request_focus();
            ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
                for (name, module) in found.iter().take(MOST) {
                    ui.horizontal(|ui| {
                        if ui.link(*name).clicked() {
                            chosen = Some((*name).clone());
                        }
                        ui.weak(*module);
                    });
                }
            });
            match found.len() {
                0 => drop(ui.weak("No node has these letters in its name or module.")),
                n if n > MOST => drop(ui.weak(format!("and {} more", n - MOST))),
                _ => {}
            }
        });
        if let Some(name) = chosen {
            wishes.push(Wish::ShowNode(name));
            return None;
        }
        (!shown.should_close()).then_some(letters)
    }
}
