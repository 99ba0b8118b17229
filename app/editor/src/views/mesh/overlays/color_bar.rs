//! The colors of a range with their values, and how the values are spread.

use std::sync::Arc;

use eframe::egui::{self, Align2, Color32, FontId, Rect, Stroke, pos2, vec2};
use mve_modules::data::Domain;

use super::Overlay;
use crate::views::ViewerAction;
use crate::views::mesh::look::coloring::ScaleSettings;
use crate::views::mesh::look::range_end::RangeEnd;
use crate::views::mesh::look::values::{Spacing, Values};
use crate::views::mesh::scene::MeshScene;
use crate::views::number::{number_text, round_numbers};
use crate::views::spread::histogram;

/// The color bar, with what is known of the values that it was last shown for.
#[derive(Default)]
pub struct ColorBar {
    known: Option<RangeCounts>,
}

/// How many of some values are in each part of a range, and beyond its ends.
struct RangeCounts {
    values: Vec<Arc<Values>>,
    range: [f64; 2],
    /// Of the first values.
    histogram: Vec<usize>,
    /// Below and above: how many of all in percent, and the farthest.
    beyond: [Option<(f64, f64)>; 2],
}

impl RangeCounts {
    /// Counts, O(n).
    fn of(values: &[Arc<Values>], range: [f64; 2]) -> Self {
        let finite =
            || values.iter().flat_map(|values| &values.values).filter(|value| value.is_finite());
        let n_all = finite().count();
        let beyond = |is_beyond: &dyn Fn(f64) -> bool, end: fn(f64, f64) -> f64| {
            let outside = || finite().copied().filter(|value| is_beyond(*value));
            let farthest = outside().reduce(end)?;
            Some((100.0 * outside().count() as f64 / n_all as f64, farthest))
        };
        // Less than a pixel of the bar is nothing that could be seen.
        let least = 1e-3 * (range[1] - range[0]);
        let beyond = [
            beyond(&|value| value < range[0] - least, f64::min),
            beyond(&|value| value > range[1] + least, f64::max),
        ];
        let of_first = |first: &Arc<Values>| histogram(&first.values, range, N_PARTS);
        let histogram = values.first().map(of_first).unwrap_or_default();
        Self { values: values.to_vec(), range, histogram, beyond }
    }

    fn is_of(&self, values: &[Arc<Values>], range: [f64; 2]) -> bool {
        let is_same = |(a, b)| Arc::ptr_eq(a, b);
        self.range == range
            && self.values.len() == values.len()
            && self.values.iter().zip(values).all(is_same)
    }
}

/// Parts of a histogram beside the color bar.
const N_PARTS: usize = 64;

impl Overlay for ColorBar {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        let (Some(rect), Some(first)) = (scene.bar, scene.values.first()) else { return };
        let range = scene.range;
        let known = self.known.take().filter(|known| known.is_of(scene.values, range));
        let known =
            self.known.insert(known.unwrap_or_else(|| RangeCounts::of(scene.values, range)));
        let scale = &mut scene.settings.scale;
        let bar = paint_color_bar(ui, rect, scale, range, first, &known.histogram);
        if let Some(bar) = bar {
            let faults = show_ends(ui, (rect, bar), scale, range);
            scene.actions.extend(faults.into_iter().map(ViewerAction::Say));
            show_beyond(ui, (rect, bar), known.beyond, scale.spacing);
        }
    }
}

/// Height of a field at an end of the bar.
const FIELD: f32 = 18.0;

/// The values at the ends of the bar, to be dragged or typed; also why some were not taken.
fn show_ends(
    ui: &mut egui::Ui,
    (rect, bar): (Rect, Rect),
    scale: &mut ScaleSettings,
    range: [f64; 2],
) -> Vec<String> {
    let [low, high] = range.map(|number| scale.spacing.back(number));
    let speed = ((high - low) / 200.0).max(f64::MIN_POSITIVE);
    let tops = [bar.bottom() + 2.0, bar.top() - 2.0 - FIELD];
    let mut faults = Vec::new();
    for ((end, top), present) in RangeEnd::ALL.into_iter().zip(tops).zip([low, high]) {
        let place =
            Rect::from_min_max(pos2(rect.left() + 6.0, top), pos2(rect.right() - 4.0, top + FIELD));
        let name = egui::Id::new(("end of the colors", end == RangeEnd::Low));
        let mut child = ui.new_child(egui::UiBuilder::new().max_rect(place).id_salt(name));
        let (field, fault) = end.show(&mut child, scale, present, |field| {
            field.speed(speed).custom_formatter(|number, _| number_text(number))
        });
        faults.extend(fault);
        field.on_hover_text(
            "Drag or type the value; Range ▸ Minimum and Maximum give it back to the data",
        );
    }
    faults
}

