//! An open map: what canvas and panels show, and the only source of truth.
//!
//! Every change goes through [`Document::apply`], which does all edits or none, and remembers the
//! map as it was. Maps are shared, so whoever runs one keeps it for as long as it likes.
//!
//! **Invariant: undoing everything brings back the bytes of the file.** A step is undone by putting
//! the old map in the place of the new one, text and all, never by an edit the other way round.

mod arrange;
mod clip;
mod edit;
mod extras;
mod files;
mod fit;
mod group;
mod history;
mod item;
mod names;
mod paste;
mod paths;
mod programs;
mod rename;
mod route;
mod transaction;

use std::cell::OnceCell;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use indexmap::{IndexMap, IndexSet};
use mve_core::{Map, MapError, Registry};

pub use clip::Clip;
pub use edit::{Alignment, Direction, Edit, EditError, EditOutcome};
pub use extras::{CanvasFrame, Extras, Note, Reroute};
pub use files::{Recovered, Recovery};
pub use fit::{fits, is_many};
pub use item::Item;
pub use paths::{move_paths, written_path};

use history::{History, Snapshot};
use transaction::Transaction;

/// What became of the file of an open map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiskChange {
    /// It holds something else.
    Changed,
    /// It is gone.
    Removed,
}

/// An open map.
#[derive(Debug)]
pub struct Document {
    id: u64,
    map: Arc<Map>,
    extras: Extras,
    /// Places of the nodes that have none in the map.
    places: IndexMap<String, [f64; 2]>,
    /// The text of the map, once asked for.
    text: OnceCell<String>,
    revision: u64,
    history: History,
    selection: IndexSet<Item>,
    path: Option<PathBuf>,
    /// What the file holds as far as is known; `None` where there is none.
    on_disk: Option<String>,
    /// Sizes of nodes as they were drawn.
    sizes: HashMap<String, [f64; 2]>,
}

impl Default for Document {
    fn default() -> Self {
        Self::new()
    }
}

impl Document {
    /// An empty map, which nobody needs to save.
    pub fn new() -> Self {
        Self::of(Map::default(), None)
    }

    /// Opens a map's file.
    pub fn open(path: &Path) -> Result<Self, MapError> {
        Ok(Self::of(Map::load(path)?, Some(path.to_owned())))
    }

    /// A map from its text: it has no file, and counts as saved.
    pub fn from_text(text: &str) -> Result<Self, MapError> {
        Ok(Self::of(Map::parse(text)?, None))
    }

    fn of(map: Map, path: Option<PathBuf>) -> Self {
        static NEXT_ID: AtomicU64 = AtomicU64::new(0);
        Self {
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
            extras: Extras::of(&map),
            places: transaction::places_of_others(&map, &HashMap::new()),
            text: OnceCell::new(),
            revision: 0,
            history: History::default(),
            selection: IndexSet::new(),
            path,
            on_disk: Some(map.to_text()),
            sizes: HashMap::new(),
            map: Arc::new(map),
        }
    }

    /// A number that no other document of this process has.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// The map.
    pub fn map(&self) -> &Arc<Map> {
        &self.map
    }

    /// What the canvas draws beside nodes and links.
    pub fn extras(&self) -> &Extras {
        &self.extras
    }

    /// Where an item is drawn; nodes that have no place in the map get one in layers. `None` for
    /// links and what is not there.
    pub fn position(&self, item: &Item) -> Option<[f64; 2]> {
        match item {
            Item::Node(name) if self.map.nodes.contains_key(name) => {
                self.map.layout.get(name).or_else(|| self.places.get(name)).copied()
            }
            Item::Frame(name) => self.extras.frames.get(name).map(|frame| frame.at),
            Item::Note(name) => self.extras.notes.get(name).map(|note| note.at),
            Item::Reroute(name) => self.extras.reroutes.get(name).map(|reroute| reroute.at),
            Item::Node(_) | Item::Link(_) => None,
        }
    }

    /// Everything that is drawn but links.
    pub fn all_items(&self) -> Vec<Item> {
        let nodes = self.map.nodes.keys().cloned().map(Item::Node);
        let frames = self.extras.frames.keys().cloned().map(Item::Frame);
        let notes = self.extras.notes.keys().cloned().map(Item::Note);
        let reroutes = self.extras.reroutes.keys().cloned().map(Item::Reroute);
        nodes.chain(frames).chain(notes).chain(reroutes).collect()
    }

    /// A name for a new node of a module, which no node has.
    pub fn free_name(&self, module: &str) -> String {
        let taken = names::taken(&self.map, "nodes");
        names::free_name(&names::name_after(module), |name| taken.contains(name))
    }

    /// The map's file.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The folder that the map's input paths are relative to.
    pub fn folder(&self) -> PathBuf {
        self.path().and_then(Path::parent).map_or_else(PathBuf::new, Path::to_owned)
    }

    /// The text of the map's file, as it would be saved.
    pub fn text(&self) -> &str {
        self.text.get_or_init(|| self.map.to_text())
    }

    /// A map that stands in another one, which keeps it.
    pub fn inside(map: Map) -> Self {
        Self::of(map, None)
    }

    /// Takes the map as saved: the one around it has it.
    pub fn count_as_saved(&mut self) {
        self.on_disk = Some(self.text().to_owned());
    }

    /// Whether the text differs from what is on disk.
    pub fn is_dirty(&self) -> bool {
        self.on_disk.as_deref() != Some(self.text())
    }

    /// Grows with each change of the map, undoing included.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Does all edits as one step, or none and says why.
    pub fn apply(&mut self, edits: &[Edit], registry: &Registry) -> Result<EditOutcome, EditError> {
        self.apply_at(edits, registry, Instant::now())
    }

