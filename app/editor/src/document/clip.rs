//! What was copied: a small map, which can be pasted here, elsewhere, or into a text.

use std::collections::HashSet;

use mve_core::{Link, Map};
use serde_json::{Value as Json, json};

use super::edit::Item;
use super::extras::Extras;
use super::names::{free_name, taken};
use super::rename::Renaming;
use super::transaction::{Transaction, offset};
use super::{Document, EditError, arrange, fits};

/// In the text of a clip, links to its nodes from others, which the map itself cannot have.
const OUTER: &str = "links_from_outside";

/// Nodes, the links among them, frames and notes, with their places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    map: Map,
    extras: Extras,
    /// Links from nodes that were not copied.
    outer: Vec<Link>,
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

impl Transaction<'_> {
    /// Adds what a clip holds under names that are free, its upper left corner at `at`.
    pub(super) fn paste(&mut self, clip: &Clip, at: [f64; 2]) -> Result<(), EditError> {
        let mut clip = clip.clone();
        let known: Vec<String> = clip.map.nodes.keys().cloned().collect();
        let missing: Vec<String> =
            known.iter().filter(|name| !clip.map.layout.contains_key(*name)).cloned().collect();
        let guess = |name: &str| arrange::guessed_size(&clip.map, name);
        let places = arrange::in_layers(&clip.map, &missing, guess);
        clip.map.layout.extend(places);
        clip.map.layout.retain(|name, _| clip.map.nodes.contains_key(name));
        let by = self.way_to(&clip, at);
        let renaming = self.new_names(&clip);
        renaming.apply(&mut clip.map, &mut clip.extras, self.registry);
        let fresh: HashSet<&String> = clip.map.nodes.keys().collect();
        let is_fresh =
            |link: &Link| fresh.contains(&link.from.node) && fresh.contains(&link.to.node);
        let inner: Vec<Link> =
            clip.map.links.iter().filter(|link| is_fresh(link)).cloned().collect();
        let is_first = self.map.nodes.is_empty();
        for (name, node) in clip.map.nodes {
            self.applied.new_items.push(Item::Node(name.clone()));
            self.map.nodes.insert(name, node);
        }
        for (name, place) in clip.map.layout {
            self.map.layout.insert(name, offset(place, by)?);
        }
        for link in inner {
            if self.is_known_to_fit(&link) {
                self.map.links.push(link);
            }
        }
        for mut link in clip.outer {
            link.to.node = renaming.node(&link.to.node);
            if fits(&self.map, self.registry, &link).is_ok() && !self.is_linked(&link) {
                self.map.links.push(link);
            }
        }
        self.paste_programs(clip.map.programs, is_first);
        if is_first && self.map.title.is_empty() {
            self.map.title = clip.map.title;
        }
        self.paste_extras(clip.extras, by)
    }

    /// How far a clip is moved to have its upper left corner at `at`.
    fn way_to(&self, clip: &Clip, at: [f64; 2]) -> [f64; 2] {
        let frames = clip.extras.frames.values().map(|frame| frame.at);
        let notes = clip.extras.notes.values().map(|note| note.at);
        let corners = clip.map.layout.values().copied().chain(frames).chain(notes);
        let areas = corners.map(|at| arrange::Area { at, size: [0.0; 2] });
        let corner = arrange::bounds(areas).map_or(at, |area| area.at);
        [at[0] - corner[0], at[1] - corner[1]]
    }

    /// Free names for the nodes of a clip.
    fn new_names(&mut self, clip: &Clip) -> Renaming {
        let mut taken = taken(&self.map, "nodes");
        let mut pairs = Vec::new();
        for old in clip.map.nodes.keys() {
            let new = free_name(old, |name| taken.contains(name));
            taken.insert(new.clone());
            pairs.push((old.clone(), new));
        }
        let changed = pairs.iter().filter(|(old, new)| old != new).cloned();
        self.applied.renamed.extend(changed);
        Renaming::new(pairs)
    }

    /// Whether a link may be pasted: nothing is said against one between unknown modules.
    fn is_known_to_fit(&self, link: &Link) -> bool {
        let is_unknown = |name: &str| {
            let node = self.map.nodes.get(name);
            node.is_some_and(|node| self.registry.find(&node.module).is_none())
        };
        let fits = fits(&self.map, self.registry, link).is_ok();
        (fits || is_unknown(&link.from.node) || is_unknown(&link.to.node)) && !self.is_linked(link)
    }

    fn is_linked(&self, link: &Link) -> bool {
        self.map.links.iter().any(|other| other.to == link.to)
    }

    /// Programs come along where a whole map is pasted into an empty one.
    fn paste_programs(
        &mut self,
        programs: indexmap::IndexMap<String, mve_core::ProgramSpec>,
        is_first: bool,
    ) {
        if is_first && self.map.programs.is_empty() {
            self.map.programs = programs;
        }
    }

    fn paste_extras(&mut self, extras: Extras, by: [f64; 2]) -> Result<(), EditError> {
        for (name, mut frame) in extras.frames {
            frame.at = offset(frame.at, by)?;
            let name = free_name(&name, |name| self.extras.frames.contains_key(name));
            self.applied.new_items.push(Item::Frame(name.clone()));
            self.extras.frames.insert(name, frame);
        }
        for (name, mut note) in extras.notes {
            note.at = offset(note.at, by)?;
            let name = free_name(&name, |name| self.extras.notes.contains_key(name));
            self.applied.new_items.push(Item::Note(name.clone()));
            self.extras.notes.insert(name, note);
        }
        for (name, mut reroute) in extras.reroutes {
            if self.map.links.contains(&reroute.link) {
                reroute.at = offset(reroute.at, by)?;
                let name = free_name(&name, |name| self.extras.reroutes.contains_key(name));
                self.applied.new_items.push(Item::Reroute(name.clone()));
                self.extras.reroutes.insert(name, reroute);
            }
        }
        let nodes = &self.map.nodes;
        let collapsed = extras.collapsed.into_iter().filter(|name| nodes.contains_key(name));
        self.extras.collapsed.extend(collapsed);
        Ok(())
    }
}
