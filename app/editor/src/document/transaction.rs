//! A map in the making: edits act on it one by one, and it takes the document's place when none
//! was refused.

use std::collections::{HashMap, HashSet};

use indexmap::{IndexMap, IndexSet};
use mve_core::{Link, MODULE, Map, Node, ParamSpec, Registry, assign};
use serde_json::{Map as JsonMap, Value as Json};

use super::arrange::{self, Area};
use super::edit::{Edit, EditError, EditOutcome};
use super::extras::{CanvasFrame, Extras, Note, Reroute};
use super::item::Item;
use super::names::{free_name, name_after, taken};
use super::rename::Renaming;
use super::route;
use super::{fits, is_many};

/// No place on a canvas lies farther out.
const FARTHEST: f64 = 1e7;

/// A map in the making.
pub(super) struct Transaction<'a> {
    pub map: Map,
    pub extras: Extras,
    pub registry: &'a Registry,
    /// Sizes of nodes as they were drawn.
    pub sizes: &'a HashMap<String, [f64; 2]>,
    pub applied: EditOutcome,
}

/// A place or size as a map keeps it.
pub(super) fn whole(point: [f64; 2]) -> Result<[f64; 2], EditError> {
    if point.iter().any(|x| !x.is_finite()) {
        return Err(EditError::Number);
    }
    // Adding zero turns a negative zero into zero.
    Ok(point.map(|x| x.round().clamp(-FARTHEST, FARTHEST) + 0.0))
}

pub(super) fn offset(point: [f64; 2], by: [f64; 2]) -> Result<[f64; 2], EditError> {
    whole([point[0] + by[0], point[1] + by[1]])
}

/// Places for the nodes of a map that have none in its layout, below those that have.
pub(super) fn places_of_others(
    map: &Map,
    sizes: &HashMap<String, [f64; 2]>,
) -> IndexMap<String, [f64; 2]> {
    let others: Vec<String> =
        map.nodes.keys().filter(|name| !map.layout.contains_key(*name)).cloned().collect();
    if others.is_empty() {
        return IndexMap::new();
    }
    let guessed = |name: &str| arrange::guessed_size(map, name);
    let size = |name: &str| sizes.get(name).copied().unwrap_or_else(|| guessed(name));
    let mut places = arrange::in_layers(map, &others, size);
    let placed = map.layout.iter().filter(|(name, _)| map.nodes.contains_key(*name));
    let areas = placed.map(|(name, at)| Area { at: *at, size: size(name) });
    if let Some(taken) = arrange::bounds(areas) {
        for place in places.values_mut() {
            *place = [place[0] + taken.at[0], place[1] + taken.at[1] + taken.size[1] + 60.0];
        }
    }
    places.values_mut().for_each(|place| *place = place.map(f64::round));
    places
}