    /// [`Document::apply`] at a given time: edits of one thing that follow each other within a
    /// second are one step.
    pub fn apply_at(
        &mut self,
        edits: &[Edit],
        registry: &Registry,
        now: Instant,
    ) -> Result<EditOutcome, EditError> {
        let mut transaction = Transaction {
            map: (*self.map).clone(),
            extras: self.extras.clone(),
            registry,
            sizes: &self.sizes,
            applied: EditOutcome::default(),
        };
        edits.iter().try_for_each(|edit| transaction.edit(edit))?;
        let Transaction { mut map, extras, applied, .. } = transaction;
        if extras != self.extras {
            extras.write_to(&mut map);
        }
        if map == *self.map {
            return Ok(applied);
        }
        let is_text = edits.iter().any(|edit| matches!(edit, Edit::ReplaceText(_)));
        if !map.problems().is_empty() && !is_text {
            // What was not understood may have been mended or removed.
            map = Map::parse(&map.to_text())?;
        }
        let mut label = edits.first().map_or_else(String::new, Edit::label);
        if edits.len() > 1 {
            label += " and more";
        }
        let targets: Option<Vec<String>> = edits.iter().map(Edit::target).collect();
        let map = Arc::new(map);
        let targets = targets.map(|targets| targets.join("; "));
        self.history.push(label, targets, now, (&self.snapshot(), &map));
        self.show(map);
        Ok(applied)
    }

    /// Takes back the last step, and selects what was selected before it; its label.
    pub fn undo(&mut self) -> Option<&str> {
        let Snapshot { map, selection } = self.history.undo(self.snapshot())?;
        self.show(map);
        self.select(selection);
        self.redo_label()
    }

    /// Does again what was undone last; its label.
    pub fn redo(&mut self) -> Option<&str> {
        let Snapshot { map, selection } = self.history.redo(self.snapshot())?;
        self.show(map);
        self.select(selection);
        self.undo_label()
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot { map: Arc::clone(&self.map), selection: self.selection.clone() }
    }

    /// What [`Document::undo`] would undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.history.undo_label()
    }

    /// What [`Document::redo`] would do again.
    pub fn redo_label(&self) -> Option<&str> {
        self.history.redo_label()
    }

    /// Puts a map in the place of the one that is open.
    fn show(&mut self, map: Arc<Map>) {
        self.extras = Extras::of(&map);
        self.places = transaction::places_of_others(&map, &self.sizes);
        self.map = map;
        self.text = OnceCell::new();
        self.revision += 1;
        let (map, extras) = (&self.map, &self.extras);
        self.selection.retain(|item| transaction::exists(map, extras, item));
    }

    /// What is selected; no part of the map.
    pub fn selection(&self) -> &IndexSet<Item> {
        &self.selection
    }

    /// Selects items, and nothing else. Those that are not there are passed over.
    pub fn select(&mut self, items: impl IntoIterator<Item = Item>) {
        let (map, extras) = (&self.map, &self.extras);
        let items = items.into_iter().filter(|item| transaction::exists(map, extras, item));
        self.selection = items.collect();
    }

    /// Tells how large a node was drawn, for the edits that put nodes in lines and layers.
    pub fn set_size(&mut self, node: &str, size: [f64; 2]) {
        match self.sizes.get_mut(node) {
            Some(known) => *known = size,
            None => drop(self.sizes.insert(node.to_owned(), size)),
        }
    }

    /// Lays the nodes out that have no place in the map, as large as they are drawn. The map stays
    /// as it is.
    pub fn place_others(&mut self) {
        self.places = transaction::places_of_others(&self.map, &self.sizes);
    }

    /// Writes the map to its file.
    pub fn save(&mut self) -> Result<(), MapError> {
        match self.path.clone() {
            Some(path) => self.save_as(&path),
            None => Err(MapError::Io {
                path: PathBuf::from("untitled"),
                source: std::io::Error::new(ErrorKind::InvalidInput, "the map has no file yet"),
            }),
        }
    }

    /// Writes the map to a file, which is its own from now on.
    pub fn save_as(&mut self, path: &Path) -> Result<(), MapError> {
        self.map.save(path)?;
        self.path = Some(path.to_owned());
        self.on_disk = Some(self.text().to_owned());
        self.history.seal();
        Ok(())
    }

    /// What became of the file since it was read or saved; `None` if it holds the same bytes, or
    /// cannot be read for now.
    pub fn disk_change(&mut self) -> Option<DiskChange> {
        let content = self.read_disk().ok()?;
        match (content, &self.on_disk) {
            (None, None) => None,
            (None, Some(_)) => Some(DiskChange::Removed),
            (Some(content), known) => {
                (Some(&content) != known.as_ref()).then_some(DiskChange::Changed)
            }
        }
    }

    /// Reads the file anew, as a step that can be undone.
    pub fn reload(&mut self) -> Result<(), MapError> {
        let Some(path) = self.path.clone() else { return Ok(()) };
        let map = Map::load(&path)?;
        self.on_disk = Some(map.to_text());
        if map != *self.map {
            let map = Arc::new(map);
            let maps = (&self.snapshot(), &map);
            self.history.push("Reload from disk".to_owned(), None, Instant::now(), maps);
            self.show(map);
        }
        Ok(())
    }

    /// Keeps what is here: what the file holds now is known, and replaced when the map is saved.
    pub fn keep_mine(&mut self) {
        if let Ok(content) = self.read_disk() {
            self.on_disk = content;
        }
    }

    /// The content of the file; `None` where there is no file.
    fn read_disk(&self) -> std::io::Result<Option<String>> {
        let Some(path) = &self.path else { return Ok(self.on_disk.clone()) };
        match std::fs::read(path) {
            Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }
}
