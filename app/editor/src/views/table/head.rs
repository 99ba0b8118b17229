//! The row of names above a table, by which its rows are sorted.

use eframe::egui;

use super::data::SortOrder;

/// The column that rows are sorted by; `None` leaves them as they are.
pub type Sort = Option<(usize, SortOrder)>;

/// Width of a letter in points, roughly.
pub const LETTER: f32 = 7.5;

/// The name above a column.
pub struct Head<'a> {
    /// Its name.
    pub name: &'a str,
    /// Name and unit.
    pub title: String,
    /// What it holds, or empty.
    pub doc: &'a str,
    /// In points.
    pub width: f32,
}

/// Shows the names; a click sorts by one, the other way round, and no longer.
pub fn header<'a>(ui: &mut egui::Ui, heads: impl Iterator<Item = Head<'a>>, sort: &mut Sort) {
    ui.horizontal(|ui| {
        for (at, head) in heads.enumerate() {
            let mark = match sort {
                Some((by, SortOrder::Up)) if *by == at => " ⏶",
                Some((by, SortOrder::Down)) if *by == at => " ⏷",
                _ => "",
            };
            let text = egui::RichText::new(head.title + mark).strong();
            let button = egui::Button::new(text).frame(false).truncate();
            let height = ui.spacing().interact_size.y;
            let response = ui.add_sized([head.width, height], button);
            let label = format!("Sort by {}", head.name);
            response
                .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, &label));
            let response = match head.doc.is_empty() {
                true => response,
                false => response.on_hover_text(head.doc),
            };
            if response.on_hover_text("Sort; again for the other way, again for none").clicked() {
                *sort = match *sort {
                    Some((by, SortOrder::Up)) if by == at => Some((at, SortOrder::Down)),
                    Some((by, SortOrder::Down)) if by == at => None,
                    _ => Some((at, SortOrder::Up)),
                };
            }
        }
    });
    ui.separator();
}