impl Transaction<'_> {
    /// Does one edit.
    pub fn edit(&mut self, edit: &Edit) -> Result<(), EditError> {
        if edit.moves_others() {
            // From now on these nodes stay where they were drawn.
            let places = places_of_others(&self.map, self.sizes);
            self.map.layout.extend(places);
        }
        match edit {
            Edit::AddNode { module, name, at } => self.add_node(module, name.as_deref(), *at),
            Edit::Remove(items) => self.remove(items),
            Edit::Connect(link) => self.connect(link),
            Edit::Disconnect(link) => self.remove(&[Item::Link(link.clone())]),
            Edit::SetParam { node, path, value } => self.set_param(node, path, value.as_ref()),
            Edit::Move(items) => items.iter().try_for_each(|(item, at)| self.place(item, *at)),
            Edit::Resize { frame, size } => {
                self.frame(frame)?.size = whole(*size)?.map(|length| length.max(1.0));
                Ok(())
            }
            Edit::Rename { node, to } => self.rename(node, to),
            Edit::SetMode { nodes, mode } => nodes.iter().try_for_each(|name| {
                self.node(name)?.mode = *mode;
                Ok(())
            }),
            Edit::SetCollapsed { nodes, is_collapsed } => {
                self.mark(nodes, *is_collapsed, |extras| &mut extras.collapsed)
            }
            Edit::SetPictured { nodes, is_pictured } => {
                self.mark(nodes, *is_pictured, |extras| &mut extras.pictured)
            }
            Edit::SetText { .. } | Edit::SetColor { .. } => self.edit_extra(edit),
            Edit::AddFrame { .. } | Edit::AddNote { .. } | Edit::AddReroute { .. } => {
                self.add_extra(edit)
            }
            Edit::Paste { clip, at } => self.paste(clip, whole(*at)?),
            Edit::Align { items, to } => {
                let places = arrange::align(&self.areas(items)?, *to);
                items.iter().zip(places).try_for_each(|(item, at)| self.place(item, at))
            }
            Edit::Distribute { items, along } => {
                let places = arrange::distribute(&self.areas(items)?, *along);
                items.iter().zip(places).try_for_each(|(item, at)| self.place(item, at))
            }
            Edit::Arrange { nodes } => self.arrange(nodes),
            Edit::MakeMap { .. } | Edit::Unpack { .. } | Edit::SetMap { .. } => {
                self.edit_maps(edit)
            }
            Edit::SetRepeat { node, repeat } => {
                self.node(node)?.repeat.clone_from(repeat);
                Ok(())
            }
            Edit::SetTitle(title) => {
                self.map.title.clone_from(title);
                Ok(())
            }
            Edit::SetProgram { .. } | Edit::RenameProgram { .. } => self.edit_program(edit),
            Edit::Keep(edit) => self.extras.kept.edit(edit).map_err(EditError::Kept),
            Edit::ReplaceText(text) => {
                self.map = Map::parse(text)?;
                self.extras = Extras::of(&self.map);
                Ok(())
            }
        }
    }

    /// Puts nodes into a set of the canvas, or takes them out.
    fn mark(
        &mut self,
        nodes: &[String],
        is_in: bool,
        set: fn(&mut Extras) -> &mut IndexSet<String>,
    ) -> Result<(), EditError> {
        nodes.iter().try_for_each(|name| {
            self.node(name)?;
            let set = set(&mut self.extras);
            match is_in {
                true => set.insert(name.clone()),
                false => set.shift_remove(name),
            };
            Ok(())
        })
    }

    pub fn node(&mut self, name: &str) -> Result<&mut Node, EditError> {
        self.map.nodes.get_mut(name).ok_or_else(|| EditError::missing("node", name))
    }

    fn frame(&mut self, name: &str) -> Result<&mut CanvasFrame, EditError> {
        self.extras.frames.get_mut(name).ok_or_else(|| EditError::missing("frame", name))
    }

    fn note(&mut self, name: &str) -> Result<&mut Note, EditError> {
        self.extras.notes.get_mut(name).ok_or_else(|| EditError::missing("note", name))
    }

    fn add_node(
        &mut self,
        module: &str,
        name: Option<&str>,
        at: [f64; 2],
    ) -> Result<(), EditError> {
        if self.registry.find(module).is_none() {
            return Err(EditError::NoModule(module.to_owned()));
        }
        let name = name.map_or_else(|| name_after(module), str::to_owned);
        check_name(&name)?;
        let taken = taken(&self.map, "nodes");
        let name = free_name(&name, |name| taken.contains(name));
        let node = Node { module: module.to_owned(), ..Node::default() };
        self.map.nodes.insert(name.clone(), node);
        self.map.layout.insert(name.clone(), whole(at)?);
        self.applied.new_items.push(Item::Node(name));
        Ok(())
    }

    fn remove(&mut self, items: &[Item]) -> Result<(), EditError> {
        for item in items {
            if !exists(&self.map, &self.extras, item) {
                return Err(EditError::missing(item.kind(), &item.to_string()));
            }
        }
        let items: HashSet<&Item> = items.iter().collect();
        let is_gone = |name: &str| items.contains(&Item::Node(name.to_owned()));
        self.map.nodes.retain(|name, _| !is_gone(name));
        self.map.layout.retain(|name, _| !is_gone(name));
        self.extras.collapsed.retain(|name| !is_gone(name));
        self.extras.pictured.retain(|name| !is_gone(name));
        self.extras.frames.retain(|name, _| !items.contains(&Item::Frame(name.clone())));
        self.extras.notes.retain(|name, _| !items.contains(&Item::Note(name.clone())));
        self.extras.reroutes.retain(|name, _| !items.contains(&Item::Reroute(name.clone())));
        self.cut(|link| {
            is_gone(&link.from.node)
                || is_gone(&link.to.node)
                || items.contains(&Item::Link(link.clone()))
        });
        Ok(())
    }

    /// Removes links, and the points of their wires.
    fn cut(&mut self, is_cut: impl Fn(&Link) -> bool) {
        let links = std::mem::take(&mut self.map.links);
        let (gone, left): (Vec<Link>, Vec<Link>) = links.into_iter().partition(is_cut);
        self.map.links = left;
        self.extras.reroutes.retain(|_, reroute| !gone.contains(&reroute.link));
    }

    fn connect(&mut self, link: &Link) -> Result<(), EditError> {
        if self.map.links.contains(link) {
            return Ok(());
        }
        fits(&self.map, self.registry, link).map_err(EditError::Link)?;
        if is_many(&self.map, self.registry, &link.to) {
            self.map.links.push(link.clone());
            return Ok(());
        }
        // The new link stands where the old one stood, so that the file changes in one line.
        let place = self.map.links.iter().position(|old| old.to == link.to);
        let place = place.unwrap_or(self.map.links.len());
        self.cut(|old| old.to == link.to);
        self.map.links.insert(place, link.clone());
        Ok(())
    }

    fn set_param(&mut self, node: &str, path: &str, value: Option<&Json>) -> Result<(), EditError> {
        let module = self.node(node)?.module.clone();
        match value {
            Some(value) => {
                let path = format!("{node}.{path}");
                assign(&mut self.map, self.registry, &path, value.clone())
                    .map_err(|problem| EditError::Param(problem.to_string()))?;
            }
            None if path == MODULE => {
                return Err(EditError::WrongKind("a node has no module by default; name one"));
            }
            None => {
                let info = self.registry.find(&module);
                let specs = info.map_or(&[][..], |info| info.module.params);
                unset(&mut self.node(node)?.params, specs, path);
            }
        }
        if path == MODULE && self.node(node)?.module != module {
            self.keep_what_fits(node);
        }
        Ok(())
    }

    /// Drops what a node cannot keep under its new module.
    fn keep_what_fits(&mut self, name: &str) {
        let Some(node) = self.map.nodes.get_mut(name) else { return };
        let Some(info) = self.registry.find(&node.module) else { return };
        node.params.retain(|param, _| info.module.params.iter().any(|spec| spec.name == param));
        let touches = |link: &Link| link.from.node == name || link.to.node == name;
        let (map, registry) = (&self.map, self.registry);
        let unfit: HashSet<Link> = map
            .links
            .iter()
            .filter(|link| touches(link) && fits(map, registry, link).is_err())
            .cloned()
            .collect();
        self.cut(|link| unfit.contains(link));
    }

    fn place(&mut self, item: &Item, at: [f64; 2]) -> Result<(), EditError> {
        let at = whole(at)?;
        match item {
            Item::Node(name) => {
                self.node(name)?;
                self.map.layout.insert(name.clone(), at);
            }
            Item::Frame(name) => self.frame(name)?.at = at,
            Item::Note(name) => self.note(name)?.at = at,
            Item::Reroute(name) => {
                let reroute = self.extras.reroutes.get_mut(name);
                reroute.ok_or_else(|| EditError::missing("point", name))?.at = at;
            }
            Item::Link(_) => return Err(EditError::WrongKind("a link has no place of its own")),
        }
        Ok(())
    }

    fn rename(&mut self, node: &str, to: &str) -> Result<(), EditError> {
        self.node(node)?;
        check_name(to)?;
        if node == to {
            return Ok(());
        }
        if taken(&self.map, "nodes").contains(to) {
            return Err(EditError::name(to, "another node has it"));
        }
        let renaming = Renaming::new([(node.to_owned(), to.to_owned())]);
        // A place that was left behind by a node of the new name is nobody's.
        self.map.layout.shift_remove(to);
        renaming.apply(&mut self.map, &mut self.extras, self.registry);
        self.applied.renamed.push((node.to_owned(), to.to_owned()));
        Ok(())
    }

    fn edit_extra(&mut self, edit: &Edit) -> Result<(), EditError> {
        match edit {
            Edit::SetText { item: Item::Frame(name), text } => {
                self.frame(name)?.title.clone_from(text);
            }
            Edit::SetText { item: Item::Note(name), text } => {
                self.note(name)?.text.clone_from(text);
            }
            Edit::SetColor { item: Item::Frame(name), color } => self.frame(name)?.color = *color,
            Edit::SetColor { item: Item::Note(name), color } => self.note(name)?.color = *color,
            _ => return Err(EditError::WrongKind("only frames and notes have a text and a color")),
        }
        Ok(())
    }

    fn add_extra(&mut self, edit: &Edit) -> Result<(), EditError> {
        let item = match edit {
            Edit::AddFrame { title, at, size } => {
                let name = free_name("frame", |name| self.extras.frames.contains_key(name));
                let size = whole(*size)?.map(|length| length.max(1.0));
                let frame = CanvasFrame {
                    title: title.clone(),
                    at: whole(*at)?,
                    size,
                    ..CanvasFrame::default()
                };
                self.extras.frames.insert(name.clone(), frame);
                Item::Frame(name)
            }
            Edit::AddNote { text, at } => {
                let name = free_name("note", |name| self.extras.notes.contains_key(name));
                let note = Note { text: text.clone(), at: whole(*at)?, ..Note::default() };
                self.extras.notes.insert(name.clone(), note);
                Item::Note(name)
            }
            Edit::AddReroute { link, at } => {
                if !self.map.links.contains(link) {
                    return Err(EditError::missing("link", &link.to_string()));
                }
                let name = free_name("point", |name| self.extras.reroutes.contains_key(name));
                let at = whole(*at)?;
                let place = self.place_on_wire(link, at);
                let reroute = Reroute { link: link.clone(), at, extra: JsonMap::new() };
                self.extras.reroutes.shift_insert(place, name.clone(), reroute);
                Item::Reroute(name)
            }
            _ => return Ok(()),
        };
        self.applied.new_items.push(item);
        Ok(())
    }

    /// Where among all points a new one of this link goes, so that its wire is lengthened least.
    fn place_on_wire(&self, link: &Link, at: [f64; 2]) -> usize {
        let reroutes = &self.extras.reroutes;
        let of_link: Vec<usize> = reroutes
            .values()
            .enumerate()
            .filter(|(_, reroute)| reroute.link == *link)
            .map(|(place, _)| place)
            .collect();
        let end = |name: &str| self.map.layout.get(name).copied().unwrap_or(at);
        let points = of_link.iter().map(|place| reroutes[*place].at);
        let wire: Vec<[f64; 2]> = std::iter::once(end(&link.from.node))
            .chain(points)
            .chain([end(&link.to.node)])
            .collect();
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let detour = |pair: &[[f64; 2]]| {
            distance(pair[0], at) + distance(at, pair[1]) - distance(pair[0], pair[1])
        };
        let detours = wire.windows(2).map(detour).enumerate();
        let best = detours.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(place, _)| place);
        of_link.get(best).copied().unwrap_or(reroutes.len())
    }

    fn areas(&self, items: &[Item]) -> Result<Vec<Area>, EditError> {
        items.iter().map(|item| self.area(item)).collect()
    }

    fn area(&self, item: &Item) -> Result<Area, EditError> {
        let Extras { frames, notes, reroutes, .. } = &self.extras;
        let area = match item {
            Item::Node(name) => {
                let size = self.size(name);
                self.map.layout.get(name).map(|at| Area { at: *at, size })
            }
            Item::Frame(name) => {
                frames.get(name).map(|frame| Area { at: frame.at, size: frame.size })
            }
            Item::Note(name) => notes.get(name).map(|note| Area { at: note.at, size: [0.0; 2] }),
            Item::Reroute(name) => {
                reroutes.get(name).map(|reroute| Area { at: reroute.at, size: [0.0; 2] })
            }
            Item::Link(_) => return Err(EditError::WrongKind("a link has no place of its own")),
        };
        area.ok_or_else(|| EditError::missing(item.kind(), &item.to_string()))
    }

    fn size(&self, node: &str) -> [f64; 2] {
        let drawn = self.sizes.get(node).copied();
        drawn.unwrap_or_else(|| arrange::guessed_size(&self.map, node))
    }

    /// Nodes in layers; their common corner stays.
    fn arrange(&mut self, nodes: &[String]) -> Result<(), EditError> {
        let names: Vec<String> = match nodes {
            [] => self.map.nodes.keys().cloned().collect(),
            some => some.to_vec(),
        };
        let items: Vec<Item> = names.iter().cloned().map(Item::Node).collect();
        let areas = self.areas(&items)?;
        let held = |frame: &CanvasFrame| -> Vec<Item> {
            let is_held = |area: &Area| frame.holds(area.at, area.size);
            let inside = items.iter().zip(&areas).filter(|(_, area)| is_held(area));
            inside.map(|(item, _)| item.clone()).collect()
        };
        let frames = self.extras.frames.iter();
        let framed: Vec<_> = frames.map(|(name, frame)| (name.clone(), held(frame))).collect();
        let Some(before) = arrange::bounds(areas) else { return Ok(()) };
        let groups = arrange::groups_of(&framed);
        let size = |name: &str| self.size(name);
        let places = arrange::in_layers_by_groups(&self.map, &names, &groups, size);
        for (name, place) in places {
            self.map.layout.insert(name, offset(place, before.at)?);
        }
        // Frames stay around what they were around.
        for (name, items) in framed {
            if let Some(around) = arrange::bounds(self.areas(&items)?) {
                let frame = self.frame(&name)?;
                Area { at: frame.at, size: frame.size } = around.framed();
            }
        }
        self.lead_wires(&names)
    }

    /// Leads the wires between nodes that have new places around what stands between their ends.
    fn lead_wires(&mut self, names: &[String]) -> Result<(), EditError> {
        let is_led =
            |link: &Link| [&link.from, &link.to].iter().all(|end| names.contains(&end.node));
        self.extras.reroutes.retain(|_, reroute| !is_led(&reroute.link));
        let links = self.map.links.iter().filter(|link| is_led(link));
        for (link, points) in route::around_nodes(&self.map, links, |name| self.size(name)) {
            for at in points {
                let name = free_name("point", |name| self.extras.reroutes.contains_key(name));
                let (link, at, extra) = (link.clone(), whole(at)?, JsonMap::new());
                self.extras.reroutes.insert(name, Reroute { link, at, extra });
            }
        }
        Ok(())
    }
}

