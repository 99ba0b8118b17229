//! The colors of a range with their values, and how the values are spread.

use std::sync::Arc;

use eframe::egui::{self, Align2, Color32, FontId, Rect, Stroke, pos2, vec2};
use mve_modules::data::Domain;

use super::Overlay;
use crate::views::mesh::look::coloring::{ScaleSettings, Spacing, Values};
use crate::views::mesh::scene::MeshScene;
use crate::views::number::{number_text, round_numbers};
use crate::views::spread::histogram;

/// The color bar, with the histogram of the values that it was last shown for.
#[derive(Default)]
pub struct ColorBar {
    histogram: Option<RangeHistogram>,
}

/// How often the values are in each part of a range.
struct RangeHistogram {
    values: Arc<Values>,
    range: [f64; 2],
    counts: Vec<usize>,
}

/// Parts of a histogram beside the color bar.
const N_PARTS: usize = 64;

impl Overlay for ColorBar {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        let (Some(rect), Some(values)) = (scene.bar, scene.values.first()) else { return };
        let range = scene.range;
        let is_of_these = |histogram: &RangeHistogram| {
            Arc::ptr_eq(&histogram.values, values) && histogram.range == range
        };
        let known = self.histogram.take().filter(is_of_these);
        let histogram = self.histogram.insert(known.unwrap_or_else(|| RangeHistogram {
            values: Arc::clone(values),
            range,
            counts: histogram(&values.values, range, N_PARTS),
        }));
        paint_color_bar(ui, rect, &scene.settings.scale, range, values, &histogram.counts);
    }
}

const BAR_WIDTH: f32 = 16.0;

/// Paints the colors of a range with their values, and how the values are spread to the left.
fn paint_color_bar(
    ui: &egui::Ui,
    rect: Rect,
    settings: &ScaleSettings,
    range: [f64; 2],
    values: &Values,
    histogram: &[usize],
) {
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
        rect.left_top() + vec2(28.0, title.size().y + 18.0),
        pos2(rect.left() + 28.0 + BAR_WIDTH, rect.bottom() - 14.0),
    );
    painter.galley(rect.left_top() + vec2(6.0, 6.0), title, text_color);
    if bar.height() < 20.0 {
        return;
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
