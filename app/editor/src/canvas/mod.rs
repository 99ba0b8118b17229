//! The canvas: nodes and wires of a map, and all that a hand does with them.
//!
//! The canvas changes nothing by itself. It reads the document, keeps what is only of the moment
//! (camera, gesture under way, open search), and answers each frame with [`Action`]s.
//!
//! Nodes are drawn with a painter, in the size of the zoom, and what is out of sight is skipped;
//! `docs/WINDOW.md` says why, and `benches/canvas.rs` measures it.

mod camera;
mod gesture;
mod insert;
mod keys;
mod linking;
mod menu;
mod paint;
mod param;
mod picture;
mod room;
mod search;
mod shape;
mod touch;

use eframe::egui::{self, Color32, Id, Pos2, Rect, Sense, Ui, WidgetInfo, WidgetType};
use mve_core::{Link, NodeMode, PortRef, Registry};

pub use camera::CanvasCamera;
use camera::CanvasView;
use gesture::{End, Gesture};
pub use keys::SHORTCUTS;
use menu::TextEntry;
pub use paint::status_color;
use paint::{Brush, NodeLook, NodeState, Palette, distance_to_wire};
use picture::show_picture;
use search::Search;
use shape::{Port, Shape, Shapes};

use crate::catalog::Catalog;
use crate::document::{Document, Edit, Item};
use crate::forms::FormEvent;
use crate::runner::{Part, Runner};
use crate::views::Thumbnails;

/// How the canvas answers to hand and eye.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct CanvasSettings {
    /// Whether nodes come to rest on the grid.
    pub snaps: bool,
    /// Whether the wheel zooms; else it scrolls, and zooms with the control key.
    pub wheel_zooms: bool,
    /// Whether titles are colored by the seconds of their nodes.
    pub shows_times: bool,
    /// Whether all nodes show pictures of what they give.
    pub shows_pictures: bool,
}

impl Default for CanvasSettings {
    fn default() -> Self {
        Self { snaps: true, wheel_zooms: true, shows_times: false, shows_pictures: false }
    }
}

/// What the canvas shows.
pub struct Scene<'a> {
    /// The map.
    pub document: &'a Document,
    /// The states of its nodes.
    pub runner: &'a Runner,
    /// The modules.
    pub registry: &'a Registry,
    /// The same, to search in.
    pub catalog: &'a Catalog,
    /// How it answers.
    pub settings: &'a CanvasSettings,
    /// The ports whose values are shown.
    pub pinned: &'a [PortRef],
}

/// What a hand asked for on the canvas.
#[derive(Clone, Debug)]
pub enum Action {
    /// Changes of the map, as one.
    Edit(Vec<Edit>),
    /// A new selection.
    Select(Vec<Item>),
    /// Run this.
    Run(Part),
    /// Show or no longer show the value of an output.
    Pin(PortRef),
    /// A form of a node's parameters was used.
    Form(String, FormEvent),
    /// Take the selection to the clipboard.
    Copy,
    /// The same, and remove it.
    Cut,
    /// Put this text of the clipboard here.
    Paste(String, [f64; 2]),
    /// Ask for the text of the clipboard.
    RequestPaste,
    /// Copy the selection beside itself, with the links into it.
    Duplicate,
    /// Put a parameter of a node into the map's program.
    Vary(String, String),
    /// Open the map that a node stands for.
    OpenMap(String),
}

/// Points at the edges of the canvas where nothing is pressed.
const EDGE: f32 = 5.0;

/// What is to be shown in the next frame.
#[derive(Clone, Copy, Debug, Default)]
enum FitTarget {
    #[default]
    Nothing,
    All,
    Selection,
}

/// What the canvas keeps from one frame to the next.
#[derive(Default)]
pub struct Canvas {
    camera: Option<CanvasCamera>,
    shapes: Shapes,
    gesture: Gesture,
    search: Option<Search>,
    /// The node, frame or note that is being given another text.
    renaming: Option<TextEntry>,
    /// Whether a note was just added, and is to be written.
    wants_to_write: bool,
    /// The parameter whose form is open.
    open_param: Option<param::OpenParam>,
    /// What the open menu of the background is about.
    menu_wire: Option<Link>,
    menu_at: [f64; 2],
    wants: FitTarget,
    /// Whether the whole map is shown, and was not moved since: then it follows the panel's size.
    is_fitted: bool,
    /// A node to move into the middle of the view.
    wants_node: Option<String>,
    view: Option<CanvasView>,
    /// Pictures of what nodes give.
    thumbnails: Thumbnails,
}

