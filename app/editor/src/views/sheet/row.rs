//! One row of the table on the screen, and how its columns look.

use std::sync::Arc;

use eframe::egui::{self, Align2, Rect, Sense, pos2, vec2};

use super::columns::SheetColumn;
use super::rows::Sheet;
use crate::views::number::ColumnFormat;
use crate::views::table::LETTER;

/// Rows that are looked at for the width and the format of a column.
const N_SAMPLED: usize = 200;
/// Space on both sides of a cell.
const MARGIN: f32 = 6.0;

/// How a column looks.
#[derive(Clone, Copy)]
pub struct Form {
    /// In points.
    pub width: f32,
    format: ColumnFormat,
}

/// Width and format of each column, from a few rows.
pub fn forms_of(sheet: &Sheet) -> Arc<[Form]> {
    let step = sheet.n_elements.div_ceil(N_SAMPLED).max(1);
    let last = sheet.n_elements.checked_sub(1);
    let sampled: Vec<usize> = (0..sheet.n_elements).step_by(step).chain(last).collect();
    let form = |column: &SheetColumn| {
        let numbers: Vec<f64> =
            sampled.iter().filter_map(|element| column.number(*element)).collect();
        let format = ColumnFormat::of(numbers.into_iter());
        let texts = sampled.iter().map(|element| cell(column, format, *element));
        let longest = texts.map(|text| text.chars().count()).max().unwrap_or(0);
        // Beside it there is the arrow of the order.
        let title = column.title().chars().count() + 2;
        let width = LETTER * (longest.max(title) as f32).clamp(5.0, 40.0) + MARGIN;
        Form { width, format }
    };
    sheet.columns.iter().map(form).collect()
}

/// A row on the screen.
pub struct Row {
    /// Its place in the order that is shown.
    pub place: usize,
    /// What it is about.
    pub element: usize,
    /// Where it is.
    pub rect: Rect,
}

/// What stands in a cell.
fn cell(column: &SheetColumn, format: ColumnFormat, element: usize) -> String {
    let number = column.number(element).map(|number| format.text(number));
    number.or_else(|| column.text(element)).unwrap_or_default()
}

/// Paints a row, names it for a screen reader, and lets it be clicked.
pub fn show_row(
    ui: &egui::Ui,
    sheet: &Sheet,
    forms: &[Form],
    row: &Row,
    is_chosen: bool,
) -> egui::Response {
    let seen = row.rect.intersect(ui.clip_rect());
    let response = ui.interact(seen, ui.id().with(("row", row.place)), Sense::click());
    let visuals = ui.visuals();
    let painter = ui.painter();
    let ground = match (is_chosen, response.hovered(), row.place % 2) {
        (true, ..) => Some(visuals.selection.bg_fill),
        (false, true, _) => Some(visuals.widgets.hovered.weak_bg_fill),
        (false, false, 1) => Some(visuals.faint_bg_color),
        _ => None,
    };
    if let Some(color) = ground {
        painter.rect_filled(row.rect, 0.0, color);
    }
    let color = if is_chosen { visuals.strong_text_color() } else { visuals.text_color() };
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut left = row.rect.left();
    let mut texts = Vec::with_capacity(sheet.columns.len());
    for (column, form) in sheet.columns.iter().zip(forms) {
        let text = cell(column, form.format, row.element);
        let place =
            Rect::from_min_size(pos2(left, row.rect.top()), vec2(form.width, row.rect.height()));
        left = place.right() + ui.spacing().item_spacing.x;
        if place.intersects(ui.clip_rect()) {
            let clipped = painter.with_clip_rect(place.intersect(ui.clip_rect()));
            let (at, align) = match column.is_numeric() {
                true => (place.right_center() - vec2(MARGIN, 0.0), Align2::RIGHT_CENTER),
                false => (place.left_center() + vec2(MARGIN, 0.0), Align2::LEFT_CENTER),
            };
            clipped.text(at, align, &text, font.clone(), color);
        }
        texts.push(text);
    }
    response.widget_info(|| {
        let names = sheet.columns.iter().map(|column| column.name.as_str());
        let cells = names.zip(&texts).map(|(name, text)| format!("{name} {text}"));
        let label = format!("row {}", cells.collect::<Vec<_>>().join(", "));
        egui::WidgetInfo::selected(egui::WidgetType::SelectableLabel, true, is_chosen, label)
    });
    response
}
