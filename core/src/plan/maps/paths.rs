//! What parameters of an inner map say of places: files, and nodes that names of files quote.

use std::path::Path;

use serde_json::{Map as JsonMap, Value as Json};

use super::level::Level;
use crate::map::Node;
use crate::param::{ParamSpec, all_given, given_at_mut};
use crate::template::{Piece, pieces};

/// The parameters of a node as the outermost map would say them: files as seen from its folder, and
/// nodes by their whole names. What came from outside is so already.
pub(super) fn from_outside(level: &Level, name: &str, node: &Node) -> JsonMap<String, Json> {
    let mut params = node.params.clone();
    let is_plain = level.folder.as_os_str().is_empty() && level.prefix.is_empty();
    let Some(info) = level.registry.find(&node.module).filter(|_| !is_plain) else { return params };
    let mut changes = Vec::new();
    for (path, spec, json) in all_given(info.module.params, &node.params) {
        let is_given = |given: &String| path == *given || path.starts_with(&format!("{given}."));
        let given = level.given.iter().filter(|(of, _)| of == name);
        let Some(written) = json.as_str() else { continue };
        if given.into_iter().any(|(_, given)| is_given(given)) {
            continue;
        }
        if spec.input_file().is_some() {
            changes.push((path, seen_from_outside(level.folder.as_path(), written)));
        } else if spec.output_file().is_some() {
            changes.push((path, with_whole_names(level, written)));
        }
    }
    for (path, text) in changes {
        if let Some(value) = given_at_mut(&mut params, &path) {
            *value = Json::from(text);
        }
    }
    params
}

/// Parameters of a module with the files that they name as seen from outside of a folder.
pub(super) fn with_files_of(
    folder: &Path,
    specs: &'static [ParamSpec],
    params: &JsonMap<String, Json>,
) -> JsonMap<String, Json> {
    let mut seen = params.clone();
    for (path, spec, json) in all_given(specs, params) {
        if let (Some(_), Some(written)) = (spec.input_file(), json.as_str())
            && let Some(value) = given_at_mut(&mut seen, &path)
        {
            *value = Json::from(seen_from_outside(folder, written));
        }
    }
    seen
}

fn seen_from_outside(folder: &Path, written: &str) -> String {
    match Path::new(written).is_absolute() || folder.as_os_str().is_empty() || written.is_empty() {
        true => written.to_owned(),
        false => folder.join(written).to_string_lossy().replace('\\', "/"),
    }
}

/// A template with the nodes that it quotes by the names that they have once the map is opened.
fn with_whole_names(level: &Level, template: &str) -> String {
    let Ok(pieces) = pieces(template) else { return template.to_owned() };
    let piece = |piece: Piece| match piece {
        Piece::Literal(text) => text.to_owned(),
        Piece::Reference(name) => {
            let is_inside = |(node, _): &(&str, &str)| level.map.nodes.contains_key(*node);
            match name.split_once('.').filter(is_inside) {
                Some((node, rest)) => format!("{{{}{node}.{rest}}}", level.prefix),
                None => format!("{{{name}}}"),
            }
        }
    };
    pieces.into_iter().map(piece).collect()
}
