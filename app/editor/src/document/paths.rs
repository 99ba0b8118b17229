//! Paths of input files in a map that moves to another folder.

use std::ffi::OsString;
use std::path::{Component, Path, PathBuf, absolute};

use mve_core::{Map, Registry, all_given, declared_at};
use serde_json::Value as Json;

use super::edit::Edit;

/// A path as a map in a folder writes it, with `/` between its parts: relative where it is given
/// so, and where it lies below the folder. A map without a folder keeps it as it is.
pub fn written_path(path: &Path, folder: Option<&Path>) -> String {
    let seen = folder.and_then(|folder| seen_from(path, folder));
    let is_below = |seen: &PathBuf| !seen.starts_with("..");
    let seen = seen.filter(|seen| path.is_relative() || is_below(seen));
    let whole = || match folder {
        Some(_) => absolute(path).unwrap_or_else(|_| path.to_owned()),
        None => path.to_owned(),
    };
    seen.unwrap_or_else(whole).to_string_lossy().replace('\\', "/")
}

/// A path as seen from a folder, with `..` where it does not lie below; `None` from one drive to
/// another.
fn seen_from(path: &Path, folder: &Path) -> Option<PathBuf> {
    let [path, folder] = [parts(path)?, parts(folder)?];
    let n_common = path.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    let is_one_drive = n_common > 0 || path.is_empty() || folder.is_empty();
    let up = folder[n_common..].iter().map(|_| Component::ParentDir.as_os_str().to_owned());
    is_one_drive.then(|| up.chain(path[n_common..].iter().cloned()).collect())
}

/// The parts of an absolute path, each `..` done.
fn parts(path: &Path) -> Option<Vec<OsString>> {
    let mut parts = Vec::new();
    for part in absolute(path).ok()?.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(parts.pop()),
            other => parts.push(other.as_os_str().to_owned()),
        }
    }
    Some(parts)
}

/// The edits after which the relative paths of a map, moved from one folder to another, name the
/// files that they named before. Paths to where no file is stay as they are.
pub fn move_paths(map: &Map, registry: &Registry, from: &Path, to: &Path) -> Vec<Edit> {
    let moved = |json: &Json| {
        let old = Path::new(json.as_str()?);
        let file: PathBuf = from.join(old);
        let is_moved = old.is_relative() && file.is_file();
        let to = if to.as_os_str().is_empty() { Path::new(".") } else { to };
        let seen = is_moved.then(|| seen_from(&file, to)).flatten();
        let seen = seen.map(|seen| Json::from(seen.to_string_lossy().replace('\\', "/")));
        seen.filter(|new| new != json)
    };
    let specs = |module: &str| registry.find(module).map_or(&[][..], |info| info.module.params);
    let is_input = |node: &str, param: &str| {
        let node = map.nodes.get(node);
        let spec = node.and_then(|n| declared_at(specs(&n.module), Some(&n.params), param));
        spec.is_some_and(|spec| spec.input_file().is_some())
    };
    let mut edits = Vec::new();
    for (node, content) in &map.nodes {
        let given = all_given(specs(&content.module), &content.params).into_iter();
        for (path, _, json) in given.filter(|(_, spec, _)| spec.input_file().is_some()) {
            if let Some(value) = moved(json) {
                edits.push(Edit::SetParam { node: node.clone(), path, value: Some(value) });
            }
        }
    }
    let is_varied = |path: &str| path.split_once('.').is_some_and(|(n, p)| is_input(n, p));
    for (name, spec) in &map.programs {
        let mut changed = spec.clone();
        let in_axes = changed.axes.iter_mut().flatten().filter(|(path, _)| is_varied(path));
        let in_axes = in_axes.flat_map(|(_, values)| values);
        let in_steps = changed.steps.iter_mut().flatten().filter(|(path, _)| is_varied(path));
        for value in in_axes.chain(in_steps.map(|(_, value)| value)) {
            *value = moved(value).unwrap_or_else(|| value.take());
        }
        if changed != *spec {
            edits.push(Edit::SetProgram { name: name.clone(), spec: Some(changed) });
        }
    }
    edits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_from_the_new_folder() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        for file in [old.join("a.obj"), new.join("b.obj")] {
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "v 0 0 0").unwrap();
        }
        let map = Map::parse(
            r#"{"mve": 1, "nodes": {
                "one": {"module": "ObjLoader", "params": {"path": "a.obj"}},
                "two": {"module": "ObjLoader", "params": {"path": "../new/b.obj"}},
                "gone": {"module": "ObjLoader", "params": {"path": "gone.obj"}},
                "out": {"module": "ObjSaver", "params": {"path": "a.obj"}}},
                "programs": {"p": {"axes": [{"one.path": ["a.obj", "gone.obj"], "out.path": ["a.obj", "b"]}]}}}"#,
        );
        let mut document = crate::document::Document::from_text(&map.unwrap().to_text()).unwrap();
        let registry = mve_modules::registry();
        let edits = move_paths(document.map(), &registry, &old, &new);
        document.apply(&edits, &registry).unwrap();
        let path = |node: &str| document.map().nodes[node].params["path"].as_str().unwrap();
        let a = "../old/a.obj";
        assert_eq!(path("one"), a);
        assert_eq!([path("gone"), path("out")], ["gone.obj", "a.obj"]);
        assert_eq!(path("two"), "b.obj");
        let axis = &document.map().programs["p"].axes[0];
        assert_eq!(axis["one.path"], [Json::from(a), Json::from("gone.obj")]);
        assert_eq!(axis["out.path"], ["a.obj", "b"]);
        assert_eq!(move_paths(document.map(), &registry, &new, &new), []);
    }

    #[test]
    fn what_is_given_relative_stays_so() {
        let folder = absolute("maps").unwrap();
        let written = |path: &str| written_path(Path::new(path), Some(&folder));
        assert_eq!(written("maps/models/a.obj"), "models/a.obj");
        assert_eq!(written("models/../a.obj"), "../a.obj");
        let below = folder.join("a.obj");
        assert_eq!(written_path(&below, Some(&folder)), "a.obj");
        let beside = absolute("a.obj").unwrap();
        let whole = beside.to_string_lossy().replace('\\', "/");
        assert_eq!(written_path(&beside, Some(&folder)), whole);
        assert_eq!(written_path(Path::new("a/b.obj"), None), "a/b.obj");
    }
}
