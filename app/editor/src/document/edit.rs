//! Edits: the steps in which a map is changed, and why one is refused.

use mve_core::{Link, Map, MapError, NodeMode, ProgramSpec, Repeat};
use serde_json::Value as Json;
use thiserror::Error;

use super::clip::Clip;
use super::item::Item;
use crate::kept::KeptEdit;

/// What items are moved to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Alignment {
    /// Their common left.
    Left,
    /// The middle between left and right.
    Center,
    /// Their common right.
    Right,
    /// Their common top.
    Top,
    /// The middle between top and bottom.
    Middle,
    /// Their common bottom.
    Bottom,
}

/// A direction of the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// From left to right.
    Across,
    /// From top to bottom.
    Down,
}

/// One change of a map. Positions and sizes are rounded to whole numbers, so that a map's file
/// stays readable.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // The fields are what their names say, in every variant.
#[allow(clippy::large_enum_variant)] // Pasting is rare, and lists of edits are short.
pub enum Edit {
    /// A new node. Without a name it is named after its module; a name that is taken gets a number.
    AddNode { module: String, name: Option<String>, at: [f64; 2] },
    /// Items go; with nodes go their links, with links their points.
    Remove(Vec<Item>),
    /// A link, in the place of the one that its input has.
    Connect(Link),
    /// A link goes.
    Disconnect(Link),
    /// A parameter by its dotted path, as [`mve_core::assign`] sets it; `None` is its default. The
    /// path `module` puts another module into the node, which keeps the parameters and links that
    /// fit.
    SetParam { node: String, path: String, value: Option<Json> },
    /// New places of upper left corners. What lies in a frame is not moved with it.
    Move(Vec<(Item, [f64; 2])>),
    /// A new size of a frame.
    Resize { frame: String, size: [f64; 2] },
    /// A new name of a node, wherever the map says it: links, layout, programs, names of files.
    Rename { node: String, to: String },
    /// Whether nodes run.
    SetMode { nodes: Vec<String>, mode: NodeMode },
    /// Whether nodes are drawn as their title alone.
    SetCollapsed { nodes: Vec<String>, is_collapsed: bool },
    /// Whether nodes show a picture of what they give.
    SetPictured { nodes: Vec<String>, is_pictured: bool },
    /// The title of a frame, or the text of a note.
    SetText { item: Item, text: String },
    /// The color of a frame or a note; `None` is as the theme has it.
    SetColor { item: Item, color: Option<[u8; 3]> },
    /// A new frame.
    AddFrame { title: String, at: [f64; 2], size: [f64; 2] },
    /// A new note.
    AddNote { text: String, at: [f64; 2] },
    /// A point through which the wire of a link is drawn; the link stays as it is.
    AddReroute { link: Link, at: [f64; 2] },
    /// What was copied, its upper left corner at `at`, under names that are free.
    Paste { clip: Clip, at: [f64; 2] },
    /// Items in a line.
    Align { items: Vec<Item>, to: Alignment },
    /// Items with equal gaps between the outermost two.
    Distribute { items: Vec<Item>, along: Direction },
    /// Nodes in layers from left to right along their links; all of them if none is named.
    Arrange { nodes: Vec<String> },
    /// Nodes go into a map of their own, under this name or one that is free; a node for it stands
    /// in their place.
    MakeMap { nodes: Vec<String>, name: Option<String> },
    /// The nodes of a map of this file stand in the place of the node for it.
    Unpack { node: String },
    /// A map of this file, new or changed.
    SetMap { name: String, map: Box<Map> },
    /// How often a node runs; `None` is once.
    SetRepeat { node: String, repeat: Option<Repeat> },
    /// What the map is for.
    SetTitle(String),
    /// A program, new or changed; `None` removes it.
    SetProgram { name: String, spec: Option<ProgramSpec> },
    /// A new name of a program.
    RenameProgram { name: String, to: String },
    /// What views of values keep.
    Keep(KeptEdit),
    /// The whole text of the map's file.
    ReplaceText(String),
}

/// What edits have made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EditOutcome {
    /// New items, in the order of the edits.
    pub new_items: Vec<Item>,
    /// Nodes that were there, under new names: the old, the new.
    pub renamed: Vec<(String, String)>,
}

