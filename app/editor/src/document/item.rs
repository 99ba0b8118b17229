//! What is on the canvas, by name.

use mve_core::Link;

/// Something on the canvas.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// A node, by name.
    Node(String),
    /// A frame, by name.
    Frame(String),
    /// A note, by name.
    Note(String),
    /// A point of a wire, by name.
    Reroute(String),
    /// A link.
    Link(Link),
}

impl Item {
    /// What the item is, in a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Node(_) => "node",
            Self::Frame(_) => "frame",
            Self::Note(_) => "note",
            Self::Reroute(_) => "point",
            Self::Link(_) => "link",
        }
    }
}

impl std::fmt::Display for Item {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Node(name) | Self::Frame(name) | Self::Note(name) | Self::Reroute(name) => {
                f.write_str(name)
            }
            Self::Link(link) => link.fmt(f),
        }
    }
}
