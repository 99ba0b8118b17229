//! Small controls that say their name to those who cannot see them.

use std::sync::Arc;

use eframe::egui::{Button, Frame, Response, RichText, StrokeKind, Ui};

use crate::drag::DraggedParam;

/// Gives a control the name that a screen reader says.
pub fn named(response: Response, name: &str) -> Response {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}

/// A button with a picture and a name.
pub fn icon_button(ui: &mut Ui, icon: &str, name: &str) -> Response {
    named(ui.button(icon), name).on_hover_text(name)
}

/// A small button without a frame, with a picture and a name.
pub fn small_button(ui: &mut Ui, icon: &str, name: &str) -> Response {
    named(ui.add(Button::new(RichText::new(icon).small()).frame_when_inactive(false)), name)
        .on_hover_text(name)
}

/// [`icon_button`], which can be pressed only if `is_enabled`; `why` says why not.
pub fn button_if(ui: &mut Ui, is_enabled: bool, text: &str, name: &str, why: &str) -> Response {
    let response = ui.add_enabled(is_enabled, Button::new(text));
    let response = response.on_disabled_hover_text(why);
    named(response, name).on_hover_text(name)
}

/// `1 step`, `2 steps`.
pub fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// A frame that parameters can be dropped on; the one that was. It looks as the frame does until
/// one is dragged over it. Of zones within each other the inner one takes it.
pub fn drop_zone(
    ui: &mut Ui,
    frame: Frame,
    add_contents: impl FnOnce(&mut Ui),
) -> Option<Arc<DraggedParam>> {
    let response = frame.show(ui, add_contents).response;
    if response.dnd_hover_payload::<DraggedParam>().is_some() {
        let stroke = ui.visuals().selection.stroke;
        ui.painter().rect_stroke(response.rect, 4.0, stroke, StrokeKind::Inside);
    }
    response.dnd_release_payload::<DraggedParam>()
}
