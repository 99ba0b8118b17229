//! Room for nodes: how much they take, and where there is some.

use eframe::egui;
use mve_core::Registry;

use super::Canvas;
use super::camera::pos;
use super::shape::Shapes;
use crate::document::Document;

impl Canvas {
    /// Tells a map how large its nodes are drawn, before they are, so that those without a place
    /// are laid out apart.
    pub fn measure(&mut self, document: &mut Document, registry: &Registry) {
        self.shapes = Shapes::default();
        self.shapes.update(document, registry, false);
        self.sizes().for_each(|(name, size)| document.set_size(name, size));
        document.place_others();
        self.shapes = Shapes::default();
    }

    /// A place for something of this size that covers no node: in sight, and as near to a point as
    /// there is one.
    pub fn free_near(&self, at: [f64; 2], size: [f64; 2]) -> Option<[f64; 2]> {
        let size = egui::vec2(size[0] as f32, size[1] as f32);
        let seen = self.view?.visible();
        let free = self.shapes.free_near(pos(at), size, seen)?;
        Some([f64::from(free.x), f64::from(free.y)])
    }
}
