//! Draws nodes, wires, frames and notes; what they react to is in `gesture`.

use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::text::{LayoutJob, TextFormat, TextWrapping};
use eframe::egui::{
    Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, Vec2, Visuals,
};
use mve_core::NodeMode;

use super::camera::CanvasView;
use super::shape::{FOOT, Port, ROW, Shape, TITLE, color_of};
use crate::document::{CanvasFrame, Note};
use crate::runner::Status;

/// Below this zoom, rows are too small to read and are not drawn.
pub const ROWS_FROM: f32 = 0.45;
/// Below this zoom, titles are too small to read and are not drawn.
pub const TITLES_FROM: f32 = 0.22;

/// At this zoom and below, text that matters less is drawn like all other text.
const STRONG_AT: f32 = 0.6;

/// Colors of the canvas in the current theme.
pub struct Palette {
    /// Behind everything.
    pub back: Color32,
    /// Of the grid.
    pub grid: Color32,
    /// Of a node.
    pub node: Color32,
    /// Around a node.
    pub edge: Color32,
    /// Around what is selected.
    pub selected: Color32,
    /// Of text.
    pub text: Color32,
    /// Of text that matters less.
    pub faint: Color32,
}

impl Palette {
    /// The colors that go with a theme. At a low zoom letters are so thin that they look paler than
    /// they are: then all text is as strong as it can be.
    pub fn of(visuals: &Visuals, zoom: f32) -> Self {
        let gray = Color32::from_gray;
        let palette = match visuals.dark_mode {
            true => Self {
                back: gray(24),
                grid: gray(32),
                node: gray(45),
                edge: gray(72),
                selected: Color32::from_rgb(255, 178, 64),
                text: gray(225),
                faint: gray(165),
            },
            false => Self {
                back: gray(232),
                grid: gray(220),
                node: gray(250),
                edge: gray(170),
                selected: Color32::from_rgb(214, 110, 0),
                text: gray(25),
                faint: gray(80),
            },
        };
        let share = ((zoom - STRONG_AT) / (1.0 - STRONG_AT)).clamp(0.0, 1.0);
        Self { faint: palette.text.lerp_to_gamma(palette.faint, share), ..palette }
    }
}

/// The color that stands for a state.
pub fn status_color(status: &Status) -> Color32 {
    match status {
        Status::New | Status::Waiting | Status::Off(_) => Color32::from_gray(130),
        Status::Running(_) => Color32::from_rgb(70, 150, 240),
        Status::Done(_) => Color32::from_rgb(70, 175, 90),
        Status::Cached(_) => Color32::from_rgb(60, 160, 160),
        Status::Dirty => Color32::from_rgb(205, 160, 40),
        Status::Stopped | Status::Skipped(_) => Color32::from_rgb(165, 125, 80),
        Status::Failed(_) | Status::Refused(_) => Color32::from_rgb(222, 72, 68),
    }
}

/// What is said of a node beside its shape.
#[derive(Clone, Copy)]
pub struct NodeState<'a> {
    /// Its name.
    pub name: &'a str,
    /// How far it is.
    pub status: &'a Status,
    /// Whether it is selected.
    pub is_selected: bool,
    /// What it warned of when it ran last.
    pub warning: Option<&'a str>,
}

/// What a node's picture depends on beside its shape.
pub struct NodeLook<'a> {
    /// What is said of it.
    pub state: NodeState<'a>,
    /// Its part of the seconds of all nodes, where times are shown.
    pub time_share: Option<f64>,
    /// The type that a link under way carries, from which side: ports that do not fit are dimmed.
    pub is_dimmed: &'a dyn Fn(&Port) -> bool,
}

impl NodeState<'_> {
    /// What it warned of, if it ran to its end.
    fn warning_of_end(&self) -> Option<&str> {
        self.warning.filter(|_| matches!(self.status, Status::Done(_) | Status::Cached(_)))
    }

    /// Its state in sentences.
    pub fn state_text(&self) -> String {
        let warning = self.warning_of_end().map(|text| format!("\nwarned: {text}"));
        self.status.explanation() + &warning.unwrap_or_default()
    }

    /// The color that stands for its state.
    fn color(&self) -> Color32 {
        self.warning_of_end().map_or(status_color(self.status), |_| WARNED)
    }
}

