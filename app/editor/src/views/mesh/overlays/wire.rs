//! All edges of a mesh.

use std::sync::Arc;

use eframe::egui::Key;

use super::Overlay;
use crate::views::mesh::lines::{LineIndices, LineSet};
use crate::views::mesh::look::settings::{Switch, SwitchHome};

/// The overlay of all edges.
#[derive(Default)]
pub struct Wire;

static LINES: LineSet = LineSet {
    color: [0.06, 0.08, 0.12, 0.65],
    fades: true,
    find: |_, _, edges| LineIndices {
        pairs: Arc::clone(&edges.indices),
        n_indices: edges.indices.len(),
    },
};

impl Overlay for Wire {
    fn switch(&self) -> Option<Switch> {
        Some(Switch {
            label: "Wire",
            doc: "The edges of all faces (W)",
            home: SwitchHome::Row,
            key: Some(Key::W),
            place: |settings| &mut settings.lines.has_wire,
        })
    }

    fn lines(&self) -> Option<&'static LineSet> {
        Some(&LINES)
    }
}