/// Why an edit was refused; the map is as it was.
#[derive(Debug, Error)]
pub enum EditError {
    /// What was to be edited is not there.
    #[error("there is no {kind} \"{name}\"")]
    Missing {
        /// Node, frame, note, point, link or program.
        kind: &'static str,
        /// What it was called.
        name: String,
    },
    /// There is no module of this id.
    #[error("there is no module \"{0}\"")]
    NoModule(String),
    /// The link makes no sense: see [`super::fits`].
    #[error("{0}")]
    Link(String),
    /// The parameter cannot be set.
    #[error("{0}")]
    Param(String),
    /// A name cannot be used.
    #[error("\"{name}\" cannot be the name: {why}")]
    Name {
        /// The name.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// What views keep cannot be changed so.
    #[error("{0}")]
    Kept(String),
    /// A place or a size is not a number.
    #[error("a place and a size are two finite numbers")]
    Number,
    /// The edit is none for items of this kind.
    #[error("{0}")]
    WrongKind(&'static str),
    /// The text is no map.
    #[error("{0}")]
    Text(#[from] MapError),
}

impl EditError {
    pub(super) fn missing(kind: &'static str, name: &str) -> Self {
        Self::Missing { kind, name: name.to_owned() }
    }

    pub(super) fn name(name: &str, why: &'static str) -> Self {
        Self::Name { name: name.to_owned(), why }
    }
}

/// One thing by its name, or how many there are.
fn count(n: usize, one: &str, many: &str) -> String {
    match n {
        1 => one.to_owned(),
        n => format!("{n} {many}"),
    }
}

impl Edit {
    /// What the edit does, for the menu entry that undoes it.
    pub fn label(&self) -> String {
        match self {
            Self::AddNode { module, .. } => format!("Add {module}"),
            Self::Remove(items) => match items.as_slice() {
                [item] => format!("Remove {} {item}", item.kind()),
                _ => format!("Remove {} items", items.len()),
            },
            Self::Connect(link) => format!("Link {link}"),
            Self::Disconnect(link) => format!("Cut {link}"),
            Self::SetParam { node, path, .. } => format!("Set {node}.{path}"),
            Self::Move(items) => match items.as_slice() {
                [(item, _)] => format!("Move {item}"),
                _ => format!("Move {} items", items.len()),
            },
            Self::Resize { .. } => "Resize frame".to_owned(),
            Self::Rename { node, to } => format!("Rename {node} to {to}"),
            Self::SetMode { nodes, mode } => {
                let verb = match mode {
                    NodeMode::Active => "Activate",
                    NodeMode::Muted => "Mute",
                    NodeMode::Bypassed => "Bypass",
                };
                let name = nodes.first().map_or("nothing", String::as_str);
                format!("{verb} {}", count(nodes.len(), name, "nodes"))
            }
            Self::SetCollapsed { nodes, is_collapsed } => {
                let verb = if *is_collapsed { "Collapse" } else { "Expand" };
                let name = nodes.first().map_or("nothing", String::as_str);
                format!("{verb} {}", count(nodes.len(), name, "nodes"))
            }
            Self::SetPictured { nodes, is_pictured } => {
                let verb = if *is_pictured { "Show picture of" } else { "Hide picture of" };
                let name = nodes.first().map_or("nothing", String::as_str);
                format!("{verb} {}", count(nodes.len(), name, "nodes"))
            }
            Self::SetText { item, .. } => format!("Edit {}", item.kind()),
            Self::SetColor { item, .. } => format!("Color {}", item.kind()),
            Self::AddFrame { .. } => "Add frame".to_owned(),
            Self::AddNote { .. } => "Add note".to_owned(),
            Self::AddReroute { .. } => "Add point to wire".to_owned(),
            Self::Paste { .. } => "Paste".to_owned(),
            Self::Align { .. } => "Align".to_owned(),
            Self::Distribute { .. } => "Distribute".to_owned(),
            Self::Arrange { .. } => "Arrange".to_owned(),
            Self::MakeMap { nodes, .. } => {
                let name = nodes.first().map_or("nothing", String::as_str);
                format!("Make a map of {}", count(nodes.len(), name, "nodes"))
            }
            Self::Unpack { node } => format!("Unpack {node}"),
            Self::SetMap { name, .. } => format!("Edit map {name}"),
            Self::SetRepeat { node, .. } => format!("Set how often {node} runs"),
            Self::SetTitle(_) => "Edit title".to_owned(),
            Self::SetProgram { name, spec: Some(_) } => format!("Edit program {name}"),
            Self::SetProgram { name, spec: None } => format!("Remove program {name}"),
            Self::RenameProgram { name, to } => format!("Rename program {name} to {to}"),
            Self::Keep(edit) => edit.label(),
            Self::ReplaceText(_) => "Edit text".to_owned(),
        }
    }

    /// Whether it would move nodes that have no place of their own.
    pub(super) fn moves_others(&self) -> bool {
        matches!(
            self,
            Self::AddNode { .. }
                | Self::Remove(_)
                | Self::Connect(_)
                | Self::Disconnect(_)
                | Self::Move(_)
                | Self::AddReroute { .. }
                | Self::Paste { .. }
                | Self::Align { .. }
                | Self::Distribute { .. }
                | Self::Arrange { .. }
                | Self::MakeMap { .. }
                | Self::Unpack { .. }
        )
    }

    /// What a quick run of edits is of: those of one target are undone as one. `None` where each
    /// edit stands for itself.
    pub(super) fn target(&self) -> Option<String> {
        match self {
            Self::SetParam { node, path, .. } => Some(format!("param {node}.{path}")),
            Self::Move(items) => {
                let names: Vec<String> =
                    items.iter().map(|(item, _)| format!("{} {item}", item.kind())).collect();
                Some(format!("move {}", names.join(", ")))
            }
            Self::Resize { frame, .. } => Some(format!("resize {frame}")),
            Self::SetText { item, .. } => Some(format!("text of {} {item}", item.kind())),
            Self::SetColor { item, .. } => Some(format!("color of {} {item}", item.kind())),
            Self::SetTitle(_) => Some("title".to_owned()),
            Self::SetMap { name, .. } => Some(format!("map {name}")),
            Self::SetRepeat { node, .. } => Some(format!("repeat of {node}")),
            Self::SetProgram { name, spec: Some(spec) } => {
                // Typing into a cell is one step; a new axis or value is one of its own.
                let axes: Vec<Vec<_>> = spec
                    .axes
                    .iter()
                    .map(|axis| axis.iter().map(|(path, values)| (path, values.len())).collect())
                    .collect();
                let steps: Vec<Vec<_>> =
                    spec.steps.iter().map(|step| step.keys().collect()).collect();
                Some(format!("program {name} {axes:?} {steps:?}"))
            }
            Self::ReplaceText(_) => Some("whole text".to_owned()),
            _ => None,
        }
    }
}