/// The color of what ran and warned.
const WARNED: Color32 = Color32::from_rgb(240, 140, 20);

/// Draws with a view and a theme.
pub struct Brush<'a> {
    /// Draws within the canvas.
    pub painter: &'a Painter,
    /// From the canvas to the screen.
    pub view: CanvasView,
    /// Colors.
    pub palette: Palette,
}

impl Brush<'_> {
    /// Points of the screen for one unit of the canvas.
    pub fn zoom(&self) -> f32 {
        self.view.camera.zoom
    }

    fn font(&self, size: f32) -> FontId {
        // In steps of half a point, so that a zoom does not fill the memory of glyphs.
        FontId::proportional((size * self.zoom() * 2.0).round().max(2.0) / 2.0)
    }

    /// Text in one line, cut to a width, which is in units of the canvas.
    pub fn line(&self, at: Pos2, align: Align2, text: &str, size: f32, width: f32, color: Color32) {
        let format = TextFormat::simple(self.font(size), color);
        let mut job = LayoutJob::single_section(text.to_owned(), format);
        job.wrap = TextWrapping::truncate_at_width(width * self.zoom());
        let galley = self.painter.layout_job(job);
        let rect = align.anchor_size(at, galley.size());
        self.painter.galley(rect.min, galley, color);
    }

    /// Fills the view and draws its grid.
    pub fn background(&self) {
        let screen = self.view.screen;
        self.painter.rect_filled(screen, 0.0, self.palette.back);
        let mut step = 20.0;
        while step * self.zoom() < 14.0 {
            step *= 5.0;
        }
        let seen = self.view.visible();
        let stroke = Stroke::new(1.0, self.palette.grid);
        let mut x = (seen.min.x / step).ceil() * step;
        while x < seen.max.x {
            let at = self.view.to_screen(Pos2::new(x, 0.0)).x;
            self.painter.vline(at, screen.y_range(), stroke);
            x += step;
        }
        let mut y = (seen.min.y / step).ceil() * step;
        while y < seen.max.y {
            let at = self.view.to_screen(Pos2::new(0.0, y)).y;
            self.painter.hline(screen.x_range(), at, stroke);
            y += step;
        }
    }

    /// Draws a wire between two points of the screen.
    pub fn wire(&self, from: Pos2, to: Pos2, color: Color32, width: f32) {
        let points = bend(from, to, self.zoom());
        let stroke = Stroke::new((width * self.zoom()).clamp(1.0, 6.0), color);
        self.painter.add(CubicBezierShape::from_points_stroke(
            points,
            false,
            Color32::TRANSPARENT,
            stroke,
        ));
    }

    /// Draws a node too small to read: its place, its kind and its state, in a few rectangles, so
    /// that maps with thousands of nodes can be moved about.
    fn far_node(&self, shape: &Shape, look: &NodeLook, rect: Rect) {
        let (kind, edge) = (self.title_color(shape, look), self.edge(look));
        let fill = if edge.color == self.palette.edge { self.palette.node } else { edge.color };
        self.painter.rect_filled(rect, 0.0, fill);
        let title = (rect.height() * 0.4).clamp(2.0, 8.0);
        self.painter.rect_filled(
            Rect { max: Pos2::new(rect.max.x, rect.min.y + title), ..rect },
            0.0,
            kind,
        );
        if *look.state.status != Status::New {
            let foot = Rect { min: Pos2::new(rect.min.x, rect.max.y - (title / 2.0)), ..rect };
            self.painter.rect_filled(foot, 0.0, look.state.color());
        }
    }

    fn title_color(&self, shape: &Shape, look: &NodeLook) -> Color32 {
        let color = look.time_share.map_or(shape.color, |share| heat(share as f32));
        faded(color, shape.mode)
    }

    fn edge(&self, look: &NodeLook) -> Stroke {
        match (look.state.is_selected, look.state.status) {
            (true, _) => Stroke::new(2.0, self.palette.selected),
            (_, Status::Failed(_) | Status::Refused(_)) => {
                Stroke::new(1.5, status_color(look.state.status))
            }
            _ => Stroke::new(1.0, self.palette.edge),
        }
    }

    /// Draws a node.
    pub fn node(&self, shape: &Shape, look: &NodeLook) {
        let rect = self.view.rect_to_screen(shape.rect());
        if self.zoom() < TITLES_FROM {
            self.far_node(shape, look, rect);
            return;
        }
        let round = CornerRadius::same((6.0 * self.zoom()).clamp(1.0, 12.0) as u8);
        self.painter.rect_filled(rect, round, faded(self.palette.node, shape.mode));
        let title = Rect::from_min_size(rect.min, Vec2::new(rect.width(), TITLE * self.zoom()));
        let flat_below = CornerRadius { sw: 0, se: 0, ..round };
        self.painter.rect_filled(title, flat_below, self.title_color(shape, look));
        self.titles(shape, look, title);
        self.foot(shape, look, rect);
        if self.zoom() >= ROWS_FROM && !shape.is_collapsed {
            self.rows(shape, rect);
        }
        self.painter.rect_stroke(rect, round, self.edge(look), StrokeKind::Outside);
        self.ports(shape, look);
    }

    fn titles(&self, shape: &Shape, look: &NodeLook, title: Rect) {
        let pad = 8.0 * self.zoom();
        let at = title.left_center() + Vec2::new(pad, 0.0);
        let white = Color32::from_gray(250);
        self.line(at, Align2::LEFT_CENTER, look.state.name, 13.0, 112.0, white);
        let rounds = shape.rounds.as_ref().map(|rounds| format!("{rounds} {}", shape.module));
        let mark = match (shape.mode, shape.summary) {
            (NodeMode::Muted, _) => "muted",
            (NodeMode::Bypassed, _) => "bypassed",
            (_, None) => "unknown",
            _ => rounds.as_deref().unwrap_or(&shape.module),
        };
        let at = title.right_center() - Vec2::new(pad, 0.0);
        self.line(at, Align2::RIGHT_CENTER, mark, 9.5, 76.0, white);
    }

    /// The line that says the node's state, with a bar while it runs.
    fn foot(&self, shape: &Shape, look: &NodeLook, rect: Rect) {
        let color = look.state.color();
        if let Status::Running(share) = look.state.status {
            let height = (3.0 * self.zoom()).max(2.0);
            let bar = Rect::from_min_size(
                rect.left_bottom() - Vec2::new(0.0, height),
                Vec2::new(rect.width() * (*share as f32).max(0.02), height),
            );
            self.painter.rect_filled(bar, 0.0, color);
        }
        let middle = rect.bottom() - FOOT / 2.0 * self.zoom();
        let dot = Pos2::new(rect.left() + 11.0 * self.zoom(), middle);
        self.painter.circle_filled(dot, (3.5 * self.zoom()).max(1.5), color);
        if self.zoom() < ROWS_FROM {
            return;
        }
        let label = match look.state.status {
            _ if shape.mode == NodeMode::Muted => "muted: does not run".to_owned(),
            _ if shape.mode == NodeMode::Bypassed => {
                let has_input = shape.inputs.iter().any(|port| !port.is_param);
                let what = if has_input { "passes its input on" } else { "has nothing to pass on" };
                format!("bypassed: {what}")
            }
            Status::New | Status::Dirty if shape.writes_files => {
                format!("{}: writes files on Run", look.state.status.label())
            }
            Status::Failed(error) => format!("failed: {error}"),
            Status::Refused(why) => why.clone(),
            Status::Skipped(node) => format!("skipped: {node} failed"),
            status => match look.time_share {
                Some(share) => format!("{}, {:.0} % of the time", status.label(), share * 100.0),
                None => status.label(),
            },
        };
        let label = match look.state.warning_of_end() {
            Some(warning) if shape.mode == NodeMode::Active => format!("{label}, {warning}"),
            _ => label,
        };
        let at = dot + Vec2::new(9.0 * self.zoom(), 0.0);
        let width = shape.size.x - 28.0;
        let ink = if matches!(look.state.status, Status::Failed(_) | Status::Refused(_)) {
            color
        } else {
            self.palette.faint
        };
        self.line(at, Align2::LEFT_CENTER, &label, 10.0, width, ink);
    }

    fn rows(&self, shape: &Shape, rect: Rect) {
        let zoom = self.zoom();
        for param in &shape.params {
            let top = rect.top() + param.y * zoom;
            let middle = top + ROW / 2.0 * zoom;
            let left = Pos2::new(rect.left() + 12.0 * zoom, middle);
            self.line(left, Align2::LEFT_CENTER, &param.name, 11.0, 92.0, self.palette.faint);
            let field = Rect::from_min_max(
                Pos2::new(rect.left() + 104.0 * zoom, top + 1.5 * zoom),
                Pos2::new(rect.right() - 8.0 * zoom, top + (ROW - 1.5) * zoom),
            );
            let fill = self.palette.edge.gamma_multiply(0.35);
            self.painter.rect_filled(field, (3.0 * zoom) as u8, fill);
            let ink = if param.is_set { self.palette.text } else { self.palette.faint };
            let at = field.left_center() + Vec2::new(5.0 * zoom, 0.0);
            self.line(at, Align2::LEFT_CENTER, &param.value, 11.0, 80.0, ink);
        }
    }

    fn ports(&self, shape: &Shape, look: &NodeLook) {
        let zoom = self.zoom();
        let names = zoom >= ROWS_FROM && !shape.is_collapsed;
        for (port, is_input) in shape
            .inputs
            .iter()
            .map(|port| (port, true))
            .chain(shape.outputs.iter().map(|port| (port, false)))
        {
            let at = self.view.to_screen(shape.at + port.offset);
            let radius = if port.is_param { 3.2 } else { 5.0 } * zoom;
            let mut color = color_of(port.data_type);
            if (look.is_dimmed)(port) {
                color = color.gamma_multiply(0.2);
            }
            if zoom < ROWS_FROM {
                // Too small for their form to be seen, and cheaper than circles.
                let dot = Rect::from_center_size(at, Vec2::splat(2.0 * radius.max(1.0)));
                self.painter.rect_filled(dot, 0.0, color);
                continue;
            }
            let edge = Stroke::new(zoom.max(0.5), self.palette.back);
            // Optional inputs are rings.
            if is_input && !port.is_required {
                let ring = Stroke::new((1.6 * zoom).max(1.0), color);
                self.painter.circle(at, radius.max(1.5), self.palette.node, ring);
            } else {
                self.painter.circle(at, radius.max(1.5), color, edge);
            }
            if names && !port.is_param {
                let (align, by) = match is_input {
                    true => (Align2::LEFT_CENTER, 11.0),
                    false => (Align2::RIGHT_CENTER, -11.0),
                };
                let name = port.at.port.replace('_', " ");
                // The whole width, where no other name stands opposite.
                let others = if is_input { &shape.outputs } else { &shape.inputs };
                let is_alone = others.iter().all(|other| other.offset.y != port.offset.y);
                let width = if is_alone { shape.size.x - 24.0 } else { shape.size.x / 2.0 - 8.0 };
                self.line(
                    at + Vec2::new(by * zoom, 0.0),
                    align,
                    &name,
                    11.0,
                    width,
                    self.palette.text,
                );
            }
        }
    }

    /// Draws a frame behind the nodes; how it stands to what is in the hand.
    pub fn frame(&self, frame: &CanvasFrame, rect: Rect, mark: FrameMark) {
        let screen = self.view.rect_to_screen(rect);
        let [r, g, b] = frame.color.unwrap_or([110, 120, 150]);
        let color = Color32::from_rgb(r, g, b);
        let (share, edge) = match mark {
            FrameMark::Selected => (0.18, Stroke::new(1.0, self.palette.selected)),
            FrameMark::Holds => (0.3, Stroke::new(2.5, self.palette.text)),
            FrameMark::None => (0.18, Stroke::new(1.0, color)),
        };
        self.painter.rect_filled(screen, 6, color.gamma_multiply(share));
        self.painter.rect_stroke(screen, 6, edge, StrokeKind::Inside);
        let at = screen.left_top() + Vec2::splat(8.0 * self.zoom());
        self.line(at, Align2::LEFT_TOP, &frame.title, 14.0, rect.width() - 16.0, self.palette.text);
    }

    /// Draws a note.
    pub fn note(&self, note: &Note, rect: Rect, is_selected: bool) {
        let screen = self.view.rect_to_screen(rect);
        let [r, g, b] = note.color.unwrap_or([225, 195, 95]);
        let color = Color32::from_rgb(r, g, b);
        self.painter.rect_filled(screen, 4, color.gamma_multiply(0.25));
        let edge = if is_selected { self.palette.selected } else { color.gamma_multiply(0.6) };
        self.painter.rect_stroke(screen, 4, Stroke::new(1.0, edge), StrokeKind::Inside);
        if self.zoom() < TITLES_FROM {
            return;
        }
        let width = screen.width() - 16.0 * self.zoom();
        let galley =
            self.painter.layout(note.text.clone(), self.font(12.0), self.palette.text, width);
        let inside = self.painter.with_clip_rect(screen.intersect(self.painter.clip_rect()));
        inside.galley(screen.min + Vec2::splat(8.0 * self.zoom()), galley, self.palette.text);
    }
}