pub(super) fn check_name(name: &str) -> Result<(), EditError> {
    let why = "a node's name cannot be empty or hold spaces, slashes or any of . { } >";
    if Map::can_name_a_node(name) { Ok(()) } else { Err(EditError::name(name, why)) }
}

/// Whether a map has this item.
pub(super) fn exists(map: &Map, extras: &Extras, item: &Item) -> bool {
    match item {
        Item::Node(name) => map.nodes.contains_key(name),
        Item::Frame(name) => extras.frames.contains_key(name),
        Item::Note(name) => extras.notes.contains_key(name),
        Item::Reroute(name) => extras.reroutes.contains_key(name),
        Item::Link(link) => map.links.contains(link),
    }
}

/// Takes a parameter out of what a map says. A choice of which nothing else is said goes with it.
fn unset(params: &mut JsonMap<String, Json>, specs: &[ParamSpec], path: &str) {
    let Some((name, nested)) = path.split_once('.') else {
        params.shift_remove(path);
        return;
    };
    let choice = specs.iter().find(|spec| spec.name == name).and_then(ParamSpec::choice);
    let Some(Json::Object(value)) = params.get_mut(name) else { return };
    let Some((id, Json::Object(inner))) = value.iter_mut().next() else { return };
    let entry = choice.and_then(|choice| Some((choice.list.find(id)?, choice.default)));
    unset(inner, entry.map_or(&[][..], |(entry, _)| entry.params), nested);
    if inner.is_empty() {
        let id = id.clone();
        match entry {
            Some((entry, default)) if entry.id == default => params.shift_remove(name),
            _ => params.insert(name.to_owned(), Json::from(id)),
        };
    }
}