impl Canvas {
    /// Shows the whole map.
    pub fn fit(&mut self) {
        self.wants = FitTarget::All;
    }

    /// Shows what is selected, or the whole map where nothing is.
    pub fn fit_selection(&mut self) {
        self.wants = FitTarget::Selection;
    }

    /// Shows what is in the middle at so many points of the screen for one unit of the canvas.
    pub fn zoom_to(&mut self, zoom: f32) {
        let center = self.camera.unwrap_or_default().center;
        self.is_fitted = false;
        self.camera = Some(CanvasCamera { center, zoom });
    }

    /// Sizes of the nodes as they are drawn, for edits that put them in lines and layers.
    pub fn sizes(&self) -> impl Iterator<Item = (&str, [f64; 2])> {
        let size = |shape: &Shape| [f64::from(shape.size.x), f64::from(shape.size.y)];
        self.shapes.nodes.iter().map(move |(name, shape)| (name.as_str(), size(shape)))
    }

    /// Moves a node into the middle of the view.
    pub fn show_node(&mut self, node: &str) {
        self.wants_node = Some(node.to_owned());
    }

    /// Where on the canvas something is put that has no place yet.
    pub fn free_place(&self) -> [f64; 2] {
        let center = self.view.map_or(Pos2::new(100.0, 100.0), |view| view.camera.center);
        let free = self.shapes.free_place(center);
        [f64::from(free.x), f64::from(free.y)]
    }

    /// Opens the search of modules in the middle of the view.
    pub fn open_search(&mut self) {
        let at = self.view.map_or(Pos2::ZERO, |view| view.screen.center());
        self.search_at(at, None);
    }

    fn search_at(&mut self, at: Pos2, end: Option<End>) {
        let world = self.view.map_or(at, |view| view.to_world(at));
        self.search = Some(Search::new(at, world, end));
    }