/// Says up to where values lie beyond the ends, and how many of them.
fn show_beyond(
    ui: &mut egui::Ui,
    (rect, bar): (Rect, Rect),
    beyond: [Option<(f64, f64)>; 2],
    spacing: Spacing,
) {
    let places = [("below", bar.bottom() + FIELD + 4.0), ("above", bar.top() - FIELD - 18.0)];
    for ((side, top), beyond) in places.into_iter().zip(beyond) {
        let Some((percent, farthest)) = beyond else { continue };
        let text = format!("{} to {}", percent_text(percent), number_text(spacing.back(farthest)));
        let place =
            Rect::from_min_max(pos2(rect.left() + 6.0, top), pos2(rect.right(), top + 14.0));
        let mut child = ui.new_child(egui::UiBuilder::new().max_rect(place).id_salt(side));
        let text = egui::RichText::new(text).size(10.0).weak();
        let said = format!("So many values lie {side} the range, the farthest at this one");
        child.add(egui::Label::new(text).extend()).on_hover_text(said);
    }
}

/// A part in percent, in one digit after the point.
fn percent_text(percent: f64) -> String {
    if percent < 0.1 { "< 0.1 %".to_owned() } else { format!("{percent:.1} %") }
}

const BAR_WIDTH: f32 = 16.0;

/// Paints the colors of a range with their values, and how the values are spread to the left;
/// where the colors are.
fn paint_color_bar(
    ui: &egui::Ui,
    rect: Rect,
    settings: &ScaleSettings,
    range: [f64; 2],
    values: &Values,
    histogram: &[usize],
) -> Option<Rect> {
    let painter = ui.painter_at(rect);
    let text_color = ui.visuals().text_color();
    let font = FontId::proportional(12.0);
    let unit = if values.unit.is_empty() { String::new() } else { format!("\n{}", values.unit) };
    // A field of vertices does not have what a metric finds between them, so say what it has.
    let place = match values.domain {
        Domain::Vertex => "at vertices",
        Domain::Corner => "at corners",
        Domain::Face => "of faces",
    };
    let title = format!("{}{unit}\n{place}", values.name);
    let title = painter.layout(title, font.clone(), text_color, rect.width() - 8.0);
    let bar = Rect::from_min_max(
        rect.left_top() + vec2(28.0, title.size().y + FIELD + 28.0),
        pos2(rect.left() + 28.0 + BAR_WIDTH, rect.bottom() - FIELD - 22.0),
    );
    painter.galley(rect.left_top() + vec2(6.0, 6.0), title, text_color);
    if bar.height() < 20.0 {
        return None;
    }
    paint_gradient(&painter, bar, settings);
    let place = |t: f64| bar.bottom() - (t.clamp(0.0, 1.0) as f32) * bar.height();
    for number in ticks(settings.spacing, range) {
        let span = 0.5 * range[1] - 0.5 * range[0];
        let t = if span > 0.0 { (0.5 * number - 0.5 * range[0]) / span } else { 0.5 };
        let (y, x) = (place(t), bar.right());
        painter.line_segment([pos2(x, y), pos2(x + 4.0, y)], Stroke::new(1.0, text_color));
        let label = number_text(settings.spacing.back(number));
        painter.text(pos2(x + 7.0, y), Align2::LEFT_CENTER, label, font.clone(), text_color);
    }
    let most = histogram.iter().copied().max().unwrap_or(0).max(1) as f32;
    let height = bar.height() / histogram.len().max(1) as f32;
    for (k, &count) in histogram.iter().enumerate().filter(|(_, count)| **count > 0) {
        let bottom = bar.bottom() - k as f32 * height;
        // The root, so that rare values are seen.
        let width = 22.0 * (count as f32 / most).sqrt();
        let strip = Rect::from_min_max(
            pos2(bar.left() - 3.0 - width, bottom - height),
            pos2(bar.left() - 3.0, bottom),
        );
        painter.rect_filled(strip, 0.0, text_color.gamma_multiply(0.45));
    }
    Some(bar)
}

fn paint_gradient(painter: &egui::Painter, bar: Rect, settings: &ScaleSettings) {
    let table = settings.table();
    let mut mesh = egui::Mesh::default();
    const STEPS: usize = 128;
    for step in 0..=STEPS {
        let [r, g, b, _] = table[step * (table.len() - 1) / STEPS];
        let y = bar.bottom() - bar.height() * step as f32 / STEPS as f32;
        mesh.colored_vertex(pos2(bar.left(), y), Color32::from_rgb(r, g, b));
        mesh.colored_vertex(pos2(bar.right(), y), Color32::from_rgb(r, g, b));
        if step > 0 {
            let at = 2 * step as u32;
            mesh.add_triangle(at - 2, at - 1, at);
            mesh.add_triangle(at - 1, at + 1, at);
        }
    }
    painter.add(mesh);
}

/// The numbers that get a tick, of those that colors follow.
fn ticks(spacing: Spacing, range: [f64; 2]) -> Vec<f64> {
    match spacing {
        Spacing::Linear => round_numbers(range),
        Spacing::Logarithmic => {
            let (first, last) = (range[0].ceil(), range[1].floor());
            if last - first >= 1.0 && last - first < 12.0 {
                (0..=(last - first) as usize).map(|k| first + k as f64).collect()
            } else {
                round_numbers(range)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(ticks(Spacing::Logarithmic, [-2.5, 1.2]), [-2.0, -1.0, 0.0, 1.0]);
    }
}
