//! Size and parts of each node as it is drawn, from the map and the declarations.

use std::collections::HashSet;

use eframe::egui::{Color32, Pos2, Rect, Vec2};
use indexmap::IndexMap;
use mve_core::{DataType, Link, Module, Node, NodeMode, ParamSpec, PortRef, Registry};

use crate::catalog;
use crate::document::{Document, Item};
use crate::forms::{each_text, name_of, rounds_text, value_text};
use crate::views::Thumbnails;

/// Width of a node, in units of the canvas.
pub const WIDTH: f32 = 200.0;
/// Height of its title.
pub const TITLE: f32 = 28.0;
/// Height of a row of ports or of a parameter.
pub const ROW: f32 = 20.0;
/// Height of the line that says its state.
pub const FOOT: f32 = 18.0;

/// Height of the picture of what it gives.
const PICTURE: f32 = 130.0;
/// Space around that.
const GAP: f32 = 6.0;

/// How much of a node is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NodeForm {
    /// Its title.
    Collapsed,
    /// Its ports and parameters.
    Whole,
    /// The same, and a picture of what it gives.
    Pictured,
}

/// Color of the title of a node whose module is not there.
const NO_MODULE: Color32 = Color32::from_rgb(150, 60, 60);

/// A port of a node as it is drawn.
#[derive(Clone)]
pub struct Port {
    /// Node and name.
    pub at: PortRef,
    /// What it takes or gives.
    pub data_type: DataType,
    /// What it is for.
    pub doc: &'static str,
    /// Whether the node runs only with it.
    pub is_required: bool,
    /// From the node's corner to its middle.
    pub offset: Vec2,
    /// Whether it is a parameter.
    pub is_param: bool,
}

/// A parameter of a node as it is drawn.
#[derive(Clone)]
pub struct ParamRow {
    /// Its declaration.
    pub spec: &'static ParamSpec,
    /// Its name for a person.
    pub name: String,
    /// Its value in short.
    pub value: String,
    /// Whether the map sets it.
    pub is_set: bool,
    /// Whether a link gives its value.
    pub is_linked: bool,
    /// From the node's top to the row's.
    pub y: f32,
}

/// A node as it is drawn.
#[derive(Clone)]
pub struct Shape {
    /// Its upper left corner on the canvas.
    pub at: Pos2,
    /// Its size.
    pub size: Vec2,
    /// Id of its module.
    pub module: String,
    /// What its module does; none if there is no such module.
    pub summary: Option<&'static str>,
    /// Color of its title.
    pub color: Color32,
    /// Whether it runs.
    pub mode: NodeMode,
    /// How often it runs, where that is more than once.
    pub rounds: Option<String>,
    /// Whether it writes files, which only Run does.
    pub writes_files: bool,
    /// Whether only its title is drawn.
    pub is_collapsed: bool,
    /// Ports on its left, parameters that take links among them.
    pub inputs: Vec<Port>,
    /// Ports on its right.
    pub outputs: Vec<Port>,
    /// Its parameters.
    pub params: Vec<ParamRow>,
    /// The space for a picture of what it gives, from its corner.
    pub picture: Option<Rect>,
}

impl Shape {
    /// Where it is on the canvas.
    pub fn rect(&self) -> Rect {
        Rect::from_min_size(self.at, self.size)
    }

    /// The same node somewhere else.
    pub fn moved(&self, by: Vec2) -> Self {
        Self { at: self.at + by, ..self.clone() }
    }
}

/// All nodes of a map as they are drawn.
#[derive(Default)]
pub struct Shapes {
    /// By name, in the order of the map: later ones are drawn over earlier ones.
    pub nodes: IndexMap<String, Shape>,
    /// Which document it is, which of its states, and whether all nodes have pictures.
    state: Option<(u64, u64, bool)>,
}

