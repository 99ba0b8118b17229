//! A node that is dropped on a wire comes between its ends.

use eframe::egui::{Pos2, Vec2};
use mve_core::{Link, PortRef};

use super::paint::{Brush, distance_to_wire};
use super::{Canvas, Scene};
use crate::document::{Edit, Item, fits};

/// How far a wire may pass from the middle of a node that lies on it, as a part of its height.
const NEAR: f32 = 0.35;

/// A wire below a node in the hand, and the links that take its place.
pub(super) struct Insertion {
    /// Its ends on the screen.
    pub ends: [Pos2; 2],
    links: [Link; 2],
}

impl Insertion {
    /// The links as edits: the second takes the place of the one that was there.
    pub fn edits(self) -> impl Iterator<Item = Edit> {
        self.links.into_iter().map(Edit::Connect)
    }
}

impl Canvas {
    /// The wire on which a single node without links lies, moved by so much, if it fits between the
    /// ends.
    pub(super) fn insertion(
        &self,
        brush: &Brush,
        scene: &Scene,
        items: &[(Item, [f64; 2])],
        by: Vec2,
    ) -> Option<Insertion> {
        let [(Item::Node(name), _)] = items else { return None };
        let map = scene.document.map();
        let is_linked = |link: &Link| link.from.node == *name || link.to.node == *name;
        if map.links.iter().any(is_linked) {
            return None;
        }
        let rect = brush.view.rect_to_screen(self.shapes.nodes.get(name)?.rect().translate(by));
        let zoom = brush.view.camera.zoom;
        let near = map.links.iter().filter_map(|link| {
            let (from, to, _) = self.shapes.ends(link)?;
            let ends = [from, to].map(|at| brush.view.to_screen(at));
            let distance = distance_to_wire(ends[0], ends[1], zoom, rect.center());
            (distance < NEAR * rect.height()).then_some((distance, ends, link))
        });
        let (_, ends, link) = near.min_by(|(a, ..), (b, ..)| a.total_cmp(b))?;
        let links = between(scene, name, link)?;
        Some(Insertion { ends, links })
    }
}

/// The links by which a node comes between the ends of another.
fn between(scene: &Scene, name: &str, link: &Link) -> Option<[Link; 2]> {
    let map = scene.document.map();
    let module = scene.registry.find(&map.nodes.get(name)?.module)?.module;
    let port = |port: &str| PortRef { node: name.to_owned(), port: port.to_owned() };
    let fitting = |link: &Link| fits(map, scene.registry, link).is_ok();
    let mut into =
        module.inputs.iter().map(|input| Link { from: link.from.clone(), to: port(input.name) });
    let mut out_of =
        module.outputs.iter().map(|output| Link { from: port(output.name), to: link.to.clone() });
    Some([into.find(fitting)?, out_of.find(fitting)?])
}
