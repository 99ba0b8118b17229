//! Names for new parts of a map.

use std::collections::HashSet;

use mve_core::Map;
use serde_json::Value as Json;

/// A name that is not taken: `name` itself, or `name-2`, `name-3` and so on.
pub(super) fn free_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    let stem = match name.rsplit_once('-') {
        Some((stem, number)) if !stem.is_empty() && number.parse::<u32>().is_ok() => stem,
        _ => name,
    };
    let mut number = 2_u64;
    loop {
        let candidate = format!("{stem}-{number}");
        if !is_taken(&candidate) {
            return candidate;
        }
        number += 1;
    }
}

/// The name of a node after its module: `ObjLoader` becomes `obj_loader`.
pub(super) fn name_after(module: &str) -> String {
    let mut name = String::new();
    let mut before = '_';
    for c in module.chars() {
        let begins_a_word = c.is_uppercase() && !before.is_uppercase() && before != '_';
        if begins_a_word {
            name.push('_');
        }
        before = if Map::can_name_a_node(c.encode_utf8(&mut [0; 4])) { c } else { '_' };
        name.extend(before.to_lowercase());
    }
    if name.is_empty() { "node".to_owned() } else { name }
}

/// The names in a section of a map's file, those of parts that were not understood too.
pub(super) fn taken(map: &Map, section: &str) -> HashSet<String> {
    match map.to_json().get(section) {
        Some(Json::Object(parts)) => parts.keys().cloned().collect(),
        _ => HashSet::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_raised_and_not_piled_up() {
        let taken = ["load", "load-2", "a-b"];
        let free = |name: &str| free_name(name, |name| taken.contains(&name));
        assert_eq!(free("save"), "save");
        assert_eq!(free("load"), "load-3");
        assert_eq!(free("load-2"), "load-3");
        assert_eq!(free("a-b"), "a-b-2");
    }

    #[test]
    fn names_of_modules_become_names_of_nodes() {
        assert_eq!(name_after("ObjLoader"), "obj_loader");
        assert_eq!(name_after("Msdm2"), "msdm2");
        assert_eq!(name_after("A b.C"), "a_b_c");
        assert_eq!(name_after(""), "node");
    }
}