impl Shapes {
    /// Makes the shapes anew where the map has changed.
    pub fn update(&mut self, document: &Document, registry: &Registry, has_pictures: bool) {
        let state = Some((document.id(), document.revision(), has_pictures));
        if self.state == state {
            return;
        }
        let map = document.map();
        let linked: HashSet<(&str, &str)> =
            map.links.iter().map(|link| (link.to.node.as_str(), link.to.port.as_str())).collect();
        self.nodes = map
            .nodes
            .iter()
            .map(|(name, node)| {
                let at = document.position(&Item::Node(name.clone())).unwrap_or_default();
                let extras = document.extras();
                let form = match extras.collapsed.contains(name) {
                    true => NodeForm::Collapsed,
                    false if has_pictures || extras.pictured.contains(name) => NodeForm::Pictured,
                    false => NodeForm::Whole,
                };
                (name.clone(), shape(name, node, at, form, registry, &linked))
            })
            .collect();
        self.state = state;
    }

    /// A place for a new node at or right of a point, where it covers no other.
    pub fn free_place(&self, at: Pos2) -> Pos2 {
        let mut place = Rect::from_min_size(at, Vec2::new(WIDTH, 160.0)).expand(10.0);
        // Each step passes at least one node.
        for _ in 0..=self.nodes.len() {
            let covered = self.nodes.values().map(Shape::rect).find(|rect| rect.intersects(place));
            let Some(covered) = covered else { break };
            place = place.translate(Vec2::new(covered.right() + 40.0 - place.left(), 0.0));
        }
        place.shrink(10.0).min
    }

    /// The corner of a free place of this size that is nearest to a point, within what is seen.
    pub fn free_near(&self, at: Pos2, size: Vec2, seen: Rect) -> Option<Pos2> {
        const STEP: f32 = 20.0;
        let covered: Vec<Rect> =
            self.nodes.values().map(|shape| shape.rect().expand(STEP * 0.95)).collect();
        let room = Rect::from_min_max(seen.min, seen.max - size).shrink(STEP * 0.5);
        if !(room.is_positive() && room.is_finite()) {
            return None;
        }
        let steps = |from: f32, to: f32| {
            let (first, last) = ((from / STEP).ceil() as i32, (to / STEP).floor() as i32);
            (first..=last).map(|step| step as f32 * STEP)
        };
        let rows = steps(room.top(), room.bottom());
        let places =
            rows.flat_map(|y| steps(room.left(), room.right()).map(move |x| Pos2::new(x, y)));
        let mut places: Vec<Pos2> = places.collect();
        places.sort_by(|a, b| a.distance_sq(at).total_cmp(&b.distance_sq(at)));
        places.into_iter().find(|place| {
            let place = Rect::from_min_size(*place, size);
            covered.iter().all(|covered| !covered.intersects(place))
        })
    }

    /// The smallest rectangle around some nodes, or around all where `names` is empty.
    pub fn bounds<'a>(&self, names: impl Iterator<Item = &'a str>) -> Option<Rect> {
        let mut names = names.peekable();
        let rects: Vec<Rect> = match names.peek() {
            Some(_) => names.filter_map(|name| self.nodes.get(name)).map(Shape::rect).collect(),
            None => self.nodes.values().map(Shape::rect).collect(),
        };
        rects.into_iter().reduce(Rect::union)
    }

    /// Where on the canvas an output is.
    pub fn output(&self, at: &PortRef) -> Option<(Pos2, &Port)> {
        let shape = self.nodes.get(&at.node)?;
        let port = shape.outputs.iter().find(|port| port.at.port == at.port)?;
        Some((shape.at + port.offset, port))
    }

    /// Where on the canvas an input is.
    pub fn input(&self, at: &PortRef) -> Option<(Pos2, &Port)> {
        let shape = self.nodes.get(&at.node)?;
        let port = shape.inputs.iter().find(|port| port.at.port == at.port)?;
        Some((shape.at + port.offset, port))
    }

    /// Both ends of a link.
    pub fn ends(&self, link: &Link) -> Option<(Pos2, Pos2, Color32)> {
        let (from, port) = self.output(&link.from)?;
        let (to, _) = self.input(&link.to)?;
        Some((from, to, color_of(port.data_type)))
    }
}

/// Color of the ports and wires of a data type.
pub fn color_of(data_type: DataType) -> Color32 {
    let [r, g, b] = data_type.color;
    Color32::from_rgb(r, g, b)
}

