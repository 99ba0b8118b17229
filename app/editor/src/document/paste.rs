//! Pasting: what was copied comes into a map under names that are free.

use std::collections::HashSet;

use indexmap::IndexMap;
use mve_core::{Link, ProgramSpec};

use super::clip::Clip;
use super::edit::EditError;
use super::extras::Extras;
use super::item::Item;
use super::names::{free_name, taken};
use super::rename::Renaming;
use super::transaction::{Transaction, offset};
use super::{arrange, fits};

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
    fn new_names(&self, clip: &Clip) -> Renaming {
        let mut taken = taken(&self.map, "nodes");
        let mut pairs = Vec::new();
        for old in clip.map.nodes.keys() {
            let new = free_name(old, |name| taken.contains(name));
            taken.insert(new.clone());
            pairs.push((old.clone(), new));
        }
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
    fn paste_programs(&mut self, programs: IndexMap<String, ProgramSpec>, is_first: bool) {
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
        let is_there = |name: &String| nodes.contains_key(name);
        self.extras.collapsed.extend(extras.collapsed.into_iter().filter(is_there));
        self.extras.pictured.extend(extras.pictured.into_iter().filter(is_there));
        Ok(())
    }
}
