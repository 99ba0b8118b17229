//! What was copied: a small map, which can be pasted here, elsewhere, or into a text.

use mve_core::{Link, Map};
use serde_json::{Value as Json, json};

use super::Document;
use super::extras::Extras;
use super::item::Item;

/// In the text of a clip, links to its nodes from others, which the map itself cannot have.
const OUTER: &str = "links_from_outside";

/// Nodes, the links among them, frames and notes, with their places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    pub(super) map: Map,
    pub(super) extras: Extras,
    /// Links from nodes that were not copied.
    pub(super) outer: Vec<Link>,
}

impl Clip {
    /// Copies items; links and their points come with the nodes that they join.
    pub fn copy(document: &Document, items: &[Item]) -> Self {
        let map = document.map();
        let mut clip = Self::default();
        for (name, node) in &map.nodes {
            if items.contains(&Item::Node(name.clone())) {
                clip.map.nodes.insert(name.clone(), node.clone());
                if let Some(at) = document.position(&Item::Node(name.clone())) {
                    clip.map.layout.insert(name.clone(), at);
                }
            }
        }
        let is_inside = |name: &str| clip.map.nodes.contains_key(name);
        let joins = |link: &&Link| is_inside(&link.from.node) && is_inside(&link.to.node);
        let links: Vec<Link> = map.links.iter().filter(joins).cloned().collect();
        let mut extras = document.extras().clone();
        extras.frames.retain(|name, _| items.contains(&Item::Frame(name.clone())));
        extras.notes.retain(|name, _| items.contains(&Item::Note(name.clone())));
        extras.reroutes.retain(|_, reroute| links.contains(&reroute.link));
        extras.collapsed.retain(|name| is_inside(name));
        extras.pictured.retain(|name| is_inside(name));
        clip.extras = extras.without_rest();
        clip.map.links = links;
        clip
    }

    /// Copies items, and notes where the links come from that are not copied: pasted beside the
    /// nodes that give to them, the copies take from these too.
    pub fn copy_with_links(document: &Document, items: &[Item]) -> Self {
        let mut clip = Self::copy(document, items);
        let nodes = &clip.map.nodes;
        let comes_in = |link: &&Link| {
            nodes.contains_key(&link.to.node) && !nodes.contains_key(&link.from.node)
        };
        clip.outer = document.map().links.iter().filter(comes_in).cloned().collect();
        clip
    }

    /// Whether nothing was copied.
    pub fn is_empty(&self) -> bool {
        let Extras { frames, notes, .. } = &self.extras;
        self.map.nodes.is_empty() && frames.is_empty() && notes.is_empty()
    }

    /// The clip as the text of a map.
    pub fn to_text(&self) -> String {
        let mut map = self.map.clone();
        self.extras.write_to(&mut map);
        if !self.outer.is_empty() {
            let links: Vec<String> = self.outer.iter().map(Link::to_string).collect();
            let canvas = map.extra.entry("canvas").or_insert_with(|| json!({}));
            canvas[OUTER] = Json::from(links);
        }
        map.to_text()
    }

    /// Reads the text of a clip or of any map; `None` if it is neither.
    pub fn parse(text: &str) -> Option<Self> {
        let mut map = Map::parse(text).ok()?;
        let extras = Extras::of(&map).without_rest();
        let outer = map.extra.get("canvas").and_then(|canvas| canvas.get(OUTER));
        let outer = outer.and_then(Json::as_array).into_iter().flatten();
        let outer = outer.filter_map(|link| link.as_str()?.parse().ok()).collect();
        map.extra.clear();
        let clip = Self { map, extras, outer };
        (!clip.is_empty()).then_some(clip)
    }
}
