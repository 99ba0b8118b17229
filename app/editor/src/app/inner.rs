//! Maps that stand in maps: each is edited in a tab of its own, and the map around it follows.

use mve_core::Map;

use super::Editor;
use super::session::{Inside, Session};
use crate::document::{Document, Edit};

impl Editor {
    /// Opens the map that a node stands for: that of a file in the tab of that file, that of this
    /// map in a tab of its own.
    pub(super) fn open_map_of(&mut self, node: &str) {
        let session = self.session();
        let Some(node) = session.document.map().nodes.get(node) else { return };
        let name = node.module.clone();
        let Some(map) = session.document.map().maps.get(&name).cloned() else {
            match name.ends_with(".json") {
                true => self.open(&session.folder().join(&name)),
                false => self.toast(format!("{name} is the module itself; a map can be opened")),
            }
            return;
        };
        let outer = session.document.id();
        let is_it = |session: &Session| {
            session
                .inside
                .as_ref()
                .is_some_and(|inside| (inside.document, &inside.name) == (outer, &name))
        };
        if let Some(place) = self.sessions.iter().position(is_it) {
            self.active = place;
            return;
        }
        let same = (0, session.document.revision());
        let (around, folder) = (session.runner.registry().clone(), session.folder());
        let document = Document::inside(map);
        let mut inner = Session::new(document, &self.shared);
        inner.inside = Some(Inside { document: outer, name, same });
        inner.set_around(around, folder);
        self.sessions.insert(self.active + 1, inner);
        self.active += 1;
    }

    /// Has maps and those inside of them say the same: what was changed in one tab is so in the
    /// other.
    pub(super) fn follow_inner_maps(&mut self) {
        for place in 0..self.sessions.len() {
            let Some(inside) = &self.sessions[place].inside else { continue };
            let outer = self.sessions.iter().position(|s| s.document.id() == inside.document);
            let name = inside.name.clone();
            let Some(outer) = outer else {
                // It goes on as a map without a file.
                self.sessions[place].inside = None;
                continue;
            };
            let now = |editor: &Self| {
                let revision = |place: usize| editor.sessions[place].document.revision();
                (revision(place), revision(outer))
            };
            let (own, around) = now(self);
            if (own, around) == inside.same {
                continue;
            }
            if own != inside.same.0 {
                let map: Map = (**self.sessions[place].document.map()).clone();
                let edit = Edit::SetMap { name, map: Box::new(map) };
                let Session { document, runner, .. } = &mut self.sessions[outer];
                let applied = document.apply(&[edit], runner.registry());
                applied.map_or_else(|error| self.toast(error.to_string()), drop);
            } else {
                let map = self.sessions[outer].document.map().maps.get(&name).cloned();
                let session = &mut self.sessions[place];
                match map {
                    None => session.inside = None,
                    Some(map) if map == **session.document.map() => {}
                    Some(map) => {
                        let edit = Edit::ReplaceText(map.to_text());
                        let Session { document, runner, .. } = session;
                        let _ = document.apply(&[edit], runner.registry());
                    }
                }
            }
            let same = now(self);
            let registry = self.sessions[outer].runner.registry().clone();
            let folder = self.sessions[outer].folder();
            let session = &mut self.sessions[place];
            session.set_around(registry, folder);
            if let Some(inside) = &mut session.inside {
                inside.same = same;
                session.document.count_as_saved();
            }
        }
    }

    /// The map that a save is about: of one inside of another, that one.
    pub(super) fn outermost(&self, place: usize) -> usize {
        let mut place = place;
        for _ in 0..self.sessions.len() {
            let Some(inside) = &self.sessions[place].inside else { break };
            let outer = self.sessions.iter().position(|s| s.document.id() == inside.document);
            let Some(outer) = outer else { break };
            place = outer;
        }
        place
    }
}
