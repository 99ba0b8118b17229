//! Maps as nodes of other maps, and loops: opened before a map is planned.
//!
//! A node whose module is the name of a map in `maps`, or the path of a map's file, stands for that
//! map. Its ports are the nodes `MapInput` and `MapOutput` inside, its parameters those that the
//! map declares in `parameters`. Opening puts the nodes of the inner map in its place, by the names
//! `node/inner`, so that steps, keys and the cache know of nothing but modules; a node of its own
//! name stays, which takes what the map gives, for whoever looks there.
//!
//! A node with `repeat`, be it a module or a map, is put there once a round, as `node/1`, `node/2`,
//! … All rounds are planned: a loop with a condition has as many as it may have at most, and those
//! behind its end do not run.

mod ends;
mod interface;
mod level;
mod open;
mod paths;
mod rounds;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

pub use ends::{MAP_ENDS, MAP_INPUT, MAP_OUTPUT};
use indexmap::IndexMap;
pub(crate) use interface::parameter_warnings;
pub(crate) use open::open;

use crate::files::refuse_special;
use crate::fingerprint::Fingerprint;
use crate::map::{Map, MapError};
use crate::problem::Problem;
use crate::registry::{ModuleInfo, OpenMap, Registry};

/// How deep maps stand in maps.
const DEEPEST: usize = 32;

/// Whether a node belongs to one round of a loop: of what all rounds give the loop has a table.
pub fn is_of_round(node: &str) -> bool {
    let is_number = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    node.contains('>') || node.split('/').skip(1).any(is_number)
}

/// A map that names others, and where it stands.
#[derive(Clone, Copy)]
struct Around<'a> {
    map: &'a Map,
    folder: &'a Path,
    /// What tells it from all others: its file, and the names that lead to it there.
    identity: &'a str,
    /// The map around this one, if it stands in that one's file.
    outer: Option<&'a Around<'a>>,
    /// The maps that lead here, each by what tells it from others and as a person names it.
    way: &'a [(String, String)],
}

/// Maps that were found, by what tells them from others and as they are named: each is opened once,
/// however many ways lead to it.
type Found = HashMap<(String, String), Arc<OpenMap>>;

impl Registry {
    /// The same modules, with the maps that this one names. What is wrong with those is told when
    /// the map is planned.
    pub fn with_maps_of(&self, map: &Map, folder: &Path) -> Self {
        self.with_maps(map, folder, &mut Vec::new())
    }

    pub(crate) fn with_maps(&self, map: &Map, folder: &Path, problems: &mut Vec<Problem>) -> Self {
        if !map.has_maps() && map.maps.is_empty() {
            return self.clone();
        }
        let around = Around { map, folder, identity: "", outer: None, way: &[] };
        find_all(self, around, &mut Found::new(), problems)
    }
}

/// The registry for a map: the maps that its nodes name.
fn find_all(
    registry: &Registry,
    around: Around,
    found: &mut Found,
    problems: &mut Vec<Problem>,
) -> Registry {
    let mut maps = IndexMap::new();
    for (name, node) in around.map.nodes.iter().filter(|(_, node)| node.is_map()) {
        if maps.contains_key(&node.module) {
            continue;
        }
        let mut inside = Vec::new();
        match find(registry, &node.module, around, (found, &mut inside)) {
            Ok(Some(map)) => drop(maps.insert(node.module.clone(), map)),
            // Where an inner map is looked at alone, those around it are known.
            Ok(None) => {
                let known = registry.open_map(&node.module);
                maps.extend(known.map(|map| (node.module.clone(), Arc::clone(map))));
            }
            Err(message) => problems.push(Problem::error(message).at(name).port("module")),
        }
        problems.extend(inside.into_iter().map(|problem| within(name, problem)));
    }
    // Those that no node names yet can be put in.
    for name in around.map.maps.keys() {
        if !maps.contains_key(name)
            && let Ok(Some(map)) = find(registry, name, around, (found, &mut Vec::new()))
        {
            maps.insert(name.clone(), map);
        }
    }
    registry.with_open_maps(maps)
}

/// A problem of a map as one of the node that stands for it.
fn within(node: &str, mut problem: Problem) -> Problem {
    problem.place.node = Some(match problem.place.node {
        Some(inner) => format!("{node}/{inner}"),
        None => node.to_owned(),
    });
    problem.place.path = None;
    problem
}

/// The map of this name as seen from another one, if there is one.
fn find(
    registry: &Registry,
    id: &str,
    around: Around,
    (found, problems): (&mut Found, &mut Vec<Problem>),
) -> Result<Option<Arc<OpenMap>>, String> {
    let mut place = Some(&around);
    while let Some(here) = place {
        if let Some(map) = here.map.maps.get(id) {
            let identity = format!("{}\n{id}", here.identity);
            let inner = Around { map, identity: &identity, outer: Some(here), ..around };
            return opened(registry, id, inner, Path::new(""), (found, problems)).map(Some);
        }
        place = here.outer;
    }
    if !id.ends_with(".json") {
        return Ok(None);
    }
    let path = around.folder.join(id);
    let identity = path.canonicalize().unwrap_or_else(|_| path.clone());
    let identity = identity.to_string_lossy().into_owned();
    if let Some(known) = found.get(&(identity.clone(), id.to_owned())) {
        return Ok(Some(Arc::clone(known)));
    }
    // A link may lead to a map; a pipe would be waited for.
    refuse_special(Path::new(&identity)).map_err(|why| format!("{}: {why}", path.display()))?;
    let map = Map::load(&path).map_err(|error| match error {
        MapError::Io { .. } => format!("{error}; paths in a map are relative to its folder"),
        error => format!("{}: {error}", path.display()),
    })?;
    let folder = Path::new(id).parent().unwrap_or(Path::new(""));
    let inner_folder = around.folder.join(folder);
    let (identity, way) = (identity.as_str(), around.way);
    let inner = Around { map: &map, folder: &inner_folder, identity, outer: None, way };
    opened(registry, id, inner, folder, (found, problems)).map(Some)
}

/// Opens a map that was found; its files are in `folder`, as seen from the map that names it.
fn opened(
    registry: &Registry,
    id: &str,
    inner: Around,
    folder: &Path,
    (found, problems): (&mut Found, &mut Vec<Problem>),
) -> Result<Arc<OpenMap>, String> {
    let name = (inner.identity.to_owned(), id.to_owned());
    if let Some(known) = found.get(&name) {
        return Ok(Arc::clone(known));
    }
    let mut way = inner.way.to_vec();
    if let Some(first) = way.iter().position(|known| known.0 == inner.identity) {
        let names = way[first..].iter().map(|(_, name)| name.as_str()).chain([id]);
        let names: Vec<&str> = names.collect();
        return Err(format!("the map contains itself: {}", names.join(" -> ")));
    }
    way.push(name.clone());
    if way.len() > DEEPEST {
        return Err(format!("maps stand in maps more than {DEEPEST} deep"));
    }
    problems.extend(inner.map.problems().iter().cloned());
    let registry = find_all(registry, Around { way: &way, ..inner }, found, problems);
    let module = interface::interface(id, inner.map, &registry, folder);
    let version = Fingerprint::of(b"mve: a map as a node");
    let info = ModuleInfo { module, category: "structure", version };
    problems.extend(interface::faults(inner.map, &registry));
    let (map, folder) = (inner.map.as_inside(), folder.to_owned());
    let open = Arc::new(OpenMap { info, map, registry, folder });
    found.insert(name, Arc::clone(&open));
    Ok(open)
}