    /// Shows the canvas in all the room that is left.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene) -> Vec<Action> {
        let mut actions = Vec::new();
        let screen = ui.available_rect_before_wrap();
        ui.allocate_rect(screen, Sense::hover());
        // The edges are for hands that look for those of the panels beside.
        let back = ui.interact(screen.shrink(EDGE), ui.id().with("back"), Sense::click_and_drag());
        back.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "canvas"));
        self.shapes.update(scene.document, scene.registry, scene.settings.shows_pictures);
        let view = self.place_camera(screen, scene);
        let moved = self.moved_camera(ui, &back, view, scene);
        self.is_fitted &= moved == view.camera;
        let view = CanvasView { camera: moved, ..view };
        self.camera = Some(view.camera);
        self.view = Some(view);

        let painter = ui.painter_at(screen);
        let brush =
            Brush { painter: &painter, view, palette: Palette::of(ui.visuals(), view.camera.zoom) };
        brush.background();
        self.frames_and_notes(ui, &brush, scene, &mut actions);
        let (hovered_wire, over) = self.wires(ui, &brush, &back, scene);
        self.nodes(ui, &brush, scene, &mut actions);
        over.iter().for_each(|wire| wire.draw(&brush));
        self.background_gestures(ui, &back, &brush, scene, hovered_wire, &mut actions);
        self.finish_gesture(ui, &brush, scene, &mut actions);
        self.popups(ui, scene, &mut actions);
        self.keys(ui, &back, scene, &mut actions);
        self.hint(&brush, scene);
        actions
    }

    fn place_camera(&mut self, screen: Rect, scene: &Scene) -> CanvasView {
        let camera = self.camera.unwrap_or_default();
        let mut view = CanvasView { camera, screen };
        let is_first = self.camera.is_none() && screen.area() > 0.0;
        let is_resized = self.view.is_some_and(|view| view.screen.size() != screen.size());
        let wants = std::mem::take(&mut self.wants);
        let asked = !matches!(wants, FitTarget::Nothing) || is_first;
        let bounds = match wants {
            FitTarget::Selection => {
                self.is_fitted = false;
                self.shapes.bounds(scene.document.selection().iter().filter_map(node_of))
            }
            FitTarget::Nothing if !(is_first || self.is_fitted && is_resized) => None,
            FitTarget::All | FitTarget::Nothing => {
                self.is_fitted = true;
                self.shapes.bounds(std::iter::empty())
            }
        };
        if let Some(bounds) = bounds {
            let fitting = view.fitting(bounds);
            // Panels that take room from the canvas take none from the letters on it.
            let is_too_small = fitting.zoom < paint::ROWS_FROM && fitting.zoom < camera.zoom;
            view.camera = match is_resized && !asked && is_too_small {
                true => CanvasCamera { zoom: camera.zoom, ..fitting },
                false => fitting,
            };
        }
        if let Some(shape) = self.wants_node.take().and_then(|name| self.shapes.nodes.get(&name)) {
            self.is_fitted = false;
            view.camera = CanvasCamera { center: shape.rect().center(), ..view.camera };
        }
        view
    }

    /// Wheel, pinch and the middle button.
    fn moved_camera(
        &self,
        ui: &Ui,
        back: &egui::Response,
        view: CanvasView,
        scene: &Scene,
    ) -> CanvasCamera {
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let Some(pointer) = pointer.filter(|at| view.screen.contains(*at)) else {
            return view.camera;
        };
        // What lies over the canvas, such as the search, keeps its own wheel.
        let is_covered = ui.ctx().layer_id_at(pointer).is_some_and(|layer| layer != back.layer_id);
        if is_covered {
            return view.camera;
        }
        let (pinch, scroll, is_panning, moved) = ui.input(|input| {
            let is_panning = input.pointer.middle_down()
                || (input.pointer.primary_down() && input.key_down(egui::Key::Space));
            (input.zoom_delta(), input.smooth_scroll_delta(), is_panning, input.pointer.delta())
        });
        let mut view = view;
        if pinch != 1.0 {
            view.camera = view.zoomed(pinch, pointer);
        } else if scroll != egui::Vec2::ZERO {
            view.camera = match scene.settings.wheel_zooms {
                true => view.zoomed((scroll.y / 240.0).exp2(), pointer),
                false => view.panned(scroll),
            };
        }
        if is_panning {
            view.camera = view.panned(moved);
        }
        view.camera
    }

    /// Draws the wires; the one below the pointer, and those to be drawn once more over the nodes:
    /// that one, and those of selected nodes, which can so be followed wherever they go.
    fn wires(
        &self,
        ui: &Ui,
        brush: &Brush,
        back: &egui::Response,
        scene: &Scene,
    ) -> (Option<Link>, Vec<WireOver>) {
        let pointer = back.hover_pos().filter(|_| matches!(self.gesture, Gesture::Idle));
        let zoom = brush.view.camera.zoom;
        let mut hovered: Option<(f32, &Link)> = None;
        let seen = brush.view.screen.expand(160.0 * zoom);
        let mut drawn: Vec<(&Link, Vec<Pos2>, Color32)> = Vec::new();
        for link in &scene.document.map().links {
            if self.gesture.holds(link) {
                continue;
            }
            let Some((from, to, color)) = self.shapes.ends(link) else { continue };
            let mut points = vec![self.moved(&link.from.node, from, brush)];
            for (name, reroute) in &scene.document.extras().reroutes {
                if reroute.link == *link {
                    let at = Pos2::new(reroute.at[0] as f32, reroute.at[1] as f32);
                    points.push(
                        brush.view.to_screen(at + self.gesture.shift(&Item::Reroute(name.clone()))),
                    );
                }
            }
            points.push(self.moved(&link.to.node, to, brush));
            if !Rect::from_points(&points).intersects(seen) {
                continue;
            }
            if let Some(pointer) = pointer {
                let near =
                    points.windows(2).map(|ends| distance_to_wire(ends[0], ends[1], zoom, pointer));
                let distance = near.fold(f32::INFINITY, f32::min);
                if distance < 7.0 && hovered.is_none_or(|(best, _)| distance < best) {
                    hovered = Some((distance, link));
                }
            }
            drawn.push((link, points, color));
        }
        let hovered = hovered.map(|(_, link)| link);
        let mut over = Vec::new();
        let selection = scene.document.selection();
        for (link, points, color) in drawn {
            let is_selected = selection.contains(&Item::Link(link.clone()));
            let ends_in = |node: &String| selection.contains(&Item::Node(node.clone()));
            let (color, width) = match (is_selected, hovered == Some(link)) {
                (true, _) => (brush.palette.selected, 3.5),
                (_, true) => (color, 4.0),
                _ => (color.gamma_multiply(0.85), 2.2),
            };
            points.windows(2).for_each(|ends| brush.wire(ends[0], ends[1], color, width));
            if is_selected
                || hovered == Some(link)
                || ends_in(&link.from.node)
                || ends_in(&link.to.node)
            {
                over.push(WireOver { points, color });
            }
        }
        if let Some(link) = hovered {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
            back.clone().on_hover_text_at_pointer(link.to_string());
        }
        (hovered.cloned(), over)
    }

    /// Where on the screen a point of a node is, with the drag that is under way.
    fn moved(&self, node: &str, at: Pos2, brush: &Brush) -> Pos2 {
        brush.view.to_screen(at + self.gesture.shift_of_node(node))
    }

    fn nodes(&mut self, ui: &mut Ui, brush: &Brush, scene: &Scene, actions: &mut Vec<Action>) {
        let seen = brush.view.visible();
        let total: f64 = match scene.settings.shows_times {
            true => {
                let names = self.shapes.nodes.keys();
                names.filter_map(|name| scene.runner.seconds(name)).sum()
            }
            false => 0.0,
        };
        let shapes = std::mem::take(&mut self.shapes);
        for (name, shape) in &shapes.nodes {
            let by = self.gesture.shift_of_node(name);
            let is_near = seen.expand(16.0).intersects(shape.rect().translate(by));
            if !is_near {
                continue;
            }
            let moved;
            let shape = match by == egui::Vec2::ZERO {
                true => shape,
                false => {
                    moved = shape.moved(by);
                    &moved
                }
            };
            let status = scene.runner.status(name);
            let gesture = &self.gesture;
            let is_dimmed = |port: &Port| gesture.refuses(port, scene);
            let state = NodeState {
                name,
                status: &status,
                is_selected: scene.document.selection().contains(&Item::Node(name.clone())),
                warning: scene.runner.warning(name),
            };
            let look = NodeLook {
                state,
                time_share: Some(total)
                    .filter(|total| *total > 0.0)
                    .and_then(|_| scene.runner.seconds(name))
                    .map(|seconds| seconds / total),
                is_dimmed: &is_dimmed,
            };
            brush.node(shape, &look);
            if let Some(space) = shape.picture.filter(|_| brush.shows_pictures()) {
                let space = space.translate(shape.at.to_vec2());
                show_picture(&mut self.thumbnails, ui, brush, scene, (name, space));
            }
            self.touch_node(ui, brush, scene, shape, &state, actions);
        }
        self.shapes = shapes;
    }

    /// Whether a picture of what a node gives is in the making.
    pub fn is_busy(&self) -> bool {
        self.thumbnails.is_busy()
    }

    fn popups(&mut self, ui: &mut Ui, scene: &Scene, actions: &mut Vec<Action>) {
        if let Some(search) = &mut self.search
            && search.show(ui, scene, &self.shapes, actions)
        {
            self.search = None;
        }
        if let Some(open) = &mut self.open_param
            && open.show(ui, self.camera, scene, actions)
        {
            self.open_param = None;
        }
        self.rename_popup(ui, scene, actions);
    }

    /// What a person who has never seen this can do next.
    fn hint(&self, brush: &Brush, scene: &Scene) {
        if scene.document.map().nodes.is_empty() && self.search.is_none() {
            let text = "Double click, or press Tab, to add a module.\nOr drop a mesh file here.";
            brush.painter.text(
                brush.view.screen.center(),
                egui::Align2::CENTER_CENTER,
                text,
                egui::FontId::proportional(16.0),
                brush.palette.faint,
            );
        }
    }
}

/// A wire that is drawn over nodes, thin enough for these to be read.
struct WireOver {
    points: Vec<Pos2>,
    color: Color32,
}

impl WireOver {
    fn draw(&self, brush: &Brush) {
        let color = self.color.gamma_multiply(0.7);
        self.points.windows(2).for_each(|ends| brush.wire(ends[0], ends[1], color, 1.2));
    }
}

fn node_of(item: &Item) -> Option<&str> {
    match item {
        Item::Node(name) => Some(name),
        _ => None,
    }
}

/// The mode that a key switches some nodes to: off if all of them have it, else on.
fn toggled(scene: &Scene, nodes: &[String], mode: NodeMode) -> NodeMode {
    let has =
        |name: &String| scene.document.map().nodes.get(name).is_some_and(|node| node.mode == mode);
    if nodes.iter().all(has) { NodeMode::Active } else { mode }
}

/// The id by which the search's field is focused.
fn search_field() -> Id {
    Id::new("search of modules")
}
