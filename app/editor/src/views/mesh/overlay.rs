//! What is painted over and under the pictures: background, box, axes, color bar.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Stroke, Vec2, pos2, vec2};
use glam::{DVec2, DVec3};
use mve_modules::data::Domain;

use super::coloring::{ScaleSettings, Spacing, Values};
use crate::views::camera::{Bounds, Camera};
use crate::views::number::{number_text, round_numbers};

/// Where a camera's normalized coordinates are on the screen.
#[derive(Clone, Copy)]
pub struct Screen {
    /// The picture.
    pub rect: Rect,
}

impl Screen {
    /// Width by height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.rect.width()) / f64::from(self.rect.height())
    }

    /// The place of normalized coordinates.
    pub fn place(&self, at: DVec2) -> Pos2 {
        let half = 0.5 * self.rect.size();
        self.rect.center() + vec2(at.x as f32 * half.x, -at.y as f32 * half.y)
    }

    /// The normalized coordinates of a place.
    pub fn normalized(&self, place: Pos2) -> DVec2 {
        self.normalized_move(place - self.rect.center())
    }

    /// A move on the screen in normalized coordinates.
    pub fn normalized_move(&self, moved: Vec2) -> DVec2 {
        let half = (0.5 * self.rect.size()).max(Vec2::splat(0.5));
        DVec2::new(f64::from(moved.x / half.x), f64::from(-moved.y / half.y))
    }
}

/// A quiet gradient that fits the theme.
pub fn paint_background(painter: &egui::Painter, rect: Rect, is_dark: bool) {
    let (top, bottom) = match is_dark {
        true => (Color32::from_rgb(58, 62, 70), Color32::from_rgb(28, 30, 34)),
        false => (Color32::from_rgb(250, 251, 253), Color32::from_rgb(206, 212, 220)),
    };
    let mut mesh = egui::Mesh::default();
    for (place, color) in [
        (rect.left_top(), top),
        (rect.right_top(), top),
        (rect.right_bottom(), bottom),
        (rect.left_bottom(), bottom),
    ] {
        mesh.colored_vertex(place, color);
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(0, 2, 3);
    painter.add(mesh);
}

/// Which edges of the box to paint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxPart {
    /// Those behind what is in the box, to be painted before it.
    Behind,
    /// The others, with the lengths.
    Ahead,
}

/// Paints edges of a box around what is shown.
pub fn paint_box(
    painter: &egui::Painter,
    screen: &Screen,
    camera: &Camera,
    bounds: &Bounds,
    part: BoxPart,
    color: Color32,
) {
    let corners = bounds.corners();
    let eye_depth = |i: &usize| -camera.view_of(corners[*i]).z;
    // Of a box that is seen from outside, just the edges at the farthest corner are hidden.
    let Some(farthest) = (0..8).max_by(|a, b| eye_depth(a).total_cmp(&eye_depth(b))) else {
        return;
    };
    let aspect = screen.aspect();
    for axis in 0..3 {
        let mut labeled: Option<(Pos2, f32)> = None;
        let middle_of_box = camera.project(bounds.center(), aspect).map(|at| screen.place(at));
        for from in (0..8usize).filter(|i| i >> axis & 1 == 0) {
            let to = from | 1 << axis;
            let is_behind = from == farthest || to == farthest;
            let ends = [from, to].map(|i| camera.project(corners[i], aspect));
            let [Some(a), Some(b)] = ends.map(|at| at.map(|at| screen.place(at))) else { continue };
            if is_behind == (part == BoxPart::Behind) {
                painter.line_segment([a, b], Stroke::new(1.0, color));
            }
            // The edge that is farthest out has free space beyond it; of two, the lower one.
            let middle = a + 0.5 * (b - a);
            let out = middle_of_box.map_or(Vec2::ZERO, |center| middle - center);
            let score = out.length() + 0.2 * out.y;
            if labeled.is_none_or(|(_, best)| score > best) && (b - a).length() > 24.0 {
                labeled = Some((middle + 14.0 * out.normalized() * vec2(1.8, 1.0), score));
            }
        }
        if let (Some((place, _)), BoxPart::Ahead) = (labeled, part) {
            let length = (bounds.high - bounds.low)[axis];
            let text = format!("{} {}", ["x", "y", "z"][axis], number_text(length));
            painter.text(place, Align2::CENTER_CENTER, text, FontId::proportional(12.0), color);
        }
    }
}

/// Paints the directions of the axes into the lower left corner.
pub fn paint_axes(painter: &egui::Painter, rect: Rect, camera: &Camera) {
    const LENGTH: f32 = 26.0;
    if rect.width() < 4.0 * LENGTH || rect.height() < 4.0 * LENGTH {
        return;
    }
    let middle = rect.left_bottom() + vec2(1.6 * LENGTH, -1.6 * LENGTH);
    let view = camera.axes();
    let mut axes = [
        (DVec3::X, "x", Color32::from_rgb(220, 70, 70)),
        (DVec3::Y, "y", Color32::from_rgb(80, 170, 70)),
        (DVec3::Z, "z", Color32::from_rgb(70, 120, 230)),
    ];
    // From back to front.
    axes.sort_by(|a, b| view.back.dot(a.0).total_cmp(&view.back.dot(b.0)));
    for (axis, name, color) in axes {
        let to = vec2(view.right.dot(axis) as f32, -view.up.dot(axis) as f32);
        let color = if view.back.dot(axis) < -0.05 { color.gamma_multiply(0.6) } else { color };
        painter.line_segment([middle, middle + LENGTH * to], Stroke::new(2.0, color));
        let at = middle + (LENGTH + 8.0) * to;
        painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(12.0), color);
    }
}

/// Width that a color bar takes with its labels.
pub const BAR_SPACE: f32 = 104.0;
const BAR_WIDTH: f32 = 16.0;

/// Paints the colors of a range with their values, and how the values are spread to the left.
pub fn paint_color_bar(
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

/// How many of the values lie in each of so many equal parts of a range.
pub fn histogram(values: &[f64], [low, high]: [f64; 2], n_parts: usize) -> Vec<usize> {
    let mut counts = vec![0; n_parts];
    let span = 0.5 * high - 0.5 * low;
    if n_parts == 0 || span.is_nan() || span <= 0.0 {
        return counts;
    }
    for &value in values.iter().filter(|value| **value >= low && **value <= high) {
        let part = ((0.5 * value - 0.5 * low) / span * n_parts as f64) as usize;
        counts[part.min(n_parts - 1)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_counts_each_value_within_the_range_once() {
        let values = [0.0, 0.1, 0.5, 0.99, 1.0, 1.01, f64::NAN, -1.0];
        assert_eq!(histogram(&values, [0.0, 1.0], 4), [2, 0, 1, 2]);
        assert_eq!(histogram(&values, [1.0, 1.0], 2), [0, 0]);
        assert_eq!(histogram(&[0.0], [-1e308, 1e308], 2), [0, 1]);
    }

    #[test]
    fn places_and_normalized_coordinates_undo_each_other() {
        let screen = Screen { rect: Rect::from_min_size(pos2(10.0, 20.0), vec2(200.0, 100.0)) };
        assert_eq!(screen.place(DVec2::new(-1.0, 1.0)), pos2(10.0, 20.0));
        assert_eq!(screen.normalized(pos2(210.0, 120.0)), DVec2::new(1.0, -1.0));
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(ticks(Spacing::Logarithmic, [-2.5, 1.2]), [-2.0, -1.0, 0.0, 1.0]);
    }
}
