//! The edges of a mesh that belong to one face only.

use std::sync::Arc;

use eframe::egui::Key;

use super::Overlay;
use crate::views::mesh::lines::{LineIndices, LineSet};
use crate::views::mesh::look::settings::{Switch, SwitchHome};

/// The overlay of border edges.
#[derive(Default)]
pub struct Border;

static LINES: LineSet = LineSet {
    color: [1.0, 0.55, 0.05, 1.0],
    fades: false,
    find: |_, _, edges| LineIndices {
        pairs: Arc::clone(&edges.indices),
        n_indices: 2 * edges.n_border,
    },
};

impl Overlay for Border {
    fn switch(&self) -> Option<Switch> {
        Some(Switch {
            label: "Border edges",
            doc: "Edges of one face only, in orange (B)",
            home: SwitchHome::Menu,
            key: Some(Key::B),
            place: |settings| &mut settings.lines.has_border,
        })
    }

    fn lines(&self) -> Option<&'static LineSet> {
        Some(&LINES)
    }
}