/// How a frame stands to what is in the hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameMark {
    /// Not at all.
    None,
    /// It is selected.
    Selected,
    /// It holds a node that is moved.
    Holds,
}

/// The color of what does not run by itself.
fn faded(color: Color32, mode: NodeMode) -> Color32 {
    match mode {
        NodeMode::Active => color,
        NodeMode::Muted | NodeMode::Bypassed => color.gamma_multiply(0.45),
    }
}

/// The four points of a wire's curve.
pub fn bend(from: Pos2, to: Pos2, zoom: f32) -> [Pos2; 4] {
    let across = (to.x - from.x).abs() * 0.5;
    let reach =
        across.clamp(24.0 * zoom, 160.0 * zoom).max((to.y - from.y).abs().min(60.0 * zoom) * 0.5);
    [from, from + Vec2::new(reach, 0.0), to - Vec2::new(reach, 0.0), to]
}

/// How far a point is from a wire's curve, both on the screen.
pub fn distance_to_wire(from: Pos2, to: Pos2, zoom: f32, point: Pos2) -> f32 {
    let [a, b, c, d] = bend(from, to, zoom);
    let reach = (b.x - a.x).abs();
    let around = Rect::from_two_pos(from, to).expand2(Vec2::new(reach + 8.0, 8.0));
    if !around.contains(point) {
        return f32::INFINITY;
    }
    let at = |t: f32| {
        let s = 1.0 - t;
        let mix = |a: f32, b: f32, c: f32, d: f32| {
            s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
        };
        Pos2::new(mix(a.x, b.x, c.x, d.x), mix(a.y, b.y, c.y, d.y))
    };
    let mut nearest = f32::INFINITY;
    let mut before = a;
    for step in 1..=20 {
        let next = at(step as f32 / 20.0);
        nearest = nearest.min(distance_to_segment(before, next, point));
        before = next;
    }
    nearest
}

fn distance_to_segment(a: Pos2, b: Pos2, point: Pos2) -> f32 {
    let along = b - a;
    let length = along.length_sq();
    let t = if length > 0.0 { ((point - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * t - point).length()
}

/// From blue for little to red for much.
fn heat(share: f32) -> Color32 {
    let t = share.clamp(0.0, 1.0).sqrt();
    let mix = |a: f32, b: f32| (a + (b - a) * t) as u8;
    Color32::from_rgb(mix(60.0, 205.0), mix(80.0, 55.0), mix(130.0, 45.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_stronger_where_letters_are_thin() {
        for visuals in [Visuals::light(), Visuals::dark()] {
            let contrast = |zoom: f32| {
                let Palette { faint, node, .. } = Palette::of(&visuals, zoom);
                faint.r().abs_diff(node.r())
            };
            assert!(contrast(0.5) > contrast(0.8) && contrast(0.8) > contrast(1.0));
            assert_eq!(contrast(1.0), contrast(3.0));
        }
    }
}