fn shape(
    name: &str,
    node: &Node,
    at: [f64; 2],
    form: NodeForm,
    registry: &Registry,
    linked: &HashSet<(&str, &str)>,
) -> Shape {
    let info = registry.of(node);
    let mut shape = Shape {
        at: Pos2::new(at[0] as f32, at[1] as f32),
        size: Vec2::new(WIDTH, TITLE),
        module: node.module.clone(),
        summary: info.map(|info| info.module.summary),
        color: info.map_or(NO_MODULE, |info| {
            let [r, g, b] = catalog::category_color(info.category, registry);
            Color32::from_rgb(r, g, b)
        }),
        mode: node.mode,
        rounds: node.repeat.as_ref().map(rounds_text),
        writes_files: registry.writes_files(node),
        is_collapsed: form == NodeForm::Collapsed,
        inputs: Vec::new(),
        outputs: Vec::new(),
        params: Vec::new(),
        picture: None,
    };
    let Some(info) = info else {
        shape.size.y = TITLE + ROW + FOOT;
        return shape;
    };
    let n_rows = add_ports(&mut shape, name, info.module);
    let n_rows = add_params(&mut shape, name, node, info.module, n_rows, linked);
    let rows = TITLE + n_rows as f32 * ROW;
    shape.size.y = rows + FOOT;
    let has_picture =
        || info.module.outputs.iter().any(|output| Thumbnails::are_of(output.data_type));
    match form {
        NodeForm::Collapsed => collapse(&mut shape),
        NodeForm::Pictured if has_picture() => {
            let at = Pos2::new(GAP, rows + GAP);
            let size = Vec2::new(WIDTH - 2.0 * GAP, PICTURE);
            shape.picture = Some(Rect::from_min_size(at, size));
            shape.size.y += PICTURE + GAP;
        }
        NodeForm::Pictured | NodeForm::Whole => {}
    }
    shape
}

/// Ports of inputs and outputs beside each other; how many rows they take.
fn add_ports(shape: &mut Shape, node: &str, module: &Module) -> usize {
    let at = |port: &str| PortRef { node: node.to_owned(), port: port.to_owned() };
    for (row, spec) in module.outputs.iter().enumerate() {
        shape.outputs.push(Port {
            at: at(spec.name),
            data_type: spec.data_type,
            doc: spec.doc,
            is_required: false,
            offset: Vec2::new(WIDTH, row_middle(row)),
            is_param: false,
        });
    }
    for (row, spec) in module.inputs.iter().enumerate() {
        shape.inputs.push(Port {
            at: at(spec.name),
            data_type: spec.data_type,
            doc: spec.doc,
            is_required: spec.is_required,
            offset: Vec2::new(0.0, row_middle(row)),
            is_param: false,
        });
    }
    module.inputs.len().max(module.outputs.len())
}

/// Parameters below the `n_rows` rows of ports; how many rows there are then.
fn add_params(
    shape: &mut Shape,
    name: &str,
    node: &Node,
    module: &'static Module,
    n_rows: usize,
    linked: &HashSet<(&str, &str)>,
) -> usize {
    for (row, spec) in (n_rows..).zip(module.params) {
        let is_linked = linked.contains(&(name, spec.name));
        if let Some(data_type) = spec.link_type() {
            shape.inputs.push(Port {
                at: PortRef { node: name.to_owned(), port: spec.name.to_owned() },
                data_type,
                doc: spec.doc,
                is_required: false,
                offset: Vec2::new(0.0, row_middle(row)),
                is_param: true,
            });
        }
        let given = node.params.get(spec.name);
        let each = node.repeat.as_ref().and_then(|repeat| each_text(repeat, spec.name));
        shape.params.push(ParamRow {
            spec,
            name: name_of(spec),
            is_set: given.is_some() || each.is_some(),
            value: match each {
                Some(each) => each,
                None if is_linked => "linked".to_owned(),
                None => value_text(spec, given),
            },
            is_linked,
            y: TITLE + row as f32 * ROW,
        });
    }
    n_rows + module.params.len()
}

fn row_middle(row: usize) -> f32 {
    TITLE + (row as f32 + 0.5) * ROW
}

/// Draws all ports of a collapsed node at the ends of its title.
fn collapse(shape: &mut Shape) {
    shape.size.y = TITLE + FOOT;
    shape.params.clear();
    let middle = TITLE / 2.0;
    shape.inputs.iter_mut().for_each(|port| port.offset.y = middle);
    shape.outputs.iter_mut().for_each(|port| port.offset.y = middle);
}
